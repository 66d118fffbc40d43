//! Equilibria and how they are found: closed forms, methods, tangents, events, hard scenes.
#![allow(
    clippy::unwrap_used,
    clippy::print_stderr,
    reason = "a test that fails may panic and say why"
)]

#[path = "../../benches/stability/agreement.rs"]
mod agreement;
mod closed_forms;
mod cylinder;
mod cylinder_contacts;
mod cylinder_refused;
mod derivatives;
#[path = "../../benches/stability/detection.rs"]
mod detection;
mod equilibria;
mod error_estimate;
mod events;
mod grains;
#[path = "../common/hard.rs"]
#[allow(dead_code, reason = "the bench takes the rest")]
mod hard;
mod hysteresis;
#[path = "../common/increments.rs"]
mod increments;
mod membrane_curvature;
mod membranes;
mod methods;
#[path = "../common/packs.rs"]
mod packs;
#[path = "../common/pairs.rs"]
mod pairs;
mod peer_pack;
#[path = "../../benches/stability/reference.rs"]
mod reference;
mod slopes;
mod stability;
mod tangent;
mod tangent_twin;
mod threads;

//! Cement between grains: balance, breakage, laws in two steps, and hydrate that dissociates.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod balance;
mod cement;
#[path = "../common/cemented.rs"]
mod cemented;
mod cracks;
mod cracks_bag;
mod hydrate;
mod hydrate_bag;
mod hydrate_commands;
#[path = "../common/hydrates.rs"]
mod hydrates;
#[path = "../common/increments.rs"]
mod increments;
mod of_hydrate;
#[path = "../common/packs.rs"]
mod packs;
#[cfg(feature = "mcap")]
#[path = "../common/python.rs"]
mod python;
mod round;
mod tangent;
mod two_step;
mod two_step_closed_forms;

//! Friction: the laws of one contact, closed forms, and packs.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod balance;
mod clamped;
mod closed_forms;
mod frames;
mod laws;
mod pack;
#[path = "../common/packs.rs"]
mod packs;
mod partial_slip;
mod partial_slip_steps;
mod peers;
#[path = "../common/punches.rs"]
mod punches;
#[path = "../common/rough.rs"]
mod rough;
#[path = "../common/sheared.rs"]
mod sheared;

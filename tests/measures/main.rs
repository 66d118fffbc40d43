//! What is measured of a pack: its force network and how its grains move.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod fabric;
mod fabric_bag;
mod fabric_chains;
mod motion;
mod motion_local;
#[path = "../common/packs.rs"]
mod packs;
#[cfg(feature = "mcap")]
#[path = "../common/python.rs"]
mod python;
#[path = "../common/rough.rs"]
mod rough;

//! Discs in the plane.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "../common/cemented.rs"]
mod cemented;
#[path = "../common/packs.rs"]
mod packs;

mod balance;
mod biaxial;
mod bonds;
mod crystal;
mod crystals;
mod discs;
mod gradings;
mod rescale;
mod samples;

//! Discs in the plane.

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "../common/cemented.rs"]
mod cemented;
#[path = "../common/packs.rs"]
mod packs;

mod balance;
mod biaxial;
mod cracking;
mod crystal;
mod discs;
mod gradings;
mod lattice;
mod no_z;
mod rescale;
mod samples;
mod threads;

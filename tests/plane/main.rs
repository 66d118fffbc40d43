//! Discs in the plane.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "../common/cemented.rs"]
mod cemented;
#[path = "../common/packs.rs"]
mod packs;

mod annulus;
mod balance;
mod beam;
mod biaxial;
mod bonds;
mod cracking;
mod crystal;
mod derivatives;
mod discs;
mod dynamic;
mod gradings;
mod lattice;
mod membranes;
mod motion;
mod no_z;
mod outputs;
mod points;
mod rescale;
mod samples;
mod shear;
mod sweeps;
mod tangent;
mod threads;

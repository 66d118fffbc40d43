//! Discs in the plane.

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod balance;
mod biaxial;
mod discs;
mod shear;

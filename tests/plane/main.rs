//! Discs in the plane.

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod balance;
mod biaxial;
mod crystal;
mod discs;
mod outputs;

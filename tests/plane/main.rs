//! Discs in the plane.

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod annulus;
mod balance;
mod biaxial;
mod derivatives;
mod discs;
mod membranes;
mod points;

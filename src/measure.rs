//! What an equilibrium tells: wall forces, stress, strain, moduli, porosity, coordination.
//!
//! Everything is computed from the load-carrying contacts of one state, listed once. Beside it, how
//! that compares with what a real rig measures ([`discrepancy`]).

pub mod contacts;
pub mod coordination;
pub mod discrepancy;
pub mod fabric;
pub mod grains;
pub mod moduli;
pub mod motion;
pub mod network;
pub mod porosity;
pub mod rearrangement;
pub mod stress;
pub mod tangent;
pub mod walls;

//! What an equilibrium tells: wall forces, stress, strain, moduli, porosity, coordination, the force
//! network, what events and cement did, and how the grains moved.
//!
//! Nearly everything is computed from the load-carrying contacts of one state, listed once. Beside it,
//! how that compares with what a real rig measures ([`discrepancy`]).

use nalgebra::Matrix3;

pub mod cement;
pub mod contacts;
pub mod coordination;
pub mod discrepancy;
pub mod fabric;
pub mod grains;
pub mod hydrate;
pub mod moduli;
pub mod motion;
pub mod network;
pub mod plane;
pub mod porosity;
pub mod rearrangement;
pub mod shear;
pub mod stress;
pub mod sudden;
pub mod tangent;
pub mod walls;

/// The entries of a tensor row by row, as reports and messages have them.
pub(crate) fn row_major(m: &Matrix3<f64>) -> [f64; 9] {
    std::array::from_fn(|k| m[(k / 3, k % 3)])
}

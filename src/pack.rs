//! The specimen: grains with their properties, and the box they are in.

pub mod generate;
pub mod properties;

use crate::wall::Bounds;

/// One grain's constants and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Radius R \[m\].
    pub radius: f64,
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Coefficient of friction μ.
    pub friction: f64,
}

/// Grains in a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Pack {
    /// The walls' positions.
    pub bounds: Bounds,
    /// The grains, in the order of the pack file.
    pub grains: Vec<Grain>,
}

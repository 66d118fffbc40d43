//! An elastic cylinder of cement beside the contact of the grains (T 4.7): the parallel bond.
//!
//! The cylinder is pinned to each body at a cementing point ξ. Its force follows the way between
//! the two points, in every direction with the same stiffness, its couple the twist.

use std::f64::consts::PI;

/// Stiffnesses of a cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// π R̄² Ē/L̄ \[N/m\] (4.20).
    pub stiffness: f64,
    /// π R̄⁴ Ḡ/(2 L̄) \[N m\] (4.21).
    pub torsion_stiffness: f64,
}

impl Cylinder {
    /// Of radius R̄ and length L̄ \[m\] and the moduli Ē and Ḡ \[Pa\].
    #[must_use]
    pub fn new(radius: f64, length: f64, young: f64, shear: f64) -> Self {
        let area = PI * radius * radius;
        Self {
            stiffness: area * young / length,
            torsion_stiffness: 0.5 * area * radius * radius * shear / length,
        }
    }

    /// The cylinder with that share of its cement left.
    #[must_use]
    pub fn times(&self, share: f64) -> Self {
        Self {
            stiffness: share * self.stiffness,
            torsion_stiffness: share * self.torsion_stiffness,
        }
    }
}

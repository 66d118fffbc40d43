//! An elastic cylinder of cement beside the contact of the grains (T 4.7): the parallel bond.
//!
//! The cylinder is pinned to each body at a cementing point, where the contact was at the deposition.
//! Its force follows the way from one point to the other, in every direction with the same
//! stiffness (4.20), its couple the twist (4.21). The increments (4.19) of that way are those of the
//! contact: its part along the normal adds up to the approach since the deposition, its part across
//! turns with the contact plane as all tangential forces do, which differs from a way that stays
//! where it was by the square of the rotation of the plane.

use std::f64::consts::PI;

use super::effective::Normal;

/// A cylinder of cement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// π R̄² Ē/L̄ \[N/m\] (4.20).
    pub stiffness: f64,
    /// π R̄⁴ Ḡ/(2 L̄) \[N m\] (4.21).
    pub torsion_stiffness: f64,
    /// r⁽ᶜ⁾ \[m\].
    pub distance: f64,
}

impl Cylinder {
    /// Of radius R̄ and length L̄ \[m\] and the moduli Ē and Ḡ \[Pa\], between bodies `distance` \[m\]
    /// apart at the deposition, with the share `share` of its cement left.
    #[must_use]
    pub fn new(
        [radius, length]: [f64; 2],
        [young, shear]: [f64; 2],
        distance: f64,
        share: f64,
    ) -> Self {
        let area = share * PI * radius * radius;
        Self {
            stiffness: area * young / length,
            torsion_stiffness: 0.5 * area * radius * radius * shear / length,
            distance,
        }
    }

    /// Force, stiffness and energy along the normal at the distance `distance` \[m\] (4.20, 4.26a).
    #[must_use]
    pub fn answer(&self, distance: f64) -> Normal {
        let approach = self.distance - distance;
        let force = self.stiffness * approach;
        Normal { force, stiffness: self.stiffness, energy: 0.5 * force * approach }
    }
}

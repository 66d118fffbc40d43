//! The thick-walled cylinder (A.96-A.114, 34-37).
//!
//! In the plane (A.9) as in B's three dimensions the constant modulus drops out of the stresses
//! A.113. Of A.112 the D must begin with a minus, or A.111 would not give σzz = P_z; nothing else
//! depends on it.

mod rings;

pub use rings::{Ring, Rings, edge_density};

use super::hooke::Hooke;
use super::strength::MohrCoulomb;

/// A cylinder with the pressures on its walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    /// Radius a of the hole \[m\].
    pub inner: f64,
    /// Outer radius b \[m\].
    pub outer: f64,
    /// Pressure in the hole \[Pa\], which B has empty.
    pub inner_pressure: f64,
    /// P_r \[Pa\], on the outer wall.
    pub outer_pressure: f64,
}

/// Stresses at a radius \[Pa\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hoop {
    /// σrr.
    pub radial: f64,
    /// σtt.
    pub tangential: f64,
}

impl Cylinder {
    /// The stresses at `radius` \[m\] for a constant modulus (A.113, with a pressure in the hole).
    #[must_use]
    pub fn stress(&self, radius: f64) -> Hoop {
        let [even, odd] = self.parts();
        let odd = odd / (radius * radius);
        Hoop { radial: even - odd, tangential: even + odd }
    }

    /// Displacement towards the axis \[m\] at `radius` \[m\] (A.107).
    #[must_use]
    pub fn inward(&self, elastic: &Hooke, radius: f64) -> f64 {
        let Hoop { radial, tangential } = self.stress(radius);
        radius * (tangential - elastic.poisson * radial) / elastic.young
    }

    /// Even part \[Pa\] of the stresses, and what r² divides \[N\].
    fn parts(&self) -> [f64; 2] {
        let [a, b] = [self.inner, self.outer].map(|radius| radius * radius);
        let even = (b * self.outer_pressure - a * self.inner_pressure) / (b - a);
        [even, a * b * (self.outer_pressure - self.inner_pressure) / (b - a)]
    }
}

/// P_r \[Pa\] at which the wall of an empty hole fails (34, 36), for `ratio` = a/b.
#[must_use]
pub fn failure_pressure(material: &MohrCoulomb, ratio: f64) -> f64 {
    0.5 * material.uniaxial() * (1.0 - ratio * ratio)
}

/// P_r at which failure begins at r = a + d̄ over that at which it would at r = a, to the first order
/// in `layer` = d̄/a (37). Nothing where that is no pressure any more.
#[must_use]
pub fn edge_effect(friction: f64, layer: f64) -> Option<f64> {
    let top = 1.0 - friction.sin();
    let below = top - 2.0 * layer;
    (below > 0.0).then(|| top / below)
}

/// The same from A.113 and A.94 with nothing left out.
#[must_use]
pub fn edge_effect_exact(material: &MohrCoulomb, layer: f64) -> Option<f64> {
    let square = (1.0 + layer).powi(-2);
    let below = (1.0 + square) - material.ratio() * (1.0 - square);
    (below > 0.0).then(|| 2.0 / below)
}

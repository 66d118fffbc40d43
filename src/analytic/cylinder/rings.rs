//! The cylinder with a modulus that depends on the radius (4.4.3, the dashed line of figure 46).
//!
//! Rings of constant modulus each hold A.107 with their own constants: displacement and radial stress
//! go on from ring to ring, so that the sum is exact and needs no grid but the rings themselves. Both
//! are linear in the two unknowns at the hole, of which the pressures give one each.

use super::{Cylinder, Hoop};
use crate::analytic::strength::MohrCoulomb;

/// A ring of constant modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Its outer radius \[m\]; the ring before ends where it begins.
    pub outer: f64,
    /// Its Young's modulus \[Pa\], above 0.
    pub young: f64,
}

/// A cylinder of rings that stick to each other, from the hole outwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Rings {
    /// Radius of the hole \[m\].
    inner: f64,
    poisson: f64,
    rings: Vec<Ring>,
    /// Displacement and stress at the inner side of every ring, and last at the outer wall.
    sides: Vec<Side>,
}

/// Inward displacement \[m\] and radial stress \[Pa\] at a radius.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    inward: f64,
    radial: f64,
}

impl Rings {
    /// The cylinder from `shape` whose `rings` end at its outer radius, with Poisson's ratio ν of all;
    /// nothing when they are not in order or without stiffness.
    #[must_use]
    pub fn new(shape: &Cylinder, poisson: f64, rings: Vec<Ring>) -> Option<Self> {
        let ordered = rings.windows(2).all(|pair| pair[0].outer < pair[1].outer);
        let starts =
            rings.first().is_some_and(|first| shape.inner > 0.0 && first.outer > shape.inner);
        let ends = rings.last().is_some_and(|last| last.outer == shape.outer);
        let stiff = rings.iter().all(|ring| ring.young > 0.0) && poisson.abs() < 1.0;
        if !(ordered && starts && ends && stiff) {
            return None;
        }
        let inner = shape.inner;
        let mut of = Self { inner, poisson, rings, sides: Vec::new() };
        // One solution with the pressure in the hole, and one with a displacement there alone.
        let pressed = of.outwards(Side { inward: 0.0, radial: shape.inner_pressure });
        let moved = of.outwards(Side { inward: inner, radial: 0.0 });
        let [at, by] = [&pressed, &moved].map(|sides| sides[of.rings.len()].radial);
        let share = (shape.outer_pressure - at) / by;
        let both = |(one, other): (&Side, &Side)| Side {
            inward: one.inward + share * other.inward,
            radial: one.radial + share * other.radial,
        };
        of.sides = pressed.iter().zip(&moved).map(both).collect();
        Some(of)
    }

    /// `count` rings of equal width with the modulus \[Pa\] that `young` has in their middles \[m\].
    #[must_use]
    pub fn of_modulus(
        shape: &Cylinder,
        poisson: f64,
        count: u32,
        young: impl Fn(f64) -> f64,
    ) -> Option<Self> {
        let width = (shape.outer - shape.inner) / f64::from(count);
        let ring = |number: u32| {
            let begin = shape.inner + f64::from(number) * width;
            // The last one to the last bit.
            let outer = if number + 1 == count { shape.outer } else { begin + width };
            Ring { outer, young: young(begin + 0.5 * width) }
        };
        Self::new(shape, poisson, (0..count).map(ring).collect())
    }

    /// The stresses at `radius` \[m\], of the inner ring where two meet; nothing outside.
    #[must_use]
    pub fn stress(&self, radius: f64) -> Option<Hoop> {
        let number = self.ring_at(radius)?;
        Some(self.within(number, self.sides[number], radius).1)
    }

    /// Displacement towards the axis \[m\] at `radius` \[m\]; nothing outside.
    #[must_use]
    pub fn inward(&self, radius: f64) -> Option<f64> {
        let number = self.ring_at(radius)?;
        Some(self.within(number, self.sides[number], radius).0.inward)
    }

    /// Where and at which share of the pressures the cylinder fails first: radius \[m\] and share, of
    /// the sides of all rings. The pressures grow together. Nothing when no pressure makes it fail.
    #[must_use]
    pub fn failure(&self, material: &MohrCoulomb) -> Option<(f64, f64)> {
        let places = (0..self.rings.len()).flat_map(|number| {
            let ring = self.rings[number];
            [self.begin(number), ring.outer].map(|radius| (number, radius))
        });
        let share = |(number, radius): (usize, f64)| {
            let Hoop { radial, tangential } = self.within(number, self.sides[number], radius).1;
            let (major, minor) = (radial.max(tangential), radial.min(tangential));
            (radius, material.uniaxial() / (major - material.ratio() * minor))
        };
        let first = |one: (f64, f64), other: (f64, f64)| if other.1 < one.1 { other } else { one };
        places.map(share).filter(|(_, share)| *share >= 0.0).reduce(first)
    }

    fn ring_at(&self, radius: f64) -> Option<usize> {
        (radius >= self.inner).then(|| self.rings.iter().position(|ring| radius <= ring.outer))?
    }

    fn begin(&self, number: usize) -> f64 {
        if number == 0 { self.inner } else { self.rings[number - 1].outer }
    }

    /// The sides of all rings from the hole outwards.
    fn outwards(&self, hole: Side) -> Vec<Side> {
        let mut sides = vec![hole];
        for (number, ring) in self.rings.iter().enumerate() {
            sides.push(self.within(number, sides[number], ring.outer).0);
        }
        sides
    }

    /// What is at `radius` \[m\] of a ring with `side` at its inner side: A.107 inwards, w = A r + B/r,
    /// with εrr = dw/dr and εtt = w/r.
    fn within(&self, number: usize, side: Side, radius: f64) -> (Side, Hoop) {
        let (begin, young, poisson) = (self.begin(number), self.rings[number].young, self.poisson);
        let hoop = side.inward / begin;
        let even = 0.5 * (1.0 - poisson) * (hoop + (1.0 + poisson) * side.radial / young);
        let odd = (hoop - even) * (begin / radius).powi(2);
        let [even_stress, odd_stress] =
            [young * even / (1.0 - poisson), young * odd / (1.0 + poisson)];
        let stress =
            Hoop { radial: even_stress - odd_stress, tangential: even_stress + odd_stress };
        (Side { inward: radius * (even + odd), radial: stress.radial }, stress)
    }
}

/// Contacts per volume over those far from a wall, at a `distance` \[m\] from the surface of grains of
/// mean diameter d̄ \[m\]: none at the surface, half at a radius, all from a diameter on (4.4.3).
#[must_use]
pub fn edge_density(distance: f64, diameter: f64) -> f64 {
    (distance / diameter).clamp(0.0, 1.0)
}

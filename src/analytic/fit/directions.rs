//! Principal directions of stress and strain in the course of a test, and whether they agree
//! (A.11, A.12).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::analytic::tensor::Tensor;

/// The angle from one direction to another \[rad\], from -π/2 to π/2: directions have no sense.
#[must_use]
pub fn between(from: f64, to: f64) -> f64 {
    let turned = (to - from).rem_euclid(PI);
    if turned > FRAC_PI_2 { turned - PI } else { turned }
}

/// Major principal directions β \[rad\] at a place of a test; nothing where there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directions {
    /// Of the stress.
    pub stress: Option<f64>,
    /// Of all strain so far.
    pub strain: Option<f64>,
    /// Of the stress since the place before.
    pub stress_increment: Option<f64>,
    /// Of the strain since the place before.
    pub strain_increment: Option<f64>,
}

impl Directions {
    /// Angle \[rad\] from the stress to the strain increment: 0 when they are coaxial (A.16).
    #[must_use]
    pub fn non_coaxiality(&self) -> Option<f64> {
        Some(between(self.stress?, self.strain_increment?))
    }
}

/// The directions at every place of a test with these stresses \[Pa\] and strains; the first place has
/// no increments.
#[must_use]
pub fn directions(stress: &[Tensor], strain: &[Tensor]) -> Vec<Directions> {
    let before = |all: &[Tensor], place: usize| {
        let before = all[place.checked_sub(1)?];
        all[place].since(&before).direction()
    };
    let at = |place: usize| Directions {
        stress: stress[place].direction(),
        strain: strain[place].direction(),
        stress_increment: before(stress, place),
        strain_increment: before(strain, place),
    };
    (0..stress.len().min(strain.len())).map(at).collect()
}

//! The bilinear material that a biaxial test shows (figure A.5).

use super::{record, strength};
use crate::analytic::hooke::Hooke;
use crate::analytic::model::Bilinear;
use crate::analytic::strength::MohrCoulomb;

/// A biaxial test at constant σ3, from its isotropic state on: four series of one length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Test<'a> {
    /// ε1.
    pub axial_strain: &'a [f64],
    /// ε1 + ε3.
    pub area_strain: &'a [f64],
    /// σ1 \[Pa\].
    pub major: &'a [f64],
    /// σ3 \[Pa\].
    pub minor: &'a [f64],
}

impl Test<'_> {
    /// σ1 - σ3 \[Pa\].
    #[must_use]
    pub fn deviator(&self) -> Vec<f64> {
        self.major.iter().zip(self.minor).map(|(major, minor)| major - minor).collect()
    }

    /// E50, ν of the beginning, φ' of the peak and ψ of the plastic branch; nothing when the test does not
    /// show one of them.
    ///
    /// φ' is that of sand, which one test cannot tell from cohesion: for cemented grains put the
    /// strength that [`strength::cohesive`] fits to several in its place.
    #[must_use]
    pub fn material(&self) -> Option<Bilinear> {
        let deviator = self.deviator();
        let peak = record::peak(&deviator)?;
        let young = record::secant_50(self.axial_strain, &deviator)?;
        let begin = record::begin(&deviator)?;
        let poisson = record::poisson(self.axial_strain, self.area_strain, begin)?;
        let friction = strength::mobilised(self.major[peak], self.minor[peak])?;
        let plastic = record::plastic(self.axial_strain, &deviator)?;
        let dilatancy = record::dilatancy(self.axial_strain, self.area_strain, plastic)?;
        let strength = MohrCoulomb { friction, cohesion: 0.0 };
        Some(Bilinear { elastic: Hooke { young, poisson }, strength, dilatancy })
    }
}

//! The beam on two supports with a load halfway (4.5): what B's table 13 predicts.

use super::strength::MohrCoulomb;

/// A beam of rectangular section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Between the supports \[m\].
    pub span: f64,
    /// \[m\].
    pub height: f64,
    /// Across the plane \[m\].
    pub depth: f64,
}

impl Beam {
    /// Tension \[Pa\] of the lowest fibre under `load` \[N\], by Bernoulli's hypothesis.
    #[must_use]
    pub fn tension(&self, load: f64) -> f64 {
        1.5 * load * self.span / (self.depth * self.height * self.height)
    }

    /// Load \[N\] at which the lowest fibre reaches the tension that Mohr and Coulomb allow.
    #[must_use]
    pub fn strength(&self, material: &MohrCoulomb) -> f64 {
        material.tension() / self.tension(1.0)
    }
}

//! The advanced Mohr-Coulomb model: elastic, then plastic with dilatancy, in the biaxial test
//! (figure A.5, A.18-A.21).

use super::flow::dilation;
use super::hooke::Hooke;
use super::strength::MohrCoulomb;

/// A bilinear material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bilinear {
    /// Before failure.
    pub elastic: Hooke,
    /// When it fails.
    pub strength: MohrCoulomb,
    /// ψ \[rad\] while it fails.
    pub dilatancy: f64,
}

/// A place on the curves of a biaxial test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biaxial {
    /// ε1, of the loading beyond the isotropic stress.
    pub axial_strain: f64,
    /// σ1 \[Pa\].
    pub major: f64,
    /// ε_tot = ε1 + ε3, positive where the area shrinks.
    pub area_strain: f64,
}

impl Bilinear {
    /// ε1 at which a biaxial test fails that began isotropic at σ3 = `minor` \[Pa\].
    #[must_use]
    pub fn failure_strain(&self, minor: f64) -> f64 {
        (self.strength.major(minor) - minor) / self.elastic.young
    }

    /// The state at the axial strain ε1 beside the constant σ3 = `minor` \[Pa\].
    #[must_use]
    pub fn biaxial(&self, minor: f64, axial_strain: f64) -> Biaxial {
        let elastic = axial_strain.min(self.failure_strain(minor));
        let plastic = axial_strain - elastic;
        let area = (1.0 - self.elastic.poisson) * elastic;
        Biaxial {
            axial_strain,
            major: minor + self.elastic.young * elastic,
            area_strain: area + (1.0 - dilation(self.dilatancy)) * plastic,
        }
    }
}

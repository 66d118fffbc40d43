//! Hooke's law in the plane (A.9), and the moduli that tests show (A.19, A.22, A.24).

use super::tensor::Tensor;

/// An isotropic elastic material in the plane, where there is no third direction to strain in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hooke {
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν, between -1 and 1 in the plane.
    pub poisson: f64,
}

impl Hooke {
    /// The material whose area shrinks under pressure with K = σ0/(εxx + εyy) \[Pa\] and that
    /// shears with G \[Pa\].
    #[must_use]
    pub fn of_moduli(bulk: f64, shear: f64) -> Self {
        Self {
            young: 4.0 * bulk * shear / (bulk + shear),
            poisson: (bulk - shear) / (bulk + shear),
        }
    }

    /// The strain under `stress` \[Pa\] (A.9).
    #[must_use]
    pub fn strain(&self, stress: &Tensor) -> Tensor {
        Tensor {
            xx: (stress.xx - self.poisson * stress.yy) / self.young,
            yy: (stress.yy - self.poisson * stress.xx) / self.young,
            xy: (1.0 + self.poisson) * stress.xy / self.young,
        }
    }

    /// The stress \[Pa\] that `strain` takes: the inverse of A.9.
    #[must_use]
    pub fn stress(&self, strain: &Tensor) -> Tensor {
        let plane = self.young / (1.0 - self.poisson * self.poisson);
        Tensor {
            xx: plane * (strain.xx + self.poisson * strain.yy),
            yy: plane * (strain.yy + self.poisson * strain.xx),
            xy: self.young * strain.xy / (1.0 + self.poisson),
        }
    }

    /// G = E/2(1+ν) \[Pa\] (A.24).
    #[must_use]
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }

    /// K = E/2(1-ν) \[Pa\]: mean stress over the strain of the area.
    #[must_use]
    pub fn bulk_modulus(&self) -> f64 {
        0.5 * self.young / (1.0 - self.poisson)
    }

    /// σ̇1/ε̇1 \[Pa\] with no lateral strain, where σ̇3/σ̇1 = ν (A.22).
    #[must_use]
    pub fn compression_modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }
}

//! Strength: Mohr and Coulomb (20, A.13, A.94), Caquot (21-23), how a shear box fails (28-30).

use std::f64::consts::FRAC_PI_2;

use super::tensor::Tensor;

/// A material that fails when the Mohr circle of its stress touches a line (A.13).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MohrCoulomb {
    /// φ' \[rad\].
    pub friction: f64,
    /// c' \[Pa\]; 0 of sand.
    pub cohesion: f64,
}

impl MohrCoulomb {
    /// (1 + sin φ')/(1 - sin φ'), σ1/σ3 of sand at failure (20).
    #[must_use]
    pub fn ratio(&self) -> f64 {
        let sine = self.friction.sin();
        (1.0 + sine) / (1.0 - sine)
    }

    /// σ1 \[Pa\] at failure without σ3 (34).
    #[must_use]
    pub fn uniaxial(&self) -> f64 {
        2.0 * self.cohesion * self.friction.cos() / (1.0 - self.friction.sin())
    }

    /// The tension \[Pa\] at failure without σ1: -σ3 of A.13.
    #[must_use]
    pub fn tension(&self) -> f64 {
        2.0 * self.cohesion * self.friction.cos() / (1.0 + self.friction.sin())
    }

    /// σ1 \[Pa\] at failure beside σ3 = `minor` \[Pa\] (A.94).
    #[must_use]
    pub fn major(&self, minor: f64) -> f64 {
        self.ratio() * minor + self.uniaxial()
    }

    /// Radius of the failing Mohr circle \[Pa\] about `mean` \[Pa\] (A.13).
    #[must_use]
    pub fn radius(&self, mean: f64) -> f64 {
        mean * self.friction.sin() + self.cohesion * self.friction.cos()
    }

    /// By how much \[Pa\] the Mohr circle of `stress` is too large: negative before failure.
    #[must_use]
    pub fn excess(&self, stress: &Tensor) -> f64 {
        stress.radius() - self.radius(stress.mean())
    }

    /// Shear stress \[Pa\] at failure beside σxx and σyy \[Pa\] (A.25), whose direction A.14 gives;
    /// nothing when these two alone are too far apart.
    #[must_use]
    pub fn shear(&self, xx: f64, yy: f64) -> Option<f64> {
        let (radius, half) = (self.radius(0.5 * (xx + yy)), 0.5 * (xx - yy));
        (radius >= half.abs()).then(|| (radius * radius - half * half).sqrt())
    }

    /// Angle \[rad\] between the planes that fail and the one that σ1 acts on (A.36).
    #[must_use]
    pub fn plane(&self) -> f64 {
        0.5 * (FRAC_PI_2 + self.friction)
    }
}

/// φ' \[rad\] in a triaxial test by Caquot (21), of grains with the friction coefficient f; nothing
/// from where no ratio of stresses makes them slide.
#[must_use]
pub fn caquot_triaxial(friction: f64) -> Option<f64> {
    angle_of_sine(15.0 * friction / (10.0 + 3.0 * friction))
}

/// φ' \[rad\] by Caquot with σ2 halfway (22).
#[must_use]
pub fn caquot_halfway(friction: f64) -> Option<f64> {
    angle_of_sine(1.5 * friction)
}

/// φ' \[rad\] in plane strain by Caquot (23): f over the mean of |cos| of all directions.
#[must_use]
pub fn caquot_plane(friction: f64) -> f64 {
    (FRAC_PI_2 * friction).atan()
}

fn angle_of_sine(sine: f64) -> Option<f64> {
    (sine < 1.0).then(|| sine.asin())
}

/// What gives way in a shear box (figure 27).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mechanism {
    /// Sliding along horizontal planes.
    Horizontal,
    /// Sliding along vertical planes, which turn with the box (De Josselin de Jong).
    Vertical,
    /// Contacts that open in the direction of σ3 (B's own).
    Lateral,
}

impl Mechanism {
    /// σxx/σyy at failure of sand that slides along these planes (28, 29); the third way takes any.
    #[must_use]
    pub fn lateral_stress(self, friction: f64) -> Option<f64> {
        let square = friction.sin().powi(2);
        match self {
            Self::Horizontal => Some((1.0 + square) / (1.0 - square)),
            Self::Vertical => Some((1.0 - square) / (1.0 + square)),
            Self::Lateral => None,
        }
    }

    /// Mean rotation of the grains over that of the upright walls (30).
    #[must_use]
    pub fn rotation(self) -> f64 {
        match self {
            Self::Horizontal => 0.0,
            Self::Vertical => 1.0,
            Self::Lateral => 0.5,
        }
    }
}

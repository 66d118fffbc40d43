//! Discs of one size in rows, each with six neighbours (A.115-A.127).
//!
//! Rows lie along x. A grain has two contacts along x with the normal force F_t, and four at 60° with
//! F_n and F_s. Its stress is (A.117, A.119)
//!
//! σxx = C (2 F_t + F_n - √3 F_s),  σyy = C (3 F_n + √3 F_s),  C = 1/(4√3 r²)
//!
//! and a homogeneous strain keeps t = n - √3 s (A.124). Contacts of constant stiffness that were made
//! without force then carry F_t = F_n - √3 F_s/κ, which solves to A.126 with the full stresses. There
//! the sign of κ σxx in F_n is plus: with the minus of the printed A.127 and (5.1) isotropic stress
//! would not give A.123. This holds away from the walls, where the stress is even.

use super::hooke::Hooke;

/// n_c/v of the crystal, 2√3: three contacts a grain in the volume 4√3 r³ (A.116).
pub const CONTACT_DENSITY: f64 = 3.464_101_615_137_754_6;

/// A crystal of cemented discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crystal {
    /// r \[m\]; the depth is 2r.
    pub radius: f64,
    /// κ = ks/kn.
    pub kappa: f64,
}

/// Forces of the contacts of a grain \[N\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces {
    /// F_n of the contacts at 60° to the rows.
    pub inclined: f64,
    /// F_s of those: positive when a grain is pushed apart from its neighbours in the row by the
    /// rows above and below, as σyy > σxx does.
    pub shear: f64,
    /// F_t of the contacts along the row.
    pub row: f64,
}

impl Crystal {
    /// C \[1/m²\] (A.118).
    #[must_use]
    pub fn per_area(&self) -> f64 {
        1.0 / (4.0 * 3.0_f64.sqrt() * self.radius * self.radius)
    }

    /// The forces under σxx along the rows and σyy across them \[Pa\] (A.126 with its full stresses).
    #[must_use]
    pub fn forces(&self, xx: f64, yy: f64) -> Forces {
        let kappa = self.kappa;
        let scale = 1.0 / (6.0 * self.per_area() * (kappa + 1.0));
        Forces {
            inclined: scale * ((kappa + 2.0) * yy + kappa * xx),
            shear: scale * kappa * (yy - xx) * 3.0_f64.sqrt(),
            row: scale * ((kappa - 1.0) * yy + (kappa + 3.0) * xx),
        }
    }

    /// E and ν, the same in all directions: E = 2√3 kn (1+κ)/(3+κ)/2r and ν = (1-κ)/(3+κ).
    #[must_use]
    pub fn elasticity(&self, kn: f64) -> Hooke {
        let scale = CONTACT_DENSITY * kn / (2.0 * self.radius);
        let below = 3.0 + self.kappa;
        Hooke { young: scale * (1.0 + self.kappa) / below, poisson: (1.0 - self.kappa) / below }
    }

    /// σ1 \[Pa\] across the rows at which the inclined contacts crack in shear (11) beside σ3 \[Pa\]
    /// along them, for the friction coefficient f and the contact strength F_t \[N\]; nothing when
    /// the friction grows as fast as the shear force.
    #[must_use]
    pub fn shear_failure(&self, minor: f64, friction: f64, strength: f64) -> Option<f64> {
        // F_s - f F_n is the sum of what σ1 and σ3 each do.
        let spare = |forces: Forces| forces.shear - friction * forces.inclined;
        let [growth, start] = [self.forces(0.0, 1.0), self.forces(minor, 0.0)].map(spare);
        (growth > 0.0).then(|| (strength - start) / growth)
    }
}

//! Stiffness and strength of cemented grains out of their contacts (A.74-A.95).

use super::hooke::Hooke;
use super::strength::MohrCoulomb;

/// E and ν as B has them (A.80-A.83), for contacts of stiffness kn \[N/m\] and κ = ks/kn.
///
/// A.77 averages the strains of the contacts' own projections, which is not the strain of the pack.
/// For κ > 1, which is for all grains, E and G lie above their upper bounds ([`uniform`]).
#[must_use]
pub fn averaged(contact_density: f64, kn: f64, diameter: f64, kappa: f64) -> Hooke {
    Hooke {
        young: contact_density * kn / diameter * kappa / (kappa + 1.0),
        poisson: -(kappa - 1.0) / (kappa + 1.0),
    }
}

/// E and ν when every grain moves with the strain of the pack and none turns: upper bounds of K, G
/// and E for contacts in all directions alike, and exact in a [crystal](super::crystal).
///
/// K = n_c/v kn/4d̄ is A.85; G = n_c/v (kn + ks)/8d̄ follows from A.42-A.45 with F_n = kn d̄ ε:n⊗n and
/// F_s = ks d̄ ε:n⊗t.
#[must_use]
pub fn uniform(contact_density: f64, kn: f64, diameter: f64, kappa: f64) -> Hooke {
    let stiffness = contact_density * kn / diameter;
    Hooke::of_moduli(0.25 * stiffness, 0.125 * stiffness * (1.0 + kappa))
}

/// E \[Pa\] from the isotropic stiffness and a Poisson's ratio that was measured (A.85).
#[must_use]
pub fn young_of_poisson(contact_density: f64, kn: f64, diameter: f64, poisson: f64) -> f64 {
    (1.0 - poisson) * contact_density * kn / (2.0 * diameter)
}

/// Strength when contacts of the micro cohesion c_μ \[Pa\] along σ3 open (A.90-A.95).
#[must_use]
pub fn strength(contact_density: f64, micro_cohesion: f64) -> MohrCoulomb {
    MohrCoulomb {
        friction: (1.0_f64 / 3.0).asin(),
        cohesion: micro_cohesion * contact_density / (16.0 * 2.0_f64.sqrt()),
    }
}

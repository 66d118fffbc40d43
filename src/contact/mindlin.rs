//! Shear and torsion of a Hertz contact that does not slip (Mindlin 1949; T 3.5a, 3.9a), and the
//! couple at which it twists freely (Lubkin 1951; T 3.3.3).

use std::f64::consts::PI;

/// G \[Pa\] of an isotropic material.
#[must_use]
pub fn shear_modulus(young: f64, poisson: f64) -> f64 {
    young / (2.0 * (1.0 + poisson))
}

/// (2-ν)/G \[1/Pa\]: what a body adds to the compliance in shear.
#[must_use]
pub fn shear_compliance(young: f64, poisson: f64) -> f64 {
    (2.0 - poisson) / shear_modulus(young, poisson)
}

/// 1/G \[1/Pa\]: what a body adds to the compliance in torsion.
#[must_use]
pub fn torsion_compliance(young: f64, poisson: f64) -> f64 {
    1.0 / shear_modulus(young, poisson)
}

/// Radius a of the contact circle \[m\] (T 2.1), a² = R* h.
#[must_use]
pub fn contact_radius(effective_radius: f64, overlap: f64) -> f64 {
    (effective_radius * overlap).sqrt()
}

/// k_s \[N/m\] (T 3.5a); `compliance_sum` is that of [`shear_compliance`] over both bodies.
#[must_use]
pub fn shear_stiffness(contact_radius: f64, compliance_sum: f64) -> f64 {
    8.0 * contact_radius / compliance_sum
}

/// k_t \[N m\] (T 3.9a); `compliance_sum` is that of [`torsion_compliance`] over both bodies.
#[must_use]
pub fn torsion_stiffness(contact_radius: f64, compliance_sum: f64) -> f64 {
    16.0 / 3.0 * contact_radius.powi(3) / compliance_sum
}

/// Largest torsional couple \[N m\] at the Coulomb limit Q_max = μP (T 3.3.3): 3π/16 a Q_max.
#[must_use]
pub fn torsion_limit(contact_radius: f64, shear_limit: f64) -> f64 {
    3.0 * PI / 16.0 * contact_radius * shear_limit
}

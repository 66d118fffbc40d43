//! Hertz' normal contact (T 2.2-2.3, 2.6): energy, force and stiffness of one overlap h \[m\].
//!
//! With the modulus M = 4/3 E* √R* \[N/m^1.5\] the force is P = M h^1.5, its potential
//! U = 2/5 M h^2.5 and its tangent stiffness dP/dh = 3/2 M h^0.5.

/// (1-ν²)/E \[1/Pa\]: what a body adds to 1/E* (T 2.3b).
#[must_use]
pub fn compliance(young: f64, poisson: f64) -> f64 {
    (1.0 - poisson * poisson) / young
}

/// R* \[m\] of two spheres (T 2.3a); against a wall R* is the radius itself.
#[must_use]
#[inline(always)]
pub fn effective_radius(radius_i: f64, radius_j: f64) -> f64 {
    radius_i * radius_j / (radius_i + radius_j)
}

/// M = 4/3 E* √R* of a contact with effective radius R* and the sum 1/E* of both compliances.
#[must_use]
#[inline(always)]
pub fn modulus(effective_radius: f64, compliance_sum: f64) -> f64 {
    4.0 / 3.0 * effective_radius.sqrt() / compliance_sum
}

/// P \[N\] (T 2.2).
#[must_use]
#[inline(always)]
pub fn force(modulus: f64, overlap: f64) -> f64 {
    modulus * overlap * overlap.sqrt()
}

/// U \[J\] (T 2.6) of a contact whose force is `force`.
#[must_use]
#[inline(always)]
pub fn energy(force: f64, overlap: f64) -> f64 {
    0.4 * force * overlap
}

/// dP/dh \[N/m\].
#[must_use]
#[inline(always)]
pub fn stiffness(modulus: f64, overlap: f64) -> f64 {
    1.5 * modulus * overlap.sqrt()
}

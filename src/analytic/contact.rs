//! The contact of two grains (1-6), and how dense contacts are.
//!
//! r̄ = 2 r_i r_j/(r_i + r_j) is the mean radius of both.

/// κ of a Hertz-Mindlin contact of grains with Poisson's ratio ν (6): Mindlin's stiffness over the
/// secant of Hertz' law, F/n. The tangent dF/dn is 3/2 of the secant.
#[must_use]
pub fn stiffness_ratio(poisson: f64) -> f64 {
    3.0 * (1.0 - poisson) / (2.0 - poisson)
}

/// M \[N/m^1.5\] of F = M n^1.5 (1) for grains of shear modulus G \[Pa\] and r̄ \[m\].
#[must_use]
pub fn hertz_modulus(shear_modulus: f64, poisson: f64, mean_radius: f64) -> f64 {
    2.0 * (2.0 * mean_radius).sqrt() * shear_modulus / (3.0 * (1.0 - poisson))
}

/// Secant stiffness F/n \[N/m\] of a contact under the normal force F \[N\] (A.86).
#[must_use]
pub fn secant_stiffness(hertz_modulus: f64, normal_force: f64) -> f64 {
    (hertz_modulus * hertz_modulus * normal_force).cbrt()
}

/// ks \[N/m\] after Mindlin (3): 2 (3 G² (1-ν) r̄ F)^⅓/(2-ν), where the print has the G² before the
/// root, as G³.
#[must_use]
pub fn shear_stiffness(
    shear_modulus: f64,
    poisson: f64,
    mean_radius: f64,
    normal_force: f64,
) -> f64 {
    let cube = 3.0 * shear_modulus * shear_modulus * (1.0 - poisson) * mean_radius * normal_force;
    2.0 * cube.cbrt() / (2.0 - poisson)
}

/// n_c/v of `contacts` in `volume` \[m³\] between grains of mean diameter d̄ \[m\] (A.82).
#[must_use]
pub fn density(contacts: f64, diameter: f64, volume: f64) -> f64 {
    contacts * diameter.powi(3) / volume
}

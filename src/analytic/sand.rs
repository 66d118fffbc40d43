//! Stiffness of sand, which grows as the third root of its stress (24, A.86-A.89).

/// The exponent β of the stress that Hertz' law leads to (A.89).
pub const EXPONENT: f64 = 1.0 / 3.0;

/// σref \[Pa\], 1 bar.
pub const REFERENCE_STRESS: f64 = 1e5;

/// E_ref \[Pa\] of grains with the shear modulus G \[Pa\] at the contact density n_c/v (A.89).
///
/// It is A.80 with the secant stiffness of the contacts under their mean force at [`REFERENCE_STRESS`].
#[must_use]
pub fn reference_modulus(shear_modulus: f64, poisson: f64, contact_density: f64) -> f64 {
    let kappa = super::contact::stiffness_ratio(poisson);
    let base = REFERENCE_STRESS.sqrt() * shear_modulus / (3.0 * (1.0 - poisson)) * contact_density;
    base.powf(2.0 / 3.0) * 2.0 * kappa / (kappa + 1.0)
}

/// E \[Pa\] and ν of the first bit of a strain at the mean stress `mean_stress` \[Pa\], when every grain moves
/// with the strain of the pack and no contact slides: [`super::cemented::uniform`] with the tangent stiffness of the contacts
/// under their mean force, 3/2 of the secant that A.89 has.
#[must_use]
pub fn first(
    shear_modulus: f64,
    poisson: f64,
    contact_density: f64,
    mean_stress: f64,
) -> super::hooke::Hooke {
    let kappa = super::contact::stiffness_ratio(poisson);
    // n_c/v kn/d̄ of A.80 in E_ref.
    let secant = young(reference_modulus(shear_modulus, poisson, contact_density), mean_stress)
        * (kappa + 1.0)
        / kappa;
    super::cemented::uniform(1.0, 1.5 * secant, 1.0, kappa / 1.5)
}

/// E50 \[Pa\] at the mean stress σ0 \[Pa\] (A.89): 1.5 σ3 where half of σ1/σ3 = 3 is reached.
#[must_use]
pub fn young(reference_modulus: f64, mean_stress: f64) -> f64 {
    reference_modulus * (mean_stress / REFERENCE_STRESS).powf(EXPONENT)
}

/// E50 \[Pa\] beside the vertical stress \[Pa\] when that is twice the lateral one (24).
#[must_use]
pub fn young_of_vertical(reference_modulus: f64, vertical_stress: f64) -> f64 {
    young(reference_modulus, 0.75 * vertical_stress)
}

/// σ1 \[Pa\] after the axial strain ε1 of a compression test that began at `start` \[Pa\]: the
/// integral of A.22 with A.89 while σ3/σ1 stays at the Poisson's ratio.
#[must_use]
pub fn compression(reference_modulus: f64, poisson: f64, start: f64, strain: f64) -> f64 {
    let left = 1.0 - EXPONENT;
    let mean = 0.5 * (1.0 + poisson) / REFERENCE_STRESS;
    let slope = reference_modulus * mean.powf(EXPONENT) / (1.0 - poisson * poisson);
    (start.powf(left) + left * slope * strain).max(0.0).powf(left.recip())
}

//! Effective-medium moduli of a random pack of equal spheres (Walton 1987, Makse et al. 1999).

use std::f64::consts::PI;

/// Shear modulus and Poisson's ratio of the glass (T table 2.1).
const GLASS: (f64, f64) = (70e9 / 2.4, 0.2);

/// Whether contacts slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slip {
    /// Never: infinite friction.
    None,
    /// Freely: no friction.
    Free,
}

/// K and G \[Pa\] at a confining stress \[Pa\] of a pack with φZ, solid fraction times mean
/// coordination number.
pub(crate) fn moduli(fraction_times_coordination: f64, stress: f64, slip: Slip) -> [f64; 2] {
    let (shear, poisson) = GLASS;
    let normal = 4.0 * shear / (1.0 - poisson);
    let tangential = match slip {
        Slip::None => 8.0 * shear / (2.0 - poisson),
        Slip::Free => 0.0,
    };
    let common = fraction_times_coordination.powf(2.0 / 3.0) * (6.0 * PI * stress / normal).cbrt();
    [normal / (12.0 * PI) * common, (normal + 1.5 * tangential) / (20.0 * PI) * common]
}

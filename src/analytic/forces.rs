//! Mean forces of the contacts against their angle (A.55-A.73).
//!
//! A.73 says in components that the mean force of the contacts with normal n is the traction σ n
//! times 2V/(n_c d̄). That holds for any stress, so [`mean`] takes one that need not have its
//! principal directions along the axes.

use super::tensor::Tensor;

/// F_n^I \[N\] under the isotropic stress σ \[Pa\] (A.68), in grains of mean diameter d̄ \[m\].
#[must_use]
pub fn isotropic(stress: f64, diameter: f64, contact_density: f64) -> f64 {
    2.0 * diameter * diameter * stress / contact_density
}

/// Mean normal and shear force \[N\] of the contacts at `angle` \[rad\] from the x-axis under `stress`
/// \[Pa\] (A.73).
///
/// The force is (c F_n + s F_s, s F_n - c F_s), as in A.42-A.45: F_s is negative in the first
/// quadrant when σyy > σxx.
#[must_use]
pub fn mean(stress: &Tensor, diameter: f64, contact_density: f64, angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    let [x, y] = stress.along(angle).map(|part| isotropic(part, diameter, contact_density));
    [c * x + s * y, s * x - c * y]
}

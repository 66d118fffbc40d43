//! Plastic strain with dilatancy (A.15-A.17, A.21).
//!
//! The increments of plastic strain have their principal directions where the stress has them
//! (A.16) and ε̇3 = -μ ε̇1. With A.10 that is A.15, whose printed brackets would leave ε̇xy without a
//! partner: `1 - μ ∓ (1 + μ) cos 2α` is meant.

use std::f64::consts::FRAC_PI_4;

use super::tensor::Tensor;

/// μ = -ε̇3/ε̇1 at the angle of dilatancy ψ \[rad\] (A.15).
#[must_use]
pub fn dilation(dilatancy: f64) -> f64 {
    let sine = dilatancy.sin();
    (1.0 + sine) / (1.0 - sine)
}

/// ψ \[rad\] of increments of the principal strains (A.15, A.21): positive when the area grows while
/// ε̇1 is compressive. Nothing when both have the same sign, where no shear makes such a change.
#[must_use]
pub fn dilatancy(major: f64, minor: f64) -> Option<f64> {
    let sine = -(major + minor) / (major - minor);
    (major > minor && sine.abs() <= 1.0).then(|| sine.asin())
}

/// Angle θ \[rad\] of a shear band to the axis of σ3 (27): the line that plastic strain leaves as
/// long as it is.
#[must_use]
pub fn band(dilatancy: f64) -> f64 {
    FRAC_PI_4 + 0.5 * dilatancy
}

/// Plastic strain while the major one grows by `major`, with σ1 at the angle β = `direction` \[rad\]
/// to the x-axis (A.15).
#[must_use]
pub fn plastic(major: f64, dilatancy: f64, direction: f64) -> Tensor {
    Tensor::of_principal(major, -dilation(dilatancy) * major, direction)
}

//! Predictions and fits against the numbers that B prints, limits, conservation laws and sums over
//! contacts that are written out here.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

mod contacts;
mod crystal;
mod cylinder;
mod drawn;
mod fits;
mod plane;
mod printed;
mod sheared;

use graintwin::analytic::tensor::Tensor;

/// Whether two numbers agree to `tolerance` of the greater.
#[track_caller]
fn close(one: f64, other: f64, tolerance: f64) {
    let scale = one.abs().max(other.abs());
    assert!((one - other).abs() <= tolerance * scale, "{one} is not {other}");
}

/// Whether `one` is `other` to `tolerance` of `scale`.
#[track_caller]
fn near(one: f64, other: f64, tolerance: f64) {
    assert!((one - other).abs() <= tolerance, "{one} is not {other} to {tolerance}");
}

/// Mean of the force of a contact times its direction, over directions that are all alike: the
/// stress (A.41) of contacts of length d̄ is 2 σ0 V of them.
///
/// `force` gives normal and shear force at an angle, in the sense of A.42-A.45.
fn summed(force: impl Fn(f64) -> [f64; 2]) -> [[f64; 2]; 2] {
    // Sums over this many angles are exact up to the 35th harmonic.
    const ANGLES: u32 = 36;
    let mut mean = [[0.0; 2]; 2];
    for number in 0..ANGLES {
        let angle = std::f64::consts::TAU * (f64::from(number) + 0.3) / f64::from(ANGLES);
        let (s, c) = angle.sin_cos();
        let [normal, shear] = force(angle);
        let share = 1.0 / f64::from(ANGLES);
        mean[0][0] += share * (c * c * normal + s * c * shear);
        mean[1][1] += share * (s * s * normal - s * c * shear);
        mean[0][1] += share * (s * c * normal - c * c * shear);
        mean[1][0] += share * (s * c * normal + s * s * shear);
    }
    mean
}

/// Stresses and strains without any symmetry.
const TENSORS: [Tensor; 3] = [
    Tensor { xx: 1.0, yy: 2.0, xy: 0.0 },
    Tensor { xx: 3.1, yy: 1.7, xy: -0.9 },
    Tensor { xx: 0.4, yy: 0.4, xy: 0.3 },
];

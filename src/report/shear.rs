//! How a box of discs is sheared.

use serde::Serialize;

/// How a box of discs is sheared, and how the grains in its middle take it (B 3.3.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Shear {
    /// Shear γ of the box about its middle height at the start.
    pub tilt: f64,
    /// Small strain of the box against the reference, compression positive, shape (2, 2) row by row.
    pub strain: [f64; 4],
    /// Mean stress of the inner grains \[Pa\], compression positive, shape (2, 2) row by row: those in
    /// the middle half of the width and of the height, which walls do not disturb.
    pub inner_stress: [f64; 4],
    /// Number of the inner grains.
    pub inner_grains: u32,
    /// β_σ: angle from x to the major principal direction of that stress \[rad\]; NaN where all
    /// directions are alike.
    pub stress_direction: f64,
    /// β_ε: the same of the strain \[rad\].
    pub strain_direction: f64,
    /// Mean rotation since the start of the grains that carry load and are free \[rad\], to the left:
    /// -γ_μ, half of -γ where contacts fail in the direction of the minor stress (30).
    pub mean_rotation: f64,
}

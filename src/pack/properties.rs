//! Radii and elastic properties drawn from their distributions (T 2.7.1).

use rand::RngExt;
use rand_pcg::Pcg64;

use crate::scene::{Material, Radius};

/// Radius of one grain \[m\].
pub fn radius(of: Radius, rng: &mut Pcg64) -> f64 {
    match of {
        Radius::Uniform([low, high]) => low + (high - low) * rng.random::<f64>(),
        Radius::Constant(radius) => radius,
    }
}

/// Young's modulus \[Pa\] and Poisson's ratio of one grain.
pub fn draw(material: &Material, rng: &mut Pcg64) -> (f64, f64) {
    let _ = rng;
    (material.young, material.poisson)
}

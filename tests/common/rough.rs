//! Friction in small specimens: scenes, Hertz' law at a wall, and how to solve for one unknown.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};

use crate::packs::{E_WALL, scene_to};

/// Radius of the beads \[m\].
pub(crate) const R: f64 = 1e-4;
/// Coefficient of friction.
pub(crate) const MU: f64 = 0.3;

/// A scene of one coefficient.
pub(crate) fn frictional(tolerance: f64, coefficient: f64, law: Law, update: Update) -> Scene {
    let mut scene = scene_to(tolerance);
    scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
    scene
}

/// Hertz' M of a bead at a wall \[N/m^1.5\].
pub(crate) fn wall_modulus() -> f64 {
    4.0 / 3.0 * E_WALL * R.sqrt()
}

/// Overlap of a bead and a wall that carries `force` \[m\].
pub(crate) fn wall_overlap(force: f64) -> f64 {
    (force / wall_modulus()).powf(2.0 / 3.0)
}

/// Where `f` rises through zero between `low` and `high`, by halving to the last bit.
pub(crate) fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    assert!(f(low) <= 0.0 && f(high) >= 0.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        *(if f(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    0.5 * (low + high)
}

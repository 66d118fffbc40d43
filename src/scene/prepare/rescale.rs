//! A pack of another size or another stiffness that stays in equilibrium (B table 5, VB-39).

use serde::{Deserialize, Serialize};

use crate::scene::check::{Field, Problems};

/// What a pack is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rescale {
    /// All lengths, while the contact forces stay: stresses and moduli go with the inverse square.
    Lengths(f64),
    /// All forces, stresses and moduli, while nothing moves.
    Forces(f64),
}

impl Rescale {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let (key, factor) = match *self {
            Self::Lengths(factor) => ("lengths", factor),
            Self::Forces(factor) => ("forces", factor),
        };
        let factors = 1e-6..=1e6;
        problems.number(at.key(key), factor, &format!("1e-6 <= {key} <= 1e6"), |factor| {
            factors.contains(&factor)
        });
    }
}

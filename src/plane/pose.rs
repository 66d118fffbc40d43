//! A configuration.

use super::Vec2;
use crate::heap;

/// Where the grains are.
#[derive(Clone, Debug, Default)]
pub struct Pose {
    /// Centres \[m\], shape (n).
    pub at: Vec<Vec2>,
    /// Turns since the reference \[rad\], shape (n).
    pub turn: Vec<f64>,
}

impl Pose {
    /// Takes over `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.at.clone_from(&other.at);
        self.turn.clone_from(&other.turn);
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.at) + heap::bytes(&self.turn)
    }
}

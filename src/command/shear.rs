//! Simple shear of a box of discs: what a command asks for (B 3.3.4).

use crate::wall::{self, WallTarget};

/// The tilt of the box, and what its walls do meanwhile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shear {
    /// Shear γ of the box about its middle height at the start: the tangent of the angle by which the x
    /// walls lean towards +x, -1 < γ < 1.
    pub tilt: f64,
    /// A target of each wall.
    pub targets: [WallTarget; wall::COUNT],
}

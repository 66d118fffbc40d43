//! The six planar walls of the rig and the box between them (T 2.3, HZ-02), or cylinders ([`Room`]).
//!
//! Walls are always in the order of [`NAMES`]. A wall's displacement is along its inward
//! normal: positive compresses the pack.

mod room;
mod target;

use serde::{Deserialize, Serialize};

pub use room::{Facing, Room};
pub use target::{Control, Load, Setpoint, WallTarget, standing};

/// Number of walls of a 3D box.
pub const COUNT: usize = 6;

/// Names of the walls in their fixed order.
pub const NAMES: [&str; COUNT] = ["x_min", "x_max", "y_min", "y_max", "z_min", "z_max"];

/// The coordinate axis (0, 1, 2) that wall `wall` is normal to.
#[must_use]
pub const fn axis(wall: usize) -> usize {
    wall / 2
}

/// Component of the wall's inward normal along its axis: +1 for the low wall, -1 for the high one.
#[must_use]
pub const fn inward(wall: usize) -> f64 {
    if wall.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// An axis-aligned box \[m\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bounds {
    /// Position of the walls `x_min, y_min, z_min` \[m\].
    pub min: [f64; 3],
    /// Position of the walls `x_max, y_max, z_max` \[m\].
    pub max: [f64; 3],
}

impl Bounds {
    /// Lengths of the three sides \[m\].
    #[must_use]
    pub fn sides(&self) -> [f64; 3] {
        std::array::from_fn(|axis| self.max[axis] - self.min[axis])
    }

    /// Volume \[m³\].
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.sides().iter().product()
    }

    /// Centre \[m\].
    #[must_use]
    pub fn center(&self) -> [f64; 3] {
        std::array::from_fn(|axis| 0.5 * (self.max[axis] + self.min[axis]))
    }

    /// Area of wall `wall` \[m²\].
    #[must_use]
    pub fn area(&self, wall: usize) -> f64 {
        let sides = self.sides();
        sides[(axis(wall) + 1) % 3] * sides[(axis(wall) + 2) % 3]
    }

    /// Position of wall `wall` along its axis \[m\].
    #[must_use]
    pub fn position(&self, wall: usize) -> f64 {
        if wall.is_multiple_of(2) { self.min[axis(wall)] } else { self.max[axis(wall)] }
    }

    /// The box after each wall moved inwards by `displacement` \[m\].
    #[must_use]
    pub fn displaced(&self, displacement: &[f64; COUNT]) -> Self {
        Self {
            min: std::array::from_fn(|axis| self.min[axis] + displacement[2 * axis]),
            max: std::array::from_fn(|axis| self.max[axis] - displacement[2 * axis + 1]),
        }
    }
}

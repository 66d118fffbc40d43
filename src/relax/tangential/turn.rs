//! Turning of tangential vectors with the contact plane.

use nalgebra::Matrix3;

use crate::Vec3;

/// The smallest rotation that takes one unit vector into another.
pub(super) struct Turn {
    axis: Vec3,
    cosine: f64,
}

impl Turn {
    pub(super) fn between(from: &Vec3, to: &Vec3) -> Self {
        Self { axis: from.cross(to), cosine: from.dot(to) }
    }

    pub(super) fn forth(&self, v: &Vec3) -> Vec3 {
        let first = self.axis.cross(v);
        // Contacts do not turn over within an increment, so that 1 + cosine is not near zero.
        v + first + self.axis.cross(&first) / (1.0 + self.cosine)
    }

    pub(super) fn back(&self, v: &Vec3) -> Vec3 {
        Self { axis: -self.axis, cosine: self.cosine }.forth(v)
    }

    /// How it changes when the unit vector that it ends at does by `by`; it began at `from`.
    pub(super) fn changed(&self, from: &Vec3, by: &Vec3) -> Turning {
        Turning {
            axis: self.axis,
            cosine: self.cosine,
            axis_change: from.cross(by),
            cosine_change: from.dot(by),
        }
    }

    /// What multiplies a vector to turn it forth.
    pub(super) fn matrix(&self) -> Matrix3<f64> {
        let column = |k: usize| self.forth(&Vec3::ith(k, 1.0));
        Matrix3::from_columns(&[column(0), column(1), column(2)])
    }
}

/// The change of a [`Turn`].
pub(super) struct Turning {
    axis: Vec3,
    cosine: f64,
    axis_change: Vec3,
    cosine_change: f64,
}

impl Turning {
    /// Change of what the turn makes of `v`.
    pub(super) fn forth(&self, v: &Vec3) -> Vec3 {
        let Self { axis, cosine, axis_change, cosine_change } = self;
        let (first, first_change) = (axis.cross(v), axis_change.cross(v));
        let second = axis.cross(&first);
        let second_change = axis_change.cross(&first) + axis.cross(&first_change);
        let over = 1.0 / (1.0 + cosine);
        first_change + (second_change - second * (cosine_change * over)) * over
    }

    /// Change of what the turn back makes of `v`.
    pub(super) fn back(&self, v: &Vec3) -> Vec3 {
        let (axis, axis_change) = (-self.axis, -self.axis_change);
        Self { axis, axis_change, ..*self }.forth(v)
    }
}

/// Q⁰ᵖ: a force turned into the plane across `normal` (T 3.3.2).
#[inline(always)]
pub(super) fn turned_into_plane(force: &Vec3, normal: &Vec3) -> Vec3 {
    let size2 = force.norm_squared();
    let projected = force - normal * normal.dot(force);
    let flat2 = projected.norm_squared();
    // Nothing to turn, or nothing left in the plane.
    projected * if flat2 > 0.0 { (size2 / flat2).sqrt() } else { 0.0 }
}

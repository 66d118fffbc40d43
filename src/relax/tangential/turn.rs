//! Turning of tangential vectors with the contact plane.

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

//! What the walls enclose now: a box, or the room in a cylinder or between two.

use std::f64::consts::PI;
use std::ops::Deref;

use super::{Bounds, COUNT, axis, inward};
use crate::Vec3;

/// A box, or what is inside of a cylinder about the z-axis in its middle and outside of a smaller one:
/// `x_max` is then the outer wall and `x_min` the inner one, and there are no walls across y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// The box; that of a cylinder is the square around it.
    bounds: Bounds,
    /// Radii of the inner cylinder, 0 without one, and of the outer one \[m\]; `None` for a box.
    radii: Option<[f64; 2]>,
    /// Whether each wall is there.
    walls: [bool; COUNT],
}

/// A wall as a point sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facing {
    /// Distance of the point from the wall, positive inside \[m\].
    pub gap: f64,
    /// Inward unit normal: the gradient of the gap.
    pub normal: Vec3,
    /// Second derivative of the gap around the axis, along z × normal \[1/m\]; 0 of a plane.
    pub bend: f64,
}

impl Deref for Room {
    type Target = Bounds;

    fn deref(&self) -> &Bounds {
        &self.bounds
    }
}

impl From<Bounds> for Room {
    /// A box with all its walls.
    fn from(bounds: Bounds) -> Self {
        Self { bounds, radii: None, walls: [true; COUNT] }
    }
}

impl Room {
    /// A room in the box `bounds`, round where it has an inner and an outer radius \[m\], with the walls
    /// that are there.
    #[must_use]
    pub fn new(bounds: Bounds, radii: Option<[f64; 2]>, walls: [bool; COUNT]) -> Self {
        Self { bounds, radii, walls }
    }

    /// Whether wall `wall` is there.
    #[must_use]
    pub fn has(&self, wall: usize) -> bool {
        self.walls[wall]
    }

    /// Inner and outer radius \[m\]; `None` for a box.
    #[must_use]
    pub fn radii(&self) -> Option<[f64; 2]> {
        self.radii
    }

    /// Whether it is round.
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.radii.is_some()
    }

    /// From the axis of a round room to `at` \[m\].
    #[must_use]
    pub fn from_axis(&self, at: &Vec3) -> Vec3 {
        let [x, y, _] = self.bounds.center();
        Vec3::new(at.x - x, at.y - y, 0.0)
    }

    /// Wall `wall` as seen from `at`.
    #[must_use]
    #[inline]
    pub fn facing(&self, at: &Vec3, wall: usize) -> Facing {
        match self.radii {
            Some([inner, outer]) if wall < 2 => {
                let branch = self.from_axis(at);
                let distance = branch.norm().max(f64::MIN_POSITIVE);
                let outwards = branch / distance;
                match wall {
                    0 => Facing { gap: distance - inner, normal: outwards, bend: 1.0 / distance },
                    _ => {
                        let gap = outer - distance;
                        Facing { gap, normal: -outwards, bend: -1.0 / distance }
                    }
                }
            }
            _ => {
                let mut normal = Vec3::zeros();
                normal[axis(wall)] = inward(wall);
                let gap = (at[axis(wall)] - self.bounds.position(wall)) * inward(wall);
                Facing { gap, normal, bend: 0.0 }
            }
        }
    }

    /// Distance of `at` from wall `wall`, positive inside \[m\].
    #[must_use]
    #[inline(always)]
    pub fn gap(&self, at: &Vec3, wall: usize) -> f64 {
        match self.radii {
            Some(_) if wall < 2 => self.facing(at, wall).gap,
            _ => (at[axis(wall)] - self.bounds.position(wall)) * inward(wall),
        }
    }

    /// Inward unit normal of wall `wall` where `at` is nearest to it.
    #[must_use]
    #[inline(always)]
    pub fn normal(&self, at: &Vec3, wall: usize) -> Vec3 {
        self.facing(at, wall).normal
    }

    /// Volume \[m³\].
    #[must_use]
    pub fn volume(&self) -> f64 {
        match self.radii() {
            None => self.bounds.volume(),
            Some([inner, outer]) => PI * (outer - inner) * (outer + inner) * self.bounds.sides()[2],
        }
    }

    /// Area of wall `wall` \[m²\]; 0 of those that a round room has not.
    #[must_use]
    pub fn area(&self, wall: usize) -> f64 {
        match self.radii() {
            None => self.bounds.area(wall),
            Some([inner, outer]) if axis(wall) == 2 => PI * (outer - inner) * (outer + inner),
            Some(radii) => {
                let radius = radii.get(wall).copied().unwrap_or(0.0);
                2.0 * PI * radius * self.bounds.sides()[2]
            }
        }
    }

    /// Motion of what is at `at` when round wall `wall` moves inwards at a rate of 1: along the radius,
    /// evenly from one wall to the other, and where one is alone in proportion to the radius, or to its
    /// inverse outside of a lone inner one.
    #[must_use]
    pub fn carried(&self, at: &Vec3, wall: usize) -> Vec3 {
        let Some([inner, outer]) = self.radii() else { return Vec3::zeros() };
        let branch = self.from_axis(at);
        let distance = branch.norm();
        if distance == 0.0 {
            return Vec3::zeros();
        }
        let outwards = match (self.walls[0], self.walls[1], wall) {
            (true, true, 0) => (outer - distance) / (outer - inner),
            (true, true, _) => -(distance - inner) / (outer - inner),
            (true, false, _) => inner / distance,
            (false, ..) => -distance / outer,
        };
        branch * (outwards / distance)
    }

    /// Where round walls take what was at `at` when the room becomes `after`.
    #[must_use]
    pub fn carry(&self, after: &Self, at: &Vec3) -> Vec3 {
        let (Some([inner, outer]), Some([inner_after, outer_after])) =
            (self.radii(), after.radii())
        else {
            return *at;
        };
        let stretch = after.sides()[2] / self.sides()[2];
        let mut carried = *at;
        carried.z = after.min[2] + (at.z - self.min[2]) * stretch;
        let branch = self.from_axis(at);
        let distance = branch.norm();
        if distance == 0.0 {
            return carried;
        }
        let grown = match (self.walls[0], self.walls[1]) {
            (true, true) => {
                let stretch = (outer_after - inner_after) / (outer - inner);
                inner_after + (distance - inner) * stretch
            }
            (true, false) => distance + (inner_after - inner) * inner / distance,
            (false, _) => distance * outer_after / outer,
        };
        let [x, y, _] = after.center();
        carried.x = x + branch.x * (grown / distance);
        carried.y = y + branch.y * (grown / distance);
        carried
    }
}

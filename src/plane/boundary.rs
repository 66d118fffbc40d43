//! What surrounds the grains: bodies that the sides of the rig move.

use super::Vec2;
use crate::model::Model;
use crate::wall::{self, Bounds};

/// Sides of a pack of discs: `x_min`, `x_max`, `y_min`, `y_max`.
pub const SIDES: usize = 4;

/// A body that grains touch from inside the pack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// The side that it belongs to, as walls are numbered.
    pub side: u8,
    /// A point of the plane, or the centre \[m\].
    pub at: Vec2,
    /// Its shape.
    pub shape: Shape,
    /// Way of `at` over the inward displacement of the side.
    pub slide: Vec2,
    /// What the overlap of a grain gains over the inward displacement of the side while `at` stays.
    pub growth: f64,
    /// How it follows the tilt of the box.
    pub swing: Swing,
}

/// How a body follows the tilt γ of the box.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Swing {
    /// Way of `at` over γ \[m\].
    pub way: Vec2,
    /// How far it is turned at γ, to the left \[rad\].
    pub turn: f64,
    /// Derivative of that over γ.
    pub rate: f64,
}

/// Shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A half plane with this unit normal into the pack.
    Plane(Vec2),
    /// A disc of this radius \[m\]; the pack is outside.
    Disc(f64),
    /// All but a disc of this radius \[m\]; the pack is inside.
    Ring(f64),
}

/// How a grain is to a body.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// Direction in which `distance` grows.
    pub along: Vec2,
    /// Distance of the grain's centre from `at`, or from the plane \[m\].
    pub distance: f64,
    /// -1 where the overlap grows with the distance, in a ring.
    pub sign: f64,
    /// Mutual approach \[m\].
    pub overlap: f64,
}

impl Body {
    /// How a grain of radius `radius` \[m\] at `at` is to it.
    #[must_use]
    pub fn near(&self, at: Vec2, radius: f64) -> Near {
        let branch = at - self.at;
        match self.shape {
            Shape::Plane(normal) => {
                let distance = branch.dot(&normal);
                Near { along: normal, distance, sign: 1.0, overlap: radius - distance }
            }
            Shape::Disc(own) => {
                let distance = branch.norm();
                let overlap = radius + own - distance;
                Near { along: branch / distance, distance, sign: 1.0, overlap }
            }
            Shape::Ring(own) => {
                let distance = branch.norm();
                // The centre of a ring has no direction; nothing touches there.
                let along = if distance > 0.0 { branch / distance } else { Vec2::x() };
                Near { along, distance, sign: -1.0, overlap: radius + distance - own }
            }
        }
    }

    /// What the overlap of a grain in the direction `near` gains over the inward displacement of the
    /// side.
    #[must_use]
    pub fn approach(&self, near: &Near) -> f64 {
        near.sign * near.along.dot(&self.slide) + self.growth
    }
}

/// The bodies of `model` with its sides displaced inwards by `displacement` \[m\] and tilted by `tilt`.
///
/// A tilt by γ shears the box: what is at a height of y above its middle at the start moves along x by
/// γ y, and the side walls lean (B 3.3.4).
pub fn bodies(model: &Model, displacement: &[f64; wall::COUNT], tilt: f64, bodies: &mut Vec<Body>) {
    let bounds = model.start.displaced(displacement);
    let start = middle(&model.start);
    let lean = Vec2::new(1.0, -tilt) / tilt.hypot(1.0);
    bodies.clear();
    for side in 0..SIDES {
        let inward = wall::inward(side);
        let position = bounds.position(side);
        let (at, normal, slide, swing) = match wall::axis(side) {
            0 => {
                let at = Vec2::new(position, start.y);
                let rate = -1.0 / (1.0 + tilt * tilt);
                let swing = Swing { way: Vec2::zeros(), turn: -tilt.atan(), rate };
                (at, lean * inward, Vec2::new(inward, 0.0), swing)
            }
            _ => {
                let above = position - start.y;
                let at = Vec2::new(start.x + tilt * above, position);
                let swing = Swing { way: Vec2::new(above, 0.0), ..Swing::default() };
                (at, Vec2::new(0.0, inward), Vec2::new(tilt, 1.0) * inward, swing)
            }
        };
        let shape = Shape::Plane(normal);
        bodies.push(Body { side: side as u8, at, shape, slide, growth: 0.0, swing });
    }
}

/// Where a grain at `at` goes when the tilt grows by `more`.
#[must_use]
pub fn sheared(model: &Model, more: f64, at: Vec2) -> Vec2 {
    Vec2::new(more * (at.y - middle(&model.start).y), 0.0)
}

/// Middle of a box \[m\].
fn middle(bounds: &Bounds) -> Vec2 {
    let [x, y, _] = bounds.center();
    Vec2::new(x, y)
}

/// Where a grain at `at` goes when the sides move inwards by `ways` \[m\] and take what is between them
/// along affinely.
#[must_use]
pub fn carried(model: &Model, bounds: &Bounds, tilt: f64, ways: &[f64; SIDES], at: Vec2) -> Vec2 {
    let start = middle(&model.start);
    let sides = bounds.sides();
    let up = (at.y - bounds.min[1]) / sides[1];
    let across = (at.x - bounds.min[0] - tilt * (at.y - start.y)) / sides[0];
    let along_x = ways[0] * (1.0 - across) - ways[1] * across;
    let along_y = ways[2] * (1.0 - up) - ways[3] * up;
    Vec2::new(along_x + tilt * along_y, along_y)
}

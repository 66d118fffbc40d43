//! What surrounds the grains: bodies that the sides of the rig move.

use super::Vec2;
use crate::measure::contacts::Contact;
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
    /// Curvature of its surface at the start \[1/m\], negative where the pack is inside.
    pub curvature: f64,
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
    /// Nothing: no grain touches it.
    Nothing,
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
    /// A side without a body.
    pub(super) fn nothing(side: usize) -> Self {
        let (at, slide) = (Vec2::zeros(), Vec2::zeros());
        let shape = Shape::Nothing;
        Self {
            side: side as u8,
            at,
            shape,
            slide,
            growth: 0.0,
            curvature: 0.0,
            swing: Swing::default(),
        }
    }

    /// Effective radius \[m\] of its contact with a grain of radius `radius` \[m\], 1/(1/R + curvature).
    #[must_use]
    pub fn effective_radius(&self, radius: f64) -> f64 {
        radius / (1.0 + radius * self.curvature)
    }

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
                // As in a ring.
                let along = if distance > 0.0 { branch / distance } else { Vec2::x() };
                Near { along, distance, sign: 1.0, overlap }
            }
            Shape::Ring(own) => {
                let distance = branch.norm();
                // The centre of a ring has no direction; nothing touches there.
                let along = if distance > 0.0 { branch / distance } else { Vec2::x() };
                Near { along, distance, sign: -1.0, overlap: radius + distance - own }
            }
            Shape::Nothing => Near {
                along: Vec2::x(),
                distance: f64::INFINITY,
                sign: 1.0,
                overlap: f64::NEG_INFINITY,
            },
        }
    }

    /// What the overlap of a grain in the direction `near` gains over the inward displacement of the
    /// side.
    #[must_use]
    pub fn approach(&self, near: &Near) -> f64 {
        near.sign * near.along.dot(&self.slide) + self.growth
    }
}

/// The bodies of `model` with its sides displaced inwards by `displacement` \[m\] and tilted by `tilt`:
/// the first four are those of the sides, beyond them are further points.
///
/// A tilt by γ shears the box: what is at a height of y above its middle at the start moves along x by
/// γ y, and the side walls lean (B 3.3.4).
pub fn bodies(model: &Model, displacement: &[f64; wall::COUNT], tilt: f64, bodies: &mut Vec<Body>) {
    bodies.clear();
    let Some(setup) = &model.plane else { return };
    let bounds = model.start.displaced(displacement);
    let start = middle(&model.start);
    let lean = Vec2::new(1.0, -tilt) / tilt.hypot(1.0);
    setup.cell.shapes(displacement, |side, body| {
        bodies.push(body.unwrap_or_else(|| {
            let inward = wall::inward(side);
            let position = bounds.position(side);
            let slide = slide(side, tilt);
            let (at, normal, swing) = match wall::axis(side) {
                0 => {
                    let at = Vec2::new(position, start.y);
                    let rate = -1.0 / (1.0 + tilt * tilt);
                    let swing = Swing { way: Vec2::zeros(), turn: -tilt.atan(), rate };
                    (at, lean * inward, swing)
                }
                _ => {
                    let above = position - start.y;
                    let at = Vec2::new(start.x + tilt * above, position);
                    let swing = Swing { way: Vec2::new(above, 0.0), ..Swing::default() };
                    (at, Vec2::new(0.0, inward), swing)
                }
            };
            let shape = Shape::Plane(normal);
            Body { side: side as u8, at, shape, slide, growth: 0.0, curvature: 0.0, swing }
        }));
    });
}

/// Way of a plane side over its inward displacement.
fn slide(side: usize, tilt: f64) -> Vec2 {
    let inward = wall::inward(side);
    match wall::axis(side) {
        0 => Vec2::new(inward, 0.0),
        _ => Vec2::new(tilt, 1.0) * inward,
    }
}

/// Where a grain at `at` goes when the tilt grows by `more`.
#[must_use]
pub fn sheared(model: &Model, more: f64, at: Vec2) -> Vec2 {
    Vec2::new(more * (at.y - middle(&model.start).y), 0.0)
}

/// What `contact` presses side `side` with \[N\]: its normal force on a wall, and what there is along the
/// way of the side where the side has points.
#[must_use]
pub fn pressed(model: &Model, contact: &Contact, side: usize) -> f64 {
    match model.plane.as_ref().is_some_and(|setup| setup.cell.has_points(side)) {
        false => contact.force,
        true => {
            let on_grain = contact.normal * contact.force + contact.shear;
            Vec2::new(on_grain.x, on_grain.y).dot(&slide(side, 0.0))
        }
    }
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
    let sides = bounds.sides();
    let cell = model.plane.as_ref().map(|setup| &setup.cell);
    if let Some(way) = cell.and_then(|cell| cell.carried(0.5 * sides[0], ways, at)) {
        return way;
    }
    let start = middle(&model.start);
    let up = (at.y - bounds.min[1]) / sides[1];
    let across = (at.x - bounds.min[0] - tilt * (at.y - start.y)) / sides[0];
    let along_x = ways[0] * (1.0 - across) - ways[1] * across;
    let along_y = ways[2] * (1.0 - up) - ways[3] * up;
    Vec2::new(along_x + tilt * along_y, along_y)
}

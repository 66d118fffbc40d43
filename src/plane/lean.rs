//! The box of discs as it leans, and the affine motion from one such box to another.

use super::Vec2;
use crate::Vec3;
use crate::model::Model;
use crate::wall::Bounds;

/// A box that leans.
#[derive(Clone, Copy, Debug)]
pub struct Lean {
    /// Its middle \[m\].
    pub middle: Vec2,
    /// Width and height \[m\].
    sides: Vec2,
    /// γ.
    tilt: f64,
}

impl Lean {
    /// The box `bounds` of `model`, upright, leant by `tilt` about the height of its middle at the start.
    #[must_use]
    pub fn new(model: &Model, bounds: &Bounds, tilt: f64) -> Self {
        let ([width, height, _], [x, y, _]) = (bounds.sides(), bounds.center());
        let [_, hinge, _] = model.start.center();
        let middle = Vec2::new(x + tilt * (y - hinge), y);
        Self { middle, sides: Vec2::new(width, height), tilt }
    }

    /// Where what is at `at` goes with the box when it becomes `after`.
    #[must_use]
    pub fn carry(&self, after: &Self, at: &Vec3) -> Vec3 {
        let from = at.xy() - self.middle;
        let place = Vec2::new(from.x - self.tilt * from.y, from.y).component_div(&self.sides);
        let to = place.component_mul(&after.sides);
        let to = after.middle + Vec2::new(to.x + after.tilt * to.y, to.y);
        Vec3::new(to.x, to.y, at.z)
    }
}

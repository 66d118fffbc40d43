//! What the sides of a pack enclose: a box, or the room between two circles or cylinders.

use super::Vec2;
use super::boundary::{Body, SIDES, Shape, Swing};
use crate::report::WallForces;
use crate::scene::{self, Scene, Walls};
use crate::wall::{self, Bounds, Room};

/// A box may differ from a square, as the box of an annulus is, by this share.
pub(crate) const SQUARE: f64 = 1e-9;

/// Sides and what they enclose, as they are at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Box at the start.
    pub start: Bounds,
    /// Radius of the inner circle of an annulus at the start \[m\], 0 of a cylinder without one; `None`
    /// for a box.
    pub inner: Option<f64>,
    /// Whether there are walls across z: of spheres.
    pub ends: bool,
    /// What each side is.
    pub sides: [Side; SIDES],
}

/// What a side is.
#[derive(Clone, Debug, PartialEq)]
pub enum Side {
    /// A wall: a plane, or a circle of an annulus.
    Wall,
    /// Discs of the radius \[m\] at these places along the side \[m\].
    Points(Vec<f64>, f64),
    /// A membrane, under this pressure at the start \[Pa\].
    Membrane(f64),
    /// Nothing.
    Open,
}

impl Cell {
    /// What surrounds the pack of `scene` in the box `start`; `None` for six plane walls.
    #[must_use]
    pub fn of(scene: &Scene, start: &Bounds) -> Option<Self> {
        match scene.dimension {
            2 => Some(Self::new(&scene.walls, start)),
            _ => Self::of_spheres(&scene.walls, start),
        }
    }

    /// What surrounds spheres; `None` for six plane walls.
    #[must_use]
    pub fn of_spheres(walls: &Walls, start: &Bounds) -> Option<Self> {
        let plain = walls.cell.is_box() && walls.membranes.is_empty();
        (!plain).then(|| Self { ends: true, ..Self::new(walls, start) })
    }

    /// Of `walls` around discs in the box `start`.
    #[must_use]
    pub fn new(walls: &Walls, start: &Bounds) -> Self {
        let inner = walls.cell.inner();
        let points = walls.points.in_order();
        let targets = walls.targets.in_order();
        let has = |list: &[scene::WallName], w: usize| list.iter().any(|name| name.index() == w);
        let sides = std::array::from_fn(|w| {
            if let Some(points) = points[w] {
                return Side::Points(points.at.clone(), points.radius);
            }
            if has(&walls.membranes, w) {
                return Side::Membrane(targets[w].numbers().1);
            }
            let none = inner.is_some() && w > 1 || inner == Some(0.0) && w == 0;
            match has(&walls.open, w) || none {
                true => Side::Open,
                false => Side::Wall,
            }
        });
        Self { start: *start, inner, ends: false, sides }
    }

    /// What is wrong with the box for it.
    #[must_use]
    pub fn unfit(&self) -> Option<String> {
        let inner = self.inner?;
        let [x, y, _] = self.start.sides();
        if (x - y).abs() > SQUARE * x {
            return Some(format!(
                "the box of a round cell is {x:e} by {y:e} m; allowed: the square around its outer circle"
            ));
        }
        (2.0 * inner >= x).then(|| {
            format!("the inner radius {inner:e} m is no less than the outer one, {:e} m", 0.5 * x)
        })
    }

    /// Why no grain of the radius `radius` \[m\] may have its centre at `at` at the start.
    #[must_use]
    pub fn shuts_out(&self, at: Vec2, radius: f64) -> Option<String> {
        let [inner, outer] = self.radii(&[0.0; wall::COUNT])?;
        if radius >= outer {
            return Some(format!("has the radius {radius:e} m; allowed: less than {outer:e} m"));
        }
        let distance = (at - self.centre()).norm();
        let inside = inner > 0.0 && distance <= inner;
        (inside || distance >= outer).then(|| {
            format!(
                "is {distance:e} m from the middle of the cell; allowed: between {inner:e} and \
                 {outer:e} m"
            )
        })
    }

    /// Whether side or wall `w` is there.
    #[must_use]
    pub fn has(&self, w: usize) -> bool {
        self.sides.get(w).map_or(self.ends, |side| *side != Side::Open)
    }

    /// Whether side `w` is a membrane.
    #[must_use]
    pub fn is_membrane(&self, w: usize) -> bool {
        matches!(self.sides.get(w), Some(Side::Membrane(_)))
    }

    /// Pressure at the start of side `w`, which is a membrane \[Pa\].
    #[must_use]
    pub fn first_pressure(&self, w: usize) -> Option<f64> {
        match self.sides.get(w) {
            Some(Side::Membrane(pressure)) => Some(*pressure),
            _ => None,
        }
    }

    /// How far out of the pack the wall of side `w` is at the start \[m\]: a radius, or along its normal.
    #[must_use]
    pub fn outermost(&self, w: usize) -> f64 {
        match self.radii(&[0.0; wall::COUNT]) {
            Some(radii) => radii.get(w).copied().unwrap_or(0.0),
            None => -wall::inward(w) * self.start.position(w),
        }
    }

    /// Whether side `w` has points instead of a wall.
    #[must_use]
    pub fn has_points(&self, w: usize) -> bool {
        matches!(self.sides.get(w), Some(Side::Points(..)))
    }

    /// Whether all sides of discs are planes, so that the box can lean.
    #[must_use]
    pub fn leans(&self) -> bool {
        !self.ends && self.inner.is_none() && self.sides.iter().all(|side| *side == Side::Wall)
    }

    /// Whether the two sides across an axis carry one load, and not loads of their own.
    #[must_use]
    pub fn is_paired(&self, axis: usize) -> bool {
        self.inner.is_none() || axis == 2
    }

    /// Bodies that there are: one of each side and the points beyond the first of each.
    #[must_use]
    pub fn bodies(&self) -> usize {
        let more = |side: &Side| match side {
            Side::Points(at, _) => at.len().saturating_sub(1),
            _ => 0,
        };
        SIDES + self.sides.iter().map(more).sum::<usize>()
    }

    /// Middle of the box at the start \[m\].
    #[must_use]
    pub fn centre(&self) -> Vec2 {
        let [x, y, _] = self.start.center();
        Vec2::new(x, y)
    }

    /// Inner and outer radius of an annulus with its sides displaced inwards by `displacement` \[m\].
    #[must_use]
    pub fn radii(&self, displacement: &[f64; wall::COUNT]) -> Option<[f64; 2]> {
        let outer = 0.5 * self.start.sides()[0] - displacement[1];
        self.inner.map(|inner| [inner + displacement[0], outer])
    }

    /// The box: that of an annulus is the square around its outer circle.
    #[must_use]
    pub fn bounds(&self, displacement: &[f64; wall::COUNT]) -> Bounds {
        match self.inner {
            None => self.start.displaced(displacement),
            Some(_) => {
                let [_, d, _, _, low, high] = *displacement;
                self.start.displaced(&[d, d, d, d, low, high])
            }
        }
    }

    /// The room between the sides.
    #[must_use]
    pub fn room(&self, displacement: &[f64; wall::COUNT]) -> Room {
        let radii = self.radii(displacement);
        let walls = std::array::from_fn(|w| self.has(w) && !self.is_membrane(w));
        Room::new(self.bounds(displacement), radii, walls)
    }

    /// Volume that the sides enclose \[m³\].
    #[must_use]
    pub fn volume(&self, displacement: &[f64; wall::COUNT]) -> f64 {
        self.room(displacement).volume()
    }

    /// Area of wall `w` \[m²\]; 0 for a side that an annulus has not.
    #[must_use]
    pub fn area(&self, w: usize, displacement: &[f64; wall::COUNT]) -> f64 {
        self.room(displacement).area(w)
    }

    /// Curvature of round wall `w` at the start as a grain in the cell sees it \[1/m\]: positive where it
    /// bends away.
    #[must_use]
    pub fn curvature(&self, w: usize) -> Option<f64> {
        let [inner, outer] = self.radii(&[0.0; wall::COUNT])?;
        match w {
            0 if inner > 0.0 => Some(1.0 / inner),
            1 => Some(-1.0 / outer),
            _ => None,
        }
    }

    /// Normal stresses that the forces of the walls make: along x and y the pressure on the outer wall of
    /// a round cell, or on its inner one where that is the only one, along z the mean of both ends
    /// \[Pa\]. `None` for a box.
    #[must_use]
    pub fn pressure(&self, walls: &WallForces) -> Option<[f64; 3]> {
        self.inner?;
        let on = |w: usize| walls.normal_force[w] / self.area(w, &walls.displacement);
        let lateral = on(usize::from(self.has(1)));
        let axial = if self.ends { 0.5 * (on(4) + on(5)) } else { 0.0 };
        Some([lateral, lateral, axial])
    }

    /// Largest strain that is left from `displacement` to `target` \[m\].
    #[must_use]
    pub fn remaining_strain(
        &self,
        displacement: &[f64; wall::COUNT],
        target: &[f64; wall::COUNT],
    ) -> f64 {
        let left = |w: usize| (target[w] - displacement[w]).abs();
        let sides = self.start.sides();
        let across = |axis: usize| (left(2 * axis) + left(2 * axis + 1)) / sides[axis];
        match self.radii(&[0.0; wall::COUNT]) {
            None => (0..3).map(across).fold(0.0, f64::max),
            Some([inner, outer]) => {
                let thick = if self.has(0) && self.has(1) { outer - inner } else { outer };
                let hole = if inner > 0.0 { left(0) / inner } else { 0.0 };
                ((left(0) + left(1)) / thick).max(hole).max(across(2))
            }
        }
    }

    /// Whether a point is further than `margin` \[m\] from every side.
    #[must_use]
    pub fn is_interior(&self, at: Vec2, margin: f64, displacement: &[f64; wall::COUNT]) -> bool {
        match self.radii(displacement) {
            None => {
                let bounds = self.start.displaced(displacement);
                (0..2).all(|axis| {
                    at[axis] - bounds.min[axis] > margin && bounds.max[axis] - at[axis] > margin
                })
            }
            Some([inner, outer]) => {
                let distance = (at - self.centre()).norm();
                distance - inner > margin && outer - distance > margin
            }
        }
    }

    /// Where the walls of an annulus take what is at `at` when they move inwards by `ways` \[m\]: along
    /// the radius, evenly from one wall to the other, and in proportion to the radius where one is alone.
    #[must_use]
    pub fn carried(&self, outer: f64, ways: &[f64; SIDES], at: Vec2) -> Option<Vec2> {
        let inner = self.inner?;
        let branch = at - self.centre();
        let distance = branch.norm();
        if distance == 0.0 {
            return Some(Vec2::zeros());
        }
        let outwards = match (self.has(0), self.has(1)) {
            (true, true) => {
                let across = (distance - inner) / (outer - inner);
                ways[0] * (1.0 - across) - ways[1] * across
            }
            (false, _) => -ways[1] * distance / outer,
            (true, false) => ways[0] * inner / distance,
        };
        Some(branch * (outwards / distance))
    }

    /// The bodies of the points and circles, in the order of the sides, and `None` where a side is a plane:
    /// first one of each side, then the other points.
    pub(super) fn shapes(
        &self,
        displacement: &[f64; wall::COUNT],
        mut take: impl FnMut(usize, Option<Body>),
    ) {
        let radii = self.radii(displacement);
        let start = self.radii(&[0.0; wall::COUNT]);
        for (side, kind) in self.sides.iter().enumerate() {
            let body = match (kind, radii, start) {
                (Side::Wall, None, _) => None,
                (Side::Wall, Some(radii), Some(start)) => {
                    Some(circle(side, self.centre(), radii, start))
                }
                (Side::Points(at, radius), ..) => {
                    at.first().map(|&at| self.point(side, at, *radius, displacement))
                }
                _ => Some(Body::nothing(side)),
            };
            take(side, body);
        }
        for (side, kind) in self.sides.iter().enumerate() {
            if let Side::Points(at, radius) = kind {
                let more = at.iter().skip(1);
                more.for_each(|&at| take(side, Some(self.point(side, at, *radius, displacement))));
            }
        }
    }

    fn point(
        &self,
        side: usize,
        along: f64,
        radius: f64,
        displacement: &[f64; wall::COUNT],
    ) -> Body {
        let inward = wall::inward(side);
        let position = self.start.displaced(displacement).position(side) - inward * radius;
        let (at, slide) = match wall::axis(side) {
            0 => (Vec2::new(position, along), Vec2::new(inward, 0.0)),
            _ => (Vec2::new(along, position), Vec2::new(0.0, inward)),
        };
        let (shape, curvature) = (Shape::Disc(radius), 1.0 / radius);
        Body { side: side as u8, at, shape, slide, growth: 0.0, curvature, swing: Swing::default() }
    }
}

/// A wall of an annulus whose radii are `radii` \[m\], `start` at the start.
fn circle(side: usize, at: Vec2, radii: [f64; 2], start: [f64; 2]) -> Body {
    let (shape, curvature) = match side {
        0 => (Shape::Disc(radii[0]), 1.0 / start[0]),
        _ => (Shape::Ring(radii[1]), -1.0 / start[1]),
    };
    Body {
        side: side as u8,
        at,
        shape,
        slide: Vec2::zeros(),
        growth: 1.0,
        curvature,
        swing: Swing::default(),
    }
}

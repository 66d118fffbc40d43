//! What surrounds a pack besides plane walls (B 2.5, 3.3.2, 4.4, 4.5).

mod spheres;

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use super::{Scene, Step, WallName, Walls};
use crate::wall::{self, WallTarget};

/// Most points in all.
pub const MOST_POINTS: usize = 64;

/// What the walls enclose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cell {
    /// A box.
    #[default]
    Box,
    /// Of discs, the room between two circles about the middle of the box: `x_max` is the outer one, which
    /// the box is the square around, `x_min` the inner one.
    Annulus(Annulus),
    /// Of spheres, the room in a cylinder about an axis along z, or between two: `x_max` is the outer one,
    /// `x_min` the inner one.
    Cylinder(Cylinder),
}

/// See [`Cell::Annulus`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Annulus {
    /// Radius of the inner circle at the start \[m\], above 0.
    pub inner: f64,
}

/// See [`Cell::Cylinder`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Radius of the inner cylinder at the start \[m\], above 0; without it there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inner: Option<f64>,
}

impl Cell {
    /// Whether it is a box.
    #[must_use]
    pub fn is_box(&self) -> bool {
        *self == Self::Box
    }

    /// Radius of the inner circle or cylinder at the start \[m\], 0 without one; `None` for a box.
    #[must_use]
    pub fn inner(&self) -> Option<f64> {
        match self {
            Self::Box => None,
            Self::Annulus(annulus) => Some(annulus.inner),
            Self::Cylinder(cylinder) => Some(cylinder.inner.unwrap_or(0.0)),
        }
    }

    /// Multiplies all lengths by `factor`.
    pub(crate) fn scale(&mut self, factor: f64) {
        match self {
            Self::Box => {}
            Self::Annulus(annulus) => annulus.inner *= factor,
            Self::Cylinder(cylinder) => cylinder.inner.iter_mut().for_each(|r| *r *= factor),
        }
    }
}

/// Discs that stand in the place of a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Points {
    /// Where along the wall they are \[m\].
    pub at: Vec<f64>,
    /// Their radius \[m\], above 0; they touch from outside the line where the wall would be.
    pub radius: f64,
}

/// Points by the name of their wall.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PointSides {
    #[serde(skip_serializing_if = "Option::is_none")]
    x_min: Option<Points>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x_max: Option<Points>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y_min: Option<Points>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y_max: Option<Points>,
}

impl PointSides {
    /// In the order of the sides.
    #[must_use]
    pub fn in_order(&self) -> [Option<&Points>; 4] {
        [&self.x_min, &self.x_max, &self.y_min, &self.y_max].map(Option::as_ref)
    }

    /// Multiplies all lengths by `factor`.
    pub(crate) fn scale(&mut self, factor: f64) {
        let sides = [&mut self.x_min, &mut self.x_max, &mut self.y_min, &mut self.y_max];
        for points in sides.into_iter().flatten() {
            points.radius *= factor;
            points.at.iter_mut().for_each(|at| *at *= factor);
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.in_order().iter().all(Option::is_none)
    }
}

impl Walls {
    /// Whether these are the walls of a box and nothing else.
    pub(super) fn is_plain(&self) -> bool {
        self.cell == Cell::Box
            && self.points.is_empty()
            && self.open.is_empty()
            && self.membranes.is_empty()
    }
}

/// What a scene of spheres, or of discs, cannot have of it.
pub(super) fn check(scene: &Scene, problems: &mut Problems) {
    let Scene { walls, load_path: path, .. } = scene;
    if walls.is_plain() {
        return;
    }
    let at = Field::root().key("walls");
    if scene.dimension != 2 {
        return spheres::check(scene, &at, problems);
    }
    if let Cell::Cylinder(_) = walls.cell {
        problems.add(at.key("cell"), "a cylinder is for spheres; allowed: box, annulus");
    }
    if let Cell::Annulus(annulus) = walls.cell {
        let inner = at.key("cell").key("annulus").key("inner");
        problems.positive(inner, annulus.inner, "inner > 0 m");
        check_steps(&path.0, &Field::root().key("load_path"), problems);
    }
    check_sides(walls, &at, problems);
    check_points(walls, &at.key("points"), problems);
    check_pressures(walls, &at, problems);
}

/// A side is one thing only.
fn check_sides(walls: &Walls, at: &Field, problems: &mut Problems) {
    let annulus = walls.cell != Cell::Box;
    let mut taken = walls.points.in_order().map(|points| points.is_some());
    for (key, sides) in [("open", &walls.open), ("membranes", &walls.membranes)] {
        for (index, side) in sides.iter().enumerate() {
            let (at, w) = (at.key(key).index(index), side.index());
            let name = wall::NAMES[w];
            match taken.get_mut(w) {
                None => problems.add(at, format!("discs have no {name}; allowed: x and y sides")),
                Some(_) if annulus && w > 1 => {
                    problems.add(at, format!("an annulus has no {name}; allowed: x_min, x_max"));
                }
                Some(taken) if *taken => {
                    problems.add(at, format!("{name} is something else too; allowed: one of points, open and membranes"));
                }
                Some(taken) => *taken = true,
            }
        }
    }
    if annulus && !walls.points.is_empty() {
        problems.add(at.key("points"), "an annulus has none; allowed: `cell: box`");
    }
    if annulus && walls.open.contains(&WallName::XMax) && walls.open.contains(&WallName::XMin) {
        problems.add(at.key("open"), "nothing holds the pack; allowed: one of x_min and x_max");
    }
}

fn check_points(walls: &Walls, at: &Field, problems: &mut Problems) {
    let mut count = 0;
    for (name, points) in wall::NAMES.iter().zip(walls.points.in_order()) {
        let Some(points) = points else { continue };
        let at = at.key(name);
        problems.positive(at.key("radius"), points.radius, "radius > 0 m");
        problems.finite(&at.key("at"), &points.at);
        if points.at.is_empty() {
            problems.add(at.key("at"), "no point; allowed: at least one");
        }
        count += points.at.len();
    }
    if count > MOST_POINTS {
        problems.add(at.clone(), format!("{count} points; allowed: at most {MOST_POINTS} in all"));
    }
}

/// Membranes press from the start on, and with a stress.
fn check_pressed(walls: &Walls, at: &Field, problems: &mut Problems) {
    let targets = walls.targets.in_order();
    for side in &walls.membranes {
        let name = wall::NAMES[side.index()];
        if !matches!(targets[side.index()], WallTarget::Stress(_)) {
            problems.add(
                at.key("targets").key(name),
                "a membrane carries a stress from the start on; allowed: `{stress: ...}`",
            );
        }
    }
}

fn check_pressures(walls: &Walls, at: &Field, problems: &mut Problems) {
    check_pressed(walls, at, problems);
    let targets = walls.targets.in_order();
    for side in &walls.membranes {
        let beside = [0, 1].map(|k| 2 * (1 - wall::axis(side.index()).min(1)) + k);
        let plain = |w: &usize| {
            let is = |list: &[WallName]| list.iter().any(|name| name.index() == *w);
            !is(&walls.open) && !is(&walls.membranes) && walls.points.in_order()[*w].is_none()
        };
        if walls.cell == Cell::Box && !beside.iter().all(plain) {
            let text =
                "a membrane ends at walls; allowed: no points, open sides or membranes beside it";
            problems.add(at.key("membranes"), text);
        }
    }
    for side in &walls.open {
        if targets[side.index()] != WallTarget::Keep {
            let at = at.key("targets").key(wall::NAMES[side.index()]);
            problems.add(at, "there is no such wall; allowed: no such key");
        }
    }
}

/// Steps that strain a box are none of an annulus.
fn check_steps(steps: &[Step], at: &Field, problems: &mut Problems) {
    for (index, step) in steps.iter().enumerate() {
        let at = at.index(index);
        match step {
            Step::Walls(_) | Step::Commands(_) | Step::Unload(_) => {}
            Step::Repeat(repeat) => {
                check_steps(&repeat.steps, &at.key("repeat").key("steps"), problems);
            }
            _ => problems.add(
                at,
                "strains a box, not a round cell; allowed: walls, unload, commands, repeat",
            ),
        }
    }
}

//! What surrounds discs: plates for walls, rings for circles, rods for points, and nothing where a side is
//! open.

use std::f64::consts::TAU;

use super::{Canvas, walls};
use crate::msg::picture::Marker;
use crate::plane::boundary::SIDES;
use crate::plane::cell::{Cell, Side};
use crate::report::WallForces;
use crate::wall;

/// Corners of a circle.
const CORNERS: u32 = 180;

/// A marker of each side, deleted where there is nothing, and one of each point beyond the first of a side.
/// Circles are lines whose inner or outer edge is where the wall is.
pub(super) fn sides(canvas: &Canvas, cell: &Cell, walls: &WallForces) -> Vec<Marker> {
    let mut markers: Vec<Marker> =
        (0..SIDES).map(|side| first(canvas, cell, walls, side)).collect();
    for side in 0..SIDES {
        let Side::Points(at, radius) = &cell.sides[side] else { continue };
        for &along in at.iter().skip(1) {
            markers.push(point(canvas, walls, (side, markers.len()), along, *radius));
        }
    }
    markers
}

fn first(canvas: &Canvas, cell: &Cell, walls: &WallForces, side: usize) -> Marker {
    match (&cell.sides[side], cell.radii(&walls.displacement)) {
        (Side::Open, _) => walls::nothing(canvas, side),
        (Side::Points(at, radius), _) => match at.first() {
            Some(&along) => point(canvas, walls, (side, side), along, *radius),
            None => walls::nothing(canvas, side),
        },
        (_, Some(radii)) => circle(canvas, cell, walls, (side, radii[side.min(1)])),
        (_, None) => walls::plate(canvas, walls, side),
    }
}

fn circle(
    canvas: &Canvas,
    cell: &Cell,
    walls: &WallForces,
    (side, radius): (usize, f64),
) -> Marker {
    let thickness = walls::thickness(walls);
    let centre = cell.centre();
    // Outside of the pack, as plates are.
    let radius = radius + thickness * if side == 0 { -0.5 } else { 0.5 };
    let mut marker = canvas.marker("walls", side, Marker::LINE_STRIP);
    marker.points = (0..=CORNERS)
        .map(|corner| {
            let (sine, cosine) = (TAU * f64::from(corner) / f64::from(CORNERS)).sin_cos();
            canvas.point([centre.x + radius * cosine, centre.y + radius * sine, 0.0])
        })
        .collect();
    marker.scale = [thickness * canvas.scale, 0.0, 0.0].into();
    marker.color = walls::COLOR;
    marker
}

/// The point of `side` with the number `id` at the place `along` \[m\].
fn point(
    canvas: &Canvas,
    walls: &WallForces,
    (side, id): (usize, usize),
    along: f64,
    radius: f64,
) -> Marker {
    let (sides, centre) = walls::shape(walls);
    let axis = wall::axis(side);
    let mut at = centre;
    at[axis] = walls.position[side] - radius * wall::inward(side);
    at[1 - axis] = along;
    let mut marker = canvas.marker("walls", id, Marker::CYLINDER);
    marker.pose.position = at.map(|x| x * canvas.scale).into();
    marker.scale = [2.0 * radius, 2.0 * radius, sides[2]].map(|side| side * canvas.scale).into();
    marker.color = walls::COLOR;
    marker
}

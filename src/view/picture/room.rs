//! What surrounds spheres: plates, cylinders with discs at their ends, and membranes as they are bent.

use super::{Canvas, walls};
use crate::msg::picture::Marker;
use crate::plane::cell::{Cell, Side};
use crate::report::{Measures, WallForces};
use crate::wall;

/// A marker of each wall in the order of [`wall::NAMES`], deleted where there is nothing.
pub(super) fn room(canvas: &Canvas, cell: &Cell, measures: &Measures) -> Vec<Marker> {
    (0..wall::COUNT).map(|wall| of_wall(canvas, cell, measures, wall)).collect()
}

fn of_wall(canvas: &Canvas, cell: &Cell, measures: &Measures, wall: usize) -> Marker {
    let walls = &measures.walls;
    match (cell.sides.get(wall), cell.radii(&walls.displacement)) {
        (Some(Side::Open), _) => walls::nothing(canvas, wall),
        (Some(Side::Membrane(_)), _) => membrane(canvas, measures, wall),
        (_, None) => walls::plate(canvas, walls, wall),
        (Some(_), Some(radii)) => tube(canvas, walls, (wall, radii[wall.min(1)])),
        (None, Some([_, outer])) => platen(canvas, walls, (wall, outer)),
    }
}

/// A round wall, which ends in the middle of the platens.
fn tube(canvas: &Canvas, walls: &WallForces, (wall, radius): (usize, f64)) -> Marker {
    let (sides, centre) = walls::shape(walls);
    let height = sides[2] + walls::thickness(walls);
    cylinder(canvas, wall, centre, [radius, height])
}

/// A disc whose inner face is where the wall is.
fn platen(canvas: &Canvas, walls: &WallForces, (wall, radius): (usize, f64)) -> Marker {
    let (_, mut centre) = walls::shape(walls);
    let thickness = walls::thickness(walls);
    centre[2] = walls.position[wall] - 0.5 * thickness * wall::inward(wall);
    cylinder(canvas, wall, centre, [radius, thickness])
}

fn cylinder(canvas: &Canvas, wall: usize, centre: [f64; 3], [radius, height]: [f64; 2]) -> Marker {
    let mut marker = canvas.marker("walls", wall, Marker::CYLINDER);
    marker.pose.position = centre.map(|x| x * canvas.scale).into();
    marker.scale = [2.0 * radius, 2.0 * radius, height].map(|side| side * canvas.scale).into();
    marker.color = walls::COLOR;
    marker
}

fn membrane(canvas: &Canvas, measures: &Measures, side: usize) -> Marker {
    let surface = measures.surfaces.iter().find(|surface| surface.side == side);
    let corners = surface.into_iter().flat_map(|surface| surface.triangles.iter().flatten());
    let mut marker = canvas.marker("walls", side, Marker::TRIANGLE_LIST);
    marker.points = corners.map(|corner| canvas.point(*corner)).collect();
    if marker.points.is_empty() {
        return walls::nothing(canvas, side);
    }
    marker.scale = [1.0; 3].into();
    marker.color = walls::COLOR;
    marker
}

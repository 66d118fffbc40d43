//! Walls as thin plates that let the pack be seen.

use super::Canvas;
use crate::msg::picture::{ColorRGBA, Marker};
use crate::report::WallForces;
use crate::wall;

/// Thickness of a plate over the largest side of the box.
const THICKNESS: f64 = 0.005;

pub(super) const COLOR: ColorRGBA = ColorRGBA { r: 0.6, g: 0.7, b: 0.8, a: 0.12 };

/// Nothing in the place of wall `wall`.
pub(super) fn nothing(canvas: &Canvas, wall: usize) -> Marker {
    let mut marker = canvas.marker("walls", wall, Marker::CUBE);
    marker.action = Marker::DELETE;
    marker
}

/// The plate of one wall, outside of the box, its inner face where the wall is.
pub(super) fn plate(canvas: &Canvas, walls: &WallForces, wall: usize) -> Marker {
    let (sides, centre) = shape(walls);
    let thickness = thickness(walls);
    let axis = wall::axis(wall);
    let (mut at, mut plate) = (centre, sides);
    at[axis] = walls.position[wall] - 0.5 * thickness * wall::inward(wall);
    plate[axis] = thickness;
    let mut marker = canvas.marker("walls", wall, Marker::CUBE);
    marker.pose.position = at.map(|x| x * canvas.scale).into();
    marker.scale = plate.map(|side| side * canvas.scale).into();
    marker.color = COLOR;
    marker
}

/// Thickness of the plates \[m\].
pub(super) fn thickness(walls: &WallForces) -> f64 {
    THICKNESS * shape(walls).0.into_iter().fold(0.0, f64::max)
}

/// Sides and centre of the box \[m\].
pub(super) fn shape(walls: &WallForces) -> ([f64; 3], [f64; 3]) {
    let pair = |axis: usize| [walls.position[2 * axis], walls.position[2 * axis + 1]];
    let sides = std::array::from_fn(|axis| pair(axis)[1] - pair(axis)[0]);
    (sides, std::array::from_fn(|axis| 0.5 * (pair(axis)[0] + pair(axis)[1])))
}

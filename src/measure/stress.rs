//! Stress and strain of the pack, compression positive.

use nalgebra::Matrix3;

use crate::measure::contacts::Contact;
use crate::report::WallForces;
use crate::wall::Bounds;

/// Stress from the wall forces on the current areas \[Pa\] (T 2.11): entry (l, m) is the force
/// along l on the walls across m, mean of both. Smooth walls leave zeros off the diagonal.
#[must_use]
pub fn from_walls(walls: &WallForces, bounds: &Bounds) -> Matrix3<f64> {
    let normal = |axis: usize| {
        let [low, high] = [2 * axis, 2 * axis + 1];
        0.5 * (walls.normal_force[low] / bounds.area(low)
            + walls.normal_force[high] / bounds.area(high))
    };
    let shear = |l: usize, m: usize| {
        let [low, high] = [2 * m, 2 * m + 1];
        0.5 * (walls.force[high][l] / bounds.area(high) - walls.force[low][l] / bounds.area(low))
    };
    Matrix3::from_fn(|l, m| if l == m { normal(m) } else { shear(l, m) })
}

/// The same of a box of discs that leans by `tilt`, along x and y: the force on a leaning side is that
/// across x without `tilt` of that across y.
#[must_use]
pub fn from_leaning_walls(walls: &WallForces, bounds: &Bounds, tilt: f64) -> Matrix3<f64> {
    if tilt == 0.0 {
        return from_walls(walls, bounds);
    }
    let across = |l: usize, m: usize| {
        let [low, high] = [2 * m, 2 * m + 1];
        0.5 * (walls.force[high][l] / bounds.area(high) - walls.force[low][l] / bounds.area(low))
    };
    Matrix3::from_fn(|l, m| match (l, m) {
        (0 | 1, 0) => across(l, 0) + tilt * across(l, 1),
        (0 | 1, 1) => across(l, 1),
        _ => 0.0,
    })
}

/// Love-Weber stress \[Pa\]: T 2.13 with each grain-grain contact taken once.
#[must_use]
pub fn from_contacts(contacts: &[Contact], bounds: &Bounds) -> Matrix3<f64> {
    in_volume(contacts, bounds.volume())
}

/// The same of contacts in the volume `volume` \[m³\].
#[must_use]
pub fn in_volume(contacts: &[Contact], volume: f64) -> Matrix3<f64> {
    let mut sum = Matrix3::zeros();
    for contact in contacts {
        // r_ij between grains, n̂w (Ri - h) at a wall: either way along the normal.
        let branch = contact.normal * contact.distance;
        sum += (contact.normal * contact.force + contact.shear) * branch.transpose();
    }
    sum / volume
}

/// Engineering strain of the box against `reference` (T 2.10, positive in compression).
#[must_use]
pub fn engineering_strain(bounds: &Bounds, reference: &Bounds) -> [f64; 3] {
    let (now, before) = (bounds.sides(), reference.sides());
    std::array::from_fn(|axis| (before[axis] - now[axis]) / before[axis])
}

/// Logarithmic strain of the box against `reference` (T 2.6.1, "natural").
#[must_use]
pub fn natural_strain(bounds: &Bounds, reference: &Bounds) -> [f64; 3] {
    let (now, before) = (bounds.sides(), reference.sides());
    std::array::from_fn(|axis| (before[axis] / now[axis]).ln())
}

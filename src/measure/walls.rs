//! Forces and moments of the pack on the walls.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::plane::boundary::{SIDES, pressed};
use crate::report::WallForces;
use crate::state::State;
use crate::wall::{self, Bounds, Room};

/// Normal force on each wall \[N\], 0 of membranes, and nothing else; the neighbour list must hold the
/// contacts.
#[must_use]
pub fn normal_forces(model: &Model, state: &State, near: &Neighbours) -> [f64; wall::COUNT] {
    let grains = (&*state.position, &*state.carries);
    let bounds = state.bounds(model);
    let mut forces = normal_forces_in(model, near, grains, &bounds);
    let Some(cement) = &model.cement else { return forces };
    for bond in state.bonds.iter().filter(|bond| bond.holds()) {
        if let Other::Wall(w) = bond.second {
            let w = usize::from(w);
            let mut normal = Vec3::zeros();
            normal[wall::axis(w)] = wall::inward(w);
            let law = model.law_of(cement, bond);
            forces[w] += bond.force(&law, &state.position, &bounds);
        }
    }
    forces
}

/// Normal force of the contacts without cement on each wall \[N\], for the grains at `position` that `carries` marks, in the box `bounds`.
#[must_use]
pub fn normal_forces_in(
    model: &Model,
    near: &Neighbours,
    (position, carries): (&[Vec3], &[bool]),
    bounds: &Room,
) -> [f64; wall::COUNT] {
    let mut forces = [0.0; wall::COUNT];
    for i in (0..model.len()).filter(|&i| carries[i]) {
        for (wall, reach) in near.walls_near(model, i) {
            let w = usize::from(wall);
            let overlap = reach - wall_gap(&position[i], w, bounds);
            if overlap > 0.0 {
                forces[w] += hertz::force(near.wall_modulus(i, w), overlap);
            }
        }
    }
    forces
}

/// Sums the wall contacts among `contacts`.
#[must_use]
pub fn forces(model: &Model, state: &State, contacts: &[Contact]) -> WallForces {
    let bounds = state.bounds(model);
    let center = Vec3::from(bounds.center());
    let mut force = [Vec3::zeros(); wall::COUNT];
    let mut moment = [Vec3::zeros(); wall::COUNT];
    let mut normal_force = [0.0; wall::COUNT];
    for contact in contacts {
        if let Other::Wall(w) = contact.second {
            let w = usize::from(w);
            let on_wall = -contact.normal * contact.force - contact.shear;
            let at = state.position[contact.first as usize] - contact.normal * contact.distance;
            force[w] += on_wall;
            moment[w] += (at - center).cross(&on_wall) - contact.normal * contact.torsion;
            normal_force[w] += pressed(model, contact, w);
        }
    }
    let cell = model.plane.as_ref().map(|setup| &setup.cell).or(model.cell.as_ref());
    let membranes = cell.into_iter().flat_map(|cell| (0..SIDES).map(move |w| (w, cell)));
    for (w, cell) in membranes.filter(|(w, cell)| cell.is_membrane(*w)) {
        normal_force[w] = state.pressure[w] * cell.area(w, &state.displacement);
        if cell.is_paired(wall::axis(w)) {
            force[w][wall::axis(w)] = -wall::inward(w) * normal_force[w];
        }
    }
    WallForces {
        normal_force,
        displacement: state.displacement,
        position: std::array::from_fn(|w| bounds.position(w)),
        force: force.map(Into::into),
        moment: moment.map(Into::into),
    }
}

/// The couple of opposite walls about the pack's centre, as a pair of forces the box apart, over
/// the normal force on them: the largest of the three pairs (T 3.5, HZ-13). It tells how much
/// shear stress the normal stresses leave out.
#[must_use]
pub fn couple(walls: &WallForces, bounds: &Bounds) -> f64 {
    let sides = bounds.sides();
    (0..3)
        .map(|axis| {
            let [low, high] = [2 * axis, 2 * axis + 1];
            let moment = Vec3::from(walls.moment[low]) + Vec3::from(walls.moment[high]);
            let force = 0.5 * (walls.normal_force[low] + walls.normal_force[high]);
            if force > 0.0 { moment.norm() / (sides[axis] * force) } else { 0.0 }
        })
        .fold(0.0, f64::max)
}

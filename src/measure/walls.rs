//! Forces and moments of the pack on the walls.

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::measure::contacts::{Contact, Other};
use crate::model::Model;
use crate::report::WallForces;
use crate::state::State;
use crate::wall;

/// Normal force on each wall \[N\] and nothing else; the neighbour list must hold the contacts.
#[must_use]
pub fn normal_forces(model: &Model, state: &State, near: &Neighbours) -> [f64; wall::COUNT] {
    let bounds = state.bounds(model);
    let mut forces = [0.0; wall::COUNT];
    for i in (0..model.len()).filter(|&i| state.carries[i]) {
        for &wall in near.walls_near(i) {
            let w = usize::from(wall);
            let overlap = model.radius[i] - wall_gap(&state.position[i], w, &bounds);
            if overlap > 0.0 {
                forces[w] += hertz::force(near.wall_modulus[i], overlap);
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
            let on_wall = -contact.normal * contact.force;
            let at = state.position[contact.first as usize] - contact.normal * contact.distance;
            force[w] += on_wall;
            moment[w] += (at - center).cross(&on_wall);
            normal_force[w] += contact.force;
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

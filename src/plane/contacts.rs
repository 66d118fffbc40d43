//! The load-carrying contacts of a state of discs, as measures take them.

use super::boundary::{self, Body};
use super::{Vec2, glue, law};
use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::contact::{Other, hertz};
use crate::measure::contacts::{AT_LIMIT, Contact, Contacts};
use crate::model::Model;
use crate::state::{Condition, State};
use crate::wall;

/// Lists the contacts of `state`; the neighbour list must hold them.
#[must_use]
pub fn of(model: &Model, state: &State, near: &Neighbours) -> Contacts {
    let (mut contacts, bodies) = with_bodies(model, state, near);
    for contact in &mut contacts.list {
        contact.second = side_of(contact.second, &bodies);
    }
    contacts
}

/// The same where a wall is the number of a body, with the bodies.
pub(super) fn with_bodies(
    model: &Model,
    state: &State,
    near: &Neighbours,
) -> (Contacts, Vec<Body>) {
    let mut list = Vec::with_capacity(near.second.len());
    let mut cracks = Vec::new();
    let mut bodies = Vec::new();
    let Some(setup) = &model.plane else { return (Contacts::default(), bodies) };
    boundary::bodies(model, &state.displacement, state.tilt, &mut bodies);
    let mut memory = state.memory.contacts.iter().peekable();
    let mut bonds = state.bonds.iter().peekable();
    for i in (0..model.len()).filter(|&i| state.carries[i]) {
        let at = state.position[i];
        let sticks = glue::side(&state.glued, i);
        for k in near.row(i) {
            let j = near.second[k] as usize;
            let key = (i as u32, Other::Grain(j as u32));
            while bonds.next_if(|bond| bond.key() < key).is_some() {}
            let condition = bonds.next_if(|bond| bond.key() == key).map(|bond| bond.condition);
            let holds = condition == Some(Condition::Intact);
            if sticks.is_some() && glue::side(&state.glued, j).is_some() {
                continue;
            }
            let branch = at - state.position[j];
            let distance = branch.norm();
            let overlap = model.radius[i] + model.radius[j] - distance;
            if !state.carries[j] || overlap <= 0.0 && condition.is_none() {
                continue;
            }
            let force = law::normal(setup.law, near.modulus[k], overlap, holds).force;
            let mut contact = bare(key, branch / distance, force, overlap, distance);
            contact.cement = condition;
            match holds || overlap > 0.0 {
                true => list.push(contact),
                false => cracks.push(contact),
            }
        }
        for (b, body) in bodies.iter().enumerate() {
            let key = (i as u32, Other::Wall(b as u8));
            let touch = body.near(Vec2::new(at.x, at.y), model.radius[i]);
            let touches = match sticks {
                None => touch.overlap > 0.0,
                Some(side) => side == body.side,
            };
            if !touches {
                continue;
            }
            let compliance = model.compliance[i] + model.wall_compliance;
            let modulus = hertz::modulus(body.effective_radius(model.radius[i]), compliance);
            let force = law::normal(setup.law, modulus, touch.overlap, false).force;
            let normal = touch.along * touch.sign;
            let lever = model.radius[i] - touch.overlap;
            let normal = Vec3::new(normal.x, normal.y, 0.0);
            list.push(bare(key, normal, force, touch.overlap, lever));
        }
    }
    for contact in &mut list {
        let key = (contact.first, contact.second);
        while memory.next_if(|m| m.key() < key).is_some() {}
        let Some(load) = memory.next_if(|m| m.key() == key) else { continue };
        contact.shear = load.shear;
        contact.slipped = load.slides;
        let slips = contact.cement != Some(Condition::Intact);
        contact.slides = slips
            && model.friction.as_ref().is_some_and(|friction| {
                let limit = friction.between(contact.first, contact.second) * contact.force;
                // Nothing slides on a smooth wall that carries no shear.
                limit > 0.0 && contact.shear.norm() >= (1.0 - AT_LIMIT) * limit
            });
    }
    glue::hold(model, state, &mut list);
    let mean = |sum: f64| sum / list.len().max(1) as f64;
    let mean_force = mean(list.iter().map(|c| c.force.abs()).sum());
    let mean_shear = mean(list.iter().map(|c| c.shear.norm()).sum());
    (Contacts { list, cracks, mean_force, mean_shear }, bodies)
}

/// The side whose body it is.
fn side_of(other: Other, bodies: &[Body]) -> Other {
    match other {
        Other::Wall(body) => Other::Wall(bodies[usize::from(body)].side),
        grain @ Other::Grain(_) => grain,
    }
}

fn bare(
    (first, second): (u32, Other),
    normal: Vec3,
    force: f64,
    overlap: f64,
    distance: f64,
) -> Contact {
    let shear = Vec3::zeros();
    let (torsion, slides, slipped, cement) = (0.0, false, false, None);
    Contact {
        first,
        second,
        normal,
        force,
        overlap,
        shear,
        torsion,
        slides,
        slipped,
        distance,
        cement,
    }
}

/// Force on each side against its inward displacement \[N\], its normal force; the z walls of a pack of discs carry none.
#[must_use]
pub fn normal_forces(model: &Model, state: &State, near: &Neighbours) -> [f64; wall::COUNT] {
    super::pressed::Pressed::of(model, state, near).normal
}

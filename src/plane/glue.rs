//! Grains that stick to a side of the rig (B 3.3.4): they go and turn with it, like a part of the wall.
//!
//! What other grains do to them the wall feels: their gradient goes to the side. Between two glued
//! grains, and between them and any wall, nothing is computed.

use super::Vec2;
use super::act::Scenery;
use super::balance::Balance;
use super::boundary::Body;
use super::left_of;
use super::matrix::FREEDOMS;
use super::pose::Pose;
use super::reference::{Joint, Reference};
use super::slope::Slope;
use crate::Vec3;
use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::state::State;

/// Stiffness that holds a glued grain in the linear system over that of a contact.
const RIGID: f64 = 1e12;

/// The side that grain `i` sticks to.
#[inline]
#[must_use]
pub fn side(glued: &[Option<u8>], i: usize) -> Option<u8> {
    glued.get(i).copied().flatten()
}

/// Whether both bodies of `joint` are parts of walls.
#[inline]
pub(super) fn joins(glued: &[Option<u8>], joint: &Joint) -> bool {
    side(glued, joint.first as usize).is_some()
        && match joint.second {
            Other::Grain(j) => side(glued, j as usize).is_some(),
            Other::Wall(_) => true,
        }
}

/// Glues the grains of `state` that touch a wall to it, to that which they press most. What is then
/// inside a wall is forgotten.
pub(super) fn apply(model: &Model, state: &mut State, bodies: &[Body]) {
    state.glued.clear();
    for (i, at) in state.position.iter().enumerate() {
        let overlap = |body: &Body| body.near(Vec2::new(at.x, at.y), model.radius[i]).overlap;
        let deepest = bodies
            .iter()
            .filter(|body| overlap(body) > 0.0)
            .max_by(|one, other| overlap(one).total_cmp(&overlap(other)));
        state.glued.push(deepest.map(|body| body.side));
        state.carries[i] |= deepest.is_some();
    }
    let State { glued, memory, .. } = state;
    memory.contacts.retain(|load| {
        let sticks = |other| match other {
            Other::Grain(j) => side(glued, j as usize).is_some(),
            Other::Wall(_) => true,
        };
        side(glued, load.first as usize).is_none() || !sticks(load.second)
    });
}

/// Takes the glued grains of `pose` from where walls were, `before`, to where they are, `now`.
pub(super) fn place(glued: &[Option<u8>], before: &[Body], now: &[Body], pose: &mut Pose) {
    for (i, side) in glued.iter().enumerate() {
        let Some(side) = side.map(usize::from) else { continue };
        let turn = now[side].swing.turn - before[side].swing.turn;
        let local = pose.at[i] - before[side].at;
        let (sine, cosine) = turn.sin_cos();
        pose.at[i] = now[side].at + local * cosine + left_of(local) * sine;
        pose.turn[i] += turn;
    }
}

/// Hands the gradient of glued grains to their sides and to the tilt.
pub(super) fn take_over(scenery: &Scenery<'_>, pose: &Pose, balance: &mut Balance) {
    for (i, side) in scenery.glued.iter().enumerate() {
        let Some(side) = side.map(usize::from) else { continue };
        let body = &scenery.bodies[side];
        let own = &mut balance.gradient[FREEDOMS * i..FREEDOMS * (i + 1)];
        let held = Vec2::new(own[0], own[1]);
        let moment = own[2] * scenery.model.radius[i];
        own.fill(0.0);
        balance.press(body, held.dot(&body.slide), held);
        let way = body.swing.way + left_of(pose.at[i] - body.at) * body.swing.rate;
        balance.tilt += held.dot(&way) + moment * body.swing.rate;
    }
}

/// Holds glued grains where they are in the linear system, so that the factors are those of the others.
pub(super) fn stiffen(glued: &[Option<u8>], slope: &mut Slope) {
    let rigid = RIGID * slope.idle;
    for (block, _) in slope.matrix.diagonal.iter_mut().zip(glued).filter(|(_, side)| side.is_some())
    {
        (0..FREEDOMS).for_each(|a| block[a][a] += rigid);
    }
}

/// Adds what glued grains add to the columns of their sides.
pub(super) fn add_columns(
    state: &State,
    bodies: &[Body],
    reference: &Reference,
    slope: &mut Slope,
) {
    if state.glued.is_empty() {
        return;
    }
    let mut ways = Vec::with_capacity(FREEDOMS * state.glued.len());
    let mut columns = std::mem::take(&mut slope.columns);
    for (side, column) in columns.iter_mut().enumerate() {
        ways.clear();
        for own in &state.glued {
            let way = match own {
                Some(own) if usize::from(*own) == side => bodies[side].slide,
                _ => Vec2::zeros(),
            };
            ways.extend([way.x, way.y, 0.0]);
        }
        // Membranes, whose links these would be, have no glue.
        slope.multiply(&ways, (reference, &[]), column);
    }
    slope.columns = columns;
}

/// Sets the entries of glued grains to zero in a list of three numbers a grain.
pub(super) fn clear(glued: &[Option<u8>], list: &mut [f64]) {
    for (own, _) in list.chunks_exact_mut(FREEDOMS).zip(glued).filter(|(_, side)| side.is_some()) {
        own.fill(0.0);
    }
}

/// Gives the contacts of glued grains with their walls, among `list`, the force that holds the grains.
pub(super) fn hold(model: &Model, state: &State, list: &mut [Contact]) {
    if state.glued.is_empty() {
        return;
    }
    let mut held: Vec<Vec3> = match model.has_gravity() {
        true => (0..model.len()).map(|i| -model.gravity * model.mass(i)).collect(),
        false => vec![Vec3::zeros(); model.len()],
    };
    for contact in list.iter() {
        if let Other::Grain(j) = contact.second {
            let force = contact.normal * contact.force + contact.shear;
            held[contact.first as usize] -= force;
            held[j as usize] += force;
        }
    }
    for contact in list.iter_mut().filter(|c| matches!(c.second, Other::Wall(_))) {
        let i = contact.first as usize;
        if side(&state.glued, i).is_some() {
            contact.force = held[i].dot(&contact.normal);
            contact.shear = held[i] - contact.normal * contact.force;
        }
    }
}

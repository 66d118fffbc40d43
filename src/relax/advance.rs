//! One load increment: walls to a target, in sub-increments that the pack can follow.

use crate::Vec3;
use crate::measure::walls;
use crate::model::Model;
use crate::relax::jump::Jump;
use crate::relax::tangential::Changes;
use crate::relax::{Outcome, Status, Workspace, accuracy, newton, relax};
use crate::scene::{Method, Update};
use crate::state::State;
use crate::wall::{self, Control, Setpoint};

/// A sub-increment is never smaller than this share of `solver.max_strain_increment`, so that
/// decompression passes the point where the overlaps vanish.
const LEAST_SHARE: f64 = 0.01;
/// A command of exactly the largest strain may come out larger by rounding and is not halved.
const ROUNDING: f64 = 1e-9;
/// Halvings of a sub-increment that finds no equilibrium.
const HALVINGS: u32 = 6;
/// Most times that the limits of friction are renewed and the increment solved again.
const RENEWALS: u32 = 3;

/// What an increment came to.
#[derive(Clone, Debug)]
pub struct Advance {
    /// The last relaxation.
    pub outcome: Outcome,
    /// Equilibria on the way, the last included.
    pub substeps: u32,
    /// Steps of the method of all relaxations.
    pub iterations: u32,
    /// Legs of the flow of all relaxations, each from a configuration that was unstable.
    pub descents: u32,
    /// Estimated error of the normal forces on the walls at the end, the largest \[N\]
    /// ([`accuracy`]).
    pub wall_force_error: f64,
    /// Instabilities that the pack went through, in order.
    pub jumps: Vec<Jump>,
    /// Contacts that opened and formed, and what is left of the error of freezing the limits.
    pub changes: Changes,
}

/// Moves the walls of `state`, an equilibrium, to the displacement `target` \[m\] and relaxes.
///
/// When no equilibrium is found `state` is what it was before. `here` is the outcome that led to
/// `state`.
pub fn advance(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    setpoint: &Setpoint,
    here: Outcome,
) -> Advance {
    let target = &std::array::from_fn(|w| match setpoint[w] {
        Control::Displacement(displacement) => displacement,
        Control::Load(_) => state.displacement[w],
    });
    let start = state.clone();
    let mut last = state.clone();
    let mut so_far = Advance {
        outcome: here,
        substeps: 0,
        iterations: 0,
        descents: 0,
        wall_force_error: 0.0,
        jumps: Vec::new(),
        changes: Changes::default(),
    };
    work.neighbours.refresh(model, &state.position, &state.bounds(model));
    let mut forces = walls::normal_forces(model, state, &work.neighbours);
    while state.displacement != *target || so_far.substeps == 0 {
        let ratio = remaining_strain(model, state, target) / strain_limit(model, &so_far.outcome);
        let parts = (ratio * (1.0 - ROUNDING)).ceil().max(1.0);
        let mut share = 1.0 / parts;
        last.copy_from(state);
        for attempt in 0.. {
            work.begin(model, state);
            work.jumps.clear();
            move_walls(model, state, target, share);
            // The seeds' methods begin where the walls take the grains.
            if work.reference.active && model.solver.method == Method::Newton {
                newton::predict(model, state, work);
            }
            let outcome = solve(model, state, work);
            so_far.outcome = outcome;
            so_far.iterations += outcome.iterations;
            so_far.descents += outcome.descents;
            if outcome.status.is_equilibrium() {
                break;
            }
            state.copy_from(&last);
            if attempt == HALVINGS {
                state.copy_from(&start);
                so_far.jumps.clear();
                return so_far;
            }
            share *= 0.5;
        }
        so_far.substeps += 1;
        if state.displacement == *target {
            so_far.wall_force_error =
                accuracy::wall_force_error(model, state, work, &so_far.outcome);
        }
        so_far.jumps.append(&mut work.jumps);
        let changes = work.commit(model, state);
        so_far.changes.opened += changes.opened;
        so_far.changes.formed += changes.formed;
        so_far.changes.excess = so_far.changes.excess.max(changes.excess);
        let next = walls::normal_forces(model, state, &work.neighbours);
        for w in 0..wall::COUNT {
            let path = state.displacement[w] - last.displacement[w];
            state.wall_work += 0.5 * (forces[w] + next[w]) * path;
        }
        forces = next;
    }
    so_far
}

/// Relaxes, and with friction up to date renews the limits and relaxes again.
fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let mut outcome = relax(model, state, work);
    if model.friction.as_ref().is_some_and(|friction| friction.update == Update::Current) {
        for _ in 0..RENEWALS {
            if outcome.status != Status::Converged {
                break;
            }
            work.reference.renew(model, state);
            let (iterations, descents) = (outcome.iterations, outcome.descents);
            outcome = relax(model, state, work);
            let settled = outcome.iterations == 0;
            outcome.iterations += iterations;
            outcome.descents += descents;
            if settled {
                break;
            }
        }
    }
    outcome
}

/// Largest strain of an axis that is left, against the box at the start, a shift of the whole box counted as a strain too.
fn remaining_strain(model: &Model, state: &State, target: &[f64; wall::COUNT]) -> f64 {
    let sides = model.start.sides();
    (0..3)
        .map(|axis| {
            let left = |w: usize| (target[w] - state.displacement[w]).abs();
            (left(2 * axis) + left(2 * axis + 1)) / sides[axis]
        })
        .fold(0.0, f64::max)
}

/// Largest strain of one sub-increment: a share of the mean overlap strain h/(2R), because
/// contacts that open and close between two equilibria are what makes them hard to find.
fn strain_limit(model: &Model, here: &Outcome) -> f64 {
    let most = model.solver.max_strain_increment;
    let overlap_strain = here.sums.mean_overlap() / (2.0 * model.mean_radius);
    if overlap_strain == 0.0 {
        return most;
    }
    (model.solver.max_overlap_share * overlap_strain).clamp(LEAST_SHARE * most, most)
}

/// Moves the walls by `share` of what is left to `target`, and the grains affinely with them.
pub fn move_walls(model: &Model, state: &mut State, target: &[f64; wall::COUNT], share: f64) {
    let before = state.bounds(model);
    for (now, target) in state.displacement.iter_mut().zip(target) {
        *now = if share >= 1.0 { *target } else { *now + share * (target - *now) };
    }
    let after = state.bounds(model);
    let (low, new_low) = (Vec3::from(before.min), Vec3::from(after.min));
    let scale = Vec3::from(after.sides()).component_div(&Vec3::from(before.sides()));
    for at in &mut state.position {
        *at = new_low + scale.component_mul(&(*at - low));
    }
}

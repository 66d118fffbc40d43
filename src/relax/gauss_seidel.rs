//! Grain by grain to equilibrium, the method of van Baars (B 2.3): each grain in turn is moved to
//! where its contacts balance while the others stay (18-19), in sweeps over the pack until the
//! residual holds.
//!
//! As there a long displacement is cut (B 2.4, "truncate"), and the rest of it is found in the next
//! sweeps among the contacts of the new place. Different is the block of a contact that slides: with
//! its shear stiffness set to zero (B 2.4) a grain can go to and fro between slip and slip; here it
//! keeps that of sticking, the largest that it can have, and every displacement lowers the energy.

mod local;

use crate::model::Model;
use crate::relax::Workspace;
use crate::relax::newton::Solved;
use crate::relax::site::{Others, Site};
use crate::relax::verdict::{Progress, residual, verdict};
use crate::state::State;
use crate::wall::Room;
use local::Local;

/// Most sweeps between two looks at the balance of the whole pack.
const PATIENCE: u32 = 50;

/// Relaxes the grains of `state` that carry load.
pub(super) fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    let bounds = state.bounds(model);
    let most = model.solver.most_iterations();
    let mut iterations = 0;
    let mut largest = f64::INFINITY;
    work.adjacency.begin();
    loop {
        work.evaluate(model, state, &bounds);
        let progress = Progress { iterations, patient: iterations > 0 };
        if let Some(end) = verdict(model, state, work, progress) {
            return end;
        }
        // Where the grains at their turns are as much better it is worth looking at the whole pack.
        let sought = model.solver.tolerance / residual(model, work);
        let hope = sought * largest.min(work.balance.largest());
        for _ in 0..PATIENCE.min(most - iterations) {
            largest = sweep(model, state, work, &bounds);
            iterations += 1;
            if largest <= hope {
                break;
            }
        }
    }
}

/// Moves every grain once; returns the largest unbalanced force that one had at its turn \[N\].
fn sweep(model: &Model, state: &mut State, work: &mut Workspace, bounds: &Room) -> f64 {
    work.sweeps += 1;
    work.neighbours.refresh(model, &state.position, bounds);
    let Workspace { neighbours, reference, adjacency, reference_stiffness, .. } = work;
    let scale = 1.0 / *reference_stiffness;
    let mut largest = 0.0_f64;
    let State { position, rotation, carries, .. } = state;
    let others = Others { model, neighbours, reference, carries, bounds };
    adjacency.refresh(&others);
    for i in (0..model.len()).filter(|&i| carries[i]) {
        let local = Local::of(&Site { others: &others, adjacency, position, rotation }, i, scale);
        largest = largest.max(local.unbalanced());
        let [u, w] = local.step(model.solver.step_cap * model.radius[i], scale);
        position[i] += u;
        if let Some(rotation) = rotation.get_mut(i) {
            *rotation += w / model.radius[i];
        }
    }
    largest
}

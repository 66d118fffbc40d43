//! Grain by grain to equilibrium, the method of van Baars (B 2.3): each grain in turn is moved to
//! where its contacts balance while the others stay (18-19), in sweeps over the pack until the
//! residual holds.
//!
//! As there a long displacement is cut (B 2.4, "truncate"), and the rest of it is found in the next
//! sweeps among the contacts of the new place. Different is the block of a contact that slides: with
//! its shear stiffness set to zero (B 2.4) a grain can go to and fro between slip and slip; here it
//! keeps that of sticking, the largest that it can have, and every displacement lowers the energy.

mod local;

use crate::contact::Other;
use crate::model::Model;
use crate::relax::Workspace;
use crate::relax::newton::Solved;
use crate::relax::rows::Rows;
use crate::relax::site::{Others, Site};
use crate::relax::verdict::{Progress, residual, verdict};
use crate::state::State;
use crate::wall::Bounds;
use local::Local;

/// Most sweeps between two looks at the balance of the whole pack.
const PATIENCE: u32 = 50;

/// Scratch of this module.
#[derive(Clone, Debug, Default)]
pub(super) struct Sweeper {
    /// Neighbours of each grain, with Hertz' M.
    near: Rows<(u32, f64)>,
    /// Contacts of each grain at the reference.
    held: Rows<u32>,
    /// Sweeps so far.
    pub(super) sweeps: u64,
}

/// Relaxes the grains of `state` that carry load.
pub(super) fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    let bounds = state.bounds(model);
    let mut sweeper = std::mem::take(&mut work.sweeper);
    sweeper.list_held(model, work);
    let solved = run(model, state, work, &mut sweeper, &bounds);
    work.sweeper = sweeper;
    solved
}

fn run(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    sweeper: &mut Sweeper,
    bounds: &Bounds,
) -> Solved {
    let most = model.solver.most_iterations();
    let mut iterations = 0;
    let mut listed = None;
    let mut largest = f64::INFINITY;
    loop {
        work.evaluate(model, state, bounds);
        let progress = Progress { iterations, patient: iterations > 0 };
        if let Some(end) = verdict(model, state, work, progress) {
            return end;
        }
        // Where the grains at their turns are as much better it is worth looking at the whole pack.
        let sought = model.solver.tolerance / residual(model, work);
        let hope = sought * largest.min(work.balance.largest());
        for _ in 0..PATIENCE.min(most - iterations) {
            work.neighbours.refresh(model, &state.position, bounds);
            if listed != Some(work.neighbours.rebuilds) {
                let carries = &state.carries;
                let both = |i: usize, j: usize| carries[i] && carries[j];
                sweeper.near.fill_pairs(&work.neighbours, model.len(), both);
                listed = Some(work.neighbours.rebuilds);
            }
            largest = sweeper.sweep(model, state, work, bounds);
            iterations += 1;
            if largest <= hope {
                break;
            }
        }
    }
}

impl Sweeper {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.near.heap_bytes() + self.held.heap_bytes()
    }

    /// Lists the contacts at the reference by grain.
    fn list_held(&mut self, model: &Model, work: &Workspace) {
        let contacts = &work.reference.contacts;
        self.held.fill(model.len(), || {
            contacts.iter().enumerate().flat_map(|(k, held)| {
                let second = match held.second {
                    Other::Grain(j) => Some((j as usize, k as u32)),
                    Other::Wall(_) => None,
                };
                std::iter::once((held.first as usize, k as u32)).chain(second)
            })
        });
    }

    /// Moves every grain once; returns the largest unbalanced force that one had at its turn \[N\].
    fn sweep(
        &mut self,
        model: &Model,
        state: &mut State,
        work: &Workspace,
        bounds: &Bounds,
    ) -> f64 {
        self.sweeps += 1;
        let Workspace { neighbours, reference, .. } = work;
        let scale = 1.0 / work.reference_stiffness;
        let mut largest = 0.0_f64;
        for i in 0..model.len() {
            if !state.carries[i] {
                continue;
            }
            let State { position, rotation, carries, .. } = &*state;
            let others = Others { model, neighbours, reference, carries, bounds };
            let site = Site { others: &others, position, rotation };
            let local = Local::of(&site, i, self.near.row(i), self.held.row(i), scale);
            largest = largest.max(local.unbalanced());
            let [u, w] = local.step(model.solver.step_cap * model.radius[i], scale);
            state.position[i] += u;
            if let Some(rotation) = state.rotation.get_mut(i) {
                *rotation += w / model.radius[i];
            }
        }
        largest
    }
}

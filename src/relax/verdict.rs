//! What ends a method that comes to the equilibrium in many small steps.

use crate::model::Model;
use crate::relax::newton::{self, Solved};
use crate::relax::{Status, Workspace, rattlers};
use crate::state::State;

/// Where a method is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Progress {
    /// Steps so far.
    pub(super) iterations: u32,
    /// Whether it is time to look for grains that nothing holds.
    pub(super) patient: bool,
}

/// Judges `state`, whose balance was taken last: `Some` ends the relaxation.
pub(super) fn verdict(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    progress: Progress,
) -> Option<Solved> {
    let sums = work.balance.sums;
    let largest = work.balance.largest();
    let residual = residual(model, work);
    let iterations = progress.iterations;
    let end = |status| Some(Solved { status, residual, iterations });
    if !(largest.is_finite() && sums.energy.is_finite()) {
        return end(Status::NonFinite);
    }
    if !model.has_gravity() && sums.mean_force() < work.negligible_force {
        return Some(Solved { status: Status::Unjammed, residual: 0.0, iterations });
    }
    if residual <= model.solver.tolerance {
        return end(Status::Converged);
    }
    let may_release = model.has_gravity() || work.reference.active;
    if progress.patient && may_release && rattlers::release(model, state, work) {
        return end(Status::Converged);
    }
    if iterations >= model.solver.most_iterations() {
        return end(Status::MaxIterations);
    }
    None
}

/// Largest unbalanced force over the mean contact force in the balance taken last.
pub(super) fn residual(model: &Model, work: &Workspace) -> f64 {
    newton::residual(model, work.balance.largest(), work.balance.sums.mean_force())
}

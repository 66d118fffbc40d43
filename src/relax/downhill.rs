//! From an instability to the next equilibrium: legs of the flow, with Newton's method after each.

use crate::model::Model;
use crate::relax::flow::Flow;
use crate::relax::jump::Watch;
use crate::relax::{Outcome, Status, Workspace, carrying, fire};
use crate::state::State;

/// Most legs, each until the drag takes less of the unbalanced force than before.
const LEGS: u32 = 10;
/// Share of the unbalanced force that the drag takes at the end of the first leg.
const DRAG: f64 = 0.1;
/// What each leg divides that share by.
const CLOSER: f64 = 3.0;
/// Residuals of the inertial descents where the flow takes too long, and most steps of each.
const LAST_RESORT: [f64; 5] = [1e-3, 3e-4, 1e-4, 1e-5, 1e-6];
const MOST_DESCENT: u32 = 3000;

/// Takes the pack back to where the search of `failed` began, and from there the way overdamped
/// motion would take it, until Newton's method stays in the basin that this leads to.
///
/// Where the flow takes too long, as when friction holds grains that hardly touch anything, any
/// minimum is taken that Newton's method finds from where it came to, or after inertial descents
/// from where it began.
pub(super) fn descend(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    failed: Outcome,
) -> Outcome {
    let mut flow = Flow::new();
    let mut watch = Watch::default();
    let mut share = DRAG;
    let mut outcome = failed;
    let start = work.origin.clone();
    for leg in 1..=LEGS {
        work.origin.restore(state);
        if !model.has_gravity() {
            // Those that float may come in the way. Under their weight they would fall for ever.
            state.carries.fill(true);
        }
        let status = flow.follow(model, state, work, &mut watch, share);
        let tired = status == Status::MaxIterations || leg == LEGS;
        if !status.is_equilibrium() && !tired {
            return Outcome { status, ..outcome };
        }
        share /= CLOSER;
        work.origin.copy(state);
        let iterations = outcome.iterations;
        let follows = work.follows;
        work.follows = follows && !tired;
        outcome = carrying(model, state, work);
        outcome.iterations += iterations;
        if tired && !outcome.status.is_equilibrium() {
            start.restore(state);
            outcome = any_minimum(model, state, work, outcome);
        }
        work.follows = follows;
        outcome.descents = leg;
        if tired || !matches!(outcome.status, Status::Unstable | Status::Stalled) {
            break;
        }
    }
    if outcome.status.is_equilibrium() {
        work.jumps.extend(watch.jump(model, state, &work.balance));
    }
    outcome
}

/// Descends by inertia from `state` where `outcome` is no equilibrium, until Newton's method finds
/// one.
fn any_minimum(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    mut outcome: Outcome,
) -> Outcome {
    for residual in LAST_RESORT {
        if outcome.status.is_equilibrium() {
            break;
        }
        let goal = fire::Goal { residual, pressure: None, even: false, steps: MOST_DESCENT };
        fire::descend(model, state, work, goal);
        let iterations = outcome.iterations;
        outcome = carrying(model, state, work);
        outcome.iterations += iterations;
    }
    outcome
}

//! Conjugate gradients on the energy itself, the method of the thesis (T appendix A, P appendix A).
//!
//! Kept are the direction of Fletcher and Reeves (A.7, A.10), the refresh by a steepest-descent
//! step, which is β = 0 (P A.3 prints α), the search for the best step along the direction and
//! the limit on the way that a grain may go in one of them. Different are:
//! - the end: the residual of the balance, not (A.12), whose two printed pairs of tolerances differ
//!   by eight orders of magnitude;
//! - the search: it looks for the zero of the slope, not for the least energy. Near the equilibrium
//!   rounding hides the differences of the energy, and with friction not every law has one;
//! - the sub-increments: those of [`advance`](crate::relax::advance), each brought to equilibrium.
//!   The thesis moves the walls on every k_inc steps, on the way to the first one.

use crate::Vec3;
use crate::model::Model;
use crate::relax::newton::{self, Solved};
use crate::relax::verdict::{Progress, residual, verdict};
use crate::relax::{Status, Workspace};
use crate::state::State;
use crate::wall::Room;

/// Steps from one steepest-descent step to the next (k_SD), and between two looks for grains that
/// nothing holds.
const REFRESH: u32 = 200;
/// The search ends where the slope is at most this share of that at its start.
const SLACK: f64 = 0.1;
/// Trials of one search.
const TRIALS: u32 = 20;
/// Most that a trial step grows by.
const GROWTH: f64 = 4.0;

/// Relaxes the grains of `state` that carry load.
pub(super) fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    let bounds = state.bounds(model);
    let mut iterations = 0;
    let mut before = 0.0;
    // Where the first search looks; later ones begin with the curvature that the last one found.
    let mut curvature = work.reference_stiffness;
    let mut refresh = true;
    work.step.clear();
    work.step.resize(state.position.len(), Vec3::zeros());
    work.turn.clear();
    work.turn.resize(state.rotation.len(), Vec3::zeros());
    work.evaluate(model, state, &bounds);
    loop {
        let look = iterations % REFRESH == 0;
        let progress = Progress { iterations, patient: look && iterations > 0 };
        if let Some(end) = verdict(model, state, work, progress) {
            return end;
        }
        let square = newton::square(&work.balance);
        refresh |= look;
        work.direct(if refresh { 0.0 } else { square / before }); // (A.7), (A.10)
        let mut slope = work.slope(&work.balance);
        if slope >= 0.0 && !refresh {
            refresh = true;
            work.direct(0.0);
            slope = -square;
        }
        iterations += 1;
        match search(model, state, work, &bounds, slope, curvature) {
            Some(found) => {
                curvature = found;
                refresh = false;
            }
            None if refresh => {
                let residual = residual(model, work);
                return Solved { status: Status::Stalled, residual, iterations };
            }
            None => refresh = true,
        }
        before = square;
    }
}

impl Workspace {
    /// p = -g + β p (A.7).
    fn direct(&mut self, beta: f64) {
        let Self { balance, step, turn, .. } = self;
        let all = step.iter_mut().chain(turn).zip(balance.gradient.iter().chain(&balance.moment));
        for (p, g) in all {
            *p = *p * beta - g;
        }
    }
}

/// A step along the direction, and the slope there.
#[derive(Clone, Copy)]
struct Trial {
    alpha: f64,
    slope: f64,
}

/// Looks for the lowest point along the direction and goes there. Returns the curvature on the way
/// \[N/m\], `None` where there is no step down.
fn search(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    bounds: &Room,
    slope: f64,
    curvature: f64,
) -> Option<f64> {
    let square: f64 = work.step.iter().chain(&work.turn).map(Vec3::norm_squared).sum();
    let cap = longest(model, work);
    let mut low = Trial { alpha: 0.0, slope };
    let mut high: Option<Trial> = None;
    let mut alpha = (-slope / (curvature * square)).min(cap);
    for _ in 0..TRIALS {
        work.try_step(model, state, alpha);
        let here = Trial { alpha, slope: work.slope(&work.trial_balance) };
        let down = here.slope < 0.0;
        if here.slope.abs() <= SLACK * slope.abs() || (down && alpha >= cap) {
            work.accept(state);
            let found = (here.slope - slope) / (alpha * square);
            return Some(if found > 0.0 { found } else { curvature });
        }
        // The slope stays below zero at `low` and above it, or unknown, at `high`.
        let zero =
            |a: Trial, b: Trial| a.alpha - a.slope * (b.alpha - a.alpha) / (b.slope - a.slope);
        let next = zero(low, here);
        match down {
            true => low = here,
            false => high = Some(here),
        }
        alpha = match high {
            Some(high) => {
                let width = high.alpha - low.alpha;
                let inside = (low.alpha + 0.1 * width)..=(high.alpha - 0.1 * width);
                if inside.contains(&next) { next } else { low.alpha + 0.5 * width }
            }
            None if next > low.alpha => next.min(GROWTH * low.alpha).min(cap),
            None => (GROWTH * low.alpha).min(cap),
        };
    }
    // The list may have been made for a trial that was refused.
    work.neighbours.refresh(model, &state.position, bounds);
    None
}

/// Largest step along the direction: no grain goes further than the scene allows.
fn longest(model: &Model, work: &Workspace) -> f64 {
    let furthest = |steps: &[Vec3]| {
        let share = |(step, radius): (&Vec3, &f64)| step.norm() / radius;
        steps.iter().zip(&model.radius).map(share).fold(0.0, f64::max)
    };
    let furthest = f64::max(furthest(&work.step), furthest(&work.turn));
    model.solver.step_cap / furthest.max(f64::MIN_POSITIVE)
}

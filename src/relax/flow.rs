//! The overdamped descent dx/dt = -M grad Π with one mobility M for every grain, rotations times
//! radius alike: the way that a specimen in a viscous fluid would go from an unstable
//! configuration, and so the definition of where an instability ends.
//!
//! The flow is stiff: contacts relax thousands of times faster than the pack rearranges. It is
//! integrated by a two-stage Rosenbrock method that stays of second order with the approximate
//! Hessian of the solver (Verwer et al., SIAM J. Sci. Comput. 20, 1456, 1999: ROS2), whose first
//! stage is embedded and tells the error. Both stages solve (H + σ) s = b with σ = 1/(γ Δt).
//! Towards the minimum Δt grows without bound and the step becomes Newton's.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::Vec3;
use crate::model::Model;
use crate::relax::linear::Inner;
use crate::relax::{Status, Workspace};
use crate::state::State;

/// γ of ROS2: L-stable, and the first stage stops short of Newton's step instead of passing it.
const GAMMA: f64 = 1.0 + FRAC_1_SQRT_2;
/// Error of a step over the mean overlap.
const ERROR: f64 = 0.05;
/// First σ over the reference stiffness.
const FIRST_SHIFT: f64 = 0.1;
/// Largest σ over the reference stiffness: steps far below what the stiffest contact needs.
const LARGEST_SHIFT: f64 = 1e4;
/// What σ may be multiplied by after a step.
const CHANGE: (f64, f64) = (0.1, 5.0);
/// What σ is multiplied by where the curvature is below -σ.
const STIFFEN: f64 = 3.0;
/// Accuracy of the linear solves.
const FORCING: f64 = 0.05;
/// Most products of one linear solve.
const MOST_PRODUCTS: u32 = 1000;

/// Where the flow is, between two legs.
#[derive(Clone, Copy, Debug)]
pub struct Flow {
    /// σ over the reference stiffness.
    shift: f64,
    /// Steps taken, the refused ones included.
    pub steps: u32,
    /// Whether a direction of negative curvature was met.
    pub concave: bool,
}

impl Flow {
    /// Before the first step.
    #[must_use]
    pub fn new() -> Self {
        Self { shift: FIRST_SHIFT, steps: 0, concave: false }
    }

    /// Follows the flow from `state` until a step leaves less than `share` of the unbalanced
    /// force to the drag, in `most` steps in all: then Newton's method goes on from there.
    ///
    /// Returns `Converged` there, `Unjammed`, `MaxIterations` or `NonFinite`.
    pub fn follow(
        &mut self,
        model: &Model,
        state: &mut State,
        work: &mut Workspace,
        share: f64,
        most: u32,
    ) -> Status {
        let bounds = state.bounds(model);
        work.evaluate(model, state, &bounds);
        loop {
            let sums = work.balance.sums;
            let largest = work.balance.largest();
            if !(largest.is_finite() && sums.energy.is_finite()) {
                return Status::NonFinite;
            }
            if !model.has_gravity() && sums.mean_force() < work.negligible_force {
                return Status::Unjammed;
            }
            if largest == 0.0 {
                return Status::Converged;
            }
            work.assemble(model);
            let drag = loop {
                if self.steps >= most || self.shift > LARGEST_SHIFT {
                    return Status::MaxIterations;
                }
                self.steps += 1;
                if let Some(drag) = self.step(model, state, work, largest) {
                    break drag;
                }
            };
            if drag <= share {
                return Status::Converged;
            }
        }
    }

    /// Tries one step; says what share of the unbalanced force the drag took, `None` when the
    /// step was too long and a shorter one is to be tried.
    fn step(
        &mut self,
        model: &Model,
        state: &mut State,
        work: &mut Workspace,
        largest: f64,
    ) -> Option<f64> {
        let bounds = state.bounds(model);
        let sigma = self.shift * work.reference_stiffness;
        work.shift.clear();
        work.shift.resize(model.len(), self.shift as f32);
        // First stage: s1 = γ Δt k1, and the point x + Δt k1.
        if work.solve(largest, work.forcing.0, MOST_PRODUCTS) == Inner::NegativeCurvature {
            self.concave = true;
            self.shift *= STIFFEN;
            return None;
        }
        let drag = sigma * norm(&work.step, &work.turn)
            / norm(&work.balance.gradient, &work.balance.moment);
        work.try_step(model, state, &bounds, 1.0 / GAMMA);
        // Second stage, F(x + Δt k1) - 2 k1 on the right with k1 = σ s1, solved for d = s1 + s2.
        let Workspace { balance, trial_balance, step, turn, .. } = &mut *work;
        for ((to, g), s) in trial_balance.gradient.iter_mut().zip(&balance.gradient).zip(step) {
            *to += g + *s * (2.0 * sigma);
        }
        for ((to, g), s) in trial_balance.moment.iter_mut().zip(&balance.moment).zip(turn) {
            *to += g + *s * (2.0 * sigma);
        }
        let unit = work.trial_balance.largest();
        std::mem::swap(&mut work.first_step, &mut work.step);
        std::mem::swap(&mut work.first_turn, &mut work.turn);
        let right = std::mem::take(&mut work.trial_balance);
        let inner = work.solve_again(&right, unit, work.forcing.1, MOST_PRODUCTS);
        work.trial_balance = right;
        if inner == Inner::NegativeCurvature {
            self.concave = true;
            self.shift *= STIFFEN;
            return None;
        }
        // The error is d/2γ, the step (s1 + d/2)/γ. 
        let Workspace { step, turn, first_step, first_turn, .. } = &mut *work;
        let (mut along, mut square, mut dd) = (0.0, 0.0, 0.0);
        for (d, s) in step.iter().zip(&*first_step).chain(turn.iter().zip(&*first_turn)) {
            let whole = s + d * 0.5;
            along += d.dot(&whole);
            square += whole.norm_squared();
            dd += d.norm_squared();
        }
        let along = along / square;
        let (mut across, mut most) = (0.0_f64, 0.0_f64);
        for (d, s) in step.iter_mut().zip(first_step).chain(turn.iter_mut().zip(first_turn)) {
            let whole = *s + *d * 0.5;
            most = most.max(d.norm_squared());
            across = across.max((*d - whole * along).norm_squared());
            *d = whole;
        }
        let overlap = match work.balance.sums.contacts {
            0 => 0.1 * model.mean_radius,
            _ => work.balance.sums.mean_overlap(),
        };
        let scale = 0.5 / GAMMA / (work.flow_error * overlap);
        let relative = 0.5 * f64::sqrt(dd / square) / work.relative;
        let mut error = scale * across.sqrt();
        if relative > 1.0 { error = error.max(relative); }
        if std::env::var("DBG").is_ok() {
            let mut w = (0.0, 0);
            for i in 0..model.len() { 
                let  e = (work.step[i]).norm_squared();
                if e > w.0 { w = (e, i); } }
            eprintln!("{} sig {:.2e} res {:.2e} drag {:.2e} across {:.2e} all {:.2e} along {:.2e} grain {} {:.2e}", self.steps, self.shift, largest/work.balance.sums.mean_force(), drag, scale*across.sqrt(), scale*most.sqrt(), relative, w.1, (w.0 as f64).sqrt()/overlap);
        }
        if error.is_nan() {
            self.shift *= STIFFEN;
            return None;
        }
        let change = (error.sqrt() / 0.9).clamp(CHANGE.0, CHANGE.1);
        if error > 1.0 {
            self.shift *= change;
            return None;
        }
        work.try_step(model, state, &bounds, 1.0 / GAMMA);
        work.accept(state);
        self.shift *= change;
        Some(drag)
    }
}

fn norm(moves: &[Vec3], turns: &[Vec3]) -> f64 {
    moves.iter().chain(turns).map(Vec3::norm_squared).sum::<f64>().sqrt()
}

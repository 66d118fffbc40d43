//! The overdamped descent dx/dt = -M grad Π with one mobility M for every grain, rotations times
//! radius alike: the way that a specimen in a viscous fluid would go from an unstable
//! configuration, and so what tells where an instability ends.
//!
//! The flow is stiff: contacts relax thousands of times faster than the pack rearranges. A step is
//! linearly implicit, (H + σ) s = -g with σ = 1/(M Δt), and one more solve with the same matrix
//! for what the step left unbalanced takes it to the implicit Euler step and tells how far the
//! linearisation was off: that decides Δt. When the flow goes the way of a growing mode, σ stays
//! above its curvature. Towards a minimum Δt grows without bound and the step becomes Newton's.

use crate::Vec3;
use crate::model::Model;
use crate::relax::jump::Watch;
use crate::relax::linear::Inner;
use crate::relax::{Status, Workspace};
use crate::state::State;

/// Largest correction of a grain's step, but for the part along the flow, over the mean overlap.
const ERROR: f64 = 0.2;
/// What a grain's correction may be beyond that over the way that it has come.
const TRAVEL: f64 = 0.02;
/// Correction of the whole step over the step beyond which the implicit step is solved for.
const SHARE: f64 = 0.5;
/// Forces that may be left then, and iterations that it may take.
const LEFT: f64 = 0.3;
const MOST_SETTLING: u32 = 8;
/// First σ over the reference stiffness.
const FIRST_SHIFT: f64 = 0.1;
/// Largest σ over the reference stiffness: the flow would hardly move.
const LARGEST_SHIFT: f64 = 1e6;
/// What σ may be multiplied by after a step, and at least after one that was refused before.
const CHANGE: (f64, f64) = (0.1, 5.0);
const AFTER_REFUSAL: f64 = 0.7;
/// What σ is multiplied by where the matrix has a direction of negative curvature.
const STIFFEN: f64 = 3.0;
/// Least σ over the negative curvature along the step, and the one that is taken instead: the
/// step along a growing mode is 1/(1 - 1/ratio) times that of the explicit method.
const ABOVE: (f64, f64) = (1.5, 1.7);
/// Share of the right-hand side that the solves for the step and for its correction leave.
const FORCING: (f64, f64) = (0.1, 0.5);
/// Most products of one linear solve.
const MOST_PRODUCTS: u32 = 1000;
/// Most steps, the refused ones included, without friction and with it: a pack that flows far gets
/// there, but what friction keeps from rolling creeps.
const MOST_STEPS: [u32; 2] = [10_000, 1500];

/// Where the flow is, between two legs.
#[derive(Clone, Copy, Debug)]
pub struct Flow {
    /// σ over the reference stiffness.
    shift: f64,
    /// Steps, the refused ones included.
    steps: u32,
    /// Whether the last step was refused.
    refused: bool,
}

/// A step that was too long, and the σ over the reference stiffness to try instead.
struct Refused(f64);

impl Flow {
    /// Before the first step.
    #[must_use]
    pub fn new() -> Self {
        Self { shift: FIRST_SHIFT, steps: 0, refused: false }
    }

    /// Follows the flow from `state` until the drag takes less than `share` of the unbalanced
    /// force: from there Newton's method goes on. `watch` sees each configuration.
    ///
    /// Returns `Converged` there, `Unjammed`, `MaxIterations` or `NonFinite`.
    pub fn follow(
        &mut self,
        model: &Model,
        state: &mut State,
        work: &mut Workspace,
        watch: &mut Watch,
        share: f64,
    ) -> Status {
        let bounds = state.bounds(model);
        work.evaluate(model, state, &bounds);
        loop {
            watch.see(state, &work.balance);
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
                if self.steps >= MOST_STEPS[usize::from(work.reference.active)]
                    || self.shift > LARGEST_SHIFT
                {
                    return Status::MaxIterations;
                }
                self.steps += 1;
                match self.step(model, state, work, largest) {
                    Ok(drag) => break drag,
                    Err(Refused(shift)) => (self.shift, self.refused) = (shift, true),
                }
            };
            if drag <= share {
                return Status::Converged;
            }
        }
    }

    /// Tries one step; says what share of the unbalanced force the drag took.
    fn step(
        &mut self,
        model: &Model,
        state: &mut State,
        work: &mut Workspace,
        largest: f64,
    ) -> Result<f64, Refused> {
        let bounds = state.bounds(model);
        let sigma = self.shift * work.reference_stiffness;
        work.shift.clear();
        work.shift.resize(model.len(), self.shift as f32);
        if work.solve(largest, FORCING.0, MOST_PRODUCTS) == Inner::NegativeCurvature {
            return Err(Refused(STIFFEN * self.shift));
        }
        let square = square(&work.step, &work.turn);
        // s·Hs = -s·g - σ s·s
        let along = -work.slope(&work.balance) / square - sigma;
        let negative = (-along / work.reference_stiffness).max(0.0);
        if self.shift < ABOVE.0 * negative {
            return Err(Refused(ABOVE.1 * negative));
        }
        let drag =
            sigma * (square / self::square(&work.balance.gradient, &work.balance.moment)).sqrt();
        work.try_step(model, state, 1.0);
        if correct(work, sigma) == Inner::NegativeCurvature {
            return Err(Refused(STIFFEN * self.shift));
        }
        let (error, share) = take_correction(model, state, work);
        if error.is_nan() || share.is_nan() {
            return Err(Refused(STIFFEN * self.shift));
        }
        let change = (error.sqrt() / 0.9).clamp(CHANGE.0, CHANGE.1);
        if error > 1.0 {
            return Err(Refused(change * self.shift));
        }
        work.try_step(model, state, 1.0);
        if share > SHARE && !settle(model, state, work, sigma) {
            work.evaluate(model, state, &bounds);
            work.assemble(model);
            return Err(Refused(STIFFEN * self.shift));
        }
        work.accept(state);
        let change = if self.refused { change.max(AFTER_REFUSAL) } else { change };
        self.refused = false;
        self.shift = (change * self.shift).max(ABOVE.1 * negative);
        Ok(drag)
    }
}

impl Default for Flow {
    fn default() -> Self {
        Self::new()
    }
}

/// Solves for the correction of the step: what balances g + σ s at the trial configuration. The
/// step goes to `first_step`, the correction to `step`.
fn correct(work: &mut Workspace, sigma: f64) -> Inner {
    let mut right = std::mem::take(&mut work.trial_balance);
    let steps = work.step.iter().chain(&work.turn);
    for (to, s) in right.gradient.iter_mut().chain(&mut right.moment).zip(steps) {
        *to += s * sigma;
    }
    std::mem::swap(&mut work.first_step, &mut work.step);
    std::mem::swap(&mut work.first_turn, &mut work.turn);
    let inner = work.solve_again(&right, right.largest(), FORCING.1, MOST_PRODUCTS);
    work.trial_balance = right;
    inner
}

/// Adds the step to its correction, both in `step` then; says how large the correction was of a
/// grain, over what is allowed, and of the whole step, over the step. Along the flow it only tells
/// when the pack comes by, not where.
fn take_correction(model: &Model, state: &State, work: &mut Workspace) -> (f64, f64) {
    let overlap = match work.balance.sums.contacts {
        0 => 0.1 * model.mean_radius,
        _ => work.balance.sums.mean_overlap(),
    };
    let Workspace { step, turn, first_step, first_turn, origin, .. } = work;
    let length = square(first_step, first_turn);
    let share = (square(step, turn) / length).sqrt();
    let all = || step.iter().chain(&*turn).zip(first_step.iter().chain(&*first_turn));
    let along = all().map(|(d, s)| d.dot(s)).sum::<f64>() / length;
    let far = state.position.iter().zip(&origin.position).map(|(at, from)| (at - from).norm());
    let mut error = 0.0_f64;
    for ((d, s), far) in all().zip(far.clone().chain(far)) {
        error = error.max((d - s * along).norm() / (ERROR * overlap + TRAVEL * far));
    }
    for (d, s) in step.iter_mut().zip(&*first_step).chain(turn.iter_mut().zip(&*first_turn)) {
        *d += s;
    }
    (error, share)
}

/// Newton's method for the implicit step from the one that was tried, which was corrected by more
/// than [`SHARE`]: contacts opened or closed on the way. Says whether the forces g + σ s that are
/// left at the trial configuration are small against those of the drag or those at the start.
fn settle(model: &Model, state: &State, work: &mut Workspace, sigma: f64) -> bool {
    let allowed = LEFT * LEFT * square(&work.balance.gradient, &work.balance.moment);
    for _ in 0..MOST_SETTLING {
        let Workspace { trial_balance, step, turn, .. } = &mut *work;
        let mut left = 0.0;
        let forces = trial_balance.gradient.iter().chain(&trial_balance.moment);
        for (g, s) in forces.zip(step.iter().chain(&*turn)) {
            left += (g + s * sigma).norm_squared();
        }
        if left <= allowed.max(LEFT * LEFT * sigma * sigma * square(step, turn)) {
            return true;
        }
        std::mem::swap(&mut work.balance, &mut work.trial_balance);
        work.assemble(model);
        std::mem::swap(&mut work.balance, &mut work.trial_balance);
        work.factorise();
        if correct(work, sigma) == Inner::NegativeCurvature {
            return false;
        }
        let Workspace { step, turn, first_step, first_turn, .. } = &mut *work;
        for (d, s) in step.iter_mut().chain(turn).zip(first_step.iter().chain(&*first_turn)) {
            *d += s;
        }
        work.try_step(model, state, 1.0);
    }
    false
}

fn square(moves: &[Vec3], turns: &[Vec3]) -> f64 {
    moves.iter().chain(turns).map(Vec3::norm_squared).sum()
}

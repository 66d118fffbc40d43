//! Relaxation to static equilibrium: the minimum of the potential energy (T 2.5, A.2).
//!
//! [`advance`](advance::advance) moves the walls in sub-increments and calls [`relax`] after each.
//! That leaves out the grains that cannot carry load ([`rattlers`]), minimises the energy of the
//! others by [`newton`], and where that runs into an instability follows the grains downhill
//! ([`fire`]) and begins again.

pub mod advance;
pub mod balance;
pub mod fire;
pub mod linear;
pub mod newton;
pub mod rattlers;
mod sym3;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::Neighbours;
use crate::model::Model;
use crate::state::State;
use crate::wall::Bounds;
use balance::{Balance, Configuration, Sums};
use linear::Linear;
use rattlers::Rattlers;

/// Times that floating grains which turn out to carry load may join the balance.
const ROUNDS: u32 = 40;

/// Residuals of the descents from an unstable configuration, one after the other.
const DESCENTS: [f64; 5] = [1e-3, 3e-4, 1e-4, 1e-5, 1e-6];
/// Steps of a descent.
const MOST_DESCENT: u32 = 100_000;

/// How a relaxation ended. All but the first two leave no state to trust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The residual is below the tolerance at a minimum.
    Converged,
    /// No grain carries load: the forces are zero.
    Unjammed,
    /// The steps ran out.
    MaxIterations,
    /// Newton's method found no minimum nearby: the pack is on its way to another one.
    Unstable,
    /// No step descends any more: the tolerance is below what rounding allows.
    Stalled,
    /// A position or force is not finite.
    NonFinite,
}

impl Status {
    /// Whether the state is an equilibrium.
    #[must_use]
    pub fn is_equilibrium(self) -> bool {
        matches!(self, Self::Converged | Self::Unjammed)
    }
}

/// What a relaxation came to.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Largest unbalanced force of a grain over the mean contact force.
    pub residual: f64,
    /// Newton steps.
    pub iterations: u32,
    /// Inertial descents, each from a configuration that was unstable.
    pub descents: u32,
    /// Sums at the end.
    pub sums: Sums,
}

impl Outcome {
    /// Before the first relaxation.
    pub const NONE: Self = Self {
        status: Status::Unjammed,
        residual: 0.0,
        iterations: 0,
        descents: 0,
        sums: Sums::NONE,
    };
}

/// Scratch that may be thrown away at any time.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// Pairs that can touch.
    pub neighbours: Neighbours,
    /// The balance at the state.
    pub balance: Balance,
    /// The linear system of the present step.
    pub linear: Linear,
    /// Stiffness that single precision is scaled by \[N/m\].
    pub reference_stiffness: f64,
    /// Newton steps longer than this many mean overlaps are shortened by a shift of the Hessian.
    pub step_cap: f64,
    /// Shift of each grain's block, shape (n).
    shift: Vec<f32>,
    /// Contacts of each grain, shape (n); for packs with weight.
    support: Vec<u32>,
    trial: Vec<Vec3>,
    /// Velocities of an inertial descent, shape (n).
    velocity: Vec<Vec3>,
    trial_balance: Balance,
    rattlers: Rattlers,
    negligible_force: f64,
}

impl Workspace {
    /// Scratch for `model`.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let compliance = model.compliance.iter().sum::<f64>() / model.len().max(1) as f64;
        let modulus = hertz::modulus(0.5 * model.mean_radius, 2.0 * compliance);
        Self {
            neighbours: Neighbours::default(),
            balance: Balance::default(),
            linear: Linear::default(),
            reference_stiffness: hertz::stiffness(modulus, 1e-2 * model.mean_radius),
            step_cap: 1.0,
            shift: Vec::with_capacity(model.len()),
            support: Vec::new(),
            trial: Vec::with_capacity(model.len()),
            velocity: Vec::with_capacity(model.len()),
            trial_balance: Balance::default(),
            rattlers: Rattlers::default(),
            negligible_force: model.negligible_force(),
        }
    }

    /// Evaluates the balance of the grains in `carries`.
    pub fn evaluate(
        &mut self,
        model: &Model,
        position: &[Vec3],
        carries: &[bool],
        bounds: &Bounds,
    ) {
        self.neighbours.refresh(model, position, bounds);
        self.balance.evaluate(&Configuration {
            model,
            neighbours: &self.neighbours,
            position,
            carries,
            bounds,
            reference_stiffness: self.reference_stiffness,
        });
    }
}

/// Relaxes `state` at its walls. On a status that is no equilibrium the state is not to be used.
pub fn relax(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let mut outcome = newton(model, state, work);
    for residual in DESCENTS {
        if outcome.status != Status::Unstable && outcome.status != Status::Stalled {
            break;
        }
        let goal = fire::Goal { residual, pressure: None, steps: MOST_DESCENT };
        fire::descend(model, state, work, goal);
        let (iterations, descents) = (outcome.iterations, outcome.descents);
        outcome = newton(model, state, work);
        outcome.iterations += iterations;
        outcome.descents += descents + 1;
    }
    outcome
}

/// Relaxes by Newton's method alone.
fn newton(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let (mut iterations, mut round) = (0, 0);
    rattlers::find(model, state, work);
    loop {
        let solved = newton::solve(model, state, work);
        iterations += solved.iterations;
        let (residual, sums) = (solved.residual, work.balance.sums);
        let outcome = |status| Outcome { status, residual, iterations, sums, descents: 0 };
        if !solved.status.is_equilibrium() {
            return outcome(solved.status);
        }
        let joined = rattlers::settle(model, state, work);
        // Grains that were released leave a residual behind that is no longer that of the rest.
        if !joined && residual <= model.solver.tolerance {
            return outcome(solved.status);
        }
        if round == ROUNDS {
            return outcome(Status::MaxIterations);
        }
        round += 1;
    }
}

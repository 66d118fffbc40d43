//! FIRE, the inertial descent of Bitzek et al., PRL 97, 170201 (2006): for packs far from
//! equilibrium, where Newton's method has nothing to hold on to.
//!
//! With a pressure the box sides are unknowns too: the enthalpy Π + pV is descended in the
//! grains' positions within the box and the logarithms of its three sides, whose force is
//! V (σ - p) by the virial. At its minimum all three normal stresses are p.

use crate::Vec3;
use crate::measure::walls;
use crate::model::Model;
use crate::relax::advance::move_walls;
use crate::relax::balance::Sums;
use crate::relax::{Status, Workspace};
use crate::state::State;
use crate::wall::{self, Room};

/// Positive-power steps before the time step may grow (Bitzek's N_min).
const PATIENCE: u32 = 5;
/// Mass of a grain over the reference stiffness: makes the time step a pure number. Rotations
/// times radius have the same.
const MASS: f64 = 4.0;
/// Longest step of a grain over the mean radius, and of a side over itself.
const LONGEST: (f64, f64) = (0.1, 1e-3);
/// Largest time step: the stiffest packs here are stable up to about 1.4.
const LARGEST_TIME_STEP: f64 = 1.0;

/// Where a descent ends.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Root mean square of the unbalanced forces over the mean contact force.
    pub residual: f64,
    /// Stress that the box is to have \[Pa\]; `None` fixes the walls. Each normal stress ends
    /// within `residual` of it.
    pub pressure: Option<f64>,
    /// Whether all sides are strained alike, by the mean of the stresses.
    pub even: bool,
    /// Most steps.
    pub steps: u32,
}

/// Descends to `goal`, all grains taking part. Returns `Converged`, `Unjammed` (fixed walls only),
/// `MaxIterations` or `NonFinite`.
pub fn descend(model: &Model, state: &mut State, work: &mut Workspace, goal: Goal) -> Status {
    state.carries.fill(true);
    let mut velocity = std::mem::take(&mut work.velocity);
    velocity.clear();
    velocity.resize(model.len() + state.rotation.len(), Vec3::zeros());
    let status = run(model, state, work, goal, &mut velocity);
    work.velocity = velocity;
    status
}

fn run(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    goal: Goal,
    velocity: &mut [Vec3],
) -> Status {
    let mut box_velocity = Vec3::zeros();
    let mass = MASS * work.reference_stiffness;
    let box_mass = mass * model.len() as f64 * model.mean_radius.powi(2);
    let (mut dt, mut alpha, mut positive) = (0.1, 0.1, 0);
    for _ in 0..goal.steps {
        let bounds = state.bounds(model);
        work.evaluate(model, state, &bounds);
        let sums = work.balance.sums;
        let gradient = || work.balance.gradient.iter().chain(&work.balance.moment);
        let force2: f64 = gradient().map(Vec3::norm_squared).sum();
        if !force2.is_finite() {
            return Status::NonFinite;
        }
        let excess = match goal.pressure {
            Some(pressure) => match (excess(model, state, work, &bounds, pressure), goal.even) {
                (excess, true) => Vec3::repeat(excess.mean()),
                (excess, false) => excess,
            },
            None if sums.mean_force() < work.negligible_force => return Status::Unjammed,
            None => Vec3::zeros(),
        };
        if reached(&goal, force2, &sums, &excess, model.len(), bounds.volume()) {
            return Status::Converged;
        }
        // With masses of one kind the mixing may use forces and velocities in natural units.
        let scale = mass / box_mass;
        let grains = velocity.iter().zip(gradient()).map(|(v, g)| -v.dot(g)).sum::<f64>();
        let power = grains + box_velocity.dot(&excess);
        if power > 0.0 {
            let speed2 = velocity.iter().map(Vec3::norm_squared).sum::<f64>()
                + box_velocity.norm_squared() / scale;
            let force2 = force2 + excess.norm_squared() * scale;
            let mix = alpha * (speed2 / force2).sqrt();
            for (v, g) in velocity.iter_mut().zip(gradient()) {
                *v = *v * (1.0 - alpha) - g * mix;
            }
            box_velocity = box_velocity * (1.0 - alpha) + excess * (mix * scale);
            positive += 1;
            if positive > PATIENCE {
                dt = f64::min(dt * 1.1, LARGEST_TIME_STEP);
                alpha *= 0.99;
            }
        } else {
            velocity.fill(Vec3::zeros());
            box_velocity = Vec3::zeros();
            (dt, alpha, positive) = (dt * 0.5, 0.1, 0);
        }
        let longest = LONGEST.0 * model.mean_radius / dt;
        for (v, g) in velocity.iter_mut().zip(gradient()) {
            *v -= g * (dt / mass);
            let speed = v.norm();
            if speed > longest {
                *v *= longest / speed;
            }
        }
        let (moving, turning) = velocity.split_at(model.len());
        for (at, v) in state.position.iter_mut().zip(moving) {
            *at += v * dt;
        }
        for ((at, v), radius) in state.rotation.iter_mut().zip(turning).zip(&model.radius) {
            *at += v * (dt / radius);
        }
        if goal.pressure.is_some() {
            let fastest = LONGEST.1 / dt;
            box_velocity += excess * (dt / box_mass);
            box_velocity = box_velocity.map(|v| v.clamp(-fastest, fastest));
            let sides = bounds.sides();
            let target: [f64; wall::COUNT] = std::array::from_fn(|w| match wall::axis(w) {
                // The outer wall of a round room; an inner one stands.
                0 | 1 if bounds.is_round() && w != 1 => state.displacement[w],
                axis => state.displacement[w] - 0.5 * sides[axis] * box_velocity[axis] * dt,
            });
            move_walls(model, state, &target, 1.0);
        }
    }
    Status::MaxIterations
}

/// What drives the logarithms of the sides \[J\]: V (σ - p) along each axis, and across the axis of a
/// round room the half of what drives that of its outer radius.
fn excess(model: &Model, state: &State, work: &Workspace, room: &Room, pressure: f64) -> Vec3 {
    let virial = Vec3::from(work.balance.sums.virial);
    let excess = virial - Vec3::repeat(pressure * room.volume());
    let Some([_, outer]) = room.radii() else { return excess };
    let grains = (&*state.position, &*state.carries);
    let on_wall = walls::normal_forces_in(model, &work.neighbours, grains, room)[1];
    let carried = state.position.iter().zip(&work.balance.gradient);
    let on_grains = carried.map(|(at, g)| room.carried(at, 1).dot(g)).sum::<f64>();
    let across = 0.5 * outer * (on_wall + on_grains - pressure * room.area(1));
    Vec3::new(across, across, excess.z)
}

fn reached(goal: &Goal, force2: f64, sums: &Sums, excess: &Vec3, n: usize, volume: f64) -> bool {
    let stress = goal.pressure.is_none_or(|p| excess.amax() <= goal.residual * p * volume);
    stress && (force2 / n as f64).sqrt() <= goal.residual * sums.mean_force()
}

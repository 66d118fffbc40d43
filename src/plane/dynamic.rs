//! Motion that local damping brings to rest (13-14), the way of Cundall and Strack that van Baars compares
//! his own with: leap-frog steps of grains and of the walls under loads, as spheres take them
//! ([`crate::relax::dynamic`]).

mod mass;
#[cfg(test)]
mod tests;

use nalgebra::Vector1;

use super::act::{Act, Scenery};
use super::matrix::FREEDOMS;
use super::newton::{OPENS, open, residual, stiffness, unit_force};
use super::reference::Joint;
use super::setup::Law;
use super::work::Workspace;
use super::{DRIVES, Vec2, advance, floating, glue};
use crate::contact::hertz;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::model::Model;
use crate::relax::dynamic::leap::{DEEPEST, Leap, PATIENCE};
use crate::relax::{Outcome, Status};
use crate::state::State;
use mass::Masses;

/// Residual above which grains that nothing holds take part.
const FAR: f64 = 1.0;

/// Scratch of this module.
#[derive(Clone, Debug, Default)]
pub(super) struct Inertia {
    masses: Masses,
    /// Velocities, and those of the turns times radius, in a time without unit \[m\]; shape (n).
    velocity: Vec<Vec2>,
    spin: Vec<Vector1<f64>>,
    /// Velocities of the drives \[m\].
    drive: [Vector1<f64>; DRIVES],
}

/// Relaxes `state` by motion from rest; a step of the outcome is one of time.
pub(super) fn relax(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
) -> Outcome {
    let mut inertia = std::mem::take(&mut work.inertia);
    inertia.halt(model.len());
    let outcome = run(model, state, work, near, &mut inertia);
    work.inertia = inertia;
    outcome
}

fn run(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
    inertia: &mut Inertia,
) -> Outcome {
    let mut outcome = Outcome { status: Status::MaxIterations, ..Outcome::NONE };
    work.search.concave = false;
    work.floating.begin(model.len());
    let leap = Leap::new(model.solver.damping);
    let most = model.solver.most_iterations();
    // Steps so far, and those before the leg at hand.
    let (mut steps, mut leg) = (0, 0);
    loop {
        work.refresh(model, state, near);
        inertia.masses.evaluate(model, state, work);
        let look = steps % PATIENCE == 0;
        outcome.residual = residual(model, work);
        let changed = match outcome.residual {
            r if r <= model.solver.tolerance => floating::drop_loose(model, state, work),
            // Far from rest what is loose may be what holds in the end.
            r if look && r > FAR => {
                floating::rejoin(model, state, work) | floating::take_back(state)
            }
            r if look => {
                // As in Newton's method: what nothing but the shear of an open contact pulls at would go on
                // for ever.
                let opened = r < OPENS && open(model, state, work);
                let dropped = floating::drop_loose(model, state, work);
                floating::rejoin(model, state, work) | dropped | opened
            }
            _ => false,
        };
        if changed {
            inertia.masses.evaluate(model, state, work);
            outcome.residual = residual(model, work);
        }
        outcome.iterations = steps;
        outcome.sums = work.balance.sums;
        if !outcome.residual.is_finite() {
            outcome.status = Status::NonFinite;
            return outcome;
        }
        if outcome.residual <= model.solver.tolerance {
            if floating::rejoin(model, state, work) {
                continue;
            }
            outcome.status = work.rest();
            return outcome;
        }
        if steps >= most {
            return outcome;
        }
        // A leg may stir what has come to rest, so that each is longer than the last.
        let rested = steps - leg >= PATIENCE * outcome.descents;
        if look && rested && outran(model, state, work) {
            work.search.concave = true;
            outcome.descents += 1;
            leg = steps;
            open(model, state, work);
            advance::renew_limits(model, state, work);
            advance::flow_on(model, state, work, near);
            inertia.masses.evaluate(model, state, work);
        }
        match look {
            true => inertia.masses.take(&work.drives, stiffness(work)),
            false => inertia.grow(work),
        }
        inertia.step(model, state, work, leap);
        steps += 1;
    }
}

/// Whether contacts that rub are no longer what they were at the reference: bodies went further along or
/// into each other than contacts are deep. With those of the last equilibrium a pack that moves far would
/// have no friction where it is.
fn outran(model: &Model, state: &State, work: &Workspace) -> bool {
    let (Some(setup), Some(_)) = (&model.plane, &model.friction) else { return false };
    let Workspace { reference, bodies, membranes, pose, balance, .. } = work;
    let deep = balance.sums.mean_overlap();
    let far = |joint: &Joint, act: &Act| {
        act.slid.abs() > deep || (act.overlap - joint.overlap.max(0.0)).abs() > deep
    };
    let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
    scenery.pairs(pose).any(|(_, _, joint, act)| far(joint, &act))
        || reference
            .edges
            .iter()
            .any(|joint| scenery.edge(joint, pose).is_some_and(|act| far(joint, &act)))
}

impl Inertia {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.masses.heap_bytes() + heap::bytes(&self.velocity) + heap::bytes(&self.spin)
    }

    /// Begins with everything at rest.
    fn halt(&mut self, grains: usize) {
        self.velocity.clear();
        self.velocity.resize(grains, Vec2::zeros());
        self.spin.clear();
        self.spin.resize(grains, Vector1::zeros());
        self.drive = [Vector1::zeros(); DRIVES];
    }

    /// Makes heavier what is held more stiffly; it keeps its momentum.
    fn grow(&mut self, work: &Workspace) {
        let Self { masses, velocity, spin, drive } = self;
        masses.grow(
            &work.drives,
            |i, [u, w]| {
                velocity[i] *= u;
                spin[i] *= w;
            },
            |k, share| drive[k] *= share,
        );
    }

    /// One leap-frog step (14).
    fn step(&mut self, model: &Model, state: &mut State, work: &mut Workspace, leap: Leap) {
        let cap = model.solver.step_cap;
        let deepest = match model.plane.as_ref().map(|setup| setup.law) {
            Some(Law::Hertz) => {
                let modulus = hertz::modulus(0.5 * model.mean_radius, 2.0 * model.compliance[0]);
                // As deep as (1) has it under a typical force.
                DEEPEST * (unit_force(model, work) / modulus).cbrt().powi(2)
            }
            // Linear contacts are as stiff at any depth.
            _ => f64::INFINITY,
        };
        let unbalance = work.unbalance(&work.balance);
        let Workspace { balance, pose, drives, bodies, .. } = work;
        for (i, gradient) in balance.gradient.chunks_exact(FREEDOMS).enumerate() {
            if !state.carries[i] || glue::side(&state.glued, i).is_some() {
                (self.velocity[i], self.spin[i]) = (Vec2::zeros(), Vector1::zeros());
                continue;
            }
            let (radius, mass) = (model.radius[i], self.masses.of(i));
            let longest = deepest.min(cap * radius);
            let (push, moment) = (Vec2::new(gradient[0], gradient[1]), Vector1::new(gradient[2]));
            pose.at[i] += leap.advance(&mut self.velocity[i], &push, mass[0], longest);
            let turn = leap.advance(&mut self.spin[i], &moment, mass[1], longest);
            pose.turn[i] += turn.x / radius;
        }
        let longest = deepest.min(cap * model.mean_radius);
        for (k, drive) in drives.iter().enumerate() {
            let mass = self.masses.of_drive(k);
            let way =
                leap.advance(&mut self.drive[k], &Vector1::new(unbalance[k]), mass, longest).x;
            for (side, share) in drive.shares.iter().enumerate() {
                state.displacement[side] += share * way;
            }
            for (at, side) in pose.at.iter_mut().zip(&state.glued) {
                let Some(side) = side.map(usize::from) else { continue };
                *at += bodies[side].slide * (drive.shares[side] * way);
            }
        }
    }
}

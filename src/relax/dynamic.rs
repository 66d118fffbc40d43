//! Motion that local damping brings to rest (B 2.2; Cundall and Strack 1979), as a way to the
//! equilibrium: leap-frog steps of the equations of motion until the residual holds, with the
//! masses scaled to the grains' stiffnesses so that all of them follow the same time step.

mod mass;

use std::f64::consts::SQRT_2;

use crate::Vec3;
use crate::heap;
use crate::model::Model;
use crate::relax::Workspace;
use crate::relax::newton::Solved;
use crate::relax::verdict::{Progress, verdict};
use crate::state::State;
use crate::wall::Room;
use mass::Masses;

/// Share of the largest stable time step.
const SAFE: f64 = 0.9;
/// Longest step over the mean overlap: two grains that meet come no deeper than contacts are. The
/// masses suit those; deeper ones would throw grains back with more energy than they had.
const DEEPEST: f64 = 0.5;
/// Steps between two looks for masses that may be smaller and for grains that nothing holds.
const PATIENCE: u32 = 50;

/// Scratch of this module.
#[derive(Clone, Debug, Default)]
pub(super) struct Inertia {
    masses: Masses,
    /// Velocities, and those of the rotations times radius, in a time without unit \[m\]; shape (n),
    /// the latter also (0).
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
}

/// Relaxes the grains of `state` that carry load.
pub(super) fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    let bounds = state.bounds(model);
    let mut inertia = std::mem::take(&mut work.inertia);
    inertia.halt(state);
    let solved = run(model, state, work, &mut inertia, &bounds);
    work.inertia = inertia;
    solved
}

fn run(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    inertia: &mut Inertia,
    bounds: &Room,
) -> Solved {
    let mut iterations = 0;
    loop {
        work.evaluate(model, state, bounds);
        let look = iterations % PATIENCE == 0;
        let progress = Progress { iterations, patient: look && iterations > 0 };
        if let Some(end) = verdict(model, state, work, progress) {
            return end;
        }
        match look {
            true => inertia.masses.take(model, work),
            false => inertia.grow(work),
        }
        inertia.step(model, state, work);
        iterations += 1;
    }
}

impl Inertia {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.masses.heap_bytes() + heap::bytes(&self.velocity) + heap::bytes(&self.spin)
    }

    /// Begins with grains at rest.
    fn halt(&mut self, state: &State) {
        self.velocity.clear();
        self.velocity.resize(state.position.len(), Vec3::zeros());
        self.spin.clear();
        self.spin.resize(state.rotation.len(), Vec3::zeros());
    }

    /// Makes the grains heavier whose contacts became stiffer; they keep their momentum.
    fn grow(&mut self, work: &Workspace) {
        let (velocity, spin) = (&mut self.velocity, &mut self.spin);
        self.masses.grow(work, |i, [u, w]| {
            velocity[i] *= u;
            if let Some(spin) = spin.get_mut(i) {
                *spin *= w;
            }
        });
    }

    /// One leap-frog step (B 13-14). Damping takes a share from each component of a force that
    /// drives the motion, and adds it to one that brakes.
    fn step(&mut self, model: &Model, state: &mut State, work: &Workspace) {
        let damping = model.solver.damping;
        // A pure number, as masses are stiffnesses: 2/ω, for forces that damping makes larger.
        let dt = SAFE * SQRT_2 / (1.0 + damping).sqrt();
        let cap = model.solver.step_cap;
        let deepest = match work.balance.sums.contacts {
            0 => f64::INFINITY,
            _ => DEEPEST * work.balance.sums.mean_overlap(),
        };
        let advance = |v: &mut Vec3, gradient: &Vec3, mass: f64, radius: f64| {
            let force = v.zip_map(gradient, |v, g| match () {
                () if v * g < 0.0 => -g * (1.0 - damping),
                () if v * g > 0.0 => -g * (1.0 + damping),
                () => -g,
            });
            *v += force * (dt / mass);
            let (length, longest) = (v.norm() * dt, deepest.min(cap * radius));
            if length > longest {
                *v *= longest / length;
            }
            *v * dt
        };
        let balance = &work.balance;
        for i in 0..model.len() {
            let (radius, mass) = (model.radius[i], self.masses.of(i));
            state.position[i] +=
                advance(&mut self.velocity[i], &balance.gradient[i], mass[0], radius);
            if let (Some(spin), Some(moment)) = (self.spin.get_mut(i), balance.moment.get(i)) {
                let turn = advance(spin, moment, mass[1], radius);
                state.rotation[i] += turn / radius;
            }
        }
    }
}

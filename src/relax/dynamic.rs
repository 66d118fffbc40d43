//! Motion that local damping brings to rest (B 2.2; Cundall and Strack 1979), as a way to the
//! equilibrium: leap-frog steps of the equations of motion until the residual holds, with the
//! masses scaled to the grains' stiffnesses so that all of them follow the same time step.

pub(crate) mod leap;
mod mass;

use crate::Vec3;
use crate::heap;
use crate::model::Model;
use crate::relax::Workspace;
use crate::relax::newton::Solved;
use crate::relax::verdict::{Progress, verdict};
use crate::state::State;
use crate::wall::Room;
use leap::{DEEPEST, Leap, PATIENCE};
use mass::Masses;

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

    /// One leap-frog step (B 13-14).
    fn step(&mut self, model: &Model, state: &mut State, work: &Workspace) {
        let leap = Leap::new(model.solver.damping);
        let cap = model.solver.step_cap;
        let deepest = match work.balance.sums.contacts {
            0 => f64::INFINITY,
            _ => DEEPEST * work.balance.sums.mean_overlap(),
        };
        let balance = &work.balance;
        for i in 0..model.len() {
            let (radius, mass) = (model.radius[i], self.masses.of(i));
            let longest = deepest.min(cap * radius);
            state.position[i] +=
                leap.advance(&mut self.velocity[i], &balance.gradient[i], mass[0], longest);
            if let (Some(spin), Some(moment)) = (self.spin.get_mut(i), balance.moment.get(i)) {
                let turn = leap.advance(spin, moment, mass[1], longest);
                state.rotation[i] += turn / radius;
            }
        }
    }
}

//! Motion that local damping brings to rest (B 2.2; Cundall and Strack 1979), as a way to the
//! equilibrium: leap-frog steps of the equations of motion until the residual holds, with the masses scaled to the grains'
//! stiffnesses so that all of them follow the same time step.
//!
//! In units of such masses the largest step is known: the stiffness of all contacts together is at
//! most twice the block diagonal D of the grains' own stiffnesses (half of it for a wall), because
//! k(a - b)² <= 2ka² + 2kb². A mass that is the largest row sum of |D| leaves ω² <= 2 (Gershgorin).

use std::f64::consts::SQRT_2;

use crate::Vec3;
use crate::contact::Other;
use crate::model::Model;
use crate::relax::Workspace;
use crate::relax::newton::Solved;
use crate::relax::sticking;
use crate::relax::sym3::Sym3;
use crate::relax::sym6::Sym6;
use crate::relax::verdict::{Progress, verdict};
use crate::state::State;
use crate::wall::Bounds;

/// Share of the largest stable time step.
const SAFE: f64 = 0.9;
/// Steps between two looks at the stiffnesses, and for grains that nothing holds.
const PATIENCE: u32 = 50;
/// Least mass of a grain over the mean: one that hardly touches anything may do so soon.
const LEAST_MASS: f64 = 0.2;

/// Scratch of this module.
#[derive(Clone, Debug, Default)]
pub(super) struct Inertia {
    /// Own stiffness of each grain, in units of the reference, shape (n).
    stiffness: Vec<Sym6>,
    /// Mass of each grain and of its rotation times radius \[N/m\], shape (n).
    mass: Vec<[f64; 2]>,
    /// Velocities, and those of the rotations times radius \[m\]; shape (n), (n) or empty.
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
    bounds: &Bounds,
) -> Solved {
    let mut iterations = 0;
    loop {
        work.evaluate(model, state, bounds);
        let look = iterations % PATIENCE == 0;
        let progress = Progress { iterations, patient: look && iterations > 0 };
        if let Some(end) = verdict(model, state, work, progress) {
            return end;
        }
        if look {
            inertia.weigh(model, work);
        }
        inertia.step(model, state, work);
        iterations += 1;
    }
}

impl Inertia {
    /// Begins with grains at rest.
    fn halt(&mut self, state: &State) {
        self.velocity.clear();
        self.velocity.resize(state.position.len(), Vec3::zeros());
        self.spin.clear();
        self.spin.resize(state.rotation.len(), Vec3::zeros());
    }

    /// Takes the masses from the stiffnesses of the contacts.
    fn weigh(&mut self, model: &Model, work: &Workspace) {
        let Workspace { balance, neighbours, reference, reference_stiffness, .. } = work;
        self.stiffness.clear();
        self.stiffness.extend(balance.wall_stiffness.iter().map(|&[x, y, z]| Sym6 {
            u: Sym3::diagonal([0.5 * x, 0.5 * y, 0.5 * z]),
            ..Sym6::default()
        }));
        for i in 0..model.len() {
            let first = neighbours.row(i).start;
            for link in &balance.links[first..first + balance.links_in_row[i] as usize] {
                self.stiffness[i].u.add_outer(1.0, link.m);
                self.stiffness[link.second as usize].u.add_outer(1.0, link.m);
            }
        }
        let scale = 1.0 / reference_stiffness;
        for (held, traction) in reference.contacts.iter().zip(&balance.tractions) {
            if !traction.live {
                continue;
            }
            let i = held.first as usize;
            match held.second {
                Other::Grain(j) => {
                    for (i, second) in [(i, false), (j as usize, true)] {
                        let radius = model.radius[i];
                        let block = sticking::block(held, traction, second, radius, scale);
                        self.stiffness[i].add(&block);
                    }
                }
                Other::Wall(_) => {
                    let half = 0.5 * scale;
                    let radius = model.radius[i];
                    self.stiffness[i].add(&sticking::block(held, traction, false, radius, half));
                }
            }
        }
        self.mass.clear();
        let unit = *reference_stiffness;
        self.mass.extend(self.stiffness.iter().map(|s| row_sums(s).map(|sum| sum * unit)));
        for kind in 0..2 {
            let carrying = self.mass.iter().filter(|mass| mass[kind] > 0.0).count().max(1);
            let mean = self.mass.iter().map(|mass| mass[kind]).sum::<f64>() / carrying as f64;
            // Nothing touches yet: any mass will do.
            let least = if mean > 0.0 { LEAST_MASS * mean } else { unit };
            for mass in &mut self.mass {
                mass[kind] = mass[kind].max(least);
            }
        }
    }

    /// One leap-frog step (B 13-14). Damping takes a share from each component of a force that
    /// drives the motion, and adds it to one that brakes.
    fn step(&mut self, model: &Model, state: &mut State, work: &Workspace) {
        let damping = model.solver.damping;
        // A pure number, as masses are stiffnesses: 2/ω, for forces that damping makes larger.
        let dt = SAFE * SQRT_2 / (1.0 + damping).sqrt();
        let cap = model.solver.step_cap;
        let advance = |v: &mut Vec3, gradient: &Vec3, mass: f64, radius: f64| {
            let force = v.zip_map(gradient, |v, g| match () {
                () if v * g < 0.0 => -g * (1.0 - damping),
                () if v * g > 0.0 => -g * (1.0 + damping),
                () => -g,
            });
            *v += force * (dt / mass);
            let (length, longest) = (v.norm() * dt, cap * radius);
            if length > longest {
                *v *= longest / length;
            }
            *v * dt
        };
        let balance = &work.balance;
        for i in 0..model.len() {
            let (radius, mass) = (model.radius[i], self.mass[i]);
            state.position[i] +=
                advance(&mut self.velocity[i], &balance.gradient[i], mass[0], radius);
            if let Some(spin) = self.spin.get_mut(i) {
                let turn = advance(spin, &balance.moment[i], mass[1], radius);
                state.rotation[i] += turn / radius;
            }
        }
    }
}

/// Largest sum of the absolute values of a row, of the displacement's and of the rotation's.
fn row_sums(block: &Sym6) -> [f64; 2] {
    let sum = |row: [f32; 3]| row.iter().map(|entry| entry.abs()).sum::<f32>();
    let (u, w) = (block.u.columns(), block.w.columns());
    let mut largest = [0.0f32; 2];
    for k in 0..3 {
        let coupling = [block.uw[k], [0, 1, 2].map(|row| block.uw[row][k])];
        for (kind, own) in [u[k], w[k]].into_iter().enumerate() {
            largest[kind] = largest[kind].max(sum(own) + sum(coupling[kind]));
        }
    }
    largest.map(f64::from)
}

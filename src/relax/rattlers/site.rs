//! One floating grain on its own: it descends among its neighbours until nothing pushes it, or
//! until they have caught it.

use nalgebra::Matrix3;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::relax::rows::Near;
use crate::wall::Room;

/// Steps of one grain in one sweep.
const STEPS: u32 = 60;
/// A grain that falls or slides down stops after this share of its longest step, 0.1 R, so that it
/// does not go past what its neighbour list knows.
const FALL: f64 = 0.5;

/// What became of a floating grain.
pub(super) enum Settled {
    /// It touches nothing that pushes it.
    Free,
    /// It falls or slides down; the neighbour list may end where it is now.
    Falling,
    /// It was moved until nothing pushed it.
    Moved,
    /// Its contacts push it from all sides.
    Caught,
}

/// One floating grain among its neighbours, which stay where they are.
pub(super) struct Site<'a> {
    pub(super) model: &'a Model,
    pub(super) neighbours: &'a Neighbours,
    /// Its neighbours.
    pub(super) near: &'a [Near],
    pub(super) bounds: &'a Room,
    pub(super) grain: usize,
    /// Whether its weight matters.
    pub(super) heavy: bool,
}

/// Energy of one grain with its derivatives.
struct Local {
    energy: f64,
    gradient: Vec3,
    hessian: Matrix3<f64>,
    /// Largest contact force \[N\].
    force: f64,
}

impl Site<'_> {
    /// Descends until no contact pushes with more than `open` or the grain is caught.
    pub(super) fn settle(&self, position: &mut [Vec3], open: f64) -> Settled {
        let longest = 0.1 * self.model.radius[self.grain];
        let from = position[self.grain];
        let mut at = from;
        let mut local = self.local(position, &at);
        let mut moved = false;
        for _ in 0..STEPS {
            if !self.heavy && local.force <= open {
                position[self.grain] = at;
                return if moved { Settled::Moved } else { Settled::Free };
            }
            if local.force > 0.0 && local.gradient.norm() <= 1e-3 * local.force {
                position[self.grain] = at;
                return Settled::Caught;
            }
            if self.heavy && (at - from).norm() > FALL * longest {
                position[self.grain] = at;
                return Settled::Falling;
            }
            let mut step = local.step(longest);
            let mut accepted = false;
            for _ in 0..20 {
                let next = self.local(position, &(at + step));
                if next.energy < local.energy {
                    at += step;
                    local = next;
                    accepted = true;
                    moved = true;
                    break;
                }
                step *= 0.5;
            }
            if !accepted {
                break;
            }
        }
        position[self.grain] = at;
        if local.force > open { Settled::Caught } else { Settled::Moved }
    }

    fn local(&self, position: &[Vec3], at: &Vec3) -> Local {
        let mut local =
            Local { energy: 0.0, gradient: Vec3::zeros(), hessian: Matrix3::zeros(), force: 0.0 };
        for &Near { second, modulus, reach } in self.near {
            let branch = at - position[second as usize];
            let distance = branch.norm();
            let overlap = reach - distance;
            if overlap > 0.0 && distance > 0.0 {
                local.push(modulus, overlap, branch / distance, 1.0 / distance);
            }
        }
        for (wall, reach) in self.neighbours.walls_near(self.model, self.grain) {
            let wall = usize::from(wall);
            let overlap = reach - wall_gap(at, wall, self.bounds);
            if overlap > 0.0 {
                let normal = self.bounds.normal(at, wall);
                let modulus = self.neighbours.wall_modulus(self.grain, wall);
                local.push(modulus, overlap, normal, 0.0);
            }
        }
        if self.heavy {
            let weight = &self.model.weight[self.grain];
            local.gradient -= weight;
            local.energy -= weight.dot(&(at - Vec3::from(self.bounds.center())));
        }
        local
    }
}

impl Local {
    /// Adds one contact with normal `normal` towards the grain and curvature 1/r of the pair.
    fn push(&mut self, modulus: f64, overlap: f64, normal: Vec3, curvature: f64) {
        let force = hertz::force(modulus, overlap);
        let bending = force * curvature;
        self.energy += hertz::energy(force, overlap);
        self.gradient -= normal * force;
        self.force = self.force.max(force);
        self.hessian +=
            normal * normal.transpose() * (hertz::stiffness(modulus, overlap) + bending)
                - Matrix3::identity() * bending;
    }

    /// A step downhill, no longer than `longest`. One and a half Newton steps open a Hertz
    /// contact at once, because P ~ h^1.5.
    fn step(&self, longest: f64) -> Vec3 {
        let eigen = self.hessian.symmetric_eigen();
        // Where nothing touches, the gradient alone sets the length.
        let least = self.gradient.norm() / longest;
        let floor = (1e-3 * eigen.eigenvalues.amax()).max(least).max(f64::MIN_POSITIVE);
        let step: Vec3 = (0..3)
            .map(|k| {
                let axis = eigen.eigenvectors.column(k).into_owned();
                let curvature = eigen.eigenvalues[k].abs().max(floor);
                axis * (-1.5 * axis.dot(&self.gradient) / curvature)
            })
            .sum();
        let length = step.norm();
        if length > longest { step * (longest / length) } else { step }
    }
}

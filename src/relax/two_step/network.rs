//! The network of springs that a step solves: forces, and the product with its stiffness.

use nalgebra::{Matrix3, Matrix6};
use rayon::prelude::*;

use super::coordinates::{Coordinates, DRIVES};
use crate::Vec3;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::contact::{Other, hertz};
use crate::heap;
use crate::model::Model;
use crate::relax::servo::Drive;
use crate::relax::tangential::{Deformation, Spring};
use crate::state::State;
use crate::wall::{self, Room};

/// Springs that one task answers for; the bits do not depend on it.
const CHUNK: usize = 256;
/// Stiffness that every coordinate of a grain has for the preconditioner, over the mean of its own.
const FLOOR: f64 = 1e-12;

/// Springs between the grains and the walls.
#[derive(Clone, Debug, Default)]
pub(super) struct Network {
    /// First those of the contacts at the reference, in their order, then those that only press.
    pub(super) springs: Vec<Spring>,
    /// What each spring does, shape as `springs`.
    pulls: Vec<Pull>,
    /// Inverse of the stiffness of each grain among bodies that stand, shape (n).
    inverse: Vec<Matrix6<f64>>,
    /// The same of the drives \[m/N\].
    drive_inverse: [f64; DRIVES],
}

/// What one spring does to its bodies.
#[derive(Clone, Copy, Debug, Default)]
struct Pull {
    /// On grain i \[N\].
    force: Vec3,
    /// Gradients with respect to the rotations of both bodies \[N m\].
    moment: [Vec3; 2],
    /// P \[N\].
    normal: f64,
}

/// Whether forces count from what the springs carry at the reference, or from nothing: then they
/// are the product of the stiffness.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Count {
    Loads,
    Changes,
}

/// The walls in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walls<'a> {
    /// Those under loads.
    pub(super) drives: &'a [Drive],
    /// Inward motion of the others \[m\].
    pub(super) moved: [f64; wall::COUNT],
    /// The box at the reference.
    pub(super) bounds: &'a Room,
}

impl Walls<'_> {
    /// Inward motion of each wall \[m\].
    fn inward(&self, drive: &[f64; DRIVES], count: Count) -> [f64; wall::COUNT] {
        let mut inward = match count {
            Count::Loads => self.moved,
            Count::Changes => [0.0; wall::COUNT],
        };
        for (drive, e) in self.drives.iter().zip(drive) {
            for side in 0..2 {
                inward[2 * drive.axis + side] += drive.shares[side] * e;
            }
        }
        inward
    }
}

impl Network {
    /// Takes the pairs of `state` that press without cement, behind the springs at hand.
    pub(super) fn press(&mut self, model: &Model, near: &Neighbours, state: &State) {
        let bounds = state.bounds(model);
        for i in (0..model.len()).filter(|&i| state.carries[i]) {
            let at = state.position[i];
            let mut add = |second: Other, normal: Vec3, modulus: f64, overlap: f64| {
                let (force, stiffness) =
                    (hertz::force(modulus, overlap), hertz::stiffness(modulus, overlap));
                let key = (i as u32, second);
                self.springs.push(Spring::pressing(key, normal, force, stiffness));
            };
            for k in near.row(i) {
                let j = near.second[k] as usize;
                let branch = at - state.position[j];
                let distance = branch.norm();
                let overlap = near.reach(model, i, k) - distance;
                if overlap > 0.0 && state.carries[j] {
                    add(Other::Grain(j as u32), branch / distance, near.modulus[k], overlap);
                }
            }
            for (w, reach) in near.walls_near(model, i) {
                let overlap = reach - wall_gap(&at, usize::from(w), &bounds);
                if overlap > 0.0 {
                    add(
                        Other::Wall(w),
                        inward_normal(w),
                        near.wall_modulus(i, usize::from(w)),
                        overlap,
                    );
                }
            }
        }
        self.pulls.resize(self.springs.len(), Pull::default());
    }

    /// How each spring is deformed by `x`.
    pub(super) fn deformations(
        &self,
        model: &Model,
        walls: &Walls<'_>,
        x: &Coordinates,
    ) -> impl Iterator<Item = Deformation> {
        let inward = walls.inward(&x.drive, Count::Loads);
        self.springs.iter().map(move |spring| deformation(model, spring, x, &inward))
    }

    /// Takes the forces along the coordinates that `x` leaves to `out`; with [`Count::Changes`] minus
    /// the product of the stiffness and `x`.
    pub(super) fn forces(
        &mut self,
        model: &Model,
        carries: &[bool],
        walls: &Walls<'_>,
        (x, count): (&Coordinates, Count),
        out: &mut Coordinates,
    ) {
        let Self { springs, pulls, .. } = self;
        let inward = walls.inward(&x.drive, count);
        let tasks = pulls.par_chunks_mut(CHUNK).zip(springs.par_chunks(CHUNK));
        tasks.for_each(|(pulls, springs)| {
            for (pull, spring) in pulls.iter_mut().zip(springs) {
                *pull = Pull::of(spring, &deformation(model, spring, x, &inward), count);
            }
        });
        out.clear(x.shift.len(), x.turn.len());
        let mut on_walls = [0.0; wall::COUNT];
        let turns = !x.turn.is_empty();
        for (spring, pull) in springs.iter().zip(pulls) {
            let i = spring.first as usize;
            out.shift[i] += pull.force;
            if turns {
                out.turn[i] -= pull.moment[0] / model.radius[i];
            }
            match spring.second {
                Other::Grain(j) => {
                    let j = j as usize;
                    out.shift[j] -= pull.force;
                    if turns {
                        out.turn[j] -= pull.moment[1] / model.radius[j];
                    }
                }
                Other::Wall(w) => on_walls[usize::from(w)] += pull.normal,
            }
        }
        for (out, drive) in out.drive.iter_mut().zip(walls.drives) {
            let goal = if count == Count::Loads { drive.goal(walls.bounds) } else { 0.0 };
            *out = goal - drive.force(&on_walls);
        }
        if count == Count::Loads {
            for (i, weight) in model.weight.iter().enumerate().filter(|(i, _)| carries[*i]) {
                out.shift[i] += weight;
            }
        }
    }

    /// Mean magnitude of the normal forces after `x` \[N\].
    pub(super) fn mean_force(&self, model: &Model, walls: &Walls<'_>, x: &Coordinates) -> f64 {
        let loaded = self.springs.iter().zip(self.deformations(model, walls, x));
        let (mut sum, mut count) = (0.0, 0_u32);
        for (spring, deformation) in loaded.filter(|(s, _)| s.normal_stiffness > 0.0) {
            sum += spring.force_after(&deformation).abs();
            count += 1;
        }
        sum / f64::from(count.max(1))
    }

    /// Inverts the diagonal blocks.
    pub(super) fn factorise(&mut self, model: &Model, drives: &[Drive]) {
        let Self { springs, inverse, drive_inverse, .. } = self;
        inverse.clear();
        inverse.resize(model.len(), Matrix6::zeros());
        let mut wall_stiffness = [0.0; wall::COUNT];
        for spring in &*springs {
            let (i, arm) = (spring.first as usize, spring.arm);
            inverse[i] += block(spring, arm[0] / model.radius[i], model.radius[i]);
            match spring.second {
                Other::Grain(j) => {
                    let j = j as usize;
                    // u_s has the other sign for this grain's displacement.
                    inverse[j] += block(spring, -arm[1] / model.radius[j], model.radius[j]);
                }
                Other::Wall(w) => wall_stiffness[usize::from(w)] += spring.normal_stiffness,
            }
        }
        inverse.par_chunks_mut(CHUNK).for_each(|blocks| blocks.iter_mut().for_each(invert));
        *drive_inverse = [0.0; DRIVES];
        for (inverse, drive) in drive_inverse.iter_mut().zip(drives) {
            let share =
                |side: usize| drive.shares[side].powi(2) * wall_stiffness[2 * drive.axis + side];
            let stiffness: f64 = share(0) + share(1);
            *inverse = if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 };
        }
    }

    /// Takes `forces` times the inverse of the diagonal blocks to `out`.
    pub(super) fn precondition(&self, forces: &Coordinates, out: &mut Coordinates) {
        let turns = !forces.turn.is_empty();
        for (i, inverse) in self.inverse.iter().enumerate() {
            let (u, w) = (forces.shift[i], if turns { forces.turn[i] } else { Vec3::zeros() });
            let corner = |row: usize, column: usize| inverse.fixed_view::<3, 3>(row, column);
            out.shift[i] = corner(0, 0) * u + corner(0, 3) * w;
            if turns {
                out.turn[i] = corner(3, 0) * u + corner(3, 3) * w;
            }
        }
        for ((out, force), inverse) in
            out.drive.iter_mut().zip(forces.drive).zip(self.drive_inverse)
        {
            *out = inverse * force;
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.springs) + heap::bytes(&self.pulls) + heap::bytes(&self.inverse)
    }
}

impl Pull {
    #[inline(always)]
    fn of(spring: &Spring, deformation: &Deformation, count: Count) -> Self {
        let Spring { normal, arm, .. } = spring;
        let mut force = spring.normal_stiffness * deformation.approach;
        let mut shear = deformation.slid * -spring.shear_stiffness;
        let mut couple = -spring.torsion_stiffness * deformation.twist;
        if count == Count::Loads {
            // (4.1, 4.5, 4.7)
            force += spring.force;
            shear += spring.shear;
            couple += spring.couple;
        }
        let (lever, couple) = (normal.cross(&shear), normal * couple);
        Self {
            force: normal * force + shear,
            moment: [lever * arm[0] - couple, lever * arm[1] + couple], // (4.9)
            normal: force,
        }
    }
}

/// How `x` deforms `spring`, where the walls go inwards by `inward` \[m\] (4.2, T 3.2, 3.7).
#[inline(always)]
fn deformation(
    model: &Model,
    spring: &Spring,
    x: &Coordinates,
    inward: &[f64; wall::COUNT],
) -> Deformation {
    let Spring { normal, arm, .. } = spring;
    let turned = |k: usize| match x.turn.get(k) {
        Some(turn) => turn / model.radius[k],
        None => Vec3::zeros(),
    };
    let i = spring.first as usize;
    let one = turned(i);
    let (moved, other, wall) = match spring.second {
        Other::Grain(j) => {
            let j = j as usize;
            (x.shift[i] - x.shift[j], turned(j), 0.0)
        }
        Other::Wall(w) => (x.shift[i], Vec3::zeros(), inward[usize::from(w)]),
    };
    let along = normal.dot(&moved);
    let sweep = one * arm[0] + other * arm[1];
    Deformation {
        approach: wall - along,
        slid: moved - normal * along + normal.cross(&sweep),
        twist: (one - other).dot(normal),
    }
}

/// Stiffness of `spring` for one of its bodies of the radius `radius` \[m\] whose rotation sweeps the
/// contact by `lever` w.
fn block(spring: &Spring, lever: f64, radius: f64) -> Matrix6<f64> {
    let Spring { normal, normal_stiffness, shear_stiffness, torsion_stiffness, .. } = spring;
    let along = normal * normal.transpose();
    let plane = Matrix3::identity() - along;
    let mut block = Matrix6::zeros();
    let mut put = |row, column, part: &Matrix3<f64>| {
        block.fixed_view_mut::<3, 3>(row, column).copy_from(part);
    };
    let swept = normal.cross_matrix() * (lever * *shear_stiffness);
    put(0, 0, &(along * *normal_stiffness + plane * *shear_stiffness));
    put(0, 3, &swept);
    put(3, 0, &swept.transpose());
    let twisting = along * (torsion_stiffness / (radius * radius));
    put(3, 3, &(plane * (lever * lever * shear_stiffness) + twisting));
    block
}

/// Inverts a block; one without any stiffness stays zero.
fn invert(block: &mut Matrix6<f64>) {
    let trace = block.trace();
    if trace <= 0.0 {
        *block = Matrix6::zeros();
        return;
    }
    for k in 0..6 {
        block[(k, k)] += FLOOR * trace;
    }
    *block = match block.cholesky() {
        Some(factors) => factors.inverse(),
        None => Matrix6::identity() * (6.0 / trace),
    };
}

/// The inward normal of wall `w`.
fn inward_normal(w: u8) -> Vec3 {
    let mut normal = Vec3::zeros();
    normal[wall::axis(usize::from(w))] = wall::inward(usize::from(w));
    normal
}

//! Shear and torsion of the contacts: what they carried at the reference configuration, and how
//! they answer to a displacement from there.
//!
//! The reference is the last equilibrium. Contacts that had an overlap there carry shear up to
//! the limit Q_max = μP⁰; new ones carry none until the next reference, and those that open keep
//! theirs until then (T 3.3.2: stiffness and limit are those of the unperturbed contact).

mod batch;
mod begin;
mod bonded;
mod commit;
mod held;
mod slope;
mod spring;
mod turn;

use rayon::prelude::*;

use crate::Vec3;
use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::pack::Layer;
use crate::relax::balance::{Balance, Configuration};
use crate::relax::membrane::Membranes;
use crate::scene::Law;
use crate::state::State;
use crate::wall;

use bonded::Bonded;
pub use commit::Changes;
pub use held::Held;
pub(super) use held::Pose;
use held::{Midway, Pair};
pub(super) use slope::{Along, Slope};
pub(super) use spring::{Deformation, Spring};

/// Contacts that one task answers for, and that are answered for before their forces are added
/// up; the bits do not depend on either.
const CHUNK: usize = 256;
const BATCH: usize = 2048;

/// The linearised answer of one contact, in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traction {
    /// Whether both bodies take part in the balance; if not, all else is zero.
    pub live: bool,
    /// Whether the contact slides.
    pub slides: bool,
    /// Unit normal towards grain i.
    pub normal: [f32; 3],
    /// Unit vector of sliding, or zero.
    pub direction: [f32; 3],
    /// -dQ/du across `direction` \[N/m\].
    pub across: f32,
    /// What -dQ/du along `direction` is more than across \[N/m\].
    pub sliding: f32,
    /// Distance of the contact from the centres of grain i and of the other \[m\] (T 3.3).
    pub arm: [f32; 2],
    /// -dM_t/dΩ_t \[N m\].
    pub torsion: f32,
    /// What cement adds to kn + P/r \[N/m\].
    pub axial: f32,
    /// What cement adds to P/r \[N/m\].
    pub bending: f32,
}

/// What one contact does to the balance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pull {
    /// Force on grain i \[N\]: Q, and that of cement along the normal.
    pub(super) force: Vec3,
    /// Gradients with respect to the rotations of both bodies \[N m\]: minus the moments on them.
    pub(super) moment: [Vec3; 2],
    pub(super) arm: [f64; 2],
    /// Of shear and torsion, and of cement along the normal \[J\].
    pub(super) potential: f64,
    /// Magnitude of the normal force that cement carries by itself \[N\].
    pub(super) cement: f64,
}

impl Pull {
    /// Of the tangential force Q and the couple about the normal n̂.
    #[inline(always)]
    pub(super) fn of(
        normal: &Vec3,
        arm: &[f64; 2],
        force: &Vec3,
        couple: f64,
        potential: f64,
    ) -> Self {
        let (lever, couple) = (normal.cross(force), normal * couple);
        let moment = [lever * arm[0] - couple, lever * arm[1] + couple];
        Self { force: *force, moment, arm: *arm, potential, cement: 0.0 }
    }
}

/// All contacts at the reference configuration; empty for a frictionless specimen.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    /// Sorted by (first, second).
    pub contacts: Vec<Held>,
    /// Layers of all contacts, for partial slip.
    layers: Vec<Layer>,
    /// Cement of the contacts that have some.
    bonds: Vec<Bonded>,
    /// Rotations at the reference \[rad\], shape (n).
    rotation: Vec<Vec3>,
    /// Pressures on the surface of the pack, whose grains are those of the reference.
    pub(in crate::relax) membranes: Membranes,
    /// Whether contacts carry shear.
    pub active: bool,
    /// Whether only cement resists sliding.
    pub(super) smooth: bool,
    /// Whether contacts that stuck in the last increment are taken to stick whatever they carry.
    pub(super) sticks: bool,
}

impl Reference {
    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.contacts)
            + heap::bytes(&self.layers)
            + heap::bytes(&self.rotation)
            + self.membranes.heap_bytes()
            + self.bond_bytes()
    }

    /// Whether the pair carried load at the reference by more than `least` \[m\] of overlap, without
    /// cement.
    #[must_use]
    pub fn holds(&self, first: u32, second: Other, least: f64) -> bool {
        let key = match second {
            Other::Grain(j) if j < first => (j, Other::Grain(first)),
            _ => (first, second),
        };
        self.contacts.binary_search_by_key(&key, |held| (held.first, held.second)).is_ok_and(|k| {
            !self.contacts[k].is_bonded() && self.contacts[k].reference_overlap > least
        })
    }

    /// Whether cement holds any bodies together.
    #[must_use]
    pub fn is_cemented(&self) -> bool {
        !self.bonds.is_empty()
    }

    /// Adds the tangential forces in the configuration `at` to `balance`.
    pub(super) fn evaluate(&self, balance: &mut Balance, at: &Configuration<'_>) {
        let (true, Some(friction)) = (self.active, &at.model.friction) else { return };
        let Configuration { model, position, rotation, bounds, .. } = *at;
        let pose = Pose { model, position, rotation, bounds };
        balance.tractions.resize(self.contacts.len(), Traction::default());
        balance.pulls.resize(BATCH, Pull::default());
        balance.moment.clear();
        balance.moment.resize(at.position.len(), Vec3::zeros());
        balance.shear_potential = 0.0;
        balance.cement_on_walls = [0.0; wall::COUNT];
        let Balance { tractions, pulls, gradient, moment, shear_potential, .. } = balance;
        let Balance { sums, cement_on_walls, .. } = balance;
        for (tractions, contacts) in tractions.chunks_mut(BATCH).zip(self.contacts.chunks(BATCH)) {
            let pulls = &mut pulls[..contacts.len()];
            let tasks = tractions.par_chunks_mut(CHUNK).zip(pulls.par_chunks_mut(CHUNK));
            tasks.zip(contacts.par_chunks(CHUNK)).for_each(|((tractions, pulls), contacts)| {
                if friction.law == Law::ReturnMap {
                    let (reference, pose, carries) = (self, &pose, at.carries);
                    let all =
                        batch::Answer { reference, pose, carries, contacts, tractions, pulls };
                    return all.all();
                }
                for ((traction, pull), held) in tractions.iter_mut().zip(pulls).zip(contacts) {
                    (*traction, *pull) = self.answer(held, friction.law, &pose, at.carries);
                }
            });
            for (held, pull) in contacts.iter().zip(&*pulls) {
                *shear_potential += pull.potential;
                if held.is_bonded() {
                    self.count(held, pull, &pose, sums, cement_on_walls);
                }
                let i = held.first as usize;
                gradient[i] -= pull.force;
                moment[i] += pull.moment[0];
                if let Other::Grain(j) = held.second {
                    let j = j as usize;
                    gradient[j] += pull.force;
                    moment[j] += pull.moment[1];
                }
            }
        }
        for (moment, radius) in moment.iter_mut().zip(&model.radius) {
            *moment /= *radius;
        }
    }

    /// Answer of the contact `held` to the configuration `pose`; nothing where one of the bodies
    /// takes no part.
    #[inline(always)]
    pub(super) fn answer(
        &self,
        held: &Held,
        law: Law,
        pose: &Pose<'_>,
        carries: &[bool],
    ) -> (Traction, Pull) {
        if !held.live(carries) {
            return Default::default();
        }
        let motion = held.motion(pose, &self.rotation);
        let sticks = self.sticks && !held.carried.slides;
        let answer = match () {
            () if held.is_bonded() => held.answer(&motion, Law::ReturnMap, &[]),
            () if sticks => held.stick(&motion),
            () => held.answer(&motion, law, &self.layers),
        };
        self.with_cement(held, answer.parts(), pose)
    }

    /// Renews the limit with the overlaps of `state` and the stiffness with their mean with those
    /// of the reference; displacements still count from there.
    pub fn renew(&mut self, model: &Model, state: &State) {
        let Some(friction) = &model.friction else { return };
        for held in &mut self.contacts {
            let overlap = held.present_overlap(model, state);
            if let (true, Some(cement)) = (held.is_bonded(), &model.cement) {
                Self::renew_bond(&self.bonds, held, model, cement, overlap);
                continue;
            }
            let pair = Pair::of(model, friction, held.first, held.second);
            held.freeze(&pair, overlap, Midway::Yes, friction.torsion);
        }
    }

    /// Elastic energy that the contacts carried at the reference \[J\].
    #[must_use]
    pub fn carried_energy(&self) -> f64 {
        let bonds = self.bonds.iter().map(|bond| bond.carried_energy).sum::<f64>();
        self.contacts.iter().map(|held| held.carried_energy).sum::<f64>() + bonds
    }
}

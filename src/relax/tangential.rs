//! Shear and torsion of the contacts: what they carried at the reference configuration, and how
//! they answer to a displacement from there.
//!
//! The reference is the last equilibrium. Contacts that had an overlap there carry shear up to
//! the limit Q_max = μP⁰; new ones carry none until the next reference, and those that open keep
//! theirs until then (T 3.3.2: stiffness and limit are those of the unperturbed contact).

mod batch;
mod commit;
mod held;
mod slope;
mod turn;

use rayon::prelude::*;

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::heap;
use crate::model::Model;
use crate::pack::Layer;
use crate::relax::balance::{Balance, Configuration};
use crate::scene::Law;
use crate::state::{Remembered, State};

pub use commit::Changes;
pub use held::Held;
pub(super) use held::Pose;
use held::{Midway, Pair, wall_normal};
pub(super) use slope::Slope;

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
}

/// What one contact does to the balance.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pull {
    /// Q on grain i \[N\].
    pub(super) force: Vec3,
    /// n̂ × Q \[N\].
    pub(super) lever: Vec3,
    /// Couple on grain i \[N m\].
    pub(super) couple: Vec3,
    /// Of shear and torsion \[J\].
    pub(super) potential: f64,
    pub(super) arm: [f64; 2],
}

/// All contacts at the reference configuration; empty for a frictionless specimen.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    /// Sorted by (first, second).
    pub contacts: Vec<Held>,
    /// Layers of all contacts, for partial slip.
    layers: Vec<Layer>,
    /// Rotations at the reference \[rad\], shape (n).
    rotation: Vec<Vec3>,
    /// Whether the specimen has friction.
    pub active: bool,
    /// Whether contacts that stuck in the last increment are taken to stick whatever they carry.
    pub(super) sticks: bool,
}

impl Reference {
    /// Takes the equilibrium `state` as reference. With `lenient` a contact may carry what it
    /// remembers although that is beyond the limit now.
    pub fn begin(&mut self, model: &Model, state: &State, near: &Neighbours, lenient: bool) {
        let Some(friction) = &model.friction else { return };
        self.active = true;
        self.rotation.clone_from(&state.rotation);
        self.contacts.clear();
        self.layers.clear();
        let bounds = state.bounds(model);
        let mut memory = state.memory.contacts.iter().peekable();
        let mut passed = 0;
        let mut push = |first: usize, second: Other, branch: Vec3, normal: Vec3, overlap: f64| {
            if overlap <= 0.0 {
                return;
            }
            let key = (first as u32, second);
            while let Some(other) = memory.next_if(|m| m.key() < key) {
                passed += other.layers as usize;
            }
            let pair = Pair::of(model, friction, key.0, second);
            if pair.friction == 0.0 {
                return;
            }
            let nothing = Remembered {
                first: key.0,
                second,
                shear: Vec3::zeros(),
                torsion: 0.0,
                slides: false,
                layers: 0,
            };
            let carried = memory.next_if(|m| m.key() == key).copied().unwrap_or(nothing);
            let layers = &state.memory.layers[passed..passed + carried.layers as usize];
            passed += layers.len();
            let mut held = Held::new(&pair, carried, [branch, normal], overlap, friction.torsion);
            if friction.law == Law::MindlinDeresiewicz {
                held.take_layers(layers, &mut self.layers);
            }
            if lenient {
                held.be_lenient();
            }
            self.contacts.push(held);
        };
        for (i, at) in state.position.iter().enumerate() {
            for k in near.row(i) {
                let j = near.second[k];
                let branch = at - state.position[j as usize];
                let reach = model.radius[i] + model.radius[j as usize];
                let distance = branch.norm();
                push(i, Other::Grain(j), branch, branch / distance, reach - distance);
            }
            for &w in near.walls_near(i) {
                let gap = wall_gap(at, usize::from(w), &bounds);
                push(i, Other::Wall(w), *at, wall_normal(w), model.radius[i] - gap);
            }
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.contacts) + heap::bytes(&self.layers) + heap::bytes(&self.rotation)
    }

    /// Whether the pair carried load at the reference by more than `least` \[m\] of overlap.
    #[must_use]
    pub fn holds(&self, first: u32, second: Other, least: f64) -> bool {
        let key = match second {
            Other::Grain(j) if j < first => (j, Other::Grain(first)),
            _ => (first, second),
        };
        self.contacts
            .binary_search_by_key(&key, |held| (held.first, held.second))
            .is_ok_and(|k| self.contacts[k].reference_overlap > least)
    }

    /// Adds the tangential forces in the configuration `at` to `balance`.
    pub(super) fn evaluate(&self, balance: &mut Balance, at: &Configuration<'_>) {
        let Some(friction) = &at.model.friction else { return };
        let Configuration { model, position, rotation, bounds, .. } = *at;
        let pose = Pose { model, position, rotation, bounds };
        balance.tractions.resize(self.contacts.len(), Traction::default());
        balance.pulls.resize(BATCH, Pull::default());
        balance.moment.clear();
        balance.moment.resize(at.position.len(), Vec3::zeros());
        balance.shear_potential = 0.0;
        let Balance { tractions, pulls, gradient, moment, shear_potential, .. } = balance;
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
                let i = held.first as usize;
                gradient[i] -= pull.force;
                moment[i] += pull.lever * pull.arm[0] - pull.couple;
                if let Other::Grain(j) = held.second {
                    let j = j as usize;
                    gradient[j] += pull.force;
                    moment[j] += pull.lever * pull.arm[1] + pull.couple;
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
        match self.sticks && !held.carried.slides {
            true => held.stick(&motion),
            false => held.answer(&motion, law, &self.layers),
        }
        .parts()
    }

    /// Renews the limit with the overlaps of `state` and the stiffness with their mean with those
    /// of the reference; displacements still count from there.
    pub fn renew(&mut self, model: &Model, state: &State) {
        let Some(friction) = &model.friction else { return };
        for held in &mut self.contacts {
            let overlap = held.present_overlap(model, state);
            let pair = Pair::of(model, friction, held.first, held.second);
            held.freeze(&pair, overlap, Midway::Yes, friction.torsion);
        }
    }

    /// Elastic energy that the contacts carried at the reference \[J\].
    #[must_use]
    pub fn carried_energy(&self) -> f64 {
        self.contacts.iter().map(|held| held.carried_energy).sum()
    }
}

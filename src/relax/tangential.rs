//! Shear and torsion of the contacts: what they carried at the reference configuration, and how
//! they answer to a displacement from there.
//!
//! The reference is the last equilibrium. Contacts that had an overlap there carry shear up to
//! the limit Q_max = μP⁰; new ones carry none until the next reference, and those that open keep
//! theirs until then (T 3.3.2: stiffness and limit are those of the unperturbed contact).

use rayon::prelude::*;

use crate::Vec3;
use crate::contact::coulomb::{self, Shear};
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::contact::partial_slip::{self, Step};
use crate::contact::{Other, hertz, mindlin};
use crate::model::{Friction, Model};
use crate::pack::Layer;
use crate::relax::balance::{Balance, Configuration};
use crate::scene::Law;
use crate::state::{Ledger, Memory, Remembered, State};
use crate::wall::{self, Bounds};

/// Contacts that one task answers for; the bits do not depend on it.
const CHUNK: usize = 512;

/// A contact at the reference configuration.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// Grain i.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// r_ij⁰ \[m\]; at a wall the centre of the grain.
    branch: Vec3,
    /// n̂⁰.
    normal: Vec3,
    /// h⁰ \[m\], or the later overlap that stiffness and limit were renewed with.
    pub overlap: f64,
    /// h⁰ \[m\].
    pub reference_overlap: f64,
    /// What the contact carried, and the elastic energy of that \[J\].
    carried: Remembered,
    carried_energy: f64,
    /// k_s \[N/m\] (T 3.5a).
    pub stiffness: f64,
    /// Q_max = μP \[N\].
    limit: f64,
    /// k_t \[N m\] (T 3.9a); zero without torsion.
    torsion_stiffness: f64,
    /// Largest couple \[N m\] (T 3.3.3).
    torsion_limit: f64,
    /// For partial slip: the contact, the overlap its layers end at and the first of them.
    partial: partial_slip::Contact,
    before: f64,
    first_layer: u32,
}

/// Where a contact is and how it moved since the reference.
struct Motion {
    normal: Vec3,
    arm: [f64; 2],
    /// u_s \[m\] (T 3.2).
    slid: Vec3,
    /// Ω_t \[rad\] (T 3.7).
    twist: f64,
}

/// Where the grains are.
struct Pose<'a> {
    model: &'a Model,
    position: &'a [Vec3],
    rotation: &'a [Vec3],
    bounds: &'a Bounds,
}

/// Answer of one contact in the current configuration.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traction {
    /// Whether both bodies take part in the balance; if not, all else is zero.
    pub live: bool,
    /// Unit normal towards grain i.
    pub normal: Vec3,
    /// Distance of the contact from the centres of grain i and of the other \[m\] (T 3.3).
    pub arm: [f64; 2],
    /// Answer to the shear.
    pub shear: Shear,
    /// Answer to the torsion.
    pub torsion: coulomb::Torsion,
}

impl Traction {
    /// Whether the contact slides or twists freely.
    #[must_use]
    pub fn slides(&self) -> bool {
        self.shear.slides
    }

    fn potential(&self) -> f64 {
        self.shear.potential + self.torsion.potential
    }
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
}

/// Constants of a pair of bodies in shear.
struct Pair {
    friction: f64,
    effective_radius: f64,
    modulus: f64,
    compliance: f64,
    shear_compliance: f64,
    torsion_compliance: f64,
}

impl Pair {
    fn of(model: &Model, friction: &Friction, first: u32, second: Other) -> Self {
        let i = first as usize;
        let (effective_radius, compliance, shear, torsion) = match second {
            Other::Grain(j) => {
                let j = j as usize;
                (
                    hertz::effective_radius(model.radius[i], model.radius[j]),
                    model.compliance[j],
                    friction.shear_compliance[j],
                    friction.torsion_compliance[j],
                )
            }
            Other::Wall(_) => (
                model.radius[i],
                model.wall_compliance,
                friction.wall_shear_compliance,
                friction.wall_torsion_compliance,
            ),
        };
        Self {
            friction: friction.between(first, second),
            effective_radius,
            modulus: hertz::modulus(effective_radius, model.compliance[i] + compliance),
            compliance: model.compliance[i] + compliance,
            shear_compliance: friction.shear_compliance[i] + shear,
            torsion_compliance: friction.torsion_compliance[i] + torsion,
        }
    }

    fn partial(&self) -> partial_slip::Contact {
        let ratio = partial_slip::stiffness_ratio(self.compliance, self.shear_compliance);
        partial_slip::Contact { modulus: self.modulus, ratio, friction: self.friction }
    }
}

/// The inward normal of wall `w`.
fn wall_normal(w: u8) -> Vec3 {
    let mut normal = Vec3::zeros();
    normal[wall::axis(usize::from(w))] = wall::inward(usize::from(w));
    normal
}

impl Held {
    /// Freezes stiffness and limit at `overlap`.
    fn freeze(&mut self, pair: &Pair, overlap: f64, torsion: bool) {
        let overlap = overlap.max(0.0);
        let radius = mindlin::contact_radius(pair.effective_radius, overlap);
        let force = hertz::force(pair.modulus, overlap);
        self.overlap = overlap;
        self.stiffness = mindlin::shear_stiffness(radius, pair.shear_compliance);
        // An infinite coefficient at an open contact is no limit of zero times infinity.
        self.limit = if force > 0.0 { pair.friction * force } else { 0.0 };
        if torsion {
            self.torsion_stiffness = mindlin::torsion_stiffness(radius, pair.torsion_compliance);
            self.torsion_limit = mindlin::torsion_limit(radius, self.limit);
        }
    }

    /// How the contact moved, for the rotations `rotation` at the reference.
    fn motion(&self, at: &Pose<'_>, rotation: &[Vec3]) -> Motion {
        let i = self.first as usize;
        let turned = |k: usize| at.rotation[k] - rotation[k];
        let xi = at.position[i];
        let (normal, arm, moved, sweep, twist) = match self.second {
            Other::Grain(j) => {
                let j = j as usize;
                let branch = xi - at.position[j];
                let distance = branch.norm();
                let normal = branch / distance;
                let (ri, rj) = (at.model.radius[i], at.model.radius[j]);
                // Of the current disc (T 2.16, 3.3a): a frozen one leaves a spurious couple.
                let arm_i = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
                let arm = [arm_i, distance - arm_i];
                let (wi, wj) = (turned(i), turned(j));
                let sweep = wi * arm[0] + wj * arm[1];
                (normal, arm, branch - self.branch, sweep, (wi - wj).dot(&normal))
            }
            Other::Wall(w) => {
                let normal = wall_normal(w);
                let arm = wall_gap(&xi, usize::from(w), at.bounds); // (3.3b)
                let wi = turned(i);
                (normal, [arm, 0.0], xi - self.branch, wi * arm, wi.dot(&normal))
            }
        };
        // (3.2): Ω × R with R = -n̂ arm.
        let slid = moved - normal * normal.dot(&moved) + normal.cross(&sweep);
        Motion { normal, arm, slid, twist }
    }

    /// Answer to `motion` by `law`.
    fn answer(&self, motion: &Motion, law: Law, layers: &[Layer]) -> Traction {
        let Motion { normal, arm, slid, twist } = *motion;
        let carried = || turn_into_plane(&self.carried.shear, &normal);
        let shear = match law {
            // Renewed while it was open.
            _ if self.stiffness == 0.0 => Shear::default(),
            Law::ReturnMap => coulomb::return_map(&carried(), &slid, self.stiffness, self.limit),
            Law::Secant => coulomb::secant(&carried(), &slid, self.stiffness, self.limit),
            Law::MindlinDeresiewicz => {
                let turn = Turn::between(&self.normal, &normal);
                let answer = self.partial.respond(self.layers(layers), &self.step(&slid, &turn));
                Shear {
                    force: turn.forth(&answer.shear),
                    across: answer.across,
                    along: answer.along,
                    direction: turn.forth(&answer.direction),
                    slides: answer.sliding,
                    ..Shear::default()
                }
            }
        };
        let torsion = coulomb::torsion(
            self.carried.torsion,
            twist,
            self.torsion_stiffness,
            self.torsion_limit,
        );
        Traction { live: true, normal, arm, shear, torsion }
    }

    /// The layers of this contact among those of all.
    fn layers<'a>(&self, layers: &'a [Layer]) -> &'a [Layer] {
        &layers[self.first_layer as usize..][..self.carried.layers as usize]
    }

    /// The step of partial slip that `slid` in the turned plane amounts to in the reference plane.
    fn step(&self, slid: &Vec3, turn: &Turn) -> Step {
        Step { before: self.before, overlap: self.overlap, displacement: turn.back(slid) }
    }
}

/// The smallest rotation that takes one unit vector into another.
struct Turn {
    axis: Vec3,
    cosine: f64,
}

impl Turn {
    fn between(from: &Vec3, to: &Vec3) -> Self {
        Self { axis: from.cross(to), cosine: from.dot(to) }
    }

    fn forth(&self, v: &Vec3) -> Vec3 {
        let first = self.axis.cross(v);
        // Contacts do not turn over within an increment, so that 1 + cosine is not near zero.
        v + first + self.axis.cross(&first) / (1.0 + self.cosine)
    }

    fn back(&self, v: &Vec3) -> Vec3 {
        Self { axis: -self.axis, cosine: self.cosine }.forth(v)
    }
}

/// Q⁰ᵖ: a force turned into the plane across `normal` (T 3.3.2).
fn turn_into_plane(force: &Vec3, normal: &Vec3) -> Vec3 {
    let size2 = force.norm_squared();
    if size2 == 0.0 {
        return Vec3::zeros();
    }
    let projected = force - normal * normal.dot(force);
    let flat2 = projected.norm_squared();
    if flat2 == 0.0 { projected } else { projected * (size2 / flat2).sqrt() }
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
            let mut held = Held {
                first: key.0,
                second,
                branch,
                normal,
                overlap,
                reference_overlap: overlap,
                carried,
                carried_energy: 0.0,
                stiffness: 0.0,
                limit: 0.0,
                torsion_stiffness: 0.0,
                torsion_limit: 0.0,
                partial: pair.partial(),
                before: overlap,
                first_layer: self.layers.len() as u32,
            };
            held.freeze(&pair, overlap, friction.torsion);
            held.carried_energy = held.energy(&carried.shear, carried.torsion);
            let layers = &state.memory.layers[passed..passed + carried.layers as usize];
            passed += layers.len();
            if friction.law == Law::MindlinDeresiewicz {
                match layers.last() {
                    Some(last) => {
                        self.layers.extend_from_slice(layers);
                        held.before = last.reach;
                    }
                    // New, or loaded under another law: one ring for all.
                    None => {
                        let share = match held.limit.is_finite() && held.limit > 0.0 {
                            true => carried.shear / held.limit.max(carried.shear.norm()),
                            false => Vec3::zeros(),
                        };
                        self.layers.push(Layer { reach: overlap, ratio: share.into() });
                        held.carried.layers = 1;
                    }
                }
                held.carried_energy = held.partial.stored(held.layers(&self.layers), held.before)
                    + held.twist_energy(carried.torsion);
                if lenient {
                    held.overlap = held.before;
                }
            }
            if lenient {
                held.limit = held.limit.max(carried.shear.norm());
                held.torsion_limit = held.torsion_limit.max(carried.torsion.abs());
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
        balance.tractions.par_chunks_mut(CHUNK).zip(self.contacts.par_chunks(CHUNK)).for_each(
            |(tractions, contacts)| {
                for (traction, held) in tractions.iter_mut().zip(contacts) {
                    let other = match held.second {
                        Other::Grain(j) => at.carries[j as usize],
                        Other::Wall(_) => true,
                    };
                    *traction = match other && at.carries[held.first as usize] {
                        true => {
                            let motion = held.motion(&pose, &self.rotation);
                            held.answer(&motion, friction.law, &self.layers)
                        }
                        false => Traction::default(),
                    };
                }
            },
        );
        balance.moment.clear();
        balance.moment.resize(at.position.len(), Vec3::zeros());
        balance.shear_potential = 0.0;
        for (held, traction) in self.contacts.iter().zip(&balance.tractions) {
            if !traction.live {
                continue;
            }
            balance.shear_potential += traction.potential();
            let i = held.first as usize;
            let force = traction.shear.force;
            let lever = traction.normal.cross(&force);
            let couple = traction.normal * traction.torsion.couple;
            balance.gradient[i] -= force;
            balance.moment[i] += (lever * traction.arm[0] - couple) / at.model.radius[i];
            if let Other::Grain(j) = held.second {
                let j = j as usize;
                balance.gradient[j] += force;
                balance.moment[j] += (lever * traction.arm[1] + couple) / at.model.radius[j];
            }
        }
    }

    /// Renews stiffness and limit with the overlaps of `state`; the displacements still count
    /// from the reference.
    pub fn renew(&mut self, model: &Model, state: &State) {
        let Some(friction) = &model.friction else { return };
        for held in &mut self.contacts {
            let overlap = current_overlap(model, state, held);
            let pair = Pair::of(model, friction, held.first, held.second);
            held.freeze(&pair, overlap, friction.torsion);
        }
    }

    /// Writes what the contacts carry in `balance`, the one of `state`, into its memory and
    /// ledger. Contacts that opened lose their load, new ones have none.
    pub fn commit(
        &self,
        model: &Model,
        state: &mut State,
        balance: &Balance,
        near: &Neighbours,
        memory: &mut Memory,
    ) -> Changes {
        let Some(friction) = &model.friction else { return Changes::default() };
        memory.clear();
        let formed = self.formed(model, friction, state, near);
        let mut changes = Changes { formed, ..Changes::default() };
        let bounds = state.bounds(model);
        let State { position, rotation, .. } = &*state;
        let pose = Pose { model, position, rotation, bounds: &bounds };
        let mut ledger = state.friction;
        ledger.stored = 0.0;
        for (held, traction) in self.contacts.iter().zip(&balance.tractions) {
            let (shear, torsion) = (traction.shear.force, traction.torsion.couple);
            let overlap = current_overlap(model, state, held);
            if !traction.live || held.stiffness == 0.0 || overlap <= 0.0 {
                changes.opened += 1;
                changes.excess = changes.excess.max(shear.norm());
                ledger.renewal += held.carried_energy;
                continue;
            }
            let mut now = *held;
            let pair = Pair::of(model, friction, held.first, held.second);
            now.freeze(&pair, overlap, friction.torsion);
            let excess = match traction.shear.slides {
                true => (shear.norm() - now.limit).abs(),
                false => shear.norm() - now.limit,
            };
            changes.excess = changes.excess.max(excess);
            let layers = memory.layers.len();
            let change = match friction.law {
                Law::MindlinDeresiewicz => {
                    let motion = held.motion(&pose, &self.rotation);
                    held.slip(&now, &motion, torsion, &self.layers, &mut memory.layers)
                }
                Law::ReturnMap | Law::Secant => held.stick_or_slide(&now, &shear, torsion),
            };
            ledger.slip += traction.shear.dissipated + traction.torsion.dissipated;
            ledger.slip += change.slip;
            ledger.renewal += change.renewal;
            ledger.stored += change.stored;
            memory.contacts.push(Remembered {
                shear,
                torsion,
                slides: traction.shear.slides,
                layers: (memory.layers.len() - layers) as u32,
                ..held.carried
            });
        }
        state.friction = ledger;
        std::mem::swap(&mut state.memory, memory);
        changes
    }

    /// Elastic energy that the contacts carried at the reference \[J\].
    #[must_use]
    pub fn carried_energy(&self) -> f64 {
        self.contacts.iter().map(|held| held.carried_energy).sum()
    }

    /// How many contacts that could slip touch in `state` but not at the reference.
    fn formed(&self, model: &Model, friction: &Friction, state: &State, near: &Neighbours) -> u32 {
        let bounds = state.bounds(model);
        let mut held = self.contacts.iter().map(|held| (held.first, held.second)).peekable();
        let mut formed = 0;
        let mut count = |first: usize, second: Other| {
            let key = (first as u32, second);
            while held.next_if(|held| *held < key).is_some() {}
            let new = held.next_if_eq(&key).is_none();
            formed += u32::from(new && Pair::of(model, friction, key.0, second).friction > 0.0);
        };
        for (i, at) in state.position.iter().enumerate().filter(|(i, _)| state.carries[*i]) {
            for &j in &near.second[near.row(i)] {
                let reach = model.radius[i] + model.radius[j as usize];
                let apart = (at - state.position[j as usize]).norm_squared();
                if state.carries[j as usize] && apart < reach * reach {
                    count(i, Other::Grain(j));
                }
            }
            for &w in near.walls_near(i) {
                if wall_gap(at, usize::from(w), &bounds) < model.radius[i] {
                    count(i, Other::Wall(w));
                }
            }
        }
        formed
    }
}

/// What an increment did to the contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Changes {
    /// Frictional contacts that opened and lost their load.
    pub opened: u32,
    /// Contacts that touch now and had no shear yet.
    pub formed: u32,
    /// Largest part of a tangential force that the limit of the present normal force would change
    /// \[N\]: the error of freezing the limit at the reference.
    pub excess: f64,
}

impl Held {
    /// Elastic energy of the loads `shear` and `torsion` at this stiffness \[J\].
    fn energy(&self, shear: &Vec3, torsion: f64) -> f64 {
        0.5 * shear.norm_squared() / self.stiffness + self.twist_energy(torsion)
    }

    fn twist_energy(&self, torsion: f64) -> f64 {
        match self.torsion_stiffness > 0.0 {
            true => 0.5 * torsion * torsion / self.torsion_stiffness,
            false => 0.0,
        }
    }

    /// Energies of an increment of a stick-or-slide law at whose end the contact is as `now`.
    fn stick_or_slide(&self, now: &Self, shear: &Vec3, torsion: f64) -> Ledger {
        let before = self.energy(&self.carried.shear, self.carried.torsion);
        let stored = now.energy(shear, torsion);
        Ledger {
            stored,
            slip: self.shortening(),
            renewal: self.carried_energy - before + self.energy(shear, torsion) - stored,
        }
    }

    /// Energies of an increment of partial slip; adds the layers at its end to `after`, turned
    /// into the present plane.
    fn slip(
        &self,
        now: &Self,
        motion: &Motion,
        torsion: f64,
        layers: &[Layer],
        after: &mut Vec<Layer>,
    ) -> Ledger {
        let turn = Turn::between(&self.normal, &motion.normal);
        let step = self.step(&motion.slid, &turn);
        let before = self.layers(layers);
        let mut own = before.to_vec();
        self.partial.commit(&mut own, &step);
        let twisted = now.twist_energy(torsion);
        let ledger = Ledger {
            stored: self.partial.stored(&own, self.overlap) + twisted,
            slip: self.partial.dissipated(before, &step),
            renewal: self.twist_energy(torsion) - twisted,
        };
        after.extend(own.iter().map(|layer| {
            let ratio = turn.forth(&Vec3::from(layer.ratio)).into();
            Layer { ratio, ..*layer }
        }));
        ledger
    }

    /// Energy lost because the limit fell below what the contact carried \[J\]: the slip from
    /// there to the limit.
    fn shortening(&self) -> f64 {
        let beyond = |carried: f64, limit: f64, stiffness: f64| {
            let excess = (carried - limit).max(0.0);
            if excess > 0.0 { 0.5 * excess * excess / stiffness } else { 0.0 }
        };
        beyond(self.carried.shear.norm(), self.limit, self.stiffness)
            + beyond(self.carried.torsion.abs(), self.torsion_limit, self.torsion_stiffness)
    }
}

/// h \[m\] of a held contact in `state`, negative when it is open.
fn current_overlap(model: &Model, state: &State, held: &Held) -> f64 {
    let i = held.first as usize;
    match held.second {
        Other::Grain(j) => {
            let j = j as usize;
            let distance = (state.position[i] - state.position[j]).norm();
            model.radius[i] + model.radius[j] - distance
        }
        Other::Wall(w) => {
            let gap = wall_gap(&state.position[i], usize::from(w), &state.bounds(model));
            model.radius[i] - gap
        }
    }
}

//! The end of an increment: what the contacts remember, and where the energy went.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::{Friction, Model};
use crate::pack::Layer;
use crate::relax::balance::Balance;
use crate::relax::tangential::Reference;
use crate::relax::tangential::held::{Held, Midway, Motion, Pair, Pose};
use crate::relax::tangential::turn::Turn;
use crate::scene::Law;
use crate::state::{Ledger, Memory, Remembered, State};

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

impl Changes {
    /// Counts those of `next` as well.
    pub(crate) fn add(&mut self, next: Self) {
        self.opened += next.opened;
        self.formed += next.formed;
        self.excess = self.excess.max(next.excess);
    }
}

impl Reference {
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
        let mut ledger = state.friction;
        let State { position, rotation, bonds, .. } = state;
        let pose = Pose { model, position, rotation, bounds: &bounds };
        ledger.stored = 0.0;
        for (held, traction) in self.contacts.iter().zip(&balance.tractions) {
            let motion = held.motion(&pose, &self.rotation);
            if let Some(bonded) = self.bond_of(held) {
                let (shear, torsion) = self.bond_load(held, &pose);
                ledger.stored += self.commit_bond(held, bonded, (&shear, torsion), &pose, bonds);
                let nothing = Remembered { slides: false, layers: 0, ..held.carried };
                memory.contacts.push(Remembered { shear, torsion, ..nothing });
                continue;
            }
            let answer = held.answer(&motion, friction.law, &self.layers);
            let (shear, torsion) = match traction.live {
                true => (answer.shear.force, answer.torsion.couple),
                false => (Vec3::zeros(), 0.0),
            };
            let overlap = held.overlap_at(&pose);
            if !traction.live || held.is_open() || overlap <= 0.0 {
                changes.opened += 1;
                changes.excess = changes.excess.max(shear.norm());
                ledger.renewal += held.carried_energy;
                continue;
            }
            let mut now = *held;
            let pair = Pair::of(model, friction, held.first, held.second);
            now.freeze(&pair, overlap, Midway::No, friction.torsion);
            let excess = match traction.slides {
                true => (shear.norm() - now.limit).abs(),
                false => shear.norm() - now.limit,
            };
            changes.excess = changes.excess.max(excess);
            let layers = memory.layers.len();
            let change = match friction.law {
                Law::MindlinDeresiewicz => {
                    held.slip(&now, &motion, torsion, &self.layers, &mut memory.layers)
                }
                Law::ReturnMap | Law::Secant => held.stick_or_slide(&now, &shear, torsion),
            };
            ledger.slip += answer.shear.dissipated + answer.torsion.dissipated;
            ledger.slip += change.slip;
            ledger.renewal += change.renewal;
            ledger.stored += change.stored;
            memory.contacts.push(Remembered {
                shear,
                torsion,
                slides: traction.slides,
                layers: (memory.layers.len() - layers) as u32,
                ..held.carried
            });
        }
        state.friction = ledger;
        std::mem::swap(&mut state.memory, memory);
        changes
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
            for k in near.row(i) {
                let (j, reach) = (near.second[k], near.reach(model, i, k).max(0.0));
                let apart = (at - state.position[j as usize]).norm_squared();
                if state.carries[j as usize] && apart < reach * reach {
                    count(i, Other::Grain(j));
                }
            }
            for (w, reach) in near.walls_near(model, i) {
                if wall_gap(at, usize::from(w), &bounds) < reach {
                    count(i, Other::Wall(w));
                }
            }
        }
        formed
    }
}

impl Held {
    /// Elastic energy of the loads `shear` and `torsion` at this stiffness \[J\].
    pub(super) fn energy(&self, shear: &Vec3, torsion: f64) -> f64 {
        0.5 * shear.norm_squared() / self.stiffness + self.twist_energy(torsion)
    }

    pub(super) fn twist_energy(&self, torsion: f64) -> f64 {
        match self.torsion_stiffness > 0.0 {
            true => 0.5 * torsion * torsion / self.torsion_stiffness,
            false => 0.0,
        }
    }

    /// Energies of an increment of a stick-or-slide law at whose end the contact is as `now`.
    pub(super) fn stick_or_slide(&self, now: &Self, shear: &Vec3, torsion: f64) -> Ledger {
        let before = self.energy(&self.carried.shear, self.carried.torsion);
        let stored = now.energy(shear, torsion);
        Ledger {
            stored,
            slip: self.shortening(),
            renewal: self.carried_energy - before + self.energy(shear, torsion) - stored,
            broken: 0.0,
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
            broken: 0.0,
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

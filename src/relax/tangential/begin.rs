//! Taking a state as the reference.

use std::iter::Peekable;
use std::slice::Iter;

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::{Friction, Model};
use crate::pack::Layer;
use crate::relax::tangential::Reference;
use crate::relax::tangential::held::{Held, Pair};
use crate::scene::Law;
use crate::state::{Bond, Remembered, State};
use crate::wall::Room;

/// A pair of bodies that press on each other.
struct Pressing {
    first: u32,
    second: Other,
    branch: Vec3,
    normal: Vec3,
    overlap: f64,
    unstressed: f64,
}

/// The lists that are gone through together, in the order of the bodies.
struct Begin<'a> {
    model: &'a Model,
    friction: &'a Friction,
    state: &'a State,
    bounds: Room,
    lenient: bool,
    memory: Peekable<Iter<'a, Remembered>>,
    /// Layers of the contacts that `memory` is past.
    passed: usize,
    bonds: Peekable<std::iter::Enumerate<Iter<'a, Bond>>>,
}

impl Reference {
    /// Takes the equilibrium `state` as reference. With `lenient` a contact may carry what it
    /// remembers although that is beyond the limit now.
    pub fn begin(&mut self, model: &Model, state: &State, near: &Neighbours, lenient: bool) {
        let Some(friction) = &model.friction else { return };
        // Smooth grains need not turn before cement is deposited between them.
        self.smooth = friction.is_smooth();
        self.active = !self.smooth || !state.bonds.is_empty();
        self.contacts.clear();
        self.layers.clear();
        self.bonds.clear();
        if !self.active {
            return;
        }
        self.rotation.clone_from(&state.rotation);
        let bounds = state.bounds(model);
        let memory = state.memory.contacts.iter().peekable();
        let bonds = state.bonds.iter().enumerate().peekable();
        let mut begin = Begin { model, friction, state, bounds, lenient, memory, passed: 0, bonds };
        for (i, at) in state.position.iter().enumerate() {
            let first = i as u32;
            for k in near.row(i) {
                let j = near.second[k];
                let branch = at - state.position[j as usize];
                let (distance, reach) = (branch.norm(), near.reach(model, i, k));
                if reach - distance > 0.0 {
                    let radii = model.radius[i] + model.radius[j as usize];
                    begin.press(
                        self,
                        &Pressing {
                            first,
                            second: Other::Grain(j),
                            branch,
                            normal: branch / distance,
                            overlap: reach - distance,
                            unstressed: radii - reach,
                        },
                    );
                }
            }
            for (w, reach) in near.walls_near(model, i) {
                let gap = wall_gap(at, usize::from(w), &bounds);
                if reach - gap > 0.0 {
                    begin.press(
                        self,
                        &Pressing {
                            first,
                            second: Other::Wall(w),
                            branch: *at,
                            normal: bounds.normal(at, usize::from(w)),
                            overlap: reach - gap,
                            unstressed: model.radius[i] - reach,
                        },
                    );
                }
            }
        }
        begin.bonds_before(self, None);
    }
}

impl Begin<'_> {
    /// Takes the bonds of the bodies before `key`.
    fn bonds_before(&mut self, to: &mut Reference, key: Option<(u32, Other)>) {
        let before = |bond: &Bond| key.is_none_or(|key| bond.key() < key);
        while let Some((place, bond)) = self.bonds.next_if(|(_, bond)| before(bond)) {
            self.bond(to, place, bond);
        }
    }

    fn bond(&mut self, to: &mut Reference, place: usize, bond: &Bond) {
        let Self { model, state, bounds, .. } = *self;
        let (true, Some(cement)) = (bond.holds(), &model.cement) else { return };
        let (carried, _) = self.carried(bond.key());
        let carried = Remembered { layers: 0, ..carried };
        let at = (place, bond);
        let made = Held::bonded(model, cement, at, carried, &state.position, &bounds);
        if let Some((mut held, bonded)) = made {
            held.bond = to.bonds.len() as u32;
            to.bonds.push(bonded);
            to.contacts.push(held);
        }
    }

    /// What the contact of the bodies `key` remembers; those before it are passed.
    fn carried(&mut self, key: (u32, Other)) -> (Remembered, &[Layer]) {
        while let Some(other) = self.memory.next_if(|m| m.key() < key) {
            self.passed += other.layers as usize;
        }
        let nothing = Remembered {
            first: key.0,
            second: key.1,
            shear: Vec3::zeros(),
            torsion: 0.0,
            slides: false,
            layers: 0,
        };
        let carried = self.memory.next_if(|m| m.key() == key).copied().unwrap_or(nothing);
        let layers = &self.state.memory.layers[self.passed..][..carried.layers as usize];
        self.passed += layers.len();
        (carried, layers)
    }

    fn press(&mut self, to: &mut Reference, pressing: &Pressing) {
        let Pressing { first, second, branch, normal, overlap, unstressed } = *pressing;
        let key = (first, second);
        self.bonds_before(to, Some(key));
        if let Some((place, bond)) = self.bonds.next_if(|(_, bond)| bond.key() == key)
            && bond.holds()
        {
            return self.bond(to, place, bond);
        }
        let pair = Pair::of(self.model, self.friction, first, second);
        if pair.friction == 0.0 {
            return;
        }
        let (law, torsion, lenient) = (self.friction.law, self.friction.torsion, self.lenient);
        let (carried, layers) = self.carried(key);
        let overlaps = [overlap, unstressed];
        let mut held = Held::new(&pair, carried, [branch, normal], overlaps, torsion);
        if law == Law::MindlinDeresiewicz {
            held.take_layers(layers, &mut to.layers);
        }
        if lenient {
            held.be_lenient();
        }
        to.contacts.push(held);
    }
}

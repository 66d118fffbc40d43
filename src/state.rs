//! What a snapshot holds.

mod bond;

use crate::Vec3;
use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::pack::{self, History, Layer};
use crate::plane::boundary::SIDES;
use crate::wall::{self, Room};

pub use bond::{Bond, Condition};

/// The configuration of a specimen at an equilibrium, and the ledger that led there.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Centres of the grains \[m\], shape (n), in the solver's order.
    pub position: Vec<Vec3>,
    /// Sum of the rotation increments of each grain \[rad\], shape (n); empty without friction.
    pub rotation: Vec<Vec3>,
    /// What the contacts remember; empty without friction.
    pub memory: Memory,
    /// What was cemented, sorted by (first, second); empty without cement.
    pub bonds: Vec<Bond>,
    /// Whether a grain takes part in the balance of forces, shape (n); the others float.
    pub carries: Vec<bool>,
    /// Inward displacement of the walls since the start \[m\].
    pub displacement: [f64; wall::COUNT],
    /// The side that each disc sticks to, shape (n); empty where nothing is glued.
    pub glued: Vec<Option<u8>>,
    /// Shear γ by which a pack of discs and its side walls lean; 0 for spheres.
    pub tilt: f64,
    /// Pressure of the sides that are membranes \[Pa\], 0 for others.
    pub pressure: [f64; SIDES],
    /// Where the outlines, or surfaces, under them were on average at the start, out of the pack \[m\].
    pub outline: [f64; SIDES],
    /// Energies of the contacts' shear and torsion.
    pub friction: Ledger,
    /// Work of the walls since the start \[J\].
    pub wall_work: f64,
    /// Stored energy at the initial equilibrium \[J\].
    pub initial_energy: f64,
    /// What dissociation has done since the start.
    pub dissociated: Dissociated,
}

/// What dissociation of hydrate has done since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dissociated {
    /// Hydrate saturation that is lost.
    pub lost: f64,
    /// Excess pore pressure \[Pa\].
    pub pressure: f64,
    /// Part of the total stress that the pore pressure has taken over from the grains \[Pa\]: the sum
    /// of α_b Δp.
    pub borne: f64,
    /// Energy that changing the grains has brought into the pack \[J\]: negative where they shrank
    /// under load.
    pub work: f64,
}

/// Energies of shear and torsion \[J\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Elastic energy stored now.
    pub stored: f64,
    /// Lost by slip since the start.
    pub slip: f64,
    /// Lost since the start where the law forgets: contacts that opened under shear, and
    /// stiffnesses that were renewed under load. The latter can be a gain.
    pub renewal: f64,
    /// Lost since the start by bonds that broke: what they and the cement around them stored.
    pub broken: f64,
}

/// The loads that frictional contacts carry at an equilibrium.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// Sorted by (first, second).
    pub contacts: Vec<Remembered>,
    /// Layers of all contacts, one contact after the other.
    pub layers: Vec<Layer>,
}

/// The tangential load of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Remembered {
    /// Grain i.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// Q on grain i \[N\].
    pub shear: Vec3,
    /// Couple on grain i about the normal towards it \[N m\].
    pub torsion: f64,
    /// Whether the contact slid in the last increment.
    pub slides: bool,
    /// How many of the `layers` are this contact's.
    pub layers: u32,
}

impl Remembered {
    /// What the list is sorted by.
    #[must_use]
    pub fn key(&self) -> (u32, Other) {
        (self.first, self.second)
    }
}

impl Memory {
    /// Forgets everything.
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.layers.clear();
    }

    fn put(&self, take: &mut dyn FnMut(&[u8])) {
        take(&(self.contacts.len() as u64).to_le_bytes());
        for contact in &self.contacts {
            let Remembered { first, second, shear, torsion, slides, layers } = contact;
            put_bodies(*first, *second, take);
            numbers(shear.as_slice(), take);
            numbers(&[*torsion], take);
            take(&[u8::from(*slides)]);
            take(&layers.to_le_bytes());
        }
        take(&(self.layers.len() as u64).to_le_bytes());
        for layer in &self.layers {
            numbers(&[layer.reach], take);
            numbers(&layer.ratio, take);
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.contacts) + heap::bytes(&self.layers)
    }

    fn copy_from(&mut self, other: &Self) {
        self.contacts.clone_from(&other.contacts);
        self.layers.clone_from(&other.layers);
    }
}

impl State {
    /// The state that `model` was loaded with, without a history.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let turning = if model.friction.is_some() { model.len() } else { 0 };
        Self {
            position: model.grains.iter().map(|g| Vec3::from(g.position)).collect(),
            rotation: vec![Vec3::zeros(); turning],
            memory: Memory::default(),
            bonds: Vec::new(),
            carries: vec![true; model.len()],
            displacement: [0.0; wall::COUNT],
            glued: Vec::new(),
            tilt: 0.0,
            pressure: [0.0; SIDES],
            outline: [0.0; SIDES],
            friction: Ledger::default(),
            wall_work: 0.0,
            initial_energy: 0.0,
            dissociated: Dissociated::default(),
        }
    }

    /// Takes up the history of the pack that `model` was made of. Without friction there is
    /// nothing to take up.
    pub fn recall(&mut self, model: &Model, history: &History) {
        if model.friction.is_none() {
            return;
        }
        let place = inverse(&model.order);
        for (k, &grain) in model.order.iter().enumerate() {
            self.rotation[k] = Vec3::from(history.rotation[grain as usize]);
        }
        // A contact of two grains turns round where the solver's order does.
        let mut contacts: Vec<(Remembered, &[Layer], f64)> = history
            .contacts
            .iter()
            .map(|memory| {
                let first = place[memory.first as usize];
                let second = pack::body_of(memory.second)
                    .map_or_else(|| Other::Grain(place[memory.second as usize]), Other::Wall);
                let (first, second, sign) = match second {
                    Other::Grain(j) if j < first => (j, Other::Grain(first), -1.0),
                    _ => (first, second, 1.0),
                };
                let remembered = Remembered {
                    first,
                    second,
                    shear: Vec3::from(memory.shear) * sign,
                    torsion: memory.torsion,
                    slides: memory.sliding,
                    layers: memory.layers.len() as u32,
                };
                (remembered, memory.layers.as_slice(), sign)
            })
            .collect();
        contacts.sort_unstable_by_key(|(remembered, ..)| remembered.key());
        self.memory.clear();
        for (remembered, layers, sign) in contacts {
            self.memory.contacts.push(remembered);
            self.memory.layers.extend(layers.iter().map(|layer| layer.times(sign)));
        }
        if model.cement.is_some() {
            self.recall_bonds(model, &place, &history.bonds);
        }
    }

    fn recall_bonds(&mut self, model: &Model, place: &[u32], bonds: &[pack::BondMemory]) {
        self.bonds.clear();
        self.bonds.extend(bonds.iter().map(|memory| {
            let first = place[memory.first as usize];
            let second = pack::body_of(memory.second)
                .map_or_else(|| Other::Grain(place[memory.second as usize]), Other::Wall);
            match second {
                Other::Grain(j) if j < first => memory.bond(j, Other::Grain(first)),
                _ => memory.bond(first, second),
            }
        }));
        self.bonds.sort_unstable_by_key(Bond::key);
        let bounds = self.bounds(model);
        for bond in &mut self.bonds {
            bond.normal_force = bond.recalled(model, &self.position, &bounds);
        }
    }

    /// The history to be saved with the pack; `None` without friction.
    #[must_use]
    pub fn history(&self, model: &Model) -> Option<History> {
        model.friction.as_ref()?;
        let mut rotation = vec![[0.0; 3]; model.len()];
        for (k, &grain) in model.order.iter().enumerate() {
            rotation[grain as usize] = self.rotation[k].into();
        }
        let mut from = 0;
        let mut contacts: Vec<pack::ContactMemory> = Vec::new();
        for memory in &self.memory.contacts {
            let to = from + memory.layers as usize;
            let first = model.order[memory.first as usize];
            let second = match memory.second {
                Other::Grain(j) => model.order[j as usize],
                Other::Wall(w) => pack::wall_index(w),
            };
            let sign = if first < second { 1.0 } else { -1.0 };
            contacts.push(pack::ContactMemory {
                first: first.min(second),
                second: first.max(second),
                shear: (memory.shear * sign).into(),
                torsion: memory.torsion,
                sliding: memory.slides,
                layers: self.memory.layers[from..to]
                    .iter()
                    .map(|layer| layer.times(sign))
                    .collect(),
            });
            from = to;
        }
        contacts.sort_unstable_by_key(|memory| (memory.first, memory.second));
        let mut bonds: Vec<pack::BondMemory> =
            self.bonds.iter().map(|bond| pack::BondMemory::of(bond, &model.order)).collect();
        bonds.sort_unstable_by_key(|memory| (memory.first, memory.second));
        Some(History { rotation, contacts, bonds })
    }

    /// Memory that its lists hold \[bytes\].
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        heap::bytes(&self.position)
            + heap::bytes(&self.rotation)
            + heap::bytes(&self.carries)
            + heap::bytes(&self.bonds)
            + heap::bytes(&self.glued)
            + self.memory.heap_bytes()
    }

    /// Hands every number of the state to `take` as little-endian bytes, lists with their length
    /// in front: two states give the same bytes when they are the same to the bit.
    pub fn put(&self, take: &mut dyn FnMut(&[u8])) {
        let Self { position, rotation, memory, bonds, carries, .. } = self;
        let Self { displacement, friction, wall_work, initial_energy, .. } = self;
        for list in [position, rotation] {
            take(&(list.len() as u64).to_le_bytes());
            list.iter().for_each(|vector| numbers(vector.as_slice(), take));
        }
        memory.put(take);
        if !bonds.is_empty() {
            take(&(bonds.len() as u64).to_le_bytes());
            bonds.iter().for_each(|bond| bond.put(take));
            numbers(&[friction.broken], take);
        }
        carries.iter().for_each(|&carries| take(&[u8::from(carries)]));
        numbers(displacement, take);
        let Ledger { stored, slip, renewal, .. } = friction;
        numbers(&[*stored, *slip, *renewal, *wall_work, *initial_energy], take);
        // Last, and only where there is something, as in recordings made before there was hydrate.
        if self.tilt != 0.0 {
            numbers(&[self.tilt], take);
        }
        self.glued.iter().for_each(|side| take(&[side.map_or(u8::MAX, |side| side)]));
        if self.pressure != [0.0; SIDES] {
            numbers(&self.pressure, take);
            numbers(&self.outline, take);
        }
        if self.dissociated != Dissociated::default() {
            let Dissociated { lost, pressure, borne, work } = self.dissociated;
            numbers(&[lost, pressure, borne, work], take);
        }
    }

    /// The room between the walls now.
    #[must_use]
    pub fn bounds(&self, model: &Model) -> Room {
        model.bounds(&self.displacement)
    }

    /// Volume that the walls enclose now \[m³\].
    #[must_use]
    pub fn volume(&self, model: &Model) -> f64 {
        match &model.plane {
            None => self.bounds(model).volume(),
            Some(setup) => setup.cell.volume(&self.displacement),
        }
    }

    /// The room with the grains of the surfaces under membranes on spheres as a whole: as much larger as
    /// it was when they were put around the pack.
    #[must_use]
    pub fn hull(&self, model: &Model) -> Room {
        let Some(cell) = &model.cell else { return self.bounds(model) };
        let mut displacement = self.displacement;
        for side in (0..SIDES).filter(|&side| cell.is_membrane(side)) {
            displacement[side] -= cell.outermost(side) - self.outline[side];
        }
        model.bounds(&displacement)
    }

    /// Copies `other` into this state without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.position.copy_from_slice(&other.position);
        self.rotation.copy_from_slice(&other.rotation);
        self.memory.copy_from(&other.memory);
        self.bonds.clone_from(&other.bonds);
        self.carries.copy_from_slice(&other.carries);
        self.displacement = other.displacement;
        self.glued.clone_from(&other.glued);
        self.tilt = other.tilt;
        self.pressure = other.pressure;
        self.outline = other.outline;
        self.friction = other.friction;
        self.wall_work = other.wall_work;
        self.initial_energy = other.initial_energy;
        self.dissociated = other.dissociated;
    }
}

fn put_bodies(first: u32, second: Other, take: &mut dyn FnMut(&[u8])) {
    let (kind, number) = match second {
        Other::Grain(grain) => (0, grain),
        Other::Wall(wall) => (1, u32::from(wall)),
    };
    take(&first.to_le_bytes());
    take(&[kind]);
    take(&number.to_le_bytes());
}

fn numbers(numbers: &[f64], take: &mut dyn FnMut(&[u8])) {
    numbers.iter().for_each(|number| take(&number.to_le_bytes()));
}

/// Where each entry of a permutation stands.
fn inverse(order: &[u32]) -> Vec<u32> {
    let mut place = vec![0; order.len()];
    for (k, &grain) in order.iter().enumerate() {
        place[grain as usize] = k as u32;
    }
    place
}

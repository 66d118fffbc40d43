//! The load-carrying contacts of a state.

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::scene::Cement;
use crate::state::{Bond, Condition, State};
use crate::wall::{Facing, Room};

/// Contacts below this share of the mean normal force are not counted: rattlers hover around zero.
pub const FAINT: f64 = 1e-6;
/// A contact slides whose tangential force is within this share of μP (T 3.6.2: "determined by
/// the ratio between the tangential and normal contact forces").
pub const AT_LIMIT: f64 = 1e-3;

/// One contact.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Grain i, in the solver's order.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// Unit normal from the other body to grain i.
    pub normal: Vec3,
    /// P, with that of cement \[N\]: negative in tension.
    pub force: f64,
    /// Mutual approach of the bodies \[m\], negative where cement bridges a gap.
    pub overlap: f64,
    /// Q on grain i \[N\]; zero without friction.
    pub shear: Vec3,
    /// Couple on grain i along `normal` \[N m\].
    pub torsion: f64,
    /// Whether |Q| is at μP, of the present P.
    pub slides: bool,
    /// Whether it slid in the last increment.
    pub slipped: bool,
    /// From the other grain's centre, or the wall's plane, to the centre of grain i \[m\].
    pub distance: f64,
    /// What became of its cement; `None` where there never was any.
    pub cement: Option<Condition>,
}

/// Contacts of one state with the mean of their forces.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// All with a positive overlap or cement between bodies that take part in the balance.
    pub list: Vec<Contact>,
    /// Contacts whose cement broke and that are open.
    pub cracks: Vec<Contact>,
    /// Mean magnitude of the normal forces of `list` \[N\].
    pub mean_force: f64,
    /// Mean magnitude of the tangential forces of `list` \[N\].
    pub mean_shear: f64,
}

impl Contacts {
    /// Lists the contacts of `state`; the neighbour list must hold them.
    #[must_use]
    pub fn of(model: &Model, state: &State, neighbours: &Neighbours) -> Self {
        let bounds = state.bounds(model);
        let mut list = Vec::with_capacity(neighbours.second.len());
        for i in (0..model.len()).filter(|&i| state.carries[i]) {
            let at = state.position[i];
            for k in neighbours.row(i) {
                let j = neighbours.second[k] as usize;
                let branch = at - state.position[j];
                let distance = branch.norm();
                let pressed = neighbours.reach(model, i, k) - distance;
                if pressed > 0.0 && state.carries[j] {
                    list.push(Contact {
                        first: i as u32,
                        second: Other::Grain(j as u32),
                        normal: branch / distance,
                        force: hertz::force(neighbours.modulus[k], pressed),
                        shear: Vec3::zeros(),
                        torsion: 0.0,
                        slides: false,
                        slipped: false,
                        overlap: model.radius[i] + model.radius[j] - distance,
                        distance,
                        cement: None,
                    });
                }
            }
            for near in neighbours.walls_near(model, i) {
                list.extend(wall_contact(model, neighbours, i, &at, near, &bounds));
            }
        }
        let cracks = match &model.cement {
            Some(cement) => cemented(model, cement, state, &mut list),
            None => Vec::new(),
        };
        let mut memory = state.memory.contacts.iter().peekable();
        for contact in &mut list {
            let key = (contact.first, contact.second);
            while memory.next_if(|m| m.key() < key).is_some() {}
            if let Some(load) = memory.next_if(|m| m.key() == key) {
                contact.shear = load.shear;
                contact.torsion = load.torsion;
                contact.slipped = load.slides;
                let slips = contact.cement != Some(Condition::Intact);
                contact.slides = slips
                    && model.friction.as_ref().is_some_and(|friction| {
                        let limit = friction.between(contact.first, contact.second) * contact.force;
                        contact.shear.norm() >= (1.0 - AT_LIMIT) * limit
                    });
            }
        }
        let mean = |sum: f64| sum / list.len().max(1) as f64;
        let mean_force = mean(list.iter().map(|c| c.force.abs()).sum());
        let mean_shear = mean(list.iter().map(|c| c.shear.norm()).sum());
        Self { list, cracks, mean_force, mean_shear }
    }

    /// Sliding contacts over all (T 3.6.2), of those that count.
    #[must_use]
    pub fn sliding_ratio(&self) -> f64 {
        let sliding = self.counted().filter(|c| c.slides).count();
        sliding as f64 / self.counted().count().max(1) as f64
    }

    /// Those that count: at least [`FAINT`] of the mean force.
    pub fn counted(&self) -> impl Iterator<Item = &Contact> {
        let least = FAINT * self.mean_force;
        let load = |c: &Contact| match c.cement {
            Some(Condition::Intact) => c.force.abs().max(c.shear.norm()),
            _ => c.force.abs(),
        };
        self.list.iter().filter(move |c| load(c) >= least)
    }
}

fn wall_contact(
    model: &Model,
    neighbours: &Neighbours,
    i: usize,
    at: &Vec3,
    (wall, reach): (u8, f64),
    bounds: &Room,
) -> Option<Contact> {
    let w = usize::from(wall);
    let Facing { gap: distance, normal, .. } = bounds.facing(at, w);
    let pressed = reach - distance;
    (pressed > 0.0).then(|| Contact {
        first: i as u32,
        second: Other::Wall(wall),
        normal,
        force: hertz::force(neighbours.wall_modulus(i, w), pressed),
        shear: Vec3::zeros(),
        torsion: 0.0,
        slides: false,
        slipped: false,
        overlap: model.radius[i] - distance,
        distance,
        cement: None,
    })
}

/// Takes the cement of `state` into the contacts that press, `list`, and returns the open ones whose
/// cement broke.
fn cemented(
    model: &Model,
    cement: &Cement,
    state: &State,
    list: &mut Vec<Contact>,
) -> Vec<Contact> {
    let bounds = state.bounds(model);
    let mut cracks = Vec::new();
    let mut pressing = std::mem::take(list).into_iter().peekable();
    for bond in state.bonds.iter().filter(|bond| bond.condition != Condition::Bare) {
        let key = bond.key();
        while let Some(other) = pressing.next_if(|c| (c.first, c.second) < key) {
            list.push(other);
        }
        let found = pressing.next_if(|c| (c.first, c.second) == key);
        let other_carries = match bond.second {
            Other::Grain(j) => state.carries[j as usize],
            Other::Wall(_) => true,
        };
        if !(state.carries[bond.first as usize] && other_carries) {
            continue;
        }
        let touches = found.is_some();
        let mut contact = found.unwrap_or_else(|| apart(model, state, bond, &bounds));
        contact.cement = Some(bond.condition);
        if bond.holds() {
            let law = model.law_of(cement, bond);
            let force = bond.force(&law, &state.position, &bounds);
            contact.force += force;
        }
        if touches || bond.holds() { list.push(contact) } else { cracks.push(contact) }
    }
    list.extend(pressing);
    cracks
}

/// The contact of `bond` without a force.
fn apart(model: &Model, state: &State, bond: &Bond, bounds: &Room) -> Contact {
    let branch = bond.branch(&state.position, bounds);
    let distance = branch.norm();
    let radius = model.radius[bond.first as usize];
    let reach = match bond.second {
        Other::Grain(j) => radius + model.radius[j as usize],
        Other::Wall(_) => radius,
    };
    Contact {
        first: bond.first,
        second: bond.second,
        normal: branch / distance,
        force: 0.0,
        shear: Vec3::zeros(),
        torsion: 0.0,
        slides: false,
        slipped: false,
        overlap: reach - distance,
        distance,
        cement: None,
    }
}

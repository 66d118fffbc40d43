//! Bonds between cohesive grains: how they form, and when they break (11-12).

use super::setup::Strength;
use crate::Vec3;
use crate::contact::Other;
use crate::contact::cement::strength::{Load, Mode};
use crate::contact::neighbours::Neighbours;
use crate::measure::contacts::{Contact, Contacts};
use crate::measure::stress;
use crate::model::Model;
use crate::relax::breakage::{Crack, Relaxed};
use crate::state::{Bond, Condition, State};

/// Gap over the mean radius that counts as none when bonds form: grains that just touch.
const TOUCHING: f64 = 1e-9;

/// Bonds every two grains of `state`, an equilibrium, that touch.
pub fn deposit(model: &Model, state: &mut State, near: &Neighbours) {
    let Some(strength) = model.plane.as_ref().and_then(|setup| setup.strength) else { return };
    state.bonds.clear();
    for i in 0..model.len() {
        for k in near.row(i) {
            let j = near.second[k] as usize;
            let branch = state.position[i] - state.position[j];
            let distance = branch.norm();
            let overlap = model.radius[i] + model.radius[j] - distance;
            if overlap < -TOUCHING * model.mean_radius {
                continue;
            }
            state.bonds.push(Bond {
                first: i as u32,
                second: Other::Grain(j as u32),
                distance,
                overlap,
                radius: strength.radius([model.radius[i], model.radius[j]]),
                share: strength.share(branch.x / distance),
                work: 0.0,
                normal_force: None,
                condition: Condition::Intact,
            });
            // What is bonded does not float.
            state.carries[i] = true;
            state.carries[j] = true;
        }
    }
}

/// What a bond carries at an equilibrium, against its strength.
#[derive(Clone, Copy, Debug)]
pub struct Carrying<'a> {
    /// Its place among the bonds of the state.
    pub place: usize,
    /// The bond.
    pub bond: &'a Bond,
    /// Its contact.
    pub contact: Contact,
    /// The larger of its forces over what it bears: it breaks at 1.
    pub used: f64,
    /// Which of them that is.
    pub mode: Mode,
}

/// All bonds of `state`, an equilibrium with the contacts `contacts`, that hold.
pub fn carrying<'a>(
    model: &'a Model,
    strength: &'a Strength,
    state: &'a State,
    contacts: &'a Contacts,
) -> impl Iterator<Item = Carrying<'a>> {
    let mut list = contacts.list.iter().peekable();
    state.bonds.iter().enumerate().filter(|(_, bond)| bond.holds()).filter_map(
        move |(place, bond)| {
            let key = bond.key();
            while list.next_if(|c| (c.first, c.second) < key).is_some() {}
            let contact = *list.next_if(|c| (c.first, c.second) == key)?;
            let (used, mode) = used(model, strength, bond, &contact);
            Some(Carrying { place, bond, contact, used, mode })
        },
    )
}

/// How much of its strength a bond uses: |F_s| of f F_n + F_t (11) and, with a cut-off, -F_n of F_t (12).
fn used(model: &Model, strength: &Strength, bond: &Bond, contact: &Contact) -> (f64, Mode) {
    let most = strength.force(bond.radius, bond.share);
    let coefficient =
        model.friction.as_ref().map_or(0.0, |friction| friction.between(bond.first, bond.second));
    let rubbed = if contact.force == 0.0 { 0.0 } else { coefficient * contact.force };
    // Where tension takes all of the resistance away any shear is too much.
    let shear = match contact.shear.norm() {
        0.0 => 0.0,
        shear => shear / (rubbed + most).max(f64::MIN_POSITIVE),
    };
    let tension = if strength.tension { -contact.force / most } else { 0.0 };
    if tension >= shear { (tension, Mode::Tension) } else { (shear, Mode::Shear) }
}

/// The bond that is furthest beyond its strength, and its place; the first of equals.
pub(super) fn weakest(model: &Model, state: &State, contacts: &Contacts) -> Option<(usize, Crack)> {
    let strength = model.plane.as_ref()?.strength?;
    let mut worst: Option<Carrying<'_>> = None;
    for one in carrying(model, &strength, state, contacts) {
        if one.used > 1.0 && worst.as_ref().is_none_or(|worst| one.used > worst.used) {
            worst = Some(one);
        }
    }
    worst.map(|Carrying { place, bond, contact, used, mode }| {
        let position =
            state.position[bond.first as usize] - contact.normal * lever(model, &contact);
        let load = Load { normal: contact.force, shear: contact.shear.norm(), torsion: 0.0 };
        let crack = Crack {
            first: bond.first,
            second: bond.second,
            mode,
            position,
            normal: contact.normal,
            load,
            overload: used,
            relaxed: Relaxed::default(),
        };
        (place, crack)
    })
}

/// From the centre of grain i to the contact \[m\].
pub(crate) fn lever(model: &Model, contact: &Contact) -> f64 {
    let radius = model.radius[contact.first as usize];
    match contact.second {
        Other::Grain(j) => {
            let other = model.radius[j as usize];
            0.5 * (contact.distance + (radius - other) * (radius + other) / contact.distance)
        }
        Other::Wall(_) => contact.distance,
    }
}

/// Breaks the bond at `place`: by shear it goes on as a frictional contact, by tension it is open.
pub(super) fn break_bond(state: &mut State, place: usize, mode: Mode) {
    state.bonds[place].condition = Condition::Broken(mode);
}

/// A state as the two bodies of a crack see it.
pub(super) struct Ends {
    pub(super) stress: f64,
    pub(super) at: [Vec3; 2],
    pub(super) turn: [Vec3; 2],
    pub(super) apart: bool,
}

impl Ends {
    pub(super) fn of(model: &Model, state: &State, contacts: &Contacts, crack: &Crack) -> Self {
        let Other::Grain(j) = crack.second else {
            return Self {
                stress: 0.0,
                at: [Vec3::zeros(); 2],
                turn: [Vec3::zeros(); 2],
                apart: false,
            };
        };
        let own = |c: &Contact| (c.first, c.second) == (crack.first, crack.second);
        let both = [crack.first as usize, j as usize];
        Self {
            stress: stress::in_volume(&contacts.list, state.volume(model)).trace() / 3.0,
            at: both.map(|k| state.position[k]),
            turn: both.map(|k| state.rotation[k]),
            apart: !contacts.list.iter().any(own),
        }
    }
}

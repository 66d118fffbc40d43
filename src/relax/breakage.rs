//! Breaking of cement: at an equilibrium the bond whose stress is the furthest beyond its strength
//! breaks, what it carried is relaxed with the walls as they are, and so on until no bond is
//! overloaded (Potyondy and Cundall 2004; T 6.2). So cracks come in an order that does not depend on
//! how bonds are numbered.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::cement::strength::{Load, Mode, Strength};
use crate::model::Model;
use crate::state::{Bond, Condition, Memory, State};

/// A bond that broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crack {
    /// Grain i, in the solver's order.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// How.
    pub mode: Mode,
    /// Where the contact was \[m\].
    pub position: Vec3,
    /// Unit normal towards grain i.
    pub normal: Vec3,
    /// What the cement carried.
    pub load: Load,
    /// The stress over the strength.
    pub overload: f64,
}

/// The bond of `state`, an equilibrium, that is loaded the most against its strength, if that is
/// beyond it, by its place.
#[must_use]
pub fn weakest(model: &Model, state: &State) -> Option<(usize, Crack)> {
    let cement = model.cement.as_ref()?;
    let strength = cement.strength?;
    let strength = Strength { tension: strength.tension, shear: strength.shear };
    let bounds = state.bounds(model);
    let mut carried = Carried { memory: &state.memory, next: 0 };
    let mut worst: Option<(usize, Crack)> = None;
    for (place, bond) in state.bonds.iter().enumerate().filter(|(_, bond)| bond.holds()) {
        let branch = bond.branch(&state.position, &bounds);
        let distance = branch.norm();
        let normal = branch / distance;
        let law = model.law_of(cement, bond);
        let normal_force = bond.force(&law, &normal, &state.position, &bounds);
        let (shear, torsion) = carried.of(bond);
        let load = Load { normal: normal_force, shear: shear.norm(), torsion: torsion.abs() };
        // Cement that is partly gone is as much weaker as it is softer.
        let (share, mode) = strength.use_of(&load, bond.radius);
        let overload = share / bond.share;
        if overload >= 1.0 && worst.as_ref().is_none_or(|(_, worst)| overload > worst.overload) {
            let Bond { first, second, .. } = *bond;
            let arm = model.radius[first as usize] - 0.5 * bond.overlap;
            let position = state.position[first as usize] - normal * arm.min(distance);
            let crack = Crack { first, second, mode, position, normal, load, overload };
            worst = Some((place, crack));
        }
    }
    worst
}

/// What contacts remember, asked for in their order.
struct Carried<'a> {
    memory: &'a Memory,
    next: usize,
}

impl Carried<'_> {
    /// Tangential force and couple of the contact of `bond`.
    fn of(&mut self, bond: &Bond) -> (Vec3, f64) {
        let contacts = &self.memory.contacts;
        while contacts.get(self.next).is_some_and(|contact| contact.key() < bond.key()) {
            self.next += 1;
        }
        match contacts.get(self.next).filter(|contact| contact.key() == bond.key()) {
            Some(contact) => (contact.shear, contact.torsion),
            None => (Vec3::zeros(), 0.0),
        }
    }
}

/// Breaks the bond at `place` of `state`: its contact is one without cement from now on, and without
/// what that carried.
pub fn break_bond(state: &mut State, place: usize, mode: Mode) {
    let bond = &mut state.bonds[place];
    bond.condition = Condition::Broken(mode);
    let key = bond.key();
    // A cemented contact has no layers that would have to go too.
    state.memory.contacts.retain(|contact| contact.key() != key);
}

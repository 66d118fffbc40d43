//! Breaking of cement: at an equilibrium the bond whose stress is the furthest beyond its strength
//! breaks, what it carried is relaxed with the walls as they are, and so on until no bond is
//! overloaded (Potyondy and Cundall 2004; T 6.2). So cracks come in an order that does not depend on
//! how bonds are numbered.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::cement::strength::{Load, Mode, Strength};
use crate::model::Model;
use crate::scene::{Cement, CementStrength};
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
    /// What became of that.
    pub relaxed: Relaxed,
}

/// What the pack did when a bond broke: from the equilibrium in which it broke to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Relaxed {
    /// Equilibria of the increment before it.
    pub substep: u32,
    /// Instabilities of the increment before it; those of its own relaxation come after it.
    pub jumps: u32,
    /// Confining stress of the contacts before and after \[Pa\]: a third of the trace of the
    /// Love-Weber stress.
    pub stress: [f64; 2],
    /// Stored energy before \[J\].
    pub energy: f64,
    /// Energy that neither the pack stores nor slip, walls or instabilities took \[J\].
    pub released: f64,
    /// Ways of both bodies \[m\].
    pub moved: [Vec3; 2],
    /// Rotations of both bodies \[rad\].
    pub turned: [Vec3; 2],
    /// Whether they are apart after it.
    pub apart: bool,
}

/// What a bond that holds carries at an equilibrium; nothing where it broke.
#[derive(Clone, Copy, Debug)]
pub struct Carrying<'a> {
    /// Its place among the bonds of the state.
    pub place: usize,
    /// The bond.
    pub bond: &'a Bond,
    /// Unit normal towards grain i.
    pub normal: Vec3,
    /// Where the contact is \[m\].
    pub position: Vec3,
    /// Normal force of the cement \[N\], negative in tension.
    pub normal_force: f64,
    /// Tangential force on grain i \[N\].
    pub shear: Vec3,
    /// Couple on grain i along the normal \[N m\].
    pub torsion: f64,
    /// The larger of its stresses over their strengths: it breaks at 1. 0 without strengths.
    pub used: f64,
    /// Which of them that is.
    pub mode: Mode,
}

impl Carrying<'_> {
    fn load(&self) -> Load {
        let Self { normal_force: normal, shear, torsion, .. } = *self;
        Load { normal, shear: shear.norm(), torsion: torsion.abs() }
    }
}

/// What was cemented in `state`, an equilibrium, in the order of its bonds.
pub fn carrying<'a>(
    model: &'a Model,
    cement: &'a Cement,
    state: &'a State,
) -> impl Iterator<Item = Carrying<'a>> + 'a {
    let bounds = state.bounds(model);
    let mut carried = Carried { memory: &state.memory, next: 0 };
    let cemented = |(_, bond): &(usize, &Bond)| bond.condition != Condition::Bare;
    state.bonds.iter().enumerate().filter(cemented).map(move |(place, bond)| {
        let branch = bond.branch(&state.position, &bounds);
        let distance = branch.norm();
        let normal = branch / distance;
        // In the middle between the surfaces, or on the wall.
        let overlap = bond.overlap + (bond.distance - distance);
        let arm = match bond.second {
            Other::Grain(_) => model.radius[bond.first as usize] - 0.5 * overlap,
            Other::Wall(_) => distance,
        };
        let position = state.position[bond.first as usize] - normal * arm;
        let (mut normal_force, mut shear, mut torsion) = (0.0, Vec3::zeros(), 0.0);
        if bond.holds() {
            let law = model.law_of(cement, bond);
            normal_force = bond.force(&law, &state.position, &bounds);
            (shear, torsion) = carried.of(bond);
        }
        let (used, mode) = (0.0, Mode::Tension);
        let mut all =
            Carrying { place, bond, normal, position, normal_force, shear, torsion, used, mode };
        if let Some(CementStrength { tension, shear }) = cement.strength
            && bond.holds()
        {
            let strength = Strength { tension, shear };
            // Cement that is partly gone is as much weaker as it is softer.
            (all.used, all.mode) = strength.use_of(&all.load(), bond.radius);
            all.used /= bond.share;
        }
        all
    })
}

/// The bond of `state`, an equilibrium, that is loaded the most against its strength, if that is
/// beyond it, by its place.
#[must_use]
pub fn weakest(model: &Model, state: &State) -> Option<(usize, Crack)> {
    let cement = model.cement.as_ref()?;
    cement.strength?;
    let mut worst: Option<Carrying<'_>> = None;
    for one in carrying(model, cement, state) {
        if one.used >= 1.0 && worst.as_ref().is_none_or(|worst| one.used > worst.used) {
            worst = Some(one);
        }
    }
    let worst = worst?;
    let load = worst.load();
    let Carrying { place, bond, normal, position, used: overload, mode, .. } = worst;
    let Bond { first, second, .. } = *bond;
    let relaxed = Relaxed::default();
    Some((place, Crack { first, second, mode, position, normal, load, overload, relaxed }))
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

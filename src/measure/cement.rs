//! Bonds and cracks in the order of the pack file.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::cement::strength::Mode;
use crate::measure::contacts::Contacts;
use crate::model::Model;
use crate::pack::wall_index;
use crate::plane::{Strength, crack};
use crate::relax::breakage::{self, Carrying, carrying};
use crate::report::{BondCondition, Bonds, Crack, Cracks, Event, EventKind, Rearrangement};
use crate::state::{Condition, State};

/// Every pair of `state`, an equilibrium, that was cemented; `None` in a scene without cement.
#[must_use]
pub fn bonds(model: &Model, state: &State, contacts: &Contacts) -> Option<Bonds> {
    if let Some(setup) = &model.plane {
        return setup.strength.as_ref().map(|strength| of_discs(model, strength, state, contacts));
    }
    let cement = model.cement.as_ref()?;
    let mut rows: Vec<(Bodies, Carrying<'_>)> = carrying(model, cement, state)
        .map(|one| (Bodies::of(model, one.bond.first, one.bond.second), one))
        .collect();
    rows.sort_unstable_by_key(|(bodies, _)| (bodies.first, bodies.second));
    let strength = cement.strength;
    let mut bonds = Bonds {
        tensile_strength: strength.map_or(f64::INFINITY, |strength| strength.tension),
        shear_strength: strength.map_or(f64::INFINITY, |strength| strength.shear),
        ..Bonds::default()
    };
    for (Bodies { first, second, sign }, one) in rows {
        bonds.first.push(first);
        bonds.second.push(second);
        bonds.condition.push(condition(one.bond.condition) as u8);
        bonds.share.push(one.bond.share);
        bonds.radius.push(one.bond.radius);
        bonds.position.extend_from_slice(one.position.as_slice());
        bonds.normal.extend_from_slice((one.normal * sign).as_slice());
        bonds.normal_force.push(one.normal_force);
        bonds.tangential_force.extend_from_slice((one.shear * sign).as_slice());
        // The couple on the other body is the opposite one, and so is the normal.
        bonds.torsion.push(one.torsion);
        bonds.strength_use.push(one.used);
    }
    Some(bonds)
}

/// Every bond of discs: what its contact carries, against F_t (11-12).
fn of_discs(model: &Model, strength: &Strength, state: &State, contacts: &Contacts) -> Bonds {
    let mut rows: Vec<_> = state
        .bonds
        .iter()
        .map(|bond| (Bodies::of(model, bond.first, bond.second), bond, None))
        .collect();
    for one in crack::carrying(model, strength, state, contacts) {
        rows[one.place].2 = Some(one);
    }
    rows.sort_unstable_by_key(|(bodies, ..)| (bodies.first, bodies.second));
    let mut bonds = Bonds {
        tensile_strength: if strength.tension { strength.cohesion } else { f64::INFINITY },
        shear_strength: strength.cohesion,
        ..Bonds::default()
    };
    for (Bodies { first, second, sign }, bond, one) in rows {
        let contact = one.as_ref().map(|one| one.contact);
        let lever = contact.map_or(0.0, |contact| crack::lever(model, &contact));
        let at = |grain: Other| match grain {
            Other::Grain(grain) => state.position[grain as usize],
            Other::Wall(_) => Vec3::zeros(),
        };
        let [i, j] = [at(Other::Grain(bond.first)), at(bond.second)];
        let normal = (i - j).normalize();
        let position = if contact.is_some() { i - normal * lever } else { 0.5 * (i + j) };
        let shear = contact.map_or_else(Vec3::zeros, |contact| contact.shear * sign);
        bonds.first.push(first);
        bonds.second.push(second);
        bonds.condition.push(condition(bond.condition) as u8);
        bonds.share.push(bond.share);
        bonds.radius.push(bond.radius);
        bonds.position.extend_from_slice(position.as_slice());
        bonds.normal.extend_from_slice((normal * sign).as_slice());
        bonds.normal_force.push(contact.map_or(0.0, |contact| contact.force));
        bonds.tangential_force.extend_from_slice(shear.as_slice());
        bonds.torsion.push(0.0);
        bonds.strength_use.push(one.map_or(0.0, |one| one.used));
    }
    bonds
}

/// The bonds of `state` by what became of them, and `cracks`, those of its increment; `None` in a
/// scene without cement.
#[must_use]
pub fn cracks(model: &Model, state: &State, cracks: &[breakage::Crack]) -> Option<Cracks> {
    let bonded = match &model.plane {
        None => model.cement.is_some(),
        Some(setup) => setup.strength.is_some(),
    };
    if !bonded {
        return None;
    }
    let count = |wanted: Condition| {
        state.bonds.iter().filter(|bond| bond.condition == wanted).count() as u32
    };
    Some(Cracks {
        intact: count(Condition::Intact),
        tension: count(Condition::Broken(Mode::Tension)),
        shear: count(Condition::Broken(Mode::Shear)),
        list: cracks.iter().map(|crack| of(model, crack)).collect(),
    })
}

fn of(model: &Model, crack: &breakage::Crack) -> Crack {
    let Bodies { first, second, sign } = Bodies::of(model, crack.first, crack.second);
    let relaxed = &crack.relaxed;
    Crack {
        first,
        second,
        mode: condition(Condition::Broken(crack.mode)),
        substep: relaxed.substep,
        position: crack.position.into(),
        normal: (crack.normal * sign).into(),
        normal_force: crack.load.normal,
        tangential_force: crack.load.shear,
        torsion: crack.load.torsion,
        overload: crack.overload,
        stress_before: relaxed.stress[0],
        stress_after: relaxed.stress[1],
        energy_released: relaxed.released,
    }
}

/// The crack as an event: both bodies, and how far they went.
#[must_use]
pub fn event(model: &Model, crack: &breakage::Crack) -> Event {
    let (grains, ways) = bodies(model, crack);
    let relaxed = &crack.relaxed;
    Event {
        kind: EventKind::ContactBreak,
        stress_before: relaxed.stress[0],
        stress_after: relaxed.stress[1],
        energy_released: relaxed.released,
        grains,
        displacement: ways.map(|body| relaxed.moved[body].norm()).to_vec(),
    }
}

/// The crack in full: what it did to the two bodies and to the contact between them.
#[must_use]
pub fn rearrangement(model: &Model, crack: &breakage::Crack) -> Rearrangement {
    let (grains, ways) = bodies(model, crack);
    let relaxed = &crack.relaxed;
    let pair = [grains[0], grains[1]];
    Rearrangement {
        kind: EventKind::ContactBreak,
        stress_before: relaxed.stress[0],
        stress_after: relaxed.stress[1],
        energy_before: relaxed.energy,
        energy_after: relaxed.energy - relaxed.released,
        grains,
        displacement: ways.map(|body| relaxed.moved[body].into()).to_vec(),
        rotation: ways.map(|body| relaxed.turned[body].into()).to_vec(),
        lost: if relaxed.apart { vec![pair] } else { Vec::new() },
        made: Vec::new(),
    }
}

/// The bodies as the pack file counts them, ascending, and the places of their ways.
fn bodies(model: &Model, crack: &breakage::Crack) -> (Vec<u32>, [usize; 2]) {
    let Bodies { first, second, sign } = Bodies::of(model, crack.first, crack.second);
    (vec![first, second], if sign > 0.0 { [0, 1] } else { [1, 0] })
}

fn condition(condition: Condition) -> BondCondition {
    match condition {
        Condition::Intact | Condition::Bare => BondCondition::Intact,
        Condition::Broken(Mode::Tension) => BondCondition::Tension,
        Condition::Broken(Mode::Shear) => BondCondition::Shear,
    }
}

/// Two bodies as the pack file counts them, the smaller number first.
struct Bodies {
    first: u32,
    second: u32,
    /// -1 where the solver's order is the other way round.
    sign: f64,
}

impl Bodies {
    fn of(model: &Model, first: u32, second: Other) -> Self {
        let one = model.order[first as usize];
        let other = match second {
            Other::Grain(j) => model.order[j as usize],
            Other::Wall(w) => wall_index(w),
        };
        let sign = if one < other { 1.0 } else { -1.0 };
        Self { first: one.min(other), second: one.max(other), sign }
    }
}

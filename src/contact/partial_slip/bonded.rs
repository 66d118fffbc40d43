//! The law without a limit of friction: nothing slips while the contact circle holds it.
//!
//! Each layer is one punch at overlap x = `reach`, moved by δ. Its pull p = -η δ \[m\] has the force
//! P'(x) p and is kept as `ratio` = p/(x + |p|), which stays below 1. A rise of the overlap from h₀
//! to h spreads its displacement evenly over the punches that come into contact. One punch at
//! √x = 2/3 (h^1.5 - h₀^1.5)/(h - h₀) replaces them: it has their force, and stores more than they
//! do by about (h - h₀)/12h of what it stores by itself. A fall hands the pull of punches that lose
//! contact on to the one at the new rim.

use super::energy::mean;
use super::merge::MOST_LAYERS;
use super::rings::secant;
use super::{Contact, Response, Step};
use crate::Vec3;
use crate::contact::hertz;
use crate::pack::Layer;

/// Punches whose reaches differ by less are one.
const SAME: f64 = 1e-12;

/// Overlap and pull of a punch \[m\].
#[derive(Clone, Copy)]
struct Punch {
    reach: f64,
    pull: Vec3,
}

impl Punch {
    fn of(layer: &Layer) -> Self {
        let ratio = Vec3::from(layer.ratio);
        let rest = (1.0 - ratio.norm()).max(f64::EPSILON);
        Self { reach: layer.reach, pull: ratio * (layer.reach / rest) }
    }

    fn stiffness(&self, contact: &Contact) -> f64 {
        hertz::stiffness(contact.modulus, self.reach)
    }

    fn layer(&self) -> Layer {
        let whole = self.reach + self.pull.norm();
        let ratio = if whole > 0.0 { self.pull / whole } else { Vec3::zeros() };
        Layer { reach: self.reach, ratio: ratio.into() }
    }
}

/// The punch that `step` adds, and how many of the old ones stay below it.
fn added(contact: &Contact, layers: &[Layer], step: &Step) -> (usize, Punch) {
    let own = -step.displacement * contact.ratio;
    if step.overlap < step.before {
        let kept = layers.partition_point(|layer| layer.reach <= step.overlap);
        let pull = layers[kept..].iter().fold(own, |sum, layer| sum + Punch::of(layer).pull);
        (kept, Punch { reach: step.overlap, pull })
    } else {
        let root = secant(1.0, step.before.max(0.0), step.overlap) / 1.5;
        (layers.len(), Punch { reach: root * root, pull: own })
    }
}

pub(super) fn respond(contact: &Contact, layers: &[Layer], step: &Step) -> Response {
    let (kept, new) = added(contact, layers, step);
    let punches = layers[..kept].iter().map(Punch::of).chain([new]);
    let shear = punches.fold(Vec3::zeros(), |sum, at| sum + at.pull * at.stiffness(contact));
    let stiffness = contact.ratio * new.stiffness(contact);
    let core = step.overlap;
    Response { shear, along: stiffness, across: stiffness, core, ..Response::NONE }
}

pub(super) fn commit(contact: &Contact, layers: &mut Vec<Layer>, step: &Step) {
    let (kept, new) = added(contact, layers, step);
    layers.truncate(kept);
    layers.push(new.layer());
    unite(layers);
}

pub(super) fn stored(contact: &Contact, layers: &[Layer]) -> f64 {
    stored_by(contact, layers.iter().map(Punch::of))
}

fn stored_by(contact: &Contact, punches: impl Iterator<Item = Punch>) -> f64 {
    let mut force = Vec3::zeros();
    let mut energy = 0.0;
    for punch in punches {
        let own = punch.pull * punch.stiffness(contact);
        energy += (force + 0.5 * own).dot(&punch.pull);
        force += own;
    }
    energy / contact.ratio
}

/// Only a falling overlap loses energy: -½ |δ|² dk_s at the rim, with δ that of the punch there.
pub(super) fn dissipated(contact: &Contact, layers: &[Layer], step: &Step) -> f64 {
    let fall = step.before - step.overlap;
    if fall <= 0.0 {
        return 0.0;
    }
    let own = -step.displacement * contact.ratio;
    let mut rim = step.before;
    let mut handed = Vec3::zeros();
    let mut heat = 0.0;
    let punches = layers.iter().rev().take_while(|layer| layer.reach > step.overlap);
    let stops = punches.map(Punch::of).chain([Punch { reach: step.overlap, pull: Vec3::zeros() }]);
    for stop in stops {
        let (high, low) = (rim.sqrt(), stop.reach.min(rim).sqrt());
        let square = mean(|s| {
            let root = high + s * (low - high);
            (handed + own * ((step.before - root * root) / fall)).norm_squared()
        });
        heat += 0.75 * contact.modulus * (high - low) * square;
        handed += stop.pull;
        rim = stop.reach.min(rim);
    }
    heat / contact.ratio
}

pub(super) fn potential(contact: &Contact, layers: &[Layer], step: &Step) -> f64 {
    let (kept, new) = added(contact, layers, step);
    stored_by(contact, layers[..kept].iter().map(Punch::of).chain([new]))
}

/// Unites punches that lie together, and then the nearest until few enough remain.
fn unite(layers: &mut Vec<Layer>) {
    for k in (1..layers.len()).rev() {
        if layers[k].reach - layers[k - 1].reach <= SAME * layers[k].reach {
            join(layers, k);
        }
    }
    while layers.len() > MOST_LAYERS {
        let gap = |k: usize| layers[k].reach - layers[k - 1].reach;
        let nearest = (1..layers.len()).min_by(|&a, &b| gap(a).total_cmp(&gap(b)));
        if let Some(k) = nearest {
            join(layers, k);
        }
    }
}

/// Makes one punch of k-1 and k with the same force, and with the same pull if both are parallel.
fn join(layers: &mut Vec<Layer>, k: usize) {
    let (outer, inner) = (Punch::of(&layers.remove(k)), Punch::of(&layers[k - 1]));
    let (low, high) = (inner.reach.sqrt(), outer.reach.sqrt());
    let size = inner.pull.norm() + outer.pull.norm();
    let share = if size > 0.0 { outer.pull.norm() / size } else { 1.0 };
    let root = low + share * (high - low);
    let pull =
        if root > 0.0 { (inner.pull * low + outer.pull * high) / root } else { Vec3::zeros() };
    layers[k - 1] = Punch { reach: root * root, pull }.layer();
}

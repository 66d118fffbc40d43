//! The contacts at the last equilibrium: what shear counts from.

use super::boundary::{Body, Shape};
use super::law::Shear;
use super::setup::Law;
use super::{Vec2, glue, left_of};
use crate::contact::neighbours::Neighbours;
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::state::{Bond, Condition, Memory, State};

/// Boundary bodies further than this share of the mean radius from a grain cannot touch it before the
/// list is made again.
const SKIN: f64 = 0.5;

/// Two bodies that can touch.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Grain i.
    pub first: u32,
    /// The other grain, or the body with this number.
    pub second: Other,
    /// Overlap and distance add up to this \[m\]; in a ring their difference is minus this.
    pub reach: f64,
    /// Effective radius of the contact \[m\].
    pub radius: f64,
    /// Hertz' M \[N/m^1.5\].
    pub modulus: f64,
    /// Whether it touched at the reference, or a bond holds: only then does it carry shear.
    pub held: bool,
    /// Whether a bond holds.
    pub bonded: bool,
    /// Unit vector along which the distance grew at the reference.
    pub along: Vec2,
    /// Distance at the reference \[m\].
    pub span: f64,
    /// Position along a plane at the reference \[m\].
    pub station: f64,
    /// Levers of grain i and of the other one \[m\]: from their centres to the contact at the reference.
    pub arm: [f64; 2],
    /// Shear.
    pub shear: Shear,
    /// Energy that the shear stored at the reference \[J\].
    pub stored: f64,
    /// Overlap at the reference \[m\].
    pub overlap: f64,
    /// Whether it slid in the last increment.
    pub slid: bool,
    /// Whether it opened under shear since: it carries none any more.
    pub opened: bool,
}

/// Two grains that can touch.
#[derive(Clone, Copy, Debug)]
pub struct Near {
    /// The grains.
    pub grains: [u32; 2],
    /// Square of the distance from which on they do nothing \[m²\]; infinite where shear or a bond may
    /// act on grains that are apart.
    pub square: f64,
}

/// All joints: those of two grains in the order of the neighbour list, and those of grains with bodies,
/// by grain and body.
#[derive(Clone, Debug, Default)]
pub struct Reference {
    /// Of two grains.
    pub pairs: Vec<Joint>,
    /// What tells that a pair does nothing, in the order of the pairs: most of them are apart, and this
    /// is a tenth of what there is to a pair.
    pub near: Vec<Near>,
    /// Of a grain and a body.
    pub edges: Vec<Joint>,
}

impl Reference {
    /// Takes the contacts of `state`, whose bodies are `bodies`. A pack as it was `given` may carry what
    /// it remembers even where that is beyond the limit.
    pub fn begin(
        &mut self,
        model: &Model,
        state: &State,
        near: &Neighbours,
        bodies: &[Body],
        given: bool,
    ) {
        self.pairs.clear();
        self.edges.clear();
        let Some(setup) = &model.plane else { return };
        let maker = Maker { model, law: setup.law, state };
        let at = |i: usize| Vec2::new(state.position[i].x, state.position[i].y);
        for i in 0..model.len() {
            for k in near.row(i) {
                let j = near.second[k] as usize;
                let branch = at(i) - at(j);
                let distance = branch.norm();
                let reach = model.radius[i] + model.radius[j];
                let mut joint =
                    Joint::new(i as u32, Other::Grain(j as u32), reach, branch / distance);
                joint.radius = hertz::effective_radius(model.radius[i], model.radius[j]);
                joint.modulus = near.modulus[k];
                joint.span = distance;
                joint.overlap = reach - distance;
                // The disc of contact is where both circles intersect.
                let [ri, rj] = [model.radius[i], model.radius[j]];
                let arm = 0.5 * (distance + (ri - rj) * (ri + rj) / distance);
                joint.arm = [arm, distance - arm];
                self.pairs.push(maker.hold(joint));
            }
            let compliance = model.compliance[i] + model.wall_compliance;
            for (b, body) in bodies.iter().enumerate() {
                let near = body.near(at(i), model.radius[i]);
                if near.overlap < -SKIN * model.mean_radius {
                    continue;
                }
                let reach = near.overlap + near.sign * near.distance;
                let mut joint = Joint::new(i as u32, Other::Wall(b as u8), reach, near.along);
                joint.radius = body.effective_radius(model.radius[i]);
                joint.modulus = hertz::modulus(joint.radius, compliance);
                joint.span = near.distance;
                joint.overlap = near.overlap;
                let lever = model.radius[i] - near.overlap;
                joint.arm = [near.sign * lever, 0.0];
                if let Shape::Plane(normal) = body.shape {
                    joint.station =
                        (at(i) - body.at).dot(&left_of(normal)) + joint.arm[0] * body.swing.turn;
                    joint.span = lever;
                }
                self.edges.push(maker.hold(joint));
            }
        }
        bind(&mut self.pairs, &state.bonds, setup.law);
        recall(&mut self.pairs, &state.memory, given);
        recall(&mut self.edges, &state.memory, given);
        self.list();
    }

    /// Lists the pairs anew.
    pub(super) fn list(&mut self) {
        self.near.clear();
        self.near.extend(self.pairs.iter().filter_map(|joint| {
            let Other::Grain(second) = joint.second else { return None };
            let far = joint.held || joint.bonded;
            let square = if far { f64::INFINITY } else { joint.reach * joint.reach };
            Some(Near { grains: [joint.first, second], square })
        }));
    }

    /// Takes the shear away from contacts that opened, so that nothing apart is pulled; `overlap` is that
    /// of each now \[m\]. Says whether there were any.
    pub fn open(&mut self, overlap: impl Fn(&Joint) -> f64) -> bool {
        let mut any = false;
        for joint in self.pairs.iter_mut().chain(&mut self.edges) {
            if joint.held && !joint.bonded && !joint.opened && overlap(joint) <= 0.0 {
                joint.opened = true;
                any |= joint.shear.limit > 0.0 && joint.shear.stiffness > 0.0;
            }
        }
        any
    }

    /// Makes every contact that can rub stick, whatever its limit.
    pub fn stick(&mut self) {
        for joint in self.pairs.iter_mut().chain(&mut self.edges) {
            if joint.shear.limit > 0.0 {
                joint.shear.limit = f64::INFINITY;
            }
        }
    }

    /// Makes contacts without friction smooth: where nothing is sheared as yet they would stick.
    pub fn smooth(&mut self) {
        for joint in self.pairs.iter_mut().chain(&mut self.edges) {
            if joint.shear.limit == 0.0 {
                joint.shear.stiffness = 0.0;
            }
        }
    }

    /// Renews the limit and the stiffness of every contact with its present overlap `overlap(joint)`
    /// \[m\]; says by how much the largest limit changed \[N\].
    pub fn renew(&mut self, model: &Model, overlap: impl Fn(&Joint) -> f64) -> f64 {
        let Some(setup) = &model.plane else { return 0.0 };
        let mut most = 0.0_f64;
        for joint in self.pairs.iter_mut().chain(&mut self.edges) {
            if !joint.held || joint.bonded || joint.opened {
                continue;
            }
            let now = overlap(joint);
            let force = super::law::normal(setup.law, joint.modulus, now, false).force;
            let limit = limit_of(model, joint, force);
            let stiffness = setup.law.shear_stiffness(model, joint.key(), joint.radius, now);
            if limit != joint.shear.limit {
                most = most.max((limit - joint.shear.limit).abs());
            }
            joint.shear.limit = limit;
            joint.shear.stiffness = stiffness;
        }
        most
    }
}

impl Joint {
    fn new(first: u32, second: Other, reach: f64, along: Vec2) -> Self {
        Self {
            first,
            second,
            reach,
            radius: 0.0,
            modulus: 0.0,
            held: false,
            bonded: false,
            along,
            span: 0.0,
            station: 0.0,
            arm: [0.0; 2],
            shear: Shear::default(),
            stored: 0.0,
            overlap: 0.0,
            slid: false,
            opened: false,
        }
    }

    /// Whether the other body is a plane.
    #[must_use]
    pub fn is_flat(&self, bodies: &[Body]) -> bool {
        match self.second {
            Other::Grain(_) => false,
            Other::Wall(body) => matches!(bodies[usize::from(body)].shape, Shape::Plane(_)),
        }
    }

    /// What lists of contacts are sorted by.
    #[must_use]
    pub fn key(&self) -> (u32, Other) {
        (self.first, self.second)
    }
}

struct Maker<'a> {
    model: &'a Model,
    law: Law,
    state: &'a State,
}

impl Maker<'_> {
    /// `joint` with the stiffness and the limit of its present force.
    fn hold(&self, mut joint: Joint) -> Joint {
        let Self { model, law, state, .. } = self;
        let carries = |grain: u32| state.carries[grain as usize];
        let live = carries(joint.first)
            && match joint.second {
                Other::Grain(j) => carries(j),
                Other::Wall(_) => true,
            };
        let live = live && !glue::joins(&state.glued, &joint);
        if model.friction.is_none() || joint.overlap <= 0.0 || !live {
            return joint;
        }
        joint.held = true;
        let force = super::law::normal(*law, joint.modulus, joint.overlap, false).force;
        joint.shear.limit = limit_of(model, &joint, force);
        joint.shear.stiffness =
            law.shear_stiffness(model, joint.key(), joint.radius, joint.overlap);
        joint
    }
}

/// μP \[N\]: without a force none, and without end where friction is.
fn limit_of(model: &Model, joint: &Joint, force: f64) -> f64 {
    let Some(friction) = &model.friction else { return 0.0 };
    let coefficient = friction.between(joint.first, joint.second);
    if force > 0.0 { coefficient * force } else { 0.0 }
}

/// Gives the joints the shear that they remember. Both lists are sorted.
fn recall(joints: &mut [Joint], memory: &Memory, given: bool) {
    let mut remembered = memory.contacts.iter().peekable();
    for joint in joints {
        let key = joint.key();
        while remembered.next_if(|load| load.key() < key).is_some() {}
        let Some(load) = remembered.next_if(|load| load.key() == key) else { continue };
        if !joint.held {
            continue;
        }
        let shear = Vec2::new(load.shear.x, load.shear.y);
        joint.shear.carried = -shear.dot(&left_of(joint.along));
        joint.stored = joint.shear.stored(joint.shear.carried);
        joint.slid = load.slides;
        if given {
            joint.shear.limit = joint.shear.limit.max(joint.shear.carried.abs());
        }
    }
}

/// Marks the joints that a bond holds, and those that are no contacts but for it.
fn bind(pairs: &mut [Joint], bonds: &[Bond], law: Law) {
    let mut bonds = bonds.iter().filter(|bond| bond.condition == Condition::Intact).peekable();
    for joint in pairs {
        let key = joint.key();
        while bonds.next_if(|bond| bond.key() < key).is_some() {}
        if bonds.next_if(|bond| bond.key() == key).is_some() {
            joint.bonded = true;
            joint.held = true;
            joint.shear.limit = f64::INFINITY;
            if let Law::Linear { shear, .. } = law {
                joint.shear.stiffness = shear;
            }
        }
    }
}

//! Scratch of the relaxation in the plane.

use super::act::{Act, Scenery};
use super::balance::Balance;
use super::boundary::{self, Body, SIDES};
use super::dynamic::Inertia;
use super::floating::Floating;
use super::gauss_seidel::Adjacency;
use super::membrane::{self, Membrane};
use super::newton::Search;
use super::outline::Finder;
use super::pose::Pose;
use super::reference::{Joint, Reference};
use super::slope::Slope;
use super::{DRIVES, Law, Vec2};
use crate::contact::neighbours::Neighbours;
use crate::contact::{Other, hertz};
use crate::heap;
use crate::model::Model;
use crate::relax::jump::Jump;
use crate::relax::tangential::Changes;
use crate::relax::{Effort, Status};
use crate::state::State;
use crate::wall::{self, Load};

/// Gap over the sum of the radii up to which pairs are taken into the pattern of the matrix.
const NEARLY: f64 = 0.01;

/// Walls that carry a load: what moves them, and what they shall carry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Inward displacement of each side over that of the drive.
    pub shares: [f64; SIDES],
    /// Force along it \[N\].
    pub force: f64,
    /// The load that makes that force, with the areas and the tilt of the box.
    pub load: Load,
}

/// Legs of a way to another equilibrium.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Legs {
    /// Contacts that opened and formed.
    pub(super) changes: Changes,
    /// Work of membranes on the grains \[J\].
    pub(super) worked: f64,
}

/// Scratch that may be thrown away at any time.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    /// What shear counts from.
    pub reference: Reference,
    /// Where the grains are.
    pub pose: Pose,
    /// The balance there.
    pub balance: Balance,
    /// Walls under loads.
    pub drives: Vec<Drive>,
    /// Sides that are membranes.
    pub membranes: Vec<Membrane>,
    /// Instabilities since the list was last emptied.
    pub jumps: Vec<Jump>,
    /// What the legs of the way at hand came to that have ended.
    pub(super) legs: Legs,
    pub(super) slope: Slope,
    pub(super) bodies: Vec<Body>,
    pub(super) trial: Pose,
    pub(super) trial_balance: Balance,
    pub(super) trial_displacement: [f64; wall::COUNT],
    pub(super) search: Search,
    pub(super) floating: Floating,
    pub(super) adjacency: Adjacency,
    pub(super) inertia: Inertia,
    finder: Finder,
    /// For the memory that is being written.
    pub(super) memory: crate::state::Memory,
    /// Number of the neighbour list that the matrix is arranged for, and the links of the membranes.
    arranged: u64,
    pub(super) links: Vec<(u32, u32)>,
    /// Force of a contact that is as good as open \[N\].
    pub(super) negligible: f64,
    positions: Vec<[f64; 2]>,
    /// Which pairs the matrix is arranged for, in the order of the neighbour list.
    coupled: Vec<bool>,
}

impl Workspace {
    /// The work done so far.
    #[must_use]
    pub fn effort(&self) -> Effort {
        Effort {
            gradients: self.balance.evaluations + self.trial_balance.evaluations,
            products: self.slope.matrix.factorisations,
        }
    }

    /// Memory that its lists hold \[bytes\].
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        let columns = self.slope.columns.iter().map(heap::bytes).sum::<usize>();
        heap::bytes(&self.reference.pairs)
            + heap::bytes(&self.reference.near)
            + heap::bytes(&self.reference.edges)
            + self.pose.heap_bytes()
            + self.trial.heap_bytes()
            + heap::bytes(&self.balance.gradient)
            + heap::bytes(&self.trial_balance.gradient)
            + heap::bytes(&self.balance.support)
            + heap::bytes(&self.trial_balance.support)
            + self.slope.matrix.heap_bytes()
            + columns
            + self.search.heap_bytes()
            + self.floating.heap_bytes()
            + self.inertia.heap_bytes()
            + heap::bytes(&self.positions)
            + heap::bytes(&self.coupled)
            + heap::bytes(&self.links)
            + self.finder.heap_bytes()
            + self.membranes.iter().map(Membrane::heap_bytes).sum::<usize>()
            + heap::bytes(&self.memory.contacts)
    }

    /// Takes the equilibrium `state` as the reference; a pack as it was `given` may carry more shear
    /// than the limit.
    pub fn begin(&mut self, model: &Model, state: &mut State, near: &mut Neighbours, given: bool) {
        near.refresh(model, &state.position, &state.bounds(model));
        self.pose.at.clear();
        self.pose.at.extend(state.position.iter().map(|at| Vec2::new(at.x, at.y)));
        self.pose.turn.clear();
        self.pose.turn.resize(model.len(), 0.0);
        membrane::wrap(model, state, &self.pose.at, (&mut self.membranes, &mut self.finder));
        boundary::bodies(model, &state.displacement, state.tilt, &mut self.bodies);
        self.reference.begin(model, state, near, &self.bodies, given);
        // A leg of motion begins in the middle of a relaxation.
        self.floating.relist();
        self.arrange(near);
        let mean = hertz::modulus(0.5 * model.mean_radius, 2.0 * model.compliance[0]);
        self.negligible = match model.plane.as_ref().map(|setup| setup.law) {
            Some(Law::Hertz) => model.negligible_force(),
            // Contacts of constant stiffness have no force that positions do not resolve.
            _ => 0.0,
        };
        self.slope.idle = hertz::stiffness(mean, 1e-2 * model.mean_radius);
    }

    /// Brings the neighbour list up to date where grains went far, and the joints with it. Says whether
    /// it had to.
    pub(super) fn refresh(
        &mut self,
        model: &Model,
        state: &mut State,
        near: &mut Neighbours,
    ) -> bool {
        self.put(state);
        if near.holds(model, &state.position, &state.bounds(model)) {
            return false;
        }
        near.rebuild(model, &state.position, &state.bounds(model));
        let before = std::mem::take(&mut self.reference);
        self.reference.begin(model, state, near, &self.bodies, false);
        keep(&before.pairs, &mut self.reference.pairs);
        keep(&before.edges, &mut self.reference.edges);
        self.reference.list();
        self.arrange(near);
        self.floating.relist();
        true
    }

    fn arrange(&mut self, near: &Neighbours) {
        let links = self.membranes.iter().flat_map(Membrane::links);
        let same_links = links.eq(self.links.iter().copied());
        let same_pairs = self.arranged == near.rebuilds && self.coupled.len() == near.second.len();
        if !(same_links && same_pairs) {
            self.arranged = near.rebuilds;
            self.couple(near);
        }
    }

    /// Arranges the matrix for the pairs that touch or nearly do. The neighbour list has many more, which
    /// would only fill it.
    pub(super) fn couple(&mut self, near: &Neighbours) {
        let Self { reference, pose, coupled, positions, slope, links, membranes, .. } = self;
        links.clear();
        links.extend(membranes.iter().flat_map(Membrane::links));
        coupled.clear();
        coupled.extend(reference.pairs.iter().map(|joint| {
            let Other::Grain(j) = joint.second else { return true };
            let (i, j) = (joint.first as usize, j as usize);
            let apart = (pose.at[i] - pose.at[j]).norm();
            joint.bonded || apart < (1.0 + NEARLY) * joint.reach
        }));
        positions.clear();
        positions.extend(pose.at.iter().map(|at| [at.x, at.y]));
        slope.matrix.arrange(positions, &near.start, &near.second, |k| coupled[k], links);
    }

    /// Whether a pair is in the matrix at hand that it is not arranged for.
    pub(super) fn lacks_pairs(&self) -> bool {
        let pairs = self.coupled.len() as u32;
        let mut filled = self.slope.matrix.filled.iter().take_while(|k| **k < pairs);
        filled.any(|&k| !self.coupled[k as usize])
    }

    /// Takes the balance of the grains and walls of `state` at the pose.
    pub(super) fn evaluate(&mut self, model: &Model, state: &State) {
        self.evaluate_and(model, state, |_, _, _| {});
    }

    /// The same, and shows `see` what each contact does, with the body where there is one.
    pub(super) fn evaluate_and(
        &mut self,
        model: &Model,
        state: &State,
        see: impl FnMut(&Joint, &Act, Option<&Body>),
    ) {
        let Some(setup) = &model.plane else { return };
        boundary::bodies(model, &state.displacement, state.tilt, &mut self.bodies);
        let Self { reference, bodies, membranes, balance, pose, .. } = self;
        let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
        balance.evaluate_and(&scenery, pose, see);
    }

    /// What the balance taken last is as an equilibrium: one that carries something or one that does not.
    pub(super) fn rest(&self) -> Status {
        let none = self.balance.sums.mean_force() <= self.negligible;
        if none { Status::Unjammed } else { Status::Converged }
    }

    /// Takes the sides that are membranes to where the outline of the pose is on average, and the ends
    /// of the membranes to the sides beside them; says whether these were elsewhere.
    pub(super) fn follow(&mut self, model: &Model, state: &mut State) -> bool {
        let Some(setup) = &model.plane else { return false };
        let mut moved = false;
        for membrane in &mut self.membranes {
            moved |= membrane.reach(&setup.cell, &state.displacement);
        }
        for membrane in &self.membranes {
            let side = membrane.side;
            state.displacement[side] = state.outline[side] - membrane.position(&self.pose.at);
        }
        moved
    }

    /// Writes the pose into `state`, but for the turns, which count from the reference until the
    /// increment ends.
    pub(super) fn put(&self, state: &mut State) {
        for (to, at) in state.position.iter_mut().zip(&self.pose.at) {
            (to.x, to.y) = (at.x, at.y);
        }
    }

    /// Force on each drive beyond its load \[N\] but for the grains taken along.
    pub(super) fn unbalance(&self, balance: &Balance) -> [f64; DRIVES] {
        let mut unbalance = [0.0; DRIVES];
        for (to, drive) in unbalance.iter_mut().zip(&self.drives) {
            let pressed = drive.shares.iter().zip(&balance.sides).map(|(s, f)| s * f).sum::<f64>();
            *to = pressed - drive.force;
        }
        unbalance
    }
}

/// Gives the joints of a new list what they were at the reference; those that were not listed did not
/// touch there.
fn keep(before: &[Joint], now: &mut [Joint]) {
    let mut old = before.iter().peekable();
    for joint in now {
        let key = joint.key();
        while old.next_if(|old| old.key() < key).is_some() {}
        match old.next_if(|old| old.key() == key) {
            Some(old) => *joint = *old,
            None => joint.held = false,
        }
    }
}

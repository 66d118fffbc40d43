//! Masses that let all discs and walls under loads follow one time step.
//!
//! As those of spheres they are the largest row sums of what holds each body alone, so that all
//! frequencies are below √2 (Gershgorin): k(a - b)² <= 2ka² + 2kb² for two bodies that move, and ka² where
//! the other one stands.

use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::plane::act::Act;
use crate::plane::boundary::{Body, SIDES, Shape};
use crate::plane::matrix::{Block, FREEDOMS};
use crate::plane::reference::Joint;
use crate::plane::slope::own_block;
use crate::plane::work::{Drive, Workspace};
use crate::plane::{DRIVES, left_of};
use crate::relax::dynamic::leap::raise;
use crate::state::State;

/// Mass of each grain and of its turn times radius, and of each drive \[N/m\].
#[derive(Clone, Debug, Default)]
pub(super) struct Masses {
    grains: Vec<[f64; 2]>,
    drives: [f64; DRIVES],
    /// What holds each grain alone \[N/m\], shape (n), a wall that stands counting by half.
    stiffness: Vec<Block>,
    /// What holds each side against its inward displacement \[N/m\].
    sides: [f64; SIDES],
    /// Which sides are under loads.
    moved: [bool; SIDES],
}

impl Masses {
    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.grains) + heap::bytes(&self.stiffness)
    }

    pub(super) fn of(&self, grain: usize) -> [f64; 2] {
        self.grains[grain]
    }

    pub(super) fn of_drive(&self, drive: usize) -> f64 {
        self.drives[drive]
    }

    /// Takes the balance at the pose, and with it what holds each body.
    pub(super) fn evaluate(&mut self, model: &Model, state: &State, work: &mut Workspace) {
        let Some(setup) = &model.plane else { return };
        self.stiffness.clear();
        self.stiffness.resize(model.len(), [[0.0; FREEDOMS]; FREEDOMS]);
        self.sides = [0.0; SIDES];
        self.moved = std::array::from_fn(|side| work.drives.iter().any(|d| d.shares[side] != 0.0));
        work.evaluate_and(model, state, |joint, act, body| {
            self.count(model, setup.turns, (joint, act, body));
        });
        // Glued grains are parts of their walls.
        for (i, side) in state.glued.iter().enumerate() {
            let Some(side) = side.map(usize::from) else { continue };
            let (slide, block) = (work.bodies[side].slide, &self.stiffness[i]);
            for a in 0..2 {
                for b in 0..2 {
                    self.sides[side] += slide[a] * block[a][b] * slide[b];
                }
            }
        }
    }

    fn count(
        &mut self,
        model: &Model,
        turns: bool,
        (joint, act, body): (&Joint, &Act, Option<&Body>),
    ) {
        let mut act = *act;
        // A contact that slides may stick again.
        let rubs = joint.held && !joint.opened && joint.shear.limit > 0.0;
        act.shear.stiffness = if rubs { joint.shear.stiffness } else { 0.0 };
        let flat = body.is_some_and(|body| matches!(body.shape, Shape::Plane(_)));
        let mut hold = |grain: usize, arm: f64, share: f64| {
            let own = own_block(&act, arm / model.radius[grain], flat, turns);
            for (to, from) in self.stiffness[grain].iter_mut().zip(own) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to += share * from);
            }
        };
        let first = joint.first as usize;
        match (joint.second, body) {
            (Other::Grain(j), _) => {
                hold(first, joint.arm[0], 1.0);
                hold(j as usize, -joint.arm[1], 1.0);
            }
            (Other::Wall(_), Some(body)) => {
                let side = usize::from(body.side);
                hold(first, joint.arm[0], if self.moved[side] { 1.0 } else { 0.5 });
                let close = act.sign * act.along.dot(&body.slide) + body.growth;
                let slip = act.pitch * left_of(act.along).dot(&body.slide);
                self.sides[side] +=
                    act.normal.stiffness * close * close + act.shear.stiffness * slip * slip;
            }
            (Other::Wall(_), None) => {}
        }
    }

    /// Takes the masses from the balance taken last; `unit` is one where nothing touches \[N/m\].
    pub(super) fn take(&mut self, drives: &[Drive], unit: f64) {
        self.grains.clear();
        self.grains.extend(self.stiffness.iter().map(row_sums));
        let [least, _] = raise(&mut self.grains, unit);
        for (k, drive) in drives.iter().enumerate() {
            self.drives[k] = self.held(drive).max(least);
        }
    }

    /// Raises masses that are too small for the balance taken last. Says what share of the new mass the
    /// old one was, of grains to `tell` and of drives to `tell_drive`.
    pub(super) fn grow(
        &mut self,
        drives: &[Drive],
        mut tell: impl FnMut(usize, [f64; 2]),
        mut tell_drive: impl FnMut(usize, f64),
    ) {
        for (i, (mass, stiffness)) in self.grains.iter_mut().zip(&self.stiffness).enumerate() {
            let [u, w] = row_sums(stiffness);
            if u > mass[0] || w > mass[1] {
                let now = [u.max(mass[0]), w.max(mass[1])];
                tell(i, [mass[0] / now[0], mass[1] / now[1]]);
                *mass = now;
            }
        }
        for (k, drive) in drives.iter().enumerate() {
            let held = self.held(drive);
            if held > self.drives[k] {
                tell_drive(k, self.drives[k] / held);
                self.drives[k] = held;
            }
        }
    }

    fn held(&self, drive: &Drive) -> f64 {
        drive.shares.iter().zip(self.sides).map(|(share, k)| share * share * k).sum()
    }
}

/// Largest sum of the absolute values of a row, of the displacement's and of the turn's.
fn row_sums(block: &Block) -> [f64; 2] {
    let [x, y, turn] = block.map(|row| row.iter().map(|entry| entry.abs()).sum::<f64>());
    [x.max(y), turn]
}

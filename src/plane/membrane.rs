//! Membranes: a pressure p on the outline of the pack, which bends with the grains (B 2.5).
//!
//! The outline is the polygon through the centres of the grains that a disc touches which rolls around
//! the pack (`outline`). With its area S the pressure has the potential p D S as long
//! as the grains of the outline are the same, which they are until the next reference. The outline goes
//! straight on to the sides at its ends, which do not feel it.

use super::matrix::{Block, FREEDOMS};
use super::outline::{Course, Finder, Pack};
use super::pose::Pose;
use super::{Cell, Vec2, left_of};
use crate::model::Model;
use crate::state::State;
use crate::wall;

/// Ends of an outline are where they shall be to this share of its length.
const SETTLED: f64 = 1e-12;

/// One membrane.
#[derive(Clone, Debug, Default)]
pub struct Membrane {
    /// Its side.
    pub side: usize,
    /// Pressure \[Pa\].
    pub pressure: f64,
    /// Depth D \[m\].
    pub depth: f64,
    /// The grains of the outline in order, the pack on their left.
    pub chain: Vec<u32>,
    /// Where the outline begins and ends along the second axis \[m\]; `None` where it is closed.
    pub ends: Option<[f64; 2]>,
    /// Unit vectors out of the pack and along the outline.
    pub axes: [Vec2; 2],
    /// Grains with their places in the chain, sorted.
    places: Vec<(u32, u32)>,
    /// Area, ends and the places of the first and last grain out of the pack, when the work began to be
    /// counted.
    before: (f64, [f64; 2], [f64; 2]),
}

impl Membrane {
    /// A membrane of this side that presses on the grains of `chain`.
    #[must_use]
    pub fn new(cell: &Cell, side: usize, pressure: f64) -> Self {
        let axes = match cell.inner {
            Some(_) => [Vec2::x(), Vec2::y()],
            None => {
                let mut out = Vec2::zeros();
                out[wall::axis(side)] = -wall::inward(side);
                [out, left_of(out)]
            }
        };
        let depth = cell.start.sides()[2];
        Self { side, pressure, depth, axes, ..Self::default() }
    }

    /// Finds the outline of the grains at `at` with the sides displaced by `displacement` \[m\].
    pub(super) fn wrap(
        &mut self,
        (model, cell): (&Model, &Cell),
        at: &[Vec2],
        displacement: &[f64; wall::COUNT],
        finder: &mut Finder,
    ) {
        let centre = cell.centre();
        self.ends = cell.inner.is_none().then(|| self.sides(cell, displacement));
        let course = match (self.ends, self.side) {
            (Some(ends), _) => Course::Between(ends),
            (None, 0) => Course::Within(centre),
            (None, _) => Course::Around(centre.y),
        };
        let (radius, mean_radius, axes) = (&*model.radius, model.mean_radius, self.axes);
        finder.find(&Pack { at, radius, mean_radius, axes }, course, &mut self.chain);
        self.places.clear();
        self.places.extend(self.chain.iter().zip(0..).map(|(&grain, place)| (grain, place)));
        self.places.sort_unstable();
    }

    /// Where the sides beside it are along the second axis, in its direction \[m\].
    fn sides(&self, cell: &Cell, displacement: &[f64; wall::COUNT]) -> [f64; 2] {
        let bounds = cell.bounds(displacement);
        let along = &self.axes[1];
        let axis = 1 - wall::axis(self.side);
        let ends = [bounds.min[axis], bounds.max[axis]].map(|x| x * along[axis]);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// Takes the ends to where the sides beside are; says whether they were elsewhere.
    pub(super) fn reach(&mut self, cell: &Cell, displacement: &[f64; wall::COUNT]) -> bool {
        let Some(before) = self.ends else { return false };
        let ends = self.sides(cell, displacement);
        self.ends = Some(ends);
        let far = SETTLED * (ends[1] - ends[0]);
        (0..2).any(|k| (ends[k] - before[k]).abs() > far)
    }

    fn local(&self, at: Vec2) -> Vec2 {
        Vec2::new(at.dot(&self.axes[0]), at.dot(&self.axes[1]))
    }

    /// The place in the chain before and after place `k`, the chain going on straight at its ends.
    fn around(&self, k: usize, at: &[Vec2]) -> [Vec2; 2] {
        let grain = |k: usize| self.local(at[self.chain[k] as usize]);
        let last = self.chain.len() - 1;
        let (before, after) = ((k + last) % (last + 1), (k + 1) % (last + 1));
        let Some([low, high]) = self.ends else { return [grain(before), grain(after)] };
        let own = grain(k);
        // As if each side were a mirror.
        let mirrored = |end: f64| Vec2::new(own.x, 2.0 * end - own.y);
        [
            if k == 0 { mirrored(low) } else { grain(before) },
            if k == last { mirrored(high) } else { grain(after) },
        ]
    }

    /// Area S between the outline and the line where the first axis begins, or inside of it where it is
    /// closed, negative for a hole \[m²\].
    #[must_use]
    pub fn area(&self, at: &[Vec2]) -> f64 {
        let grain = |k: usize| self.local(at[self.chain[k] as usize]);
        let count = self.chain.len();
        if count == 0 {
            return 0.0;
        }
        let piece = |a: Vec2, b: Vec2| 0.5 * (a.x + b.x) * (b.y - a.y);
        let open: f64 = (1..count).map(|k| piece(grain(k - 1), grain(k))).sum();
        let (first, last) = (grain(0), grain(count - 1));
        match self.ends {
            None => open + piece(last, first),
            Some([low, high]) => open + first.x * (first.y - low) + last.x * (high - last.y),
        }
    }

    /// Potential p D S \[J\].
    #[must_use]
    pub fn potential(&self, pose: &Pose) -> f64 {
        self.pressure * self.depth * self.area(&pose.at)
    }

    /// Gradient of the potential over the place `k` of the chain \[N\].
    fn pull(&self, k: usize, at: &[Vec2]) -> Vec2 {
        let [before, after] = self.around(k, at);
        let half = 0.5 * self.pressure * self.depth;
        self.axes[0] * (half * (after.y - before.y)) + self.axes[1] * (half * (before.x - after.x))
    }

    /// Adds the gradient of the potential.
    pub(super) fn add_gradient(&self, pose: &Pose, gradient: &mut [f64]) {
        for (k, &grain) in self.chain.iter().enumerate() {
            let pull = self.pull(k, &pose.at);
            gradient[FREEDOMS * grain as usize] += pull.x;
            gradient[FREEDOMS * grain as usize + 1] += pull.y;
        }
    }

    /// Force of the pressure on grain `grain` \[N\].
    pub(super) fn force(&self, grain: u32, pose: &Pose) -> Vec2 {
        let from = self.places.partition_point(|&(other, _)| other < grain);
        let own = self.places[from..].iter().take_while(|&&(other, _)| other == grain);
        -own.map(|&(_, k)| self.pull(k as usize, &pose.at)).sum::<Vec2>()
    }

    /// The pairs of grains along the outline, in order.
    pub(super) fn links(&self) -> impl Iterator<Item = (u32, u32)> {
        let count = self.chain.len();
        let pairs = if self.ends.is_some() { count.saturating_sub(1) } else { count };
        let pairs = if count < 2 { 0 } else { pairs };
        (0..pairs).map(move |k| (self.chain[k], self.chain[(k + 1) % count]))
    }

    /// Adds the second derivative of the potential to the blocks of the grains, and to those of the
    /// [`links`](Self::links).
    pub(super) fn add_slope(&self, diagonal: &mut [Block], links: &mut [Block]) {
        let half = 0.5 * self.pressure * self.depth;
        for ((a, b), block) in self.links().zip(links) {
            // ∂²S/∂u_a∂v_b = 1/2 = -∂²S/∂v_a∂u_b, whichever way the axes point.
            let sign = if a < b { half } else { -half };
            block[0][1] += sign;
            block[1][0] -= sign;
        }
        if self.ends.is_none() {
            return;
        }
        let [out, along] = self.axes;
        for (grain, sign) in [(self.chain.first(), half), (self.chain.last(), -half)] {
            let Some(&grain) = grain else { continue };
            let block = &mut diagonal[grain as usize];
            for a in 0..2 {
                for b in 0..2 {
                    block[a][b] += sign * (out[a] * along[b] + along[a] * out[b]);
                }
            }
        }
    }

    /// Where the outline is on average, out of the pack \[m\]: the radius where it is closed, negative
    /// for a hole.
    #[must_use]
    pub fn position(&self, at: &[Vec2]) -> f64 {
        let area = self.area(at);
        match self.ends {
            Some([low, high]) => area / (high - low),
            None => area.signum() * (area.abs() / std::f64::consts::PI).sqrt(),
        }
    }

    pub(super) fn heap_bytes(&self) -> usize {
        crate::heap::bytes(&self.chain) + crate::heap::bytes(&self.places)
    }

    /// Begins to count the work of the pressure.
    pub(super) fn mark(&mut self, at: &[Vec2]) {
        self.before = self.now(at);
    }

    fn now(&self, at: &[Vec2]) -> (f64, [f64; 2], [f64; 2]) {
        let out =
            |grain: Option<&u32>| grain.map_or(0.0, |&grain| self.local(at[grain as usize]).x);
        let first_and_last = [out(self.chain.first()), out(self.chain.last())];
        (self.area(at), self.ends.unwrap_or_default(), first_and_last)
    }

    /// Work of the pressure on the grains since [`mark`](Self::mark), while it went from `from` \[Pa\] to
    /// what it is \[J\]. What the sides at its ends did to S is none.
    pub(super) fn work(&self, at: &[Vec2], from: f64) -> f64 {
        let (area, ends, out) = self.before;
        let (area_now, ends_now, out_now) = self.now(at);
        let mean = |k: usize| 0.5 * (out[k] + out_now[k]);
        let strips = mean(0) * (ends_now[0] - ends[0]) - mean(1) * (ends_now[1] - ends[1]);
        -0.5 * (from + self.pressure) * self.depth * (area_now - area + strips)
    }
}

/// The membranes of a cell, each under the pressure that `state` has, around the grains at `at`.
pub(super) fn wrap(
    model: &Model,
    state: &mut State,
    at: &[Vec2],
    (membranes, finder): (&mut Vec<Membrane>, &mut Finder),
) {
    let Some(setup) = &model.plane else { return };
    let cell = &setup.cell;
    membranes.clear();
    for side in (0..super::boundary::SIDES).filter(|&side| cell.is_membrane(side)) {
        let mut membrane = Membrane::new(cell, side, state.pressure[side]);
        membrane.wrap((model, cell), at, &state.displacement, finder);
        membrane.mark(at);
        // What it presses on carries load.
        membrane.chain.iter().for_each(|&grain| state.carries[grain as usize] = true);
        membranes.push(membrane);
    }
}

//! The grains of one part of the order in motion, and the forces on them: forces alone, without
//! the linearisation that a balance has, and in a third of its time.
//!
//! A part has the pairs of its own grains once, and those with grains of another part from its
//! own side, so that the parts can be filled at the same time and the number of threads does not
//! enter. Lengths are in mean radii, moduli in that of two mean grains.

use crate::contact::neighbours::Neighbours;
use crate::model::Model;
use crate::relax::cool::Units;
use crate::relax::lanes::{Kernel, Lanes, dispatch};
use crate::wall;

/// Contacts that are computed together, and how many of them are summed side by side.
const BATCH: usize = 128;
const LANES: usize = 8;
/// Least distance of two centres.
const LEAST_DISTANCE: f32 = 1e-6;

/// x, y, z and a zero.
pub(super) type Point = [f64; 4];

/// Sums over contacts; what two parts share counts half in each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Sum of the normal forces, and number of contacts.
    force: f64,
    contacts: f64,
    /// Sum of the overlaps.
    overlap: f64,
    /// Σ P n̂ r along each axis.
    pub(super) virial: Point,
}

impl Sums {
    pub(super) fn add(&mut self, other: &Self) {
        self.force += other.force;
        self.contacts += other.contacts;
        self.overlap += other.overlap;
        for (sum, more) in self.virial.iter_mut().zip(&other.virial) {
            *sum += more;
        }
    }

    /// Mean normal force.
    pub(super) fn mean_force(&self) -> f64 {
        self.force / self.contacts.max(1.0)
    }

    /// Mean overlap.
    pub(super) fn mean_overlap(&self) -> f64 {
        self.overlap / self.contacts.max(1.0)
    }
}

/// A pair that can touch.
#[derive(Clone, Copy, Debug)]
struct Pair {
    second: u32,
    modulus: f32,
    /// Ri + Rj.
    reach: f64,
}

/// Rows of pairs, one a grain of the part.
#[derive(Clone, Debug, Default)]
struct Rows {
    start: Vec<u32>,
    pairs: Vec<Pair>,
}

impl Rows {
    fn row(&self, row: usize) -> &[Pair] {
        &self.pairs[self.start[row] as usize..self.start[row + 1] as usize]
    }
}

/// A grain with a wall that it can touch.
#[derive(Clone, Copy, Debug)]
struct AtWall {
    row: u32,
    axis: u8,
    /// Of the wall's position: -1 for the lower wall, 1 for the upper.
    side: f64,
    radius: f64,
    modulus: f64,
}

/// The grains of one part.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// First grain.
    first: usize,
    /// Pairs with both grains in the part, and those whose second grain is in another.
    inner: Rows,
    outer: Rows,
    at_walls: Vec<AtWall>,
    /// -F of each grain.
    gradient: Vec<Point>,
    velocity: Vec<Point>,
    /// One over the mass of each grain.
    lightness: Vec<f64>,
    /// Sums of the last forces.
    pub(super) sums: Sums,
    /// Sum of the squares of the last forces, and the largest speed.
    pub(super) square: f64,
    pub(super) fastest: f64,
}

/// How grains move in one step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    /// Time.
    pub(super) time: f64,
    /// What is left of the velocities.
    pub(super) keep: f64,
    /// Largest speed.
    pub(super) limit: f64,
    /// What the box is stretched by along each axis.
    pub(super) stretch: Point,
}

impl Part {
    /// Grains from `first` on at rest, with masses one over `lightness`.
    pub(super) fn new(first: usize, lightness: Vec<f64>) -> Self {
        let still = vec![[0.0; 4]; lightness.len()];
        Self { first, gradient: still.clone(), velocity: still, lightness, ..Self::default() }
    }

    /// -F of each grain.
    #[cfg(test)]
    pub(super) fn gradient(&self) -> &[Point] {
        &self.gradient
    }

    /// Takes the pairs of a new list.
    pub(super) fn list(&mut self, model: &Model, near: &Neighbours, units: &Units) {
        let range = self.first..self.first + self.lightness.len();
        for rows in [&mut self.inner, &mut self.outer] {
            rows.start.clear();
            rows.pairs.clear();
        }
        self.at_walls.clear();
        for i in range.clone() {
            self.inner.start.push(self.inner.pairs.len() as u32);
            for k in near.row(i) {
                let j = near.second[k] as usize;
                if !range.contains(&j) {
                    continue;
                }
                self.inner.pairs.push(Pair {
                    second: (j - self.first) as u32,
                    modulus: (near.modulus[k] / units.modulus) as f32,
                    reach: (model.radius[i] + model.radius[j]) / units.length,
                });
            }
            for (wall, _) in near.walls_near(model, i) {
                let wall = usize::from(wall);
                self.at_walls.push(AtWall {
                    row: (i - self.first) as u32,
                    axis: wall::axis(wall) as u8,
                    side: -wall::inward(wall),
                    radius: model.radius[i] / units.length,
                    modulus: near.wall_modulus(i, wall) / units.modulus,
                });
            }
        }
        self.inner.start.push(self.inner.pairs.len() as u32);
        self.list_outer(model, near, units);
    }

    /// Takes the pairs with other parts, from this side.
    fn list_outer(&mut self, model: &Model, near: &Neighbours, units: &Units) {
        let range = self.first..self.first + self.lightness.len();
        let mut crossing = Vec::new();
        for i in 0..range.end {
            let row = near.row(i);
            // A row ascends from behind its own grain.
            let beyond = if i < range.start { range.start } else { range.end };
            if near.second[row.clone()].last().is_none_or(|&last| (last as usize) < beyond) {
                continue;
            }
            for k in row {
                let j = near.second[k] as usize;
                match (range.contains(&i), range.contains(&j)) {
                    (true, false) => crossing.push((i, j, k)),
                    (false, true) => crossing.push((j, i, k)),
                    _ => {}
                }
            }
        }
        crossing.sort_unstable();
        let mut next = crossing.iter().peekable();
        for i in range {
            self.outer.start.push(self.outer.pairs.len() as u32);
            while let Some(&(_, j, k)) = next.next_if(|&&(own, ..)| own == i) {
                self.outer.pairs.push(Pair {
                    second: j as u32,
                    modulus: (near.modulus[k] / units.modulus) as f32,
                    reach: (model.radius[i] + model.radius[j]) / units.length,
                });
            }
        }
        self.outer.start.push(self.outer.pairs.len() as u32);
    }

    /// Takes the forces at `position` between walls at plus and minus `half`.
    pub(super) fn press(&mut self, position: &[Point], half: &Point) {
        dispatch(Press { part: self, position, half });
    }

    /// Moves the grains of this part, which are at `position`.
    pub(super) fn go(&mut self, position: &mut [Point], step: &Step) {
        dispatch(Go { part: self, position, step });
    }
}

/// Contacts side by side.
struct Batch {
    count: usize,
    ends: [(u32, u32); BATCH],
    /// From the second to the first.
    branch: [Point; BATCH],
    /// |r|², and (Ri + Rj)² - |r|².
    square: [f32; BATCH],
    gap: [f32; BATCH],
    reach: [f32; BATCH],
    modulus: [f32; BATCH],
    /// P/r.
    bending: [f32; BATCH],
}

impl Batch {
    #[inline(always)]
    fn new() -> Self {
        let (zeros, ones) = ([0.0; BATCH], [1.0; BATCH]);
        Self {
            count: 0,
            ends: [(0, 0); BATCH],
            branch: [[0.0; 4]; BATCH],
            square: ones,
            gap: zeros,
            reach: ones,
            modulus: zeros,
            bending: zeros,
        }
    }

    /// Takes a pair if it touches; the count alone tells, so that nothing needs to be guessed.
    #[inline(always)]
    fn take(&mut self, row: usize, pair: &Pair, at: &Point, second: &Point) {
        let branch: Point = std::array::from_fn(|axis| at[axis] - second[axis]);
        let square = branch[0] * branch[0] + branch[1] * branch[1] + branch[2] * branch[2];
        let gap = pair.reach * pair.reach - square;
        let n = self.count;
        self.ends[n] = (row as u32, pair.second);
        self.branch[n] = branch;
        self.square[n] = square as f32;
        self.gap[n] = gap as f32;
        self.reach[n] = pair.reach as f32;
        self.modulus[n] = pair.modulus;
        self.count = n + usize::from(gap > 0.0);
    }

    /// Forces; `share` of what they sum up to goes to `sums`.
    #[inline(always)]
    fn press(&mut self, share: f64, sums: &mut Sums) {
        // The rest are those of an earlier batch, and one that does not touch.
        let end = self.count.next_multiple_of(LANES);
        self.modulus[self.count..end].fill(0.0);
        self.gap[self.count..end].fill(0.0);
        let (mut force, mut overlap) = ([0.0; LANES], [0.0; LANES]);
        for from in (0..end).step_by(LANES) {
            for lane in 0..LANES {
                let n = from + lane;
                let distance = self.square[n].sqrt().max(LEAST_DISTANCE);
                let h = self.gap[n] / (self.reach[n] + distance);
                let p = self.modulus[n] * h * h.sqrt();
                self.bending[n] = p / distance;
                force[lane] += p;
                overlap[lane] += h;
            }
        }
        let sum = |lanes: [f32; LANES]| lanes.iter().map(|&x| f64::from(x)).sum::<f64>() * share;
        sums.force += sum(force);
        sums.overlap += sum(overlap);
        sums.contacts += self.count as f64 * share;
    }
}

struct Press<'a> {
    part: &'a mut Part,
    position: &'a [Point],
    half: &'a Point,
}

impl Kernel for Press<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { part, position, half } = self;
        let Part { inner, outer, at_walls, gradient, .. } = part;
        let own = &position[part.first..][..gradient.len()];
        let mut sums = Sums::default();
        let mut batch = Batch::new();
        gradient.fill([0.0; 4]);
        for (row, at) in own.iter().enumerate() {
            for pair in inner.row(row) {
                batch.take(row, pair, at, &own[pair.second as usize]);
                if batch.count == BATCH {
                    empty::<true>(&mut batch, gradient, &mut sums);
                }
            }
        }
        empty::<true>(&mut batch, gradient, &mut sums);
        if !outer.pairs.is_empty() {
            for (row, at) in own.iter().enumerate() {
                for pair in outer.row(row) {
                    batch.take(row, pair, at, &position[pair.second as usize]);
                    if batch.count == BATCH {
                        empty::<false>(&mut batch, gradient, &mut sums);
                    }
                }
            }
            empty::<false>(&mut batch, gradient, &mut sums);
        }
        for near in at_walls.iter() {
            let (row, axis) = (near.row as usize, usize::from(near.axis));
            let distance = half[axis] - near.side * own[row][axis];
            let h = near.radius - distance;
            if h > 0.0 {
                let p = near.modulus * h * h.sqrt();
                sums.force += p;
                sums.overlap += h;
                sums.contacts += 1.0;
                sums.virial[axis] += p * distance;
                gradient[row][axis] += p * near.side;
            }
        }
        part.sums = sums;
    }
}

/// Takes the contacts of `batch` into the gradient of their first grains, and of their second
/// ones where `BOTH`.
#[inline(always)]
fn empty<const BOTH: bool>(batch: &mut Batch, gradient: &mut [Point], sums: &mut Sums) {
    let share = if BOTH { 1.0 } else { 0.5 };
    batch.press(share, sums);
    let mut virial = [0.0; 4];
    for n in 0..batch.count {
        let (row, second) = batch.ends[n];
        let branch = &batch.branch[n];
        let bending = f64::from(batch.bending[n]);
        let push: Point = std::array::from_fn(|axis| branch[axis] * bending);
        for axis in 0..4 {
            virial[axis] += push[axis] * branch[axis];
            gradient[row as usize][axis] -= push[axis];
        }
        if BOTH {
            for axis in 0..4 {
                gradient[second as usize][axis] += push[axis];
            }
        }
    }
    for (sum, more) in sums.virial.iter_mut().zip(&virial) {
        *sum += share * more;
    }
    batch.count = 0;
}

struct Go<'a> {
    part: &'a mut Part,
    position: &'a mut [Point],
    step: &'a Step,
}

impl Kernel for Go<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { part, position, step } = self;
        let limit = step.limit * step.limit;
        let (mut square, mut fastest) = ([0.0; 4], 0.0_f64);
        let grains = position.iter_mut().zip(&mut part.velocity);
        for ((at, velocity), (gradient, lightness)) in
            grains.zip(part.gradient.iter().zip(&part.lightness))
        {
            let push = step.time * lightness;
            for axis in 0..4 {
                square[axis] += gradient[axis] * gradient[axis];
                velocity[axis] = velocity[axis] * step.keep - gradient[axis] * push;
            }
            let [x, y, z, _] = *velocity;
            let speed = x * x + y * y + z * z;
            if speed > limit {
                let slower = (limit / speed).sqrt();
                velocity.iter_mut().for_each(|v| *v *= slower);
            }
            fastest = fastest.max(speed.min(limit));
            for axis in 0..4 {
                at[axis] = at[axis] * step.stretch[axis] + velocity[axis] * step.time;
            }
        }
        part.square = square.iter().sum();
        part.fastest = fastest.sqrt();
    }
}

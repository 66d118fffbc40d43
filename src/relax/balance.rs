//! The balance of forces at one configuration: energy, gradient, and what its linearisation needs.

use rayon::join;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, plane_gap};
use crate::heap;
use crate::model::Model;
use crate::relax::block::Block;
use crate::relax::curvature::Curvature;
use crate::relax::lanes::{Kernel, Lanes, dispatch};
use crate::relax::tangential::{Pull, Reference, Traction};
use crate::wall::{self, Facing, Room};

/// Rows that are summed as one; the bits depend on it, the number of threads does not enter.
const CHUNK: usize = 256;
/// Contacts that are computed together, and how many of them a register may hold at most.
const BATCH: usize = 128;
const LANES: usize = 8;

/// One grain-grain contact of the linearisation: K = m mᵀ - b I, in units of the reference stiffness.
#[derive(Clone, Copy, Debug, Default)]
pub struct Link {
    /// √(kn + P/r) n̂.
    pub m: [f32; 3],
    /// P/r.
    pub b: f32,
    /// The second grain.
    pub second: u32,
}

/// Sums over the load-carrying contacts.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sums {
    /// Π \[J\] (T 2.7), without shear and torsion.
    pub energy: f64,
    /// Sum of the normal forces \[N\].
    pub force: f64,
    /// Sum of the overlaps \[m\].
    pub overlap: f64,
    /// Sum of P/r over the grain-grain contacts \[N/m\].
    pub bending: f64,
    /// Σ P n̂ r over the contacts, along each axis \[J\]: the volume times the normal stress.
    pub virial: [f64; 3],
    /// Number of contacts.
    pub contacts: u32,
}

impl Sums {
    /// Of no contact.
    pub const NONE: Self =
        Self { energy: 0.0, force: 0.0, overlap: 0.0, bending: 0.0, virial: [0.0; 3], contacts: 0 };

    /// Mean normal force \[N\]; 0 without contacts.
    #[must_use]
    pub fn mean_force(&self) -> f64 {
        self.force / f64::from(self.contacts.max(1))
    }

    /// Mean overlap \[m\]; 0 without contacts.
    #[must_use]
    pub fn mean_overlap(&self) -> f64 {
        self.overlap / f64::from(self.contacts.max(1))
    }

    fn add(&mut self, other: &Self) {
        self.energy += other.energy;
        self.force += other.force;
        self.overlap += other.overlap;
        self.bending += other.bending;
        for axis in 0..3 {
            self.virial[axis] += other.virial[axis];
        }
        self.contacts += other.contacts;
    }
}

/// Gradient and linearisation at one configuration.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// -F of each grain \[N\], shape (n); zero for grains that take no part.
    pub gradient: Vec<Vec3>,
    /// Contacts of row i at `Neighbours::row(i).start ..`, as many as `links_in_row[i]`.
    pub links: Vec<Link>,
    /// Number of contacts in each row, shape (n).
    pub links_in_row: Vec<u32>,
    /// Stiffness of the wall contacts along the axes, in units of the reference, shape (n).
    pub wall_stiffness: Vec<[f32; 3]>,
    /// Its xy, shape (n); empty where all walls are planes.
    pub wall_cross: Vec<f32>,
    /// Gradient with respect to w = ΩR, -M/R of each grain \[N\], shape (n); empty without friction.
    pub moment: Vec<Vec3>,
    /// Answers of the contacts at the reference, in their order; empty without friction.
    pub tractions: Vec<Traction>,
    /// Sum of the potentials of shear and torsion \[J\].
    pub shear_potential: f64,
    /// Potential of the pressures of membranes \[J\].
    pub membrane_potential: f64,
    /// Second derivative of that potential, in units of the reference stiffness.
    pub curvature: Curvature,
    /// Normal force of cement on each wall \[N\].
    pub cement_on_walls: [f64; wall::COUNT],
    /// Totals.
    pub sums: Sums,
    /// Force on the walls of each drive of the servo beyond its load \[N\].
    pub unbalance: [f64; 3],
    /// How often the balance was taken.
    pub evaluations: u64,
    /// Force on `second` of each link, negated \[N\], in the places of `links`.
    pair_force: Vec<Vec3>,
    chunk_sums: Vec<Sums>,
    /// Scratch of the tangential forces.
    pub(super) pulls: Vec<Pull>,
}

/// What the balance is taken of.
#[derive(Clone, Copy, Debug)]
pub struct Configuration<'a> {
    /// Constants.
    pub model: &'a Model,
    /// Pairs that can touch.
    pub neighbours: &'a Neighbours,
    /// Centres \[m\].
    pub position: &'a [Vec3],
    /// Grains that take part.
    pub carries: &'a [bool],
    /// Rotations \[rad\]; empty without friction.
    pub rotation: &'a [Vec3],
    /// Where shear and torsion are counted from.
    pub reference: &'a Reference,
    /// The box.
    pub bounds: &'a Room,
    /// Stiffness \[N/m\] that the linearisation is scaled by.
    pub reference_stiffness: f64,
}

/// The part of a balance that one task fills.
struct Part<'a> {
    first_row: usize,
    gradient: &'a mut [Vec3],
    links: &'a mut [Link],
    pair_force: &'a mut [Vec3],
    links_in_row: &'a mut [u32],
    wall_stiffness: &'a mut [[f32; 3]],
    sums: &'a mut [Sums],
}

impl Balance {
    /// Evaluates the balance at `at`.
    pub fn evaluate(&mut self, at: &Configuration<'_>) {
        let rows = at.position.len();
        let pairs = at.neighbours.second.len();
        self.evaluations += 1;
        self.gradient.resize(rows, Vec3::zeros());
        self.links_in_row.resize(rows, 0);
        self.wall_stiffness.resize(rows, [0.0; 3]);
        self.links.resize(pairs, Link::default());
        self.pair_force.resize(pairs, Vec3::zeros());
        self.chunk_sums.resize(rows.div_ceil(CHUNK), Sums::default());
        Part {
            first_row: 0,
            gradient: &mut self.gradient,
            links: &mut self.links,
            pair_force: &mut self.pair_force,
            links_in_row: &mut self.links_in_row,
            wall_stiffness: &mut self.wall_stiffness,
            sums: &mut self.chunk_sums,
        }
        .fill(at);
        self.sums = Sums::default();
        for chunk in &self.chunk_sums {
            self.sums.add(chunk);
        }
        self.react(at.neighbours);
        self.wall_cross.clear();
        if at.bounds.is_round() {
            self.press_on_round(at);
        }
        self.weigh(at);
        let membranes = &at.reference.membranes;
        self.membrane_potential = membranes.press(at.position, &mut self.gradient);
        membranes.bend(at.position, 1.0 / at.reference_stiffness, &mut self.curvature);
        at.reference.evaluate(self, at);
    }

    /// Adds the reactions on the second grain of each contact, in the order of the list.
    fn react(&mut self, neighbours: &Neighbours) {
        for i in 0..self.gradient.len() {
            let first = neighbours.row(i).start;
            for k in first..first + self.links_in_row[i] as usize {
                self.gradient[self.links[k].second as usize] += self.pair_force[k];
            }
        }
    }

    /// Adds the contacts with the walls of a round room. With the gap g the overlap is R - g, and the
    /// second derivative of its energy kn ∇g ∇gᵀ - P ∇∇g.
    fn press_on_round(&mut self, at: &Configuration<'_>) {
        let Configuration { model, neighbours, position, carries, bounds, .. } = *at;
        let scale = 1.0 / at.reference_stiffness;
        self.wall_cross.resize(position.len(), 0.0);
        for (i, xi) in position.iter().enumerate().filter(|(i, _)| carries[*i]) {
            for (wall, reach) in neighbours.walls_near(model, i) {
                let wall = usize::from(wall);
                let Facing { gap, normal, bend } = bounds.facing(xi, wall);
                let overlap = reach - gap;
                if overlap <= 0.0 {
                    continue;
                }
                let modulus = neighbours.wall_modulus(i, wall);
                let force = hertz::force(modulus, overlap);
                self.sums.energy += hertz::energy(force, overlap);
                self.sums.force += force;
                self.sums.overlap += overlap;
                self.sums.contacts += 1;
                for axis in 0..3 {
                    self.sums.virial[axis] += force * gap * normal[axis] * normal[axis];
                }
                self.gradient[i] -= normal * force;
                let (along, around) = (hertz::stiffness(modulus, overlap), -force * bend);
                let [nx, ny, nz] = normal.into();
                let entry = |n: f64, t: f64| ((along * n + around * t) * scale) as f32;
                let stiffness = &mut self.wall_stiffness[i];
                // Around the axis is along (-ny, nx, 0).
                stiffness[0] += entry(nx * nx, ny * ny);
                stiffness[1] += entry(ny * ny, nx * nx);
                stiffness[2] += entry(nz * nz, 0.0);
                self.wall_cross[i] += entry(nx * ny, -nx * ny);
            }
        }
    }

    /// Stiffness of grain `i`'s wall contacts, in units of the reference.
    pub(super) fn wall_block(&self, i: usize) -> Block {
        let mut block = Block::diagonal(self.wall_stiffness[i]);
        block.off.0[0] = self.cross_stiffness(i);
        block
    }

    /// xy of the stiffness of grain `i`'s wall contacts, in units of the reference.
    #[must_use]
    pub fn cross_stiffness(&self, i: usize) -> f32 {
        self.wall_cross.get(i).copied().unwrap_or(0.0)
    }

    /// Adds weights and their potential (T 2.7).
    fn weigh(&mut self, at: &Configuration<'_>) {
        let origin = Vec3::from(at.bounds.center());
        for (i, weight) in at.model.weight.iter().enumerate() {
            if at.carries[i] {
                self.gradient[i] -= weight;
                self.sums.energy -= weight.dot(&(at.position[i] - origin));
            }
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.gradient)
            + heap::bytes(&self.links)
            + heap::bytes(&self.links_in_row)
            + heap::bytes(&self.wall_stiffness)
            + heap::bytes(&self.wall_cross)
            + self.curvature.heap_bytes()
            + heap::bytes(&self.moment)
            + heap::bytes(&self.tractions)
            + heap::bytes(&self.pulls)
            + heap::bytes(&self.pair_force)
            + heap::bytes(&self.chunk_sums)
    }

    /// Largest unbalanced force of a grain, or moment over radius \[N\]; no number where one is none.
    #[must_use]
    pub fn largest(&self) -> f64 {
        let all = self.gradient.iter().chain(&self.moment);
        all.map(Vec3::norm_squared)
            .fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
            .sqrt()
    }

    /// What the search for the equilibrium descends \[J\].
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.sums.energy + self.shear_potential + self.membrane_potential
    }
}

impl Part<'_> {
    /// Fills this part, in parallel where it is larger than a chunk.
    fn fill(self, at: &Configuration<'_>) {
        let rows = self.gradient.len();
        if rows <= CHUNK {
            return self.fill_chunk(at);
        }
        let middle = rows.div_ceil(CHUNK).div_ceil(2) * CHUNK;
        let row = self.first_row + middle;
        let pair = at.neighbours.start[row] - at.neighbours.start[self.first_row];
        let (gradient, gradient_b) = self.gradient.split_at_mut(middle);
        let (links, links_b) = self.links.split_at_mut(pair as usize);
        let (pair_force, pair_force_b) = self.pair_force.split_at_mut(pair as usize);
        let (links_in_row, links_in_row_b) = self.links_in_row.split_at_mut(middle);
        let (wall_stiffness, wall_stiffness_b) = self.wall_stiffness.split_at_mut(middle);
        let (sums, sums_b) = self.sums.split_at_mut(middle / CHUNK);
        let first_row = self.first_row;
        let low =
            Part { first_row, gradient, links, pair_force, links_in_row, wall_stiffness, sums };
        let high = Part {
            first_row: row,
            gradient: gradient_b,
            links: links_b,
            pair_force: pair_force_b,
            links_in_row: links_in_row_b,
            wall_stiffness: wall_stiffness_b,
            sums: sums_b,
        };
        join(|| low.fill(at), || high.fill(at));
    }

    fn fill_chunk(self, at: &Configuration<'_>) {
        match at.bounds.is_round() {
            false => dispatch(Fill::<true> { part: self, at }),
            true => dispatch(Fill::<false> { part: self, at }),
        }
    }
}

/// Contacts whose forces are computed together, so that the compiler can put several in a register.
struct Batch {
    count: usize,
    /// Row in the part, and second grain.
    ends: [(u32, u32); BATCH],
    /// r_ij \[m\], from j to i, along each axis.
    branch: [[f64; BATCH]; 3],
    /// |r_ij|² \[m²\].
    square: [f64; BATCH],
    /// Ri + Rj \[m\].
    reach: [f64; BATCH],
    /// M \[N/m^1.5\].
    modulus: [f64; BATCH],
    /// h \[m\].
    overlap: [f64; BATCH],
    /// P \[N\].
    force: [f64; BATCH],
    /// P/r \[N/m\].
    bending: [f64; BATCH],
    /// √(kn + P/r) / r in units of the reference stiffness.
    root: [f64; BATCH],
}

impl Batch {
    #[inline(always)]
    fn new() -> Self {
        let zeros = [0.0; BATCH];
        Self {
            count: 0,
            ends: [(0, 0); BATCH],
            branch: [zeros; 3],
            square: [1.0; BATCH],
            reach: zeros,
            modulus: zeros,
            overlap: zeros,
            force: zeros,
            bending: zeros,
            root: zeros,
        }
    }

    /// Forces and stiffnesses; `scale` is one over the reference stiffness. Entries beyond the
    /// count are those of an earlier batch.
    #[inline(always)]
    fn press(&mut self, scale: f64) {
        for k in 0..self.count.next_multiple_of(LANES).min(BATCH) {
            let distance = self.square[k].sqrt();
            let overlap = self.reach[k] - distance; // (2.4a)
            let force = hertz::force(self.modulus[k], overlap);
            let bending = force / distance;
            let stiffness = hertz::stiffness(self.modulus[k], overlap);
            self.overlap[k] = overlap;
            self.force[k] = force;
            self.bending[k] = bending;
            self.root[k] = ((stiffness + bending) * scale).sqrt() / distance;
        }
    }
}

/// Fills a part, with the contacts at walls that are `PLANES`; others are added later.
struct Fill<'a, 'b, const PLANES: bool> {
    part: Part<'a>,
    at: &'a Configuration<'b>,
}

impl<const PLANES: bool> Kernel for Fill<'_, '_, PLANES> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { mut part, at } = self;
        let Configuration { model, neighbours, position, carries, .. } = *at;
        let scale = 1.0 / at.reference_stiffness;
        let mut sums = Sums::default();
        let mut batch = Batch::new();
        part.gradient.fill(Vec3::zeros());
        part.links_in_row.fill(0);
        for row in 0..part.gradient.len() {
            let i = part.first_row + row;
            part.wall_stiffness[row] = [0.0; 3];
            if !carries[i] {
                continue;
            }
            let xi = position[i];
            for k in neighbours.row(i) {
                let j = neighbours.second[k];
                let branch = xi - position[j as usize]; // r_ij, from j to i
                let reach = neighbours.reach(model, i, k);
                let square = branch.norm_squared();
                if square >= reach * reach || reach <= 0.0 || !carries[j as usize] {
                    continue;
                }
                let n = batch.count;
                batch.ends[n] = (row as u32, j);
                for axis in 0..3 {
                    batch.branch[axis][n] = branch[axis];
                }
                batch.square[n] = square;
                batch.reach[n] = reach;
                batch.modulus[n] = neighbours.modulus[k];
                batch.count = n + 1;
                if batch.count == BATCH {
                    part.empty(&mut batch, &mut sums, at, scale);
                }
            }
            if !PLANES {
                continue;
            }
            for (wall, reach) in neighbours.walls_near(model, i) {
                let wall = usize::from(wall);
                let overlap = reach - plane_gap(&xi, wall, at.bounds); // (2.4b)
                if overlap > 0.0 {
                    let modulus = neighbours.wall_modulus(i, wall);
                    let force = hertz::force(modulus, overlap);
                    sums.energy += hertz::energy(force, overlap);
                    sums.force += force;
                    sums.overlap += overlap;
                    sums.contacts += 1;
                    let axis = wall::axis(wall);
                    sums.virial[axis] += force * (reach - overlap);
                    part.gradient[row][axis] -= force * wall::inward(wall);
                    part.wall_stiffness[row][axis] +=
                        (hertz::stiffness(modulus, overlap) * scale) as f32;
                }
            }
        }
        part.empty(&mut batch, &mut sums, at, scale);
        part.sums[0] = sums;
    }
}

impl Part<'_> {
    /// Takes the contacts of `batch` into this part and its sums.
    #[inline(always)]
    fn empty(&mut self, batch: &mut Batch, sums: &mut Sums, at: &Configuration<'_>, scale: f64) {
        batch.press(scale);
        let first_pair = at.neighbours.row(self.first_row).start;
        for n in 0..batch.count {
            let (row, second) = batch.ends[n];
            let row = row as usize;
            let branch = Vec3::new(batch.branch[0][n], batch.branch[1][n], batch.branch[2][n]);
            let (force, overlap, bending) = (batch.force[n], batch.overlap[n], batch.bending[n]);
            sums.energy += hertz::energy(force, overlap);
            sums.force += force;
            sums.overlap += overlap;
            sums.bending += bending;
            let push = branch * bending;
            for axis in 0..3 {
                sums.virial[axis] += push[axis] * branch[axis];
            }
            self.gradient[row] -= push;
            let count = &mut self.links_in_row[row];
            let place =
                at.neighbours.row(self.first_row + row).start - first_pair + *count as usize;
            *count += 1;
            self.pair_force[place] = push;
            let m = branch * batch.root[n];
            self.links[place] = Link {
                m: [m.x as f32, m.y as f32, m.z as f32],
                b: (bending * scale) as f32,
                second,
            };
        }
        sums.contacts += batch.count as u32;
        batch.count = 0;
    }
}

//! The balance of forces at one configuration: energy, gradient, and what its linearisation needs.

use rayon::join;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::relax::tangential::{Pull, Reference, Traction};
use crate::wall::{self, Bounds};

/// Rows that are summed as one; the bits depend on it, the number of threads does not enter.
const CHUNK: usize = 256;

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
    /// Gradient with respect to w = ΩR, -M/R of each grain \[N\], shape (n); empty without friction.
    pub moment: Vec<Vec3>,
    /// Answers of the contacts at the reference, in their order; empty without friction.
    pub tractions: Vec<Traction>,
    /// Sum of the potentials of shear and torsion \[J\].
    pub shear_potential: f64,
    /// Totals.
    pub sums: Sums,
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
    pub bounds: &'a Bounds,
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
        self.weigh(at);
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

    /// Largest unbalanced force of a grain, or moment over radius \[N\].
    #[must_use]
    pub fn largest(&self) -> f64 {
        let all = self.gradient.iter().chain(&self.moment);
        all.map(Vec3::norm_squared).fold(0.0, f64::max).sqrt()
    }

    /// What the search for the equilibrium descends \[J\].
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.sums.energy + self.shear_potential
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
        let Configuration { model, neighbours, position, .. } = *at;
        let scale = 1.0 / at.reference_stiffness;
        let first_pair = neighbours.row(self.first_row).start;
        let mut sums = Sums::default();
        for row in 0..self.gradient.len() {
            let i = self.first_row + row;
            let mut gradient = Vec3::zeros();
            let mut walls = [0.0; 3];
            let mut count = 0;
            if at.carries[i] {
                let (xi, ri) = (position[i], model.radius[i]);
                let pairs = neighbours.row(i);
                let place = pairs.start - first_pair;
                for k in pairs {
                    let j = neighbours.second[k] as usize;
                    let branch = xi - position[j]; // r_ij, from j to i
                    let reach = ri + model.radius[j];
                    let distance2 = branch.norm_squared();
                    if distance2 >= reach * reach || !at.carries[j] {
                        continue;
                    }
                    let distance = distance2.sqrt();
                    let overlap = reach - distance; // (2.4a)
                    let force = hertz::force(neighbours.modulus[k], overlap);
                    let stiffness = hertz::stiffness(neighbours.modulus[k], overlap);
                    sums.energy += hertz::energy(force, overlap);
                    sums.force += force;
                    sums.overlap += overlap;
                    sums.contacts += 1;
                    let bending = force / distance;
                    sums.bending += bending;
                    let push = branch * bending;
                    for axis in 0..3 {
                        sums.virial[axis] += push[axis] * branch[axis];
                    }
                    gradient -= push;
                    self.pair_force[place + count] = push;
                    let m = ((stiffness + bending) * scale).sqrt() / distance;
                    self.links[place + count] = Link {
                        m: [0, 1, 2].map(|axis| (branch[axis] * m) as f32),
                        b: (bending * scale) as f32,
                        second: j as u32,
                    };
                    count += 1;
                }
                for &wall in neighbours.walls_near(i) {
                    let wall = usize::from(wall);
                    let overlap = ri - wall_gap(&xi, wall, at.bounds); // (2.4b)
                    if overlap > 0.0 {
                        let modulus = neighbours.wall_modulus[i];
                        let force = hertz::force(modulus, overlap);
                        sums.energy += hertz::energy(force, overlap);
                        sums.force += force;
                        sums.overlap += overlap;
                        sums.contacts += 1;
                        let axis = wall::axis(wall);
                        sums.virial[axis] += force * (ri - overlap);
                        gradient[axis] -= force * wall::inward(wall);
                        walls[axis] += (hertz::stiffness(modulus, overlap) * scale) as f32;
                    }
                }
            }
            self.gradient[row] = gradient;
            self.links_in_row[row] = count as u32;
            self.wall_stiffness[row] = walls;
        }
        self.sums[0] = sums;
    }
}

//! The linearised balance H s = -g, solved in single precision by preconditioned conjugate gradients.
//!
//! H = L + D + Lᵀ in 3x3 blocks. The preconditioner P = (Δ + L) Δ⁻¹ (Δ + Lᵀ) is an incomplete
//! Cholesky factorisation that modifies only the diagonal blocks, Δ_i = D_i - Σ_j K_ij Δ_j⁻¹ K_ij
//! over the earlier neighbours j. With Eisenstat's trick one backward and one forward sweep do
//! both the product with H and the two triangular solves (SIAM J. Sci. Stat. Comput. 2, 1, 1981).

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::relax::balance::{Balance, Link};
use crate::relax::sym3::Sym3;

/// A vector of three numbers, padded.
type V = [f32; 4];

/// Rows summed in single precision before they are added up in double.
const LANE_ROWS: usize = 64;

/// A pivot below this share of its row's mean diagonal is lifted to it.
const SMALL_PIVOT: f32 = 0.02;

/// How an inner solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inner {
    /// The residual fell as far as asked, or the iterations ran out: the step descends.
    Step,
    /// A direction of negative curvature was met.
    NegativeCurvature,
}

/// The linear system and the vectors of its solution.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    start: Vec<u32>,
    links: Vec<Link>,
    /// D without shift.
    diagonal: Vec<Sym3>,
    /// Δ⁻¹.
    inverse: Vec<Sym3>,
    /// Δ.
    factor: Vec<Sym3>,
    /// 2Δ - D.
    excess: Vec<Sym3>,
    /// The step, in units of `unit`.
    step: Vec<V>,
    residual: Vec<V>,
    direction: Vec<V>,
    t: Vec<V>,
    w: Vec<V>,
    /// Products with H so far.
    pub products: u64,
}

impl Linear {
    /// Takes the linearisation of `balance`; grains without contacts get a unit block.
    pub fn assemble(&mut self, balance: &Balance, neighbours: &Neighbours) {
        let rows = balance.gradient.len();
        self.start.clear();
        self.links.clear();
        self.diagonal.clear();
        self.diagonal.extend(balance.wall_stiffness.iter().map(|k| Sym3::diagonal(*k)));
        for i in 0..rows {
            self.start.push(self.links.len() as u32);
            let first = neighbours.row(i).start;
            let row = &balance.links[first..first + balance.links_in_row[i] as usize];
            for link in row {
                let block = Sym3::outer_minus(link.m, link.b);
                self.diagonal[i].add(&block);
                self.diagonal[link.second as usize].add(&block);
            }
            self.links.extend_from_slice(row);
        }
        self.start.push(self.links.len() as u32);
        for block in &mut self.diagonal {
            if block.trace() == 0.0 {
                *block = Sym3::diagonal([1.0; 3]);
            }
        }
        for vector in
            [&mut self.step, &mut self.residual, &mut self.direction, &mut self.t, &mut self.w]
        {
            vector.resize(rows, [0.0; 4]);
        }
    }

    /// Factorises H + Σ, where Σ shifts the block of grain i by `shift[i]` in units of the
    /// reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        let rows = self.diagonal.len();
        self.factor.clear();
        self.factor.extend(self.diagonal.iter().zip(shift).map(|(d, s)| d.shifted(*s)));
        self.inverse.resize(rows, Sym3::default());
        self.excess.resize(rows, Sym3::default());
        for (i, &shift) in shift.iter().enumerate() {
            let diagonal = self.diagonal[i].shifted(shift);
            let floor = SMALL_PIVOT * (diagonal.trace().abs() / 3.0).max(f32::MIN_POSITIVE);
            let (factor, inverse) = self.factor[i].inverse_lifted(floor);
            self.factor[i] = factor;
            self.inverse[i] = inverse;
            self.excess[i] = factor.twice_minus(&diagonal);
            for link in &self.links[self.start[i] as usize..self.start[i + 1] as usize] {
                self.factor[link.second as usize].subtract_product(link.m, link.b, &inverse);
            }
        }
    }

    /// Solves (H + Σ) s = -g until the preconditioned residual fell by `forcing`.
    ///
    /// `unit` is the force that right-hand side and step are scaled by.
    pub fn solve(&mut self, gradient: &[Vec3], unit: f64, forcing: f64, most: u32) -> Inner {
        for (to, g) in self.residual.iter_mut().zip(gradient) {
            let r = g * (-1.0 / unit);
            *to = [r.x as f32, r.y as f32, r.z as f32, 0.0];
        }
        self.forward();
        self.step.fill([0.0; 4]);
        let mut rho = 0.0;
        for i in 0..self.residual.len() {
            self.direction[i] = self.factor[i].times(&self.residual[i]);
        }
        rho += dot(&self.direction, &self.residual);
        let target = rho * forcing * forcing;
        for _ in 0..most {
            if rho <= target || rho <= 0.0 {
                break;
            }
            self.multiply();
            let curvature = dot(&self.direction, &self.w);
            if curvature <= 0.0 || curvature.is_nan() {
                return Inner::NegativeCurvature;
            }
            let alpha = (rho / curvature) as f32;
            axpy(&mut self.step, alpha, &self.t);
            axpy(&mut self.residual, -alpha, &self.w);
            // z = Δ r is kept in w, which is free until the next product.
            for i in 0..self.residual.len() {
                self.w[i] = self.factor[i].times(&self.residual[i]);
            }
            let next = dot(&self.w, &self.residual);
            let beta = (next / rho) as f32;
            rho = next;
            for (p, z) in self.direction.iter_mut().zip(&self.w) {
                for axis in 0..4 {
                    p[axis] = z[axis] + beta * p[axis];
                }
            }
        }
        Inner::Step
    }

    /// The step \[m\] of grain `i`; `unit` is the force of [`solve`](Self::solve) over the
    /// reference stiffness.
    #[must_use]
    pub fn step(&self, i: usize, unit: f64) -> Vec3 {
        let s = &self.step[i];
        Vec3::new(f64::from(s[0]), f64::from(s[1]), f64::from(s[2])) * unit
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start)
            + heap::bytes(&self.links)
            + heap::bytes(&self.diagonal)
            + heap::bytes(&self.inverse)
            + heap::bytes(&self.factor)
            + heap::bytes(&self.excess)
            + heap::bytes(&self.step)
            + heap::bytes(&self.residual)
            + heap::bytes(&self.direction)
            + heap::bytes(&self.t)
            + heap::bytes(&self.w)
    }

    /// residual ← (Δ + L)⁻¹ residual.
    fn forward(&mut self) {
        for i in 0..self.residual.len() {
            let y = self.inverse[i].times(&self.residual[i]);
            self.residual[i] = y;
            for link in &self.links[self.start[i] as usize..self.start[i + 1] as usize] {
                add_block(&mut self.residual[link.second as usize], link, &y);
            }
        }
    }

    /// t ← (Δ + Lᵀ)⁻¹ p and w ← (Δ + L)⁻¹ H (Δ + Lᵀ)⁻¹ p for the direction p.
    fn multiply(&mut self) {
        self.products += 1;
        for i in (0..self.direction.len()).rev() {
            let mut sum = self.direction[i];
            for link in &self.links[self.start[i] as usize..self.start[i + 1] as usize] {
                let t = self.t[link.second as usize];
                add_block(&mut sum, link, &t);
            }
            let t = self.inverse[i].times(&sum);
            self.t[i] = t;
            let e = self.excess[i].times(&t);
            let p = &self.direction[i];
            self.w[i] = [p[0] - e[0], p[1] - e[1], p[2] - e[2], 0.0];
        }
        for i in 0..self.w.len() {
            let y = self.inverse[i].times(&self.w[i]);
            for link in &self.links[self.start[i] as usize..self.start[i + 1] as usize] {
                add_block(&mut self.w[link.second as usize], link, &y);
            }
            let t = &self.t[i];
            self.w[i] = [t[0] + y[0], t[1] + y[1], t[2] + y[2], 0.0];
        }
    }
}

/// to += K v; the blocks off the diagonal are -K, so this takes them to the right-hand side.
#[inline(always)]
fn add_block(to: &mut V, link: &Link, v: &V) {
    let along = link.m[0] * v[0] + link.m[1] * v[1] + link.m[2] * v[2];
    for axis in 0..3 {
        to[axis] += link.m[axis] * along - link.b * v[axis];
    }
}

fn dot(a: &[V], b: &[V]) -> f64 {
    a.chunks(LANE_ROWS)
        .zip(b.chunks(LANE_ROWS))
        .map(|(a, b)| {
            let mut lanes = [0.0f32; 4];
            for (a, b) in a.iter().zip(b) {
                for axis in 0..4 {
                    lanes[axis] += a[axis] * b[axis];
                }
            }
            f64::from(lanes[0]) + f64::from(lanes[1]) + f64::from(lanes[2])
        })
        .sum()
}

fn axpy(to: &mut [V], factor: f32, v: &[V]) {
    for (to, v) in to.iter_mut().zip(v) {
        for axis in 0..4 {
            to[axis] += factor * v[axis];
        }
    }
}

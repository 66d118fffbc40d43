//! The linearised balance with friction: six unknowns a grain, displacement u and rotation times
//! radius w = ΩR, solved in single precision by conjugate gradients with a 6x6 block-Jacobi
//! preconditioner.
//!
//! With d = u_i - u_j and ω = λ_i w_i + λ_j w_j, λ = arm/R, the sliding displacement of a contact
//! is s = T d + n̂ × ω and its stiffness across and along the direction of sliding is α and α + β:
//! the shear answers with t = α s + β e (e·s). Terms of the order Q/r against α are left out: they
//! change the way to the equilibrium, not the equilibrium.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::relax::balance::Balance;
use crate::relax::linear::Inner;
use crate::relax::sym6::{Sym6, V6};
use crate::relax::tangential::{Reference, Traction};

/// Rows summed in single precision before they are added up in double.
const LANE_ROWS: usize = 64;
/// Pivots below this share of a row's mean diagonal are lifted to it.
const SMALL_PIVOT: f32 = 0.02;

/// Bending of a grain without contacts, over the reference stiffness.
const NO_BENDING: f32 = 1e-9;

/// One contact between grains, in units of the reference stiffness: 64 bytes.
#[derive(Clone, Copy, Debug, Default)]
struct Joint {
    /// n̂.
    n: [f32; 3],
    /// kn + P/r.
    axial: f32,
    /// P/r.
    b: f32,
    /// α.
    across: f32,
    /// β, along minus across.
    sliding: f32,
    /// e.
    e: [f32; 3],
    /// λ_i, λ_j.
    lever: [f32; 2],
    /// √γ / R_i and √γ / R_j with the torsional stiffness γ.
    twist: [f32; 2],
    /// Grain j.
    second: u32,
}

/// The linear system and the vectors of its solution.
#[derive(Clone, Debug, Default)]
pub struct Coupled {
    start: Vec<u32>,
    joints: Vec<Joint>,
    /// Blocks of the wall contacts of a grain.
    walls: Vec<(u32, Sym6)>,
    /// Sum of P/r of each grain.
    bending: Vec<f32>,
    /// Diagonal blocks without shift.
    diagonal: Vec<Sym6>,
    /// Inverse of the shifted diagonal blocks.
    inverse: Vec<Sym6>,
    shift: Vec<f32>,
    step: Vec<V6>,
    residual: Vec<V6>,
    direction: Vec<V6>,
    product: Vec<V6>,
    /// Products with the matrix so far.
    pub products: u64,
}

impl Coupled {
    /// Takes the linearisation of `balance`; grains without contacts get a unit block.
    pub fn assemble(
        &mut self,
        balance: &Balance,
        near: &Neighbours,
        reference: &Reference,
        radius: &[f64],
        reference_stiffness: f64,
    ) {
        let rows = balance.gradient.len();
        let scale = 1.0 / reference_stiffness;
        self.start.clear();
        self.joints.clear();
        self.walls.clear();
        self.diagonal.clear();
        self.diagonal.resize(rows, Sym6::default());
        self.bending.clear();
        self.bending.resize(rows, 0.0);
        let mut held = reference.contacts.iter().zip(&balance.tractions).peekable();
        for i in 0..rows {
            self.start.push(self.joints.len() as u32);
            let first = near.row(i).start;
            let mut links = balance.links[first..first + balance.links_in_row[i] as usize].iter();
            let mut link = links.next();
            // Contacts that touch, contacts that hold shear, and those that do both, in order.
            loop {
                let traction = held.peek().and_then(|(h, t)| match h.second {
                    Other::Grain(j) if h.first as usize == i => Some((j, *t)),
                    _ => None,
                });
                let (second, touching, shearing) = match (link, traction) {
                    (None, None) => break,
                    (Some(l), Some((j, t))) if l.second == j => (j, Some(l), Some(t)),
                    (Some(l), Some((j, _))) if l.second < j => (l.second, Some(l), None),
                    (Some(l), None) => (l.second, Some(l), None),
                    (_, Some((j, t))) => (j, None, Some(t)),
                };
                if shearing.is_some() {
                    held.next();
                }
                let mut joint = Joint { second, lever: [1.0; 2], ..Joint::default() };
                if let Some(l) = touching {
                    let length = (l.m[0] * l.m[0] + l.m[1] * l.m[1] + l.m[2] * l.m[2]).sqrt();
                    joint.n = l.m.map(|m| m / length);
                    joint.axial = length * length;
                    joint.b = l.b;
                    self.bending[i] += l.b;
                    self.bending[second as usize] += l.b;
                    link = links.next();
                }
                let live = shearing.filter(|t| t.live);
                if let Some(t) = live {
                    let radii = [radius[i], radius[second as usize]];
                    joint.shear(t, radii, scale);
                }
                if touching.is_some() || live.is_some() {
                    self.diagonal[i].add(&joint.block(0));
                    self.diagonal[second as usize].add(&joint.block(1));
                    self.joints.push(joint);
                }
            }
            let k = balance.wall_stiffness[i];
            let mut block = Sym6::diagonal([k[0], k[1], k[2], 0.0, 0.0, 0.0]);
            let mut touches = k != [0.0; 3];
            while let Some((_, t)) = held.next_if(|(h, _)| h.first as usize == i) {
                if t.live {
                    let mut joint = Joint::default();
                    joint.shear(t, [radius[i]; 2], scale);
                    block.add(&joint.block(0));
                    touches = true;
                }
            }
            if touches {
                self.diagonal[i].add(&block);
                self.walls.push((i as u32, block));
            }
        }
        self.start.push(self.joints.len() as u32);
        for block in &mut self.diagonal {
            let [u, w] = block.traces().map(|trace| f32::from(u8::from(trace == 0.0)));
            block.add(&Sym6::diagonal([u, u, u, w, w, w]));
        }
        for vector in [&mut self.step, &mut self.residual, &mut self.direction, &mut self.product]
        {
            vector.resize(rows, [0.0; 8]);
        }
    }

    /// Inverts the diagonal blocks of H + Σ, where Σ shifts the block of grain i by `shift[i]` in
    /// units of the reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        self.shift.clear();
        self.shift.extend_from_slice(shift);
        self.inverse.clear();
        self.inverse
            .extend(self.diagonal.iter().zip(shift).map(|(d, s)| d.inverse(*s, SMALL_PIVOT)));
    }

    /// Solves (H + Σ) s = -g until the preconditioned residual fell by `forcing`; `moment` is the
    /// gradient with respect to w. `unit` is the force that right-hand side and step are scaled by.
    pub fn solve(
        &mut self,
        gradient: &[Vec3],
        moment: &[Vec3],
        unit: f64,
        forcing: f64,
        most: u32,
    ) -> Inner {
        for ((to, g), m) in self.residual.iter_mut().zip(gradient).zip(moment) {
            let (r, s) = (g * (-1.0 / unit), m * (-1.0 / unit));
            *to = [r.x, r.y, r.z, 0.0, s.x, s.y, s.z, 0.0].map(|r| r as f32);
        }
        self.step.fill([0.0; 8]);
        for i in 0..self.residual.len() {
            self.direction[i] = self.inverse[i].times(&self.residual[i]);
        }
        let mut rho = dot(&self.direction, &self.residual);
        let target = rho * forcing * forcing;
        for _ in 0..most {
            if rho <= target || rho <= 0.0 {
                break;
            }
            self.multiply();
            let curvature = dot(&self.direction, &self.product);
            if curvature <= 0.0 || curvature.is_nan() {
                return Inner::NegativeCurvature;
            }
            let next = self.descend((rho / curvature) as f32);
            let beta = (next / rho) as f32;
            rho = next;
            for (p, z) in self.direction.iter_mut().zip(&self.product) {
                for k in 0..8 {
                    p[k] = z[k] + beta * p[k];
                }
            }
        }
        Inner::Step
    }

    /// After [`Inner::NegativeCurvature`]: the part of the curvature in the unknowns of grain `i`.
    #[must_use]
    pub fn curvature(&self, i: usize) -> f32 {
        self.direction[i].iter().zip(&self.product[i]).map(|(p, q)| p * q).sum()
    }

    /// Sum of P/r over the contacts of each grain, in units of the reference stiffness; a little
    /// more than none for grains without contacts.
    pub fn bending(&self) -> impl Iterator<Item = f32> {
        self.bending.iter().map(|b| b.max(NO_BENDING))
    }

    /// The displacement and the rotation times radius \[m\] of grain `i`; `unit` is the force of
    /// [`solve`](Self::solve) over the reference stiffness.
    #[must_use]
    pub fn step(&self, i: usize, unit: f64) -> [Vec3; 2] {
        let s = self.step[i].map(|s| f64::from(s) * unit);
        [Vec3::new(s[0], s[1], s[2]), Vec3::new(s[4], s[5], s[6])]
    }

    /// Goes `alpha` along the direction; leaves z = M⁻¹ r in `product` and returns r·z.
    fn descend(&mut self, alpha: f32) -> f64 {
        let mut sum = 0.0;
        let rows = self.residual.len();
        for from in (0..rows).step_by(LANE_ROWS) {
            let mut lanes = [0.0f32; 8];
            for i in from..(from + LANE_ROWS).min(rows) {
                let (p, q) = (&self.direction[i], &self.product[i]);
                let (x, r) = (&mut self.step[i], &mut self.residual[i]);
                for k in 0..8 {
                    x[k] += alpha * p[k];
                    r[k] -= alpha * q[k];
                }
                let z = self.inverse[i].times(r);
                for k in 0..8 {
                    lanes[k] += r[k] * z[k];
                }
                self.product[i] = z;
            }
            sum += lanes.iter().map(|&lane| f64::from(lane)).sum::<f64>();
        }
        sum
    }

    /// product ← (H + Σ) direction.
    fn multiply(&mut self) {
        self.products += 1;
        for ((y, x), s) in self.product.iter_mut().zip(&self.direction).zip(&self.shift) {
            *y = x.map(|x| x * s);
        }
        for (i, block) in &self.walls {
            let y = block.times(&self.direction[*i as usize]);
            add(&mut self.product[*i as usize], &y);
        }
        for i in 0..self.direction.len() {
            let xi = self.direction[i];
            let mut yi = self.product[i];
            for joint in &self.joints[self.start[i] as usize..self.start[i + 1] as usize] {
                let j = joint.second as usize;
                joint.multiply(&xi, &self.direction[j], &mut yi, &mut self.product[j]);
            }
            self.product[i] = yi;
        }
    }
}

impl Joint {
    /// Takes the tangential part of the linearisation.
    fn shear(&mut self, t: &Traction, radii: [f64; 2], scale: f64) {
        self.n = <[f64; 3]>::from(t.normal).map(|n| n as f32);
        self.across = (t.shear.across * scale) as f32;
        self.sliding = ((t.shear.along - t.shear.across) * scale) as f32;
        self.e = <[f64; 3]>::from(t.shear.direction).map(|e| e as f32);
        self.lever = [0, 1].map(|k| (t.arm[k] / radii[k]) as f32);
        let root = (t.torsion.stiffness * scale).sqrt();
        self.twist = radii.map(|radius| (root / radius) as f32);
    }

    /// The diagonal block of grain i (`side` 0) or j (1): a sum of squares of the rows of s, of
    /// the overlap and of the twist.
    fn block(&self, side: usize) -> Sym6 {
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let lever = self.lever[side] * sign;
        let [nx, ny, nz] = self.n;
        let mut block = Sym6::diagonal([-self.b, -self.b, -self.b, 0.0, 0.0, 0.0]);
        block.add_outer(self.axial, &[nx, ny, nz, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let twist = self.twist[side] * self.twist[side];
        block.add_outer(twist, &[0.0, 0.0, 0.0, 0.0, nx, ny, nz, 0.0]);
        // s·a = a·d + ω·(a × n̂) for a direction a in the contact plane.
        let row = |a: [f32; 3]| {
            let f = cross(a, self.n);
            [a[0], a[1], a[2], 0.0, lever * f[0], lever * f[1], lever * f[2], 0.0]
        };
        let [p, q] = plane(self.n);
        block.add_outer(self.across, &row(p));
        block.add_outer(self.across, &row(q));
        block.add_outer(self.sliding, &row(self.e));
        block
    }

    /// Adds this contact's part of the product with x to y.
    #[inline(always)]
    fn multiply(&self, xi: &V6, xj: &V6, yi: &mut V6, yj: &mut V6) {
        let n = self.n;
        let d = [xi[0] - xj[0], xi[1] - xj[1], xi[2] - xj[2]];
        let [li, lj] = self.lever;
        let wi = [xi[4], xi[5], xi[6]];
        let wj = [xj[4], xj[5], xj[6]];
        let omega = [0, 1, 2].map(|k| li * wi[k] + lj * wj[k]);
        let dn = dot3(d, n);
        let turned = cross(n, omega);
        let s = [0, 1, 2].map(|k| d[k] - dn * n[k] + turned[k]);
        let es = self.sliding * dot3(self.e, s);
        let t = [0, 1, 2].map(|k| self.across * s[k] + es * self.e[k]);
        let torque = cross(t, n);
        let [ci, cj] = self.twist;
        let twist = ci * dot3(wi, n) - cj * dot3(wj, n);
        for k in 0..3 {
            let f = t[k] - self.b * d[k] + self.axial * dn * n[k];
            yi[k] += f;
            yj[k] -= f;
            yi[4 + k] += li * torque[k] + ci * twist * n[k];
            yj[4 + k] += lj * torque[k] - cj * twist * n[k];
        }
    }
}

/// Two unit vectors across `n` and each other.
fn plane(n: [f32; 3]) -> [[f32; 3]; 2] {
    let least = if n[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let p = cross(n, least);
    let length = dot3(p, p).sqrt();
    let p = p.map(|p| p / length);
    [p, cross(n, p)]
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[inline(always)]
fn dot3(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn add(to: &mut V6, v: &V6) {
    for (to, v) in to.iter_mut().zip(v) {
        *to += v;
    }
}

fn dot(a: &[V6], b: &[V6]) -> f64 {
    a.chunks(LANE_ROWS)
        .zip(b.chunks(LANE_ROWS))
        .map(|(a, b)| {
            let mut lanes = [0.0f32; 8];
            for (a, b) in a.iter().zip(b) {
                for k in 0..8 {
                    lanes[k] += a[k] * b[k];
                }
            }
            lanes.iter().map(|&lane| f64::from(lane)).sum::<f64>()
        })
        .sum()
}

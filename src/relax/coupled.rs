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
use crate::heap;
use crate::relax::balance::Balance;
use crate::relax::linear::Inner;
use crate::relax::sym3::Sym3;
use crate::relax::sym6::{Columns, Sym6, V6};
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
    walls: Vec<(u32, Columns)>,
    /// Sum of P/r of each grain.
    bending: Vec<f32>,
    /// Diagonal blocks without shift.
    diagonal: Vec<Sym6>,
    /// Inverse of the shifted diagonal blocks; empty before they are taken.
    inverse: Vec<Columns>,
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
        self.inverse.clear();
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
            let mut block = Sym6 { u: Sym3::diagonal(k), ..Sym6::default() };
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
                self.walls.push((i as u32, block.matrix()));
            }
        }
        self.start.push(self.joints.len() as u32);
        for block in &mut self.diagonal {
            for part in [&mut block.u, &mut block.w] {
                if part.trace() == 0.0 {
                    *part = Sym3::diagonal([1.0; 3]);
                }
            }
        }
        for vector in [&mut self.step, &mut self.residual, &mut self.direction, &mut self.product] {
            vector.resize(rows, [0.0; 8]);
        }
    }

    /// Inverts the diagonal blocks of H + Σ, where Σ shifts the block of grain i by `shift[i]` in
    /// units of the reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        if self.inverse.is_empty() {
            self.shift.clear();
            self.shift.extend_from_slice(shift);
            let inverse = |(d, s): (&Sym6, &f32)| d.inverse(*s, SMALL_PIVOT);
            self.inverse.extend(self.diagonal.iter().zip(shift).map(inverse));
            return;
        }
        // Another try at the same linearisation: few shifts changed.
        for (i, &shift) in shift.iter().enumerate() {
            if self.shift[i] != shift {
                self.shift[i] = shift;
                self.inverse[i] = self.diagonal[i].inverse(shift, SMALL_PIVOT);
            }
        }
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

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start)
            + heap::bytes(&self.joints)
            + heap::bytes(&self.walls)
            + heap::bytes(&self.bending)
            + heap::bytes(&self.diagonal)
            + heap::bytes(&self.inverse)
            + heap::bytes(&self.shift)
            + heap::bytes(&self.step)
            + heap::bytes(&self.residual)
            + heap::bytes(&self.direction)
            + heap::bytes(&self.product)
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

    /// The diagonal block of grain i (`side` 0) or j (1).
    #[inline(always)]
    fn block(&self, side: usize) -> Sym6 {
        let n = self.n;
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let lever = self.lever[side];
        let square = lever * lever;
        let bend = self.across - self.b;
        let mut u = Sym3::diagonal([bend; 3]);
        u.add_outer(self.axial - self.across, n);
        let mut w = Sym3::diagonal([square * self.across; 3]);
        w.add_outer(self.twist[side] * self.twist[side] - square * self.across, n);
        // λ (α [n̂]× + β e fᵀ) with f = e × n̂, which s·e = e·d + ω·f makes.
        let a = sign * lever * self.across;
        let mut uw =
            [[0.0, -a * n[2], a * n[1]], [a * n[2], 0.0, -a * n[0]], [-a * n[1], a * n[0], 0.0]];
        if self.sliding != 0.0 {
            let f = cross(self.e, n);
            u.add_outer(self.sliding, self.e);
            w.add_outer(square * self.sliding, f);
            for (row, e) in uw.iter_mut().zip(self.e) {
                for (entry, f) in row.iter_mut().zip(f) {
                    *entry += sign * lever * self.sliding * e * f;
                }
            }
        }
        Sym6 { u, w, uw }
    }

    /// Adds this contact's part of the product with x to y.
    #[inline(always)]
    fn multiply(&self, xi: &V6, xj: &V6, yi: &mut V6, yj: &mut V6) {
        let (ui, wi) = halves(xi);
        let (uj, wj) = halves(xj);
        let n = padded(self.n);
        let [li, lj] = self.lever;
        let [ci, cj] = self.twist;
        let d = lanes(|k| ui[k] - uj[k]);
        let omega = lanes(|k| li * wi[k] + lj * wj[k]);
        let turned = cross4(&n, &omega);
        let dn = dot4(&d, &n);
        let mut t = lanes(|k| self.across * (d[k] + turned[k] - dn * n[k]));
        if self.sliding != 0.0 {
            let e = padded(self.e);
            let es = self.sliding * (dot4(&e, &d) + dot4(&e, &turned));
            t = lanes(|k| t[k] + es * e[k]);
        }
        let torque = cross4(&t, &n);
        let twist = dot4(&lanes(|k| ci * wi[k] - cj * wj[k]), &n);
        let push = self.axial * dn;
        let f = lanes(|k| t[k] - self.b * d[k] + push * n[k]);
        let [ti, tj] = [ci * twist, cj * twist];
        for k in 0..4 {
            yi[k] += f[k];
            yj[k] -= f[k];
            yi[4 + k] += li * torque[k] + ti * n[k];
            yj[4 + k] += lj * torque[k] - tj * n[k];
        }
    }
}

/// Three numbers and a zero.
type Lanes = [f32; 4];

#[inline(always)]
fn lanes(of: impl Fn(usize) -> f32) -> Lanes {
    [of(0), of(1), of(2), of(3)]
}

#[inline(always)]
fn padded(v: [f32; 3]) -> Lanes {
    [v[0], v[1], v[2], 0.0]
}

#[inline(always)]
fn halves(v: &V6) -> (Lanes, Lanes) {
    ([v[0], v[1], v[2], v[3]], [v[4], v[5], v[6], v[7]])
}

#[inline(always)]
fn cross4(a: &Lanes, b: &Lanes) -> Lanes {
    let turn = |v: &Lanes| [v[1], v[2], v[0], v[3]];
    let (a1, b1) = (turn(a), turn(b));
    turn(&lanes(|k| a[k] * b1[k] - a1[k] * b[k]))
}

#[inline(always)]
fn dot4(a: &Lanes, b: &Lanes) -> f32 {
    let p = lanes(|k| a[k] * b[k]);
    (p[0] + p[2]) + (p[1] + p[3])
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
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

//! One contact between grains in the linearised balance with friction.

use super::block6::Block6;
use crate::relax::balance::Link;
use crate::relax::block::Block;
use crate::relax::lanes::{Arithmetic, Four, Lanes};
use crate::relax::tangential::Traction;

/// A contact of grains i and j, in units of the reference stiffness: 64 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Joint {
    /// n̂, towards i.
    n: Four,
    /// e.
    e: Four,
    /// kn + P/r.
    axial: f32,
    /// P/r.
    pub(super) b: f32,
    /// α.
    across: f32,
    /// β, along minus across.
    sliding: f32,
    /// λ_i, λ_j.
    lever: [f32; 2],
    /// √γ / R_i and √γ / R_j with the torsional stiffness γ.
    twist: [f32; 2],
}

impl Joint {
    /// Of a pair that touches and carries no shear.
    #[inline(always)]
    pub(super) fn pressed(link: &Link) -> Self {
        let axial = axial(link);
        let [x, y, z] = link.m;
        let over = 1.0 / axial.sqrt();
        let n = Four([x * over, y * over, z * over, 0.0]);
        Self { n, axial, b: link.b, lever: [1.0; 2], ..Self::default() }
    }

    /// Of a grain held along `axis` by walls of the stiffness `k`.
    pub(super) fn wall(axis: usize, k: f32) -> Self {
        let mut n = Four::default();
        n.0[axis] = 1.0;
        Self { n, axial: k, ..Self::default() }
    }

    /// Of a grain held across z by walls of the stiffness `[xx, yy, xy]`, along its principal directions.
    pub(super) fn round_wall([x, y, xy]: [f32; 3]) -> [Self; 2] {
        let angle = 0.5 * (2.0 * xy).atan2(x - y);
        let (sin, cos) = angle.sin_cos();
        let (mean, radius) = (0.5 * (x + y), (0.5 * (x - y)).hypot(xy));
        let along = |n: [f32; 2], axial: f32| Self {
            n: Four([n[0], n[1], 0.0, 0.0]),
            axial,
            ..Self::default()
        };
        [along([cos, sin], mean + radius), along([-sin, cos], mean - radius)]
    }

    /// Of a contact that carries shear, and may be open; `over_radius` is 1/R of both grains,
    /// `scale` one over the reference stiffness.
    #[inline(always)]
    pub(super) fn sheared(
        link: Option<&Link>,
        t: &Traction,
        over_radius: [f32; 2],
        scale: f32,
    ) -> Self {
        let ([nx, ny, nz], [ex, ey, ez]) = (t.normal, t.direction);
        let root = (t.torsion * scale).sqrt();
        Self {
            n: Four([nx, ny, nz, 0.0]),
            e: Four([ex, ey, ez, 0.0]),
            axial: link.map_or(0.0, axial) + t.axial * scale,
            b: link.map_or(0.0, |link| link.b) + t.bending * scale,
            across: t.across * scale,
            sliding: t.sliding * scale,
            lever: [t.arm[0] * over_radius[0], t.arm[1] * over_radius[1]],
            twist: [root * over_radius[0], root * over_radius[1]],
        }
    }

    /// The same contact with i and j exchanged.
    pub(super) fn swapped(&self) -> Self {
        let [li, lj] = self.lever;
        let [ci, cj] = self.twist;
        Self { n: Four(self.n.0.map(|n| -n)), lever: [lj, li], twist: [cj, ci], ..*self }
    }

    /// This contact in registers.
    #[inline(always)]
    pub(super) fn loaded<L: Lanes>(&self, l: L) -> Loaded<L::F> {
        let [li, lj] = self.lever;
        let [ci, cj] = self.twist;
        Loaded {
            n: l.load(&self.n),
            e: l.load(&self.e),
            axial: l.splat(self.axial),
            b: l.splat(self.b),
            across: l.splat(self.across),
            sliding: l.splat(self.sliding),
            lever: [l.splat(li), l.splat(lj)],
            twist: [l.splat(ci), l.splat(cj)],
        }
    }

    /// Two contacts in registers, beside each other.
    #[inline(always)]
    pub(super) fn loaded_two<L: Lanes>(
        l: L,
        [a, b]: &[Self; 2],
    ) -> Loaded<<L::Two as Arithmetic>::F> {
        let ([li, lj], [ci, cj]) = (a.lever, a.twist);
        let ([lk, ll], [ck, cl]) = (b.lever, b.twist);
        Loaded {
            n: l.pair(l.load(&a.n), l.load(&b.n)),
            e: l.pair(l.load(&a.e), l.load(&b.e)),
            axial: l.splats(a.axial, b.axial),
            b: l.splats(a.b, b.b),
            across: l.splats(a.across, b.across),
            sliding: l.splats(a.sliding, b.sliding),
            lever: [l.splats(li, lk), l.splats(lj, ll)],
            twist: [l.splats(ci, ck), l.splats(cj, cl)],
        }
    }

    /// Adds the diagonal block of grain i (`side` 0) or j (1) to `to`.
    #[inline(always)]
    pub(super) fn add_block<L: Lanes>(&self, l: L, side: usize, to: &mut Block6) {
        let (n, e) = (l.load(&self.n), l.load(&self.e));
        let (n1, n2, e1, e2) = (l.yzx(n), l.zxy(n), l.yzx(e), l.zxy(e));
        let f = l.sub_mul(e2, n1, l.mul(e1, n2)); // e × n̂
        let f1 = l.yzx(f);
        let lever = if side == 0 { self.lever[0] } else { -self.lever[1] };
        let square = lever * lever;
        let twist = self.twist[side] * self.twist[side];
        let normal = (self.axial - self.across, [n, n1]);
        add_products(l, &mut to.u, self.across - self.b, [normal, (self.sliding, [e, e1])]);
        let turning = square * self.across;
        let of_slip = (square * self.sliding, [f, f1]);
        add_products(l, &mut to.w, turning, [(twist - turning, [n, n1]), of_slip]);
        // λ (α [n̂]× + β e fᵀ) with f = e × n̂, which s·e = e·d + ω·f makes.
        let (a, b) = (l.splat(lever * self.across), l.splat(lever * self.sliding));
        let be = l.mul(b, e);
        let [a0, a1, a2] = &mut to.uw;
        l.store(a0, l.mul_add(be, f, l.load(a0)));
        l.store(a1, l.mul_add(be, f1, l.sub_mul(a, n2, l.load(a1))));
        l.store(a2, l.mul_add(be, l.zxy(f), l.mul_add(a, n1, l.load(a2))));
    }
}

/// A contact in registers.
pub(super) struct Loaded<F> {
    n: F,
    e: F,
    axial: F,
    b: F,
    across: F,
    sliding: F,
    lever: [F; 2],
    twist: [F; 2],
}

impl<F: Copy> Loaded<F> {
    /// Adds this contact's part of the product with x of both grains to their y.
    #[inline(always)]
    pub(super) fn multiply<A: Arithmetic<F = F>>(
        &self,
        l: A,
        [[ui, wi], [uj, wj]]: [[F; 2]; 2],
        [[fi, mi], [fj, mj]]: [[F; 2]; 2],
    ) -> [[F; 2]; 2] {
        let Self { n, e, lever: [li, lj], twist: [ci, cj], .. } = *self;
        let (n1, n2) = (l.yzx(n), l.zxy(n));
        let d = l.sub(ui, uj);
        let omega = l.mul_add(li, wi, l.mul(lj, wj));
        // s = T d + n̂ × ω
        let normal = l.sum(l.mul(n, d));
        let s = l.mul_add(n1, l.zxy(omega), l.sub_mul(n, normal, d));
        let s = l.sub_mul(n2, l.yzx(omega), s);
        let along = l.mul(self.sliding, l.sum(l.mul(e, s)));
        let t = l.mul_add(along, e, l.mul(self.across, s));
        let force = l.mul_add(l.mul(self.axial, normal), n, t);
        let force = l.sub_mul(self.b, d, force);
        let torque = l.sub_mul(l.zxy(t), n1, l.mul(l.yzx(t), n2)); // t × n̂
        let twist = l.sum(l.mul(n, l.sub_mul(cj, wj, l.mul(ci, wi))));
        let couple = l.mul(twist, n);
        [
            [l.add(fi, force), l.mul_add(ci, couple, l.mul_add(li, torque, mi))],
            [l.sub(fj, force), l.sub_mul(cj, couple, l.mul_add(lj, torque, mj))],
        ]
    }
}

/// kn + P/r of a pair that touches.
#[inline(always)]
fn axial(link: &Link) -> f32 {
    let [x, y, z] = link.m;
    x * x + y * y + z * z
}

/// Adds even I + Σ s a aᵀ over the `products` (s, [a, a turned once]) to `to`.
#[inline(always)]
fn add_products<L: Lanes>(
    l: L,
    to: &mut Block,
    even: f32,
    [(s, [a, a1]), (t, [b, b1])]: [(f32, [L::F; 2]); 2],
) {
    let ones = l.load(&Four([1.0, 1.0, 1.0, 0.0]));
    let (sa, tb) = (l.mul(l.splat(s), a), l.mul(l.splat(t), b));
    let on = l.mul_add(l.splat(even), ones, l.load(&to.on));
    l.store(&mut to.on, l.mul_add(tb, b, l.mul_add(sa, a, on)));
    let off = l.mul_add(tb, b1, l.mul_add(sa, a1, l.load(&to.off)));
    l.store(&mut to.off, off);
}

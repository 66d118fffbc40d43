//! Inverses of the diagonal blocks, four grains at a time.

use super::block6::Block6;
use crate::relax::lanes::{Four, Lanes};
use crate::relax::sym3::Sym3;

/// Pivots below this share of a row's mean diagonal are lifted to it.
const SMALL_PIVOT: f32 = 0.02;

/// The inverse of `block` with `shift` on its diagonal, of a unit block where nothing holds the
/// grain; what is not positive definite is lifted until it is.
#[cold]
pub(super) fn one(block: &Block6, shift: f32) -> Block6 {
    let mut block = block.sym6();
    for part in [&mut block.u, &mut block.w] {
        if part.trace() == 0.0 {
            *part = Sym3::diagonal([1.0; 3]);
        }
    }
    Block6::from(&block.inverse(shift, SMALL_PIVOT))
}

/// The inverses `to` of four `blocks` with `shift` on their diagonals.
///
/// Written without closures, which would not be compiled for the instructions in use.
#[inline(always)]
pub(super) fn four<L: Lanes>(l: L, blocks: &[Block6; 4], shift: [f32; 4], to: &mut [Block6; 4]) {
    let [a, b, c, d] = blocks;
    let u = Sym {
        on: columns(l, [&a.u.on, &b.u.on, &c.u.on, &d.u.on]),
        off: columns(l, [&a.u.off, &b.u.off, &c.u.off, &d.u.off]),
    };
    let w = Sym {
        on: columns(l, [&a.w.on, &b.w.on, &c.w.on, &d.w.on]),
        off: columns(l, [&a.w.off, &b.w.off, &c.w.off, &d.w.off]),
    };
    // B by its turned diagonals, then by its columns.
    let [b00, b11, b22] = columns(l, [&a.uw[0], &b.uw[0], &c.uw[0], &d.uw[0]]);
    let [b01, b12, b20] = columns(l, [&a.uw[1], &b.uw[1], &c.uw[1], &d.uw[1]]);
    let [b02, b10, b21] = columns(l, [&a.uw[2], &b.uw[2], &c.uw[2], &d.uw[2]]);
    let b = [[b00, b10, b20], [b01, b11, b21], [b02, b12, b22]];

    let held = l.splat(f32::MIN_POSITIVE);
    let held = l.at_least(u.trace(l), held) & l.at_least(w.trace(l), held);
    let shift = l.set(shift);
    let (u, w) = (u.shifted(l, shift), w.shifted(l, shift));
    // By the Schur complement S = W - Bᵀ U⁻¹ B of U.
    let (inverse_u, good_u) = u.inverse(l, u.least_pivot(l));
    let x = [inverse_u.times(l, b[0]), inverse_u.times(l, b[1]), inverse_u.times(l, b[2])];
    let (inverse_w, good_w) = w.minus_products(l, &b, &x).inverse(l, w.least_pivot(l));
    // Beside it -(U⁻¹B) S⁻¹, by rows; in the corner U⁻¹ + (U⁻¹B) S⁻¹ (U⁻¹B)ᵀ.
    let [[x0, x1, x2], [y0, y1, y2], [z0, z1, z2]] = x;
    let rows = [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]];
    let minus_w = inverse_w.negated(l);
    let beside = [minus_w.times(l, rows[0]), minus_w.times(l, rows[1]), minus_w.times(l, rows[2])];
    let corner = inverse_u.minus_products(l, &beside, &rows);

    let [u_on, u_off] = [lines(l, corner.on), lines(l, corner.off)];
    let [w_on, w_off] = [lines(l, inverse_w.on), lines(l, inverse_w.off)];
    let [[b00, b01, b02], [b10, b11, b12], [b20, b21, b22]] = beside;
    let turned = [lines(l, [b00, b11, b22]), lines(l, [b01, b12, b20]), lines(l, [b02, b10, b21])];
    for k in 0..4 {
        l.store(&mut to[k].u.on, u_on[k]);
        l.store(&mut to[k].u.off, u_off[k]);
        l.store(&mut to[k].w.on, w_on[k]);
        l.store(&mut to[k].w.off, w_off[k]);
        l.store(&mut to[k].uw[0], turned[0][k]);
        l.store(&mut to[k].uw[1], turned[1][k]);
        l.store(&mut to[k].uw[2], turned[2][k]);
    }
    let good = held & good_u & good_w;
    if good != 0b1111 {
        redo(blocks, l.array(shift), good, to);
    }
}

/// Inverts alone the blocks that are not `good`.
#[cold]
#[inline(never)]
fn redo(blocks: &[Block6; 4], shift: [f32; 4], good: u32, to: &mut [Block6; 4]) {
    for k in (0..4).filter(|k| good >> k & 1 == 0) {
        to[k] = one(&blocks[k], shift[k]);
    }
}

/// The entries 0, 1 and 2 of four places, each in a register.
#[inline(always)]
fn columns<L: Lanes>(l: L, [a, b, c, d]: [&Four; 4]) -> [L::F; 3] {
    let [x, y, z, _] = l.transpose([l.load(a), l.load(b), l.load(c), l.load(d)]);
    [x, y, z]
}

/// The way back from [`columns`].
#[inline(always)]
fn lines<L: Lanes>(l: L, [x, y, z]: [L::F; 3]) -> [L::F; 4] {
    l.transpose([x, y, z, l.splat(0.0)])
}

/// from - p·q.
#[inline(always)]
fn minus_dot<L: Lanes>(l: L, from: L::F, p: &[L::F; 3], q: &[L::F; 3]) -> L::F {
    l.sub_mul(p[2], q[2], l.sub_mul(p[1], q[1], l.sub_mul(p[0], q[0], from)))
}

/// Symmetric 3x3 blocks, one in each lane.
#[derive(Clone, Copy)]
struct Sym<F> {
    /// xx, yy, zz.
    on: [F; 3],
    /// xy, yz, xz.
    off: [F; 3],
}

impl<F: Copy> Sym<F> {
    #[inline(always)]
    fn trace<L: Lanes<F = F>>(&self, l: L) -> F {
        l.add(l.add(self.on[0], self.on[1]), self.on[2])
    }

    #[inline(always)]
    fn least_pivot<L: Lanes<F = F>>(&self, l: L) -> F {
        l.mul(l.splat(SMALL_PIVOT / 3.0), self.trace(l))
    }

    #[inline(always)]
    fn shifted<L: Lanes<F = F>>(&self, l: L, shift: F) -> Self {
        let [xx, yy, zz] = self.on;
        Self { on: [l.add(xx, shift), l.add(yy, shift), l.add(zz, shift)], off: self.off }
    }

    #[inline(always)]
    fn negated<L: Lanes<F = F>>(&self, l: L) -> Self {
        let (zero, [xx, yy, zz], [xy, yz, xz]) = (l.splat(0.0), self.on, self.off);
        Self {
            on: [l.sub(zero, xx), l.sub(zero, yy), l.sub(zero, zz)],
            off: [l.sub(zero, xy), l.sub(zero, yz), l.sub(zero, xz)],
        }
    }

    #[inline(always)]
    fn times<L: Lanes<F = F>>(&self, l: L, v: [F; 3]) -> [F; 3] {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.on, self.off);
        let [x, y, z] = v;
        [
            l.mul_add(xz, z, l.mul_add(xy, y, l.mul(xx, x))),
            l.mul_add(yz, z, l.mul_add(yy, y, l.mul(xy, x))),
            l.mul_add(zz, z, l.mul_add(yz, y, l.mul(xz, x))),
        ]
    }

    /// This block minus the products of the vectors `p` and `q`, which make a symmetric block.
    #[inline(always)]
    fn minus_products<L: Lanes<F = F>>(&self, l: L, p: &[[F; 3]; 3], q: &[[F; 3]; 3]) -> Self {
        Self {
            on: [
                minus_dot(l, self.on[0], &p[0], &q[0]),
                minus_dot(l, self.on[1], &p[1], &q[1]),
                minus_dot(l, self.on[2], &p[2], &q[2]),
            ],
            off: [
                minus_dot(l, self.off[0], &p[0], &q[1]),
                minus_dot(l, self.off[1], &p[1], &q[2]),
                minus_dot(l, self.off[2], &p[0], &q[2]),
            ],
        }
    }

    /// The inverse, and the lanes where all pivots are at least `floor` > 0, as bits; elsewhere it
    /// may be anything.
    #[inline(always)]
    fn inverse<L: Lanes<F = F>>(&self, l: L, floor: F) -> (Self, u32) {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.on, self.off);
        let [of_xx, of_yy, of_zz] = [
            minor(l, [yy, zz], [yz, yz]),
            minor(l, [xx, zz], [xz, xz]),
            minor(l, [xx, yy], [xy, xy]),
        ];
        let [of_xy, of_yz, of_xz] = [
            minor(l, [xz, yz], [xy, zz]),
            minor(l, [xy, xz], [xx, yz]),
            minor(l, [xy, yz], [xz, yy]),
        ];
        let determinant = l.mul_add(xz, of_xz, l.mul_add(xy, of_xy, l.mul(xx, of_xx)));
        // The pivots are xx, the minor of zz over xx and the determinant over that minor.
        let good = l.at_least(xx, floor)
            & l.at_least(of_zz, l.mul(floor, xx))
            & l.at_least(determinant, l.mul(floor, of_zz))
            & l.at_least(determinant, l.splat(f32::MIN_POSITIVE));
        let over = l.div(l.splat(1.0), determinant);
        let on = [l.mul(of_xx, over), l.mul(of_yy, over), l.mul(of_zz, over)];
        let off = [l.mul(of_xy, over), l.mul(of_yz, over), l.mul(of_xz, over)];
        (Self { on, off }, good)
    }
}

/// ab - cd.
#[inline(always)]
fn minor<L: Lanes>(l: L, [a, b]: [L::F; 2], [c, d]: [L::F; 2]) -> L::F {
    l.sub_mul(c, d, l.mul(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::block::Block;
    use crate::relax::lanes::{Kernel, Portable, dispatch};

    /// A block whose entries are of the size `spread` beside a diagonal of about one.
    fn block(seed: u32, spread: f32, diagonal: f32) -> Block6 {
        let entry = |k: u32| {
            let bits = (seed * 64 + k).wrapping_mul(2_654_435_761) >> 8;
            spread * (bits as f32 / 8_388_608.0 - 1.0)
        };
        let three = |k: u32| Four([entry(k), entry(k + 1), entry(k + 2), 0.0]);
        let on = |k: u32| Four(three(k).0.map(|x| if x == 0.0 { x } else { diagonal + x }));
        Block6 {
            u: Block { on: on(0), off: three(3) },
            w: Block { on: on(6), off: three(9) },
            uw: [three(12), three(15), three(18)],
        }
    }

    struct All<'a>(&'a [Block6; 4], [f32; 4]);

    impl Kernel for All<'_> {
        type Output = [Block6; 4];

        #[inline(always)]
        fn run<L: Lanes>(self, l: L) -> [Block6; 4] {
            let mut inverses = [Block6::default(); 4];
            four(l, self.0, self.1, &mut inverses);
            inverses
        }
    }

    #[test]
    fn the_inverse_of_four_undoes_each_product() {
        let blocks = [1, 2, 3, 4].map(|seed| block(seed, 0.25, 1.0));
        let shift = [0.0, 0.125, 0.0, 1.0];
        let (u, w) = ([1.0f32, -2.0, 0.5, 0.0], [3.0f32, 0.25, -1.5, 0.0]);
        for (k, inverse) in dispatch(All(&blocks, shift)).iter().enumerate() {
            let [force, moment] = blocks[k].times(Portable, u, w);
            let lifted = |y: [f32; 4], x: [f32; 4]| std::array::from_fn(|c| y[c] + shift[k] * x[c]);
            let back = inverse.times(Portable, lifted(force, u), lifted(moment, w));
            for (back, x) in back.into_iter().flatten().zip([u, w].into_iter().flatten()) {
                assert!((back - x).abs() < 1e-5, "{back} {x}");
            }
        }
    }

    #[test]
    fn blocks_that_cannot_be_inverted_do_as_if_alone_and_leave_the_others_alone() {
        let good = block(5, 0.25, 1.0);
        let blocks = [block(6, 1.0, -0.5), Block6::default(), good, block(7, 2.0, 0.1)];
        let mut want = blocks.map(|block| one(&block, 0.5));
        want[2] = dispatch(All(&[good; 4], [0.5; 4]))[0];
        let got = dispatch(All(&blocks, [0.5; 4]));
        for (k, (got, want)) in got.iter().zip(&want).enumerate() {
            assert_eq!(got.sym6(), want.sym6(), "block {k}");
        }
    }

    #[test]
    fn all_instructions_give_the_same_bits() {
        for seed in 0..50 {
            let blocks = [0, 1, 2, 3].map(|k| block(4 * seed + k, 0.4, 1.0));
            let fast = dispatch(All(&blocks, [0.0, 0.1, 0.2, 0.3])).map(|b| b.sym6());
            let plain = All(&blocks, [0.0, 0.1, 0.2, 0.3]).run(Portable).map(|b| b.sym6());
            assert_eq!(fast, plain);
        }
    }
}

//! Inverses of the diagonal blocks, four grains at a time.

use super::block6::Block6;
use crate::relax::block::Block;
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
#[inline(always)]
pub(super) fn four<L: Lanes>(l: L, blocks: &[Block6; 4], shift: [f32; 4], to: &mut [Block6; 4]) {
    let lanes = |pick: fn(&Block6) -> &Four| {
        let [x, y, z, _] = l.transpose(blocks.each_ref().map(|block| l.load(pick(block))));
        [x, y, z]
    };
    let u = Sym { on: lanes(|b| &b.u.on), off: lanes(|b| &b.u.off) };
    let w = Sym { on: lanes(|b| &b.w.on), off: lanes(|b| &b.w.off) };
    let a = [lanes(|b| &b.uw[0]), lanes(|b| &b.uw[1]), lanes(|b| &b.uw[2])];
    let held = l.splat(f32::MIN_POSITIVE);
    let held = l.at_least(u.trace(l), held) & l.at_least(w.trace(l), held);
    let shift = l.load(&Four(shift));
    let (u, w) = (u.shifted(l, shift), w.shifted(l, shift));
    let least = |part: &Sym<L::F>| l.mul(l.splat(SMALL_PIVOT / 3.0), part.trace(l));
    let least_w = least(&w);
    // By the Schur complement S = W - Bᵀ U⁻¹ B of U, with B by columns.
    let b: [[L::F; 3]; 3] = std::array::from_fn(|c| std::array::from_fn(|r| a[(c + 3 - r) % 3][r]));
    let (inverse_u, good_u) = u.inverse(l, least(&u));
    let x = b.map(|column| inverse_u.times(l, column));
    let minus = |l: L, from: L::F, p: &[L::F; 3], q: &[L::F; 3]| {
        l.sub_mul(p[2], q[2], l.sub_mul(p[1], q[1], l.sub_mul(p[0], q[0], from)))
    };
    let complement = Sym {
        on: std::array::from_fn(|k| minus(l, w.on[k], &b[k], &x[k])),
        off: std::array::from_fn(|k| {
            let [i, j] = OFF[k];
            minus(l, w.off[k], &b[i], &x[j])
        }),
    };
    let (inverse_w, good_w) = complement.inverse(l, least_w);
    // Beside it -(U⁻¹B) S⁻¹, by rows; in the corner U⁻¹ + (U⁻¹B) S⁻¹ (U⁻¹B)ᵀ.
    let rows: [[L::F; 3]; 3] = std::array::from_fn(|r| x.map(|column| column[r]));
    let zero = l.splat(0.0);
    let beside = rows.map(|row| inverse_w.times(l, row).map(|v| l.sub(zero, v)));
    let corner = Sym {
        on: std::array::from_fn(|k| minus(l, inverse_u.on[k], &beside[k], &rows[k])),
        off: std::array::from_fn(|k| {
            let [i, j] = OFF[k];
            minus(l, inverse_u.off[k], &beside[i], &rows[j])
        }),
    };
    let fours = |[x, y, z]: [L::F; 3]| {
        l.transpose([x, y, z, zero]).map(|lanes| {
            let mut four = Four::default();
            l.store(&mut four, lanes);
            four
        })
    };
    let [u_on, u_off, w_on, w_off] =
        [corner.on, corner.off, inverse_w.on, inverse_w.off].map(fours);
    let turned = [0, 1, 2].map(|k| fours(std::array::from_fn(|r| beside[r][(r + k) % 3])));
    for (k, to) in to.iter_mut().enumerate() {
        *to = Block6 {
            u: Block { on: u_on[k], off: u_off[k] },
            w: Block { on: w_on[k], off: w_off[k] },
            uw: [turned[0][k], turned[1][k], turned[2][k]],
        };
    }
    let good = held & good_u & good_w;
    if good != 0b1111 {
        let shift = l.array(shift);
        for k in (0..4).filter(|k| good >> k & 1 == 0) {
            to[k] = one(&blocks[k], shift[k]);
        }
    }
}

/// Row and column of the entries beside the diagonal: xy, yz, xz.
const OFF: [[usize; 2]; 3] = [[0, 1], [1, 2], [0, 2]];

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
    fn shifted<L: Lanes<F = F>>(&self, l: L, shift: F) -> Self {
        Self { on: self.on.map(|x| l.add(x, shift)), off: self.off }
    }

    #[inline(always)]
    fn times<L: Lanes<F = F>>(&self, l: L, [x, y, z]: [F; 3]) -> [F; 3] {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.on, self.off);
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
            .map(|[a, b, c]| l.mul_add(c, z, l.mul_add(b, y, l.mul(a, x))))
    }

    /// The inverse, and the lanes where all pivots are at least `floor` > 0, as bits; elsewhere it
    /// may be anything.
    #[inline(always)]
    fn inverse<L: Lanes<F = F>>(&self, l: L, floor: F) -> (Self, u32) {
        let ([xx, yy, zz], [xy, yz, xz]) = (self.on, self.off);
        let minor = |a, b, c, d| l.sub_mul(c, d, l.mul(a, b)); // ab - cd
        let on = [minor(yy, zz, yz, yz), minor(xx, zz, xz, xz), minor(xx, yy, xy, xy)];
        let off = [minor(xz, yz, xy, zz), minor(xy, xz, xx, yz), minor(xy, yz, xz, yy)];
        let determinant = l.mul_add(xz, off[2], l.mul_add(xy, off[0], l.mul(xx, on[0])));
        // The pivots are xx, the minor of zz over xx and the determinant over that minor.
        let good = l.at_least(xx, floor)
            & l.at_least(on[2], l.mul(floor, xx))
            & l.at_least(determinant, l.mul(floor, on[2]))
            & l.at_least(determinant, l.splat(f32::MIN_POSITIVE));
        let over = l.div(l.splat(1.0), determinant);
        (Self { on: on.map(|x| l.mul(x, over)), off: off.map(|x| l.mul(x, over)) }, good)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

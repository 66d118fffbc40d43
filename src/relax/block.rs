//! Symmetric 3x3 blocks as the registers take them.

use crate::relax::lanes::{Four, Lanes};
use crate::relax::sym3::Sym3;

/// A symmetric 3x3 block: its diagonal, and (xy, yz, xz).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    pub(super) on: Four,
    pub(super) off: Four,
}

impl From<&Sym3> for Block {
    #[inline(always)]
    fn from(block: &Sym3) -> Self {
        let [[xx, xy, xz], [_, yy, yz], [_, _, zz]] = block.columns();
        Self { on: Four([xx, yy, zz, 0.0]), off: Four([xy, yz, xz, 0.0]) }
    }
}

impl Block {
    /// A diagonal block.
    pub(super) fn diagonal([x, y, z]: [f32; 3]) -> Self {
        Self { on: Four([x, y, z, 0.0]), off: Four::default() }
    }

    /// Trace.
    pub(super) fn trace(&self) -> f32 {
        let Four([x, y, z, _]) = self.on;
        x + y + z
    }

    /// self += other.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        for k in 0..4 {
            self.on.0[k] += other.on.0[k];
            self.off.0[k] += other.off.0[k];
        }
    }

    /// Takes the inverse of this block to `to` and says whether that is so: all pivots must be at
    /// least `floor` > 0.
    #[inline(always)]
    pub(super) fn invert<L: Lanes>(&self, l: L, floor: f32, to: &mut Self) -> bool {
        let (on, off) = (l.load(&self.on), l.load(&self.off));
        let (off1, off2) = (l.yzx(off), l.zxy(off));
        let minor_on = l.sub_mul(off1, off1, l.mul(l.yzx(on), l.zxy(on)));
        let minor_off = l.sub_mul(off, l.zxy(on), l.mul(off1, off2));
        let (first, second) = (l.mul(on, minor_on), l.mul(off, minor_off));
        let corner = l.lane::<2>(second);
        let determinant = l.add(l.lane::<0>(l.add(first, second)), corner);
        let over = l.div(l.splat(1.0), determinant);
        l.store(&mut to.on, l.mul(minor_on, over));
        l.store(&mut to.off, l.mul(minor_off, over));
        // The pivots are xx, the minor of zz over xx and the determinant over that minor.
        let ([xx, ..], [_, _, minor, _]) = (l.array(on), l.array(minor_on));
        let [determinant, ..] = l.array(determinant);
        xx >= floor && minor >= floor * xx && determinant >= (floor * minor).max(f32::MIN_POSITIVE)
    }

    /// This block and its inverse; where a pivot is below `floor` the diagonal is lifted first, so
    /// that the block is positive definite.
    #[cold]
    #[inline(never)]
    pub(super) fn inverse_lifted(&self, floor: f32) -> (Self, Self) {
        let (lifted, inverse) = self.sym3().inverse_lifted(floor);
        (Self::from(&lifted), Self::from(&inverse))
    }

    /// The block as it is added up.
    pub(super) fn sym3(&self) -> Sym3 {
        let (Four([xx, yy, zz, _]), Four([xy, yz, xz, _])) = (self.on, self.off);
        Sym3::new([xx, yy, zz, xy, xz, yz])
    }

    /// This block times v; lane 3 of v does not count, that of the product is zero.
    #[inline(always)]
    pub(super) fn times<L: Lanes>(&self, l: L, v: L::F) -> L::F {
        let (on, off) = (l.load(&self.on), l.load(&self.off));
        let product = l.mul(on, v);
        let product = l.mul_add(off, l.yzx(v), product);
        l.mul_add(l.zxy(off), l.zxy(v), product)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::lanes::Portable;

    #[test]
    fn the_inverse_undoes_the_product() {
        let block = Block::from(&Sym3::new([4.0, 3.0, 5.0, 0.5, -0.25, 0.75]));
        let mut inverse = Block::default();
        assert!(block.invert(Portable, 0.1, &mut inverse));
        let x = [1.0, -2.0, 0.5, 0.0];
        let back = inverse.times(Portable, block.times(Portable, x));
        for (back, x) in back.iter().zip(x) {
            assert!((back - x).abs() < 1e-6, "{back} {x}");
        }
    }

    #[test]
    fn small_pivots_are_refused() {
        let mut inverse = Block::default();
        for entries in [
            [0.05, 3.0, 5.0, 0.0, 0.0, 0.0],
            [4.0, 1.0, 5.0, 1.99, 0.0, 0.0],
            [4.0, 3.0, 1.0, 0.0, 1.99, 0.0],
            [4.0, 3.0, -5.0, 0.5, -0.25, 0.75],
            [f32::NAN; 6],
            [0.0; 6],
        ] {
            let block = Block::from(&Sym3::new(entries));
            assert!(!block.invert(Portable, 0.1, &mut inverse), "{entries:?}");
        }
    }
}

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

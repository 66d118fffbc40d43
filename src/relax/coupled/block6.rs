//! Symmetric 6x6 blocks as the registers take them.

use crate::relax::block::Block;
use crate::relax::lanes::{Four, Lanes};
use crate::relax::sym6::Sym6;

/// A block by its parts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block6 {
    /// What u does to the forces.
    pub(super) u: Block,
    /// What w does to the moments over radius.
    pub(super) w: Block,
    /// What w does to the forces, A: (xx, yy, zz), (xy, yz, zx) and (xz, yx, zy).
    pub(super) uw: [Four; 3],
}

/// Displacement and rotation times radius, or force and moment over radius.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(super) struct Six {
    pub(super) u: Four,
    pub(super) w: Four,
}

impl From<&Sym6> for Block6 {
    fn from(block: &Sym6) -> Self {
        let a = &block.uw;
        let turned = |k: usize| Four([a[0][k % 3], a[1][(1 + k) % 3], a[2][(2 + k) % 3], 0.0]);
        Self { u: Block::from(&block.u), w: Block::from(&block.w), uw: [0, 1, 2].map(turned) }
    }
}

impl Block6 {
    /// The block as it is inverted.
    pub(super) fn sym6(&self) -> Sym6 {
        let mut uw = [[0.0; 3]; 3];
        for (k, Four(turned)) in self.uw.iter().enumerate() {
            for row in 0..3 {
                uw[row][(row + k) % 3] = turned[row];
            }
        }
        Sym6 { u: self.u.sym3(), w: self.w.sym3(), uw }
    }

    /// This block times (u, w); lanes 3 do not count, those of the product are zero.
    #[inline(always)]
    pub(super) fn times<L: Lanes>(&self, l: L, u: L::F, w: L::F) -> [L::F; 2] {
        let [a0, a1, a2] = [l.load(&self.uw[0]), l.load(&self.uw[1]), l.load(&self.uw[2])];
        let force = l.mul_add(a0, w, self.u.times(l, u));
        let force = l.mul_add(a1, l.yzx(w), force);
        let force = l.mul_add(a2, l.zxy(w), force);
        let moment = l.mul_add(a0, u, self.w.times(l, w));
        let moment = l.add(moment, l.zxy(l.mul(a1, u)));
        let moment = l.add(moment, l.yzx(l.mul(a2, u)));
        [force, moment]
    }

    /// self += other.
    pub(super) fn add(&mut self, other: &Self) {
        let fours = |b: &Self| [b.u.on, b.u.off, b.w.on, b.w.off, b.uw[0], b.uw[1], b.uw[2]];
        let sum = |k: usize| {
            let (Four(a), Four(b)) = (fours(self)[k], fours(other)[k]);
            Four(std::array::from_fn(|lane| a[lane] + b[lane]))
        };
        *self = Self {
            u: Block { on: sum(0), off: sum(1) },
            w: Block { on: sum(2), off: sum(3) },
            uw: [sum(4), sum(5), sum(6)],
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::lanes::Portable;
    use crate::relax::sym3::Sym3;

    #[test]
    fn the_product_is_that_of_the_matrix() {
        let a = [[0.3, -0.6, 0.2], [0.9, 0.1, -0.4], [-0.2, 0.5, 0.7]];
        let block = Sym6 {
            u: Sym3::new([4.0, 3.0, 5.0, 0.5, -0.25, 0.75]),
            w: Sym3::new([2.0, 3.5, 2.5, -0.5, 0.25, 0.5]),
            uw: a,
        };
        let there = Block6::from(&block);
        assert_eq!(there.sym6(), block);
        let (u, w) = ([1.0f32, -2.0, 0.5, 9.0], [3.0f32, 0.25, -1.5, 9.0]);
        let [force, moment] = there.times(Portable, u, w);
        let (columns_u, columns_w) = (block.u.columns(), block.w.columns());
        for k in 0..3 {
            let f: f32 = (0..3).map(|c| columns_u[c][k] * u[c] + a[k][c] * w[c]).sum();
            let m: f32 = (0..3).map(|c| columns_w[c][k] * w[c] + a[c][k] * u[c]).sum();
            assert!((force[k] - f).abs() < 1e-5 && (moment[k] - m).abs() < 1e-5);
        }
        assert_eq!((force[3], moment[3]), (0.0, 0.0));
    }
}

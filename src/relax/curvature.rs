//! Stiffness between grains that do not touch: what the pressure of membranes does as their surface bends.
//!
//! A contact is a stiffness of the form that [`Link`](super::balance::Link) has. A pressure couples any
//! two grains that share a triangle, by a block that has no form at all; the block the other way is its
//! transpose.

use crate::heap;
use crate::relax::block::Block;
use crate::relax::lanes::Four;
use crate::relax::split::Split;
use crate::relax::sym3::Sym3;

/// A 3x3 block by its rows, in units of the reference stiffness.
pub type Block3 = [[f32; 3]; 3];

/// Second derivative of a potential by the centres of grains. A grain or a pair may be named several times:
/// the blocks add up.
#[derive(Clone, Debug, Default)]
pub struct Curvature {
    /// Symmetric blocks of single grains.
    pub own: Vec<(u32, Block3)>,
    /// Blocks of pairs: what the second grain does to the gradient of the first.
    pub pairs: Vec<([u32; 2], Block3)>,
}

impl Curvature {
    /// Forgets all blocks.
    pub(super) fn clear(&mut self) {
        self.own.clear();
        self.pairs.clear();
    }

    /// The grains of each pair.
    pub(super) fn grains(&self) -> impl Iterator<Item = [u32; 2]> {
        self.pairs.iter().map(|(grains, _)| *grains)
    }

    /// The blocks of single grains that part `k` of `split` has, with their rows.
    pub(super) fn own_of(&self, split: &Split, k: usize) -> impl Iterator<Item = (usize, Block)> {
        self.own.iter().filter_map(move |(grain, block)| {
            let at = split.places()[*grain as usize];
            (at.part as usize == k).then(|| (at.row as usize, symmetric(block)))
        })
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.own) + heap::bytes(&self.pairs)
    }
}

fn symmetric([[xx, xy, xz], [_, yy, yz], [_, _, zz]]: &Block3) -> Block {
    Block::from(&Sym3::new([*xx, *yy, *zz, *xy, *xz, *yz]))
}

/// The pairs that one part of a linear system has.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs(Vec<([u32; 2], Block3)>);

impl Pairs {
    /// Takes those of part `k` of `split`.
    pub(super) fn take(&mut self, split: &Split, k: usize, curvature: &Curvature) {
        self.0.clear();
        self.0.extend(curvature.pairs.iter().filter_map(|(grains, block)| {
            let (part, rows) = split.pair(*grains);
            (part as usize == k).then_some((rows, *block))
        }));
    }

    /// Adds the product with x, which is `of` each row, `to` each row.
    pub(super) fn multiply<V>(
        &self,
        (x, of): (&[V], impl Fn(&V) -> &Four),
        (y, to): (&mut [V], impl Fn(&mut V) -> &mut Four),
    ) {
        for ([i, j], block) in &self.0 {
            let [i, j] = [*i as usize, *j as usize];
            let (Four(xi), Four(xj)) = (of(&x[i]), of(&x[j]));
            let Four(yi) = to(&mut y[i]);
            for (yi, row) in yi.iter_mut().zip(block) {
                *yi += row[0] * xj[0] + row[1] * xj[1] + row[2] * xj[2];
            }
            let Four(yj) = to(&mut y[j]);
            for (c, yj) in yj.iter_mut().take(3).enumerate() {
                *yj += block[0][c] * xi[0] + block[1][c] * xi[1] + block[2][c] * xi[2];
            }
        }
    }

    /// Memory that its list holds \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.0)
    }
}

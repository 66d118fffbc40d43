//! The dense matrix in which one supernode is eliminated (Duff and Reid 1983).

use super::tree::{Node, Tree};
use super::{Block, FREEDOMS};
use crate::relax::lanes::{Kernel, Lanes, dispatch};

/// Columns that are eliminated as one, so that the rest is updated by all of them in one sweep.
const PANEL: usize = 6;

/// One supernode with the place of its factors.
#[derive(Clone, Debug)]
pub(super) struct Front {
    node: Node,
    /// What it leaves of each child in the stack: fronts of the children, last first.
    children: Vec<u32>,
    /// Numbers that stand in the stack for this front \[count\].
    leaves: usize,
    /// First of its factors.
    at: usize,
}

/// Makes the fronts of `tree`.
pub(super) fn lay_out(tree: &Tree, fronts: &mut Vec<Front>) {
    fronts.clear();
    let mut open: Vec<u32> = Vec::new();
    let mut at = 0;
    for (own, &node) in tree.nodes.iter().enumerate() {
        let from = open.len() - node.children as usize;
        let children = open.drain(from..).rev().collect();
        open.push(own as u32);
        let coupled = FREEDOMS * node.coupled as usize;
        fronts.push(Front { node, children, leaves: coupled * coupled, at });
        let pivots = FREEDOMS * node.pivots as usize;
        at += (pivots + coupled) * pivots;
    }
}

impl Front {
    fn pivots(&self) -> usize {
        FREEDOMS * self.node.pivots as usize
    }

    fn size(&self) -> usize {
        FREEDOMS * (self.node.pivots + self.node.coupled) as usize
    }

    fn grains<'a>(&self, tree: &'a Tree) -> &'a [u32] {
        let Node { first, pivots, coupled, .. } = self.node;
        &tree.grains[first as usize..(first + pivots + coupled) as usize]
    }

    /// Gathers the entries of the eliminated grains and what the children left, eliminates, and leaves
    /// the rest on the stack. Says whether all pivots were positive.
    pub(super) fn factorise(
        &mut self,
        tree: &Tree,
        (diagonal, pairs): (&[Block], &[Block]),
        shift: f64,
        factors: &mut Vec<f64>,
        stack: &mut Vec<f64>,
        place: &mut [u32],
    ) -> bool {
        let (m, p) = (self.size(), self.pivots());
        let grains = self.grains(tree);
        // Eliminated where its factors stay; what it leaves is taken from behind them.
        debug_assert_eq!(self.at, factors.len());
        factors.resize(self.at + m * m, 0.0);
        let dense = &mut factors[self.at..];
        for (k, &grain) in grains.iter().enumerate() {
            place[grain as usize] = k as u32;
        }
        for (k, &grain) in grains[..p / FREEDOMS].iter().enumerate() {
            let own = FREEDOMS * k;
            for a in 0..FREEDOMS {
                for b in a..FREEDOMS {
                    dense[(own + a) * m + own + b] += diagonal[grain as usize][b][a];
                }
                dense[(own + a) * m + own + a] += shift;
            }
            for &(other, entry) in tree.links_of(grain) {
                if tree.rank[other as usize] < tree.rank[grain as usize] {
                    continue;
                }
                // Column of the pivot, row of the other one; the entry has the smaller grain's row.
                let (row, block) =
                    (FREEDOMS * place[other as usize] as usize, &pairs[entry as usize]);
                for a in 0..FREEDOMS {
                    for b in 0..FREEDOMS {
                        let value = if grain < other { block[a][b] } else { block[b][a] };
                        dense[(own + a) * m + row + b] += value;
                    }
                }
            }
        }
        for &child in &self.children {
            gather(&tree.nodes[child as usize], tree, place, stack, dense, m);
        }
        if !dispatch(Eliminate { dense, m, p }) {
            return false;
        }
        for column in p..m {
            stack.extend_from_slice(&dense[column * m + p..(column + 1) * m]);
        }
        factors.truncate(self.at + m * p);
        debug_assert_eq!(self.leaves, (m - p) * (m - p));
        true
    }

    /// Forward substitution of this front's part of `right`.
    pub(super) fn forward(
        &self,
        tree: &Tree,
        factors: &[f64],
        right: &mut [f64],
        local: &mut Vec<f64>,
    ) {
        let (m, p) = (self.size(), self.pivots());
        self.take(tree, right, local);
        for column in 0..p {
            let factor = &factors[self.at + column * m..self.at + (column + 1) * m];
            let x = local[column] / factor[column];
            local[column] = x;
            for (to, l) in local[column + 1..].iter_mut().zip(&factor[column + 1..]) {
                *to -= l * x;
            }
        }
        self.give(tree, local, right, m);
    }

    /// Backward substitution of this front's part of `right`.
    pub(super) fn backward(
        &self,
        tree: &Tree,
        factors: &[f64],
        right: &mut [f64],
        local: &mut Vec<f64>,
    ) {
        let (m, p) = (self.size(), self.pivots());
        self.take(tree, right, local);
        for column in (0..p).rev() {
            let factor = &factors[self.at + column * m..self.at + (column + 1) * m];
            let sum = dot(&factor[column + 1..], &local[column + 1..]);
            local[column] = (local[column] - sum) / factor[column];
        }
        self.give(tree, local, right, p);
    }

    fn take(&self, tree: &Tree, right: &[f64], local: &mut Vec<f64>) {
        local.clear();
        for &grain in self.grains(tree) {
            let from = FREEDOMS * grain as usize;
            local.extend_from_slice(&right[from..from + FREEDOMS]);
        }
    }

    fn give(&self, tree: &Tree, local: &[f64], right: &mut [f64], most: usize) {
        for (k, &grain) in self.grains(tree)[..most / FREEDOMS].iter().enumerate() {
            let to = FREEDOMS * grain as usize;
            right[to..to + FREEDOMS].copy_from_slice(&local[FREEDOMS * k..FREEDOMS * (k + 1)]);
        }
    }
}

/// Adds what the child `node` left on top of the stack.
fn gather(
    node: &Node,
    tree: &Tree,
    place: &[u32],
    stack: &mut Vec<f64>,
    dense: &mut [f64],
    m: usize,
) {
    let from = (node.first + node.pivots) as usize;
    let grains = &tree.grains[from..from + node.coupled as usize];
    let size = FREEDOMS * grains.len();
    let left = stack.len() - size * size;
    for (j, &second) in grains.iter().enumerate() {
        let column = FREEDOMS * place[second as usize] as usize;
        for (i, &first) in grains.iter().enumerate().skip(j) {
            // Both lists are in the order of elimination: rows stay below columns.
            let row = FREEDOMS * place[first as usize] as usize;
            for b in 0..FREEDOMS {
                let child = left + (FREEDOMS * j + b) * size + FREEDOMS * i;
                let at = (column + b) * m + row;
                for a in 0..FREEDOMS {
                    dense[at + a] += stack[child + a];
                }
            }
        }
    }
    stack.truncate(left);
}

/// [`eliminate`] with the instructions of the machine, which do the same to the bit.
struct Eliminate<'a> {
    dense: &'a mut [f64],
    m: usize,
    p: usize,
}

impl Kernel for Eliminate<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) -> bool {
        eliminate(self.dense, self.m, self.p)
    }
}

/// Cholesky factors of the first `p` columns of the lower triangle of `dense`, m x m by columns, and the
/// Schur complement in the rest. Says whether all pivots were positive.
#[inline(always)]
fn eliminate(dense: &mut [f64], m: usize, p: usize) -> bool {
    let mut from = 0;
    while from < p {
        let to = (from + PANEL).min(p);
        for column in from..to {
            let (done, rest) = dense.split_at_mut(column * m);
            let own = &mut rest[..m];
            for before in from..column {
                let l = &done[before * m..(before + 1) * m];
                let x = l[column];
                for (to, l) in own[column..].iter_mut().zip(&l[column..]) {
                    *to -= l * x;
                }
            }
            let pivot = own[column];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let root = pivot.sqrt();
            own[column..].iter_mut().for_each(|entry| *entry /= root);
        }
        let (done, rest) = dense.split_at_mut(to * m);
        let panel = &done[from * m..];
        for (column, own) in rest.chunks_exact_mut(m).enumerate().map(|(k, own)| (to + k, own)) {
            update(panel, to - from, m, column, &mut own[column..]);
        }
        from = to;
    }
    true
}

/// Subtracts from `own`, the rows of `column` from the diagonal on, what the columns of `panel` do to it.
#[inline(always)]
fn update(panel: &[f64], width: usize, m: usize, column: usize, own: &mut [f64]) {
    let rows = |k: usize| &panel[k * m + column..(k + 1) * m];
    if width == PANEL {
        let [a, b, c, d, e, f] = std::array::from_fn(rows);
        let [wa, wb, wc, wd, we, wf] = [a[0], b[0], c[0], d[0], e[0], f[0]];
        let lists = a.iter().zip(b).zip(c).zip(d).zip(e).zip(f);
        for (to, (((((a, b), c), d), e), f)) in own.iter_mut().zip(lists) {
            *to -= (a * wa + b * wb) + (c * wc + d * wd) + (e * we + f * wf);
        }
        return;
    }
    for k in 0..width {
        let l = rows(k);
        let x = l[0];
        for (to, l) in own.iter_mut().zip(l) {
            *to -= l * x;
        }
    }
}

/// Sum of products in four parts, which a processor can add up side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 4];
    let (fours, rest) = a.as_chunks::<4>();
    let (other_fours, other_rest) = b.as_chunks::<4>();
    for (a, b) in fours.iter().zip(other_fours) {
        for (part, (a, b)) in parts.iter_mut().zip(a.iter().zip(b)) {
            *part += a * b;
        }
    }
    let rest: f64 = rest.iter().zip(other_rest).map(|(a, b)| a * b).sum();
    (parts[0] + parts[1]) + (parts[2] + parts[3]) + rest
}

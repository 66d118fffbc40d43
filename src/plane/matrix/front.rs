//! The dense matrix in which one supernode is eliminated (Duff and Reid 1983).

use super::tree::{Node, Tree};
use super::{Block, FREEDOMS};
use crate::heap;
use crate::relax::lanes::{Kernel, Lanes, dispatch};

/// Columns that are eliminated as one, so that the rest is updated by all of them in one sweep.
const PANEL: usize = 2 * FREEDOMS;
/// Numbers that are updated side by side.
const WIDE: usize = 4;

/// One supernode with the place of its factors.
#[derive(Clone, Debug)]
struct Front {
    node: Node,
    /// Its entries among [`Fronts::entries`].
    entries: [u32; 2],
    /// First of the places of its children's grains in it, last child first, in [`Fronts::places`].
    places: u32,
    /// First of its factors.
    at: usize,
}

/// A block of the system in a front.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Its number in the list of the pairs.
    pair: u32,
    /// First of its grains' rows and columns.
    row: u32,
    column: u32,
    /// Whether the column's grain has the smaller number, so that the block stands the other way round.
    turned: bool,
}

/// The supernodes in the order of elimination.
#[derive(Clone, Debug, Default)]
pub(super) struct Fronts {
    list: Vec<Front>,
    entries: Vec<Entry>,
    /// Coupled grains of each child that a front takes over, and where they stand among its own.
    places: Vec<u32>,
    /// Grains that each child leaves, in the order in which they are taken over.
    left: Vec<u32>,
}

impl Fronts {
    /// Makes the fronts of `tree`.
    pub(super) fn lay_out(&mut self, tree: &Tree) {
        let Self { list, entries, places, left } = self;
        list.clear();
        entries.clear();
        places.clear();
        left.clear();
        let mut open: Vec<u32> = Vec::new();
        let mut place = vec![0; tree.rank.len()];
        let mut at = 0;
        for (own, &node) in tree.nodes.iter().enumerate() {
            let grains = tree.grains_of(&node);
            for (k, &grain) in grains.iter().enumerate() {
                place[grain as usize] = (FREEDOMS * k) as u32;
            }
            let first_entry = entries.len() as u32;
            for &grain in &grains[..node.pivots as usize] {
                for &(other, pair) in tree.links_of(grain) {
                    if tree.rank[other as usize] > tree.rank[grain as usize] {
                        let [row, column] = [other, grain].map(|grain| place[grain as usize]);
                        entries.push(Entry { pair, row, column, turned: grain < other });
                    }
                }
            }
            let first_place = places.len() as u32;
            for child in open.drain(open.len() - node.children as usize..).rev() {
                let child: &Node = &tree.nodes[child as usize];
                let taken = &tree.grains_of(child)[child.pivots as usize..];
                places.extend(taken.iter().map(|&grain| place[grain as usize]));
                left.push(child.coupled);
            }
            open.push(own as u32);
            let entries = [first_entry, entries.len() as u32];
            list.push(Front { node, entries, places: first_place, at });
            let pivots = FREEDOMS * node.pivots as usize;
            at += (pivots + FREEDOMS * node.coupled as usize) * pivots;
        }
    }

    /// Factorises all: gathers the entries of the eliminated grains and what the children left,
    /// eliminates, and leaves the rest on the stack. Says whether all pivots were positive.
    pub(super) fn factorise(
        &self,
        tree: &Tree,
        (diagonal, pairs): (&[Block], &[Block]),
        shift: f64,
        factors: &mut Vec<f64>,
        stack: &mut Vec<f64>,
    ) -> bool {
        factors.clear();
        stack.clear();
        let mut left = self.left.iter();
        for front in &self.list {
            let (m, p) = (front.size(), front.pivots());
            // Eliminated where its factors stay; what it leaves is taken from behind them.
            debug_assert_eq!(front.at, factors.len());
            factors.resize(front.at + m * m, 0.0);
            let dense = &mut factors[front.at..];
            for (k, &grain) in front.grains(tree)[..p / FREEDOMS].iter().enumerate() {
                let own = FREEDOMS * k;
                for a in 0..FREEDOMS {
                    for b in a..FREEDOMS {
                        dense[(own + a) * m + own + b] = diagonal[grain as usize][b][a];
                    }
                    dense[(own + a) * m + own + a] += shift;
                }
            }
            for entry in &self.entries[front.entries[0] as usize..front.entries[1] as usize] {
                let block = &pairs[entry.pair as usize];
                let mut at = entry.column as usize * m + entry.row as usize;
                for a in 0..FREEDOMS {
                    let column = if entry.turned { block[a] } else { block.map(|row| row[a]) };
                    dense[at..at + FREEDOMS].iter_mut().zip(column).for_each(|(to, x)| *to += x);
                    at += m;
                }
            }
            let mut first = front.places as usize;
            for coupled in left.by_ref().take(front.node.children as usize) {
                let next = first + *coupled as usize;
                gather(&self.places[first..next], stack, dense, m);
                first = next;
            }
            if !dispatch(Eliminate { dense, m, p }) {
                return false;
            }
            for column in p..m {
                stack.extend_from_slice(&dense[column * m + column..(column + 1) * m]);
            }
            factors.truncate(front.at + m * p);
        }
        true
    }

    /// Solves in place for right sides of three numbers a grain.
    pub(super) fn solve(
        &self,
        tree: &Tree,
        factors: &[f64],
        rights: &mut [Vec<f64>],
        local: &mut Vec<f64>,
    ) {
        dispatch(Substitute { fronts: &self.list, tree, factors, rights, local });
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.list)
            + heap::bytes(&self.entries)
            + heap::bytes(&self.places)
            + heap::bytes(&self.left)
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
        tree.grains_of(&self.node)
    }

    /// Forward substitution of this front's part of `right`.
    #[inline(always)]
    fn forward(&self, tree: &Tree, factors: &[f64], right: &mut [f64], local: &mut Vec<f64>) {
        let (m, p) = (self.size(), self.pivots());
        self.take(tree, right, local);
        let own = &factors[self.at..self.at + m * p];
        for (k, columns) in own.chunks_exact(FREEDOMS * m).enumerate() {
            let first = FREEDOMS * k;
            let (done, rest) = local[first..].split_at_mut(FREEDOMS);
            let [a, b, c] = columns_of(columns, m, first);
            let x = done[0] * a[0];
            let y = a[1].mul_add(-x, done[1]) * b[1];
            let z = b[2].mul_add(-y, a[2].mul_add(-x, done[2])) * c[2];
            done.copy_from_slice(&[x, y, z]);
            let lower = a[FREEDOMS..].iter().zip(&b[FREEDOMS..]).zip(&c[FREEDOMS..]);
            for (to, ((a, b), c)) in rest.iter_mut().zip(lower) {
                *to = c.mul_add(-z, b.mul_add(-y, a.mul_add(-x, *to)));
            }
        }
        self.give(tree, local, right, m);
    }

    /// Backward substitution of this front's part of `right`.
    #[inline(always)]
    fn backward(&self, tree: &Tree, factors: &[f64], right: &mut [f64], local: &mut Vec<f64>) {
        let (m, p) = (self.size(), self.pivots());
        self.take(tree, right, local);
        let own = &factors[self.at..self.at + m * p];
        for (k, columns) in own.chunks_exact(FREEDOMS * m).enumerate().rev() {
            let first = FREEDOMS * k;
            let (done, rest) = local[first..].split_at_mut(FREEDOMS);
            let [a, b, c] = columns_of(columns, m, first);
            let [x, y, z] = dots([&a[FREEDOMS..], &b[FREEDOMS..], &c[FREEDOMS..]], rest);
            let z = (done[2] - z) * c[2];
            let y = b[2].mul_add(-z, done[1] - y) * b[1];
            let x = a[1].mul_add(-y, a[2].mul_add(-z, done[0] - x)) * a[0];
            done.copy_from_slice(&[x, y, z]);
        }
        self.give(tree, local, right, p);
    }

    #[inline(always)]
    fn take(&self, tree: &Tree, right: &[f64], local: &mut Vec<f64>) {
        local.clear();
        for &grain in self.grains(tree) {
            let from = FREEDOMS * grain as usize;
            local.extend_from_slice(&right[from..from + FREEDOMS]);
        }
    }

    #[inline(always)]
    fn give(&self, tree: &Tree, local: &[f64], right: &mut [f64], most: usize) {
        for (k, &grain) in self.grains(tree)[..most / FREEDOMS].iter().enumerate() {
            let to = FREEDOMS * grain as usize;
            right[to..to + FREEDOMS].copy_from_slice(&local[FREEDOMS * k..FREEDOMS * (k + 1)]);
        }
    }
}

/// Adds what a child left on top of the stack, the lower triangle by columns, to `dense`; `places` are
/// the rows of its grains there.
fn gather(places: &[u32], stack: &mut Vec<f64>, dense: &mut [f64], m: usize) {
    let size = FREEDOMS * places.len();
    let left = stack.len() - size * (size + 1) / 2;
    let mut rest = &stack[left..];
    for (j, &column) in places.iter().enumerate() {
        let column = column as usize;
        for b in 0..FREEDOMS {
            let (own, next) = rest.split_at(size - FREEDOMS * j - b);
            rest = next;
            // Both lists are in the order of elimination: rows stay below columns.
            let to = &mut dense[(column + b) * m..(column + b + 1) * m];
            let (diagonal, below) = own.split_at(FREEDOMS - b);
            to[column + b..column + FREEDOMS].iter_mut().zip(diagonal).for_each(|(to, x)| *to += x);
            for (block, &row) in below.as_chunks::<FREEDOMS>().0.iter().zip(&places[j + 1..]) {
                let row = row as usize;
                to[row..row + FREEDOMS].iter_mut().zip(block).for_each(|(to, x)| *to += x);
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

/// Cholesky factors of the first `p` columns of the lower triangle of `dense`, m x m by columns, with one
/// over the diagonal, and the Schur complement in the rest; what is above the diagonal is of no use then.
/// Says whether all pivots were positive.
#[inline(always)]
fn eliminate(dense: &mut [f64], m: usize, p: usize) -> bool {
    let mut from = 0;
    while from < p {
        let to = (from + PANEL).min(p);
        for column in from..to {
            let (done, rest) = dense.split_at_mut(column * m);
            let own = &mut rest[column..m];
            for before in done[from * m..].chunks_exact(m) {
                let l = &before[column..];
                let x = l[0];
                own.iter_mut().zip(l).for_each(|(to, l)| *to = l.mul_add(-x, *to));
            }
            let pivot = own[0];
            if pivot.is_nan() || pivot <= 0.0 {
                return false;
            }
            let over = 1.0 / pivot.sqrt();
            own[0] = over;
            own[1..].iter_mut().for_each(|entry| *entry *= over);
        }
        let (done, rest) = dense.split_at_mut(to * m);
        let panel = &done[from * m..];
        match to - from {
            PANEL => update::<PANEL>(panel, m, to, rest),
            _ => update::<FREEDOMS>(panel, m, to, rest),
        }
        from = to;
    }
    true
}

/// Subtracts from `rest`, the columns from `first` on, what the `WIDTH` columns of `panel` do to them;
/// the columns of one grain at a time, so that what is in registers serves several times.
#[inline(always)]
fn update<const WIDTH: usize>(panel: &[f64], m: usize, first: usize, rest: &mut [f64]) {
    for (k, columns) in rest.chunks_exact_mut(FREEDOMS * m).enumerate() {
        let column = first + FREEDOMS * k;
        let rows: [&[f64]; WIDTH] = std::array::from_fn(|k| &panel[k * m + column..(k + 1) * m]);
        let factor = rows.map(|row| [row[0], row[1], row[2]]);
        let (a, others) = columns.split_at_mut(m);
        let (b, c) = others.split_at_mut(m);
        let [(a, a_rest), (b, b_rest), (c, c_rest)] =
            [a, b, c].map(|own| own[column..].as_chunks_mut::<WIDE>());
        let mut at = 0;
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            let mut sums = [*a, *b, *c];
            for (row, factor) in rows.iter().zip(&factor) {
                let l = &row[at..at + WIDE];
                for (sum, factor) in sums.iter_mut().zip(factor) {
                    sum.iter_mut().zip(l).for_each(|(to, l)| *to = l.mul_add(-factor, *to));
                }
            }
            [*a, *b, *c] = sums;
            at += WIDE;
        }
        for ((a, b), c) in a_rest.iter_mut().zip(b_rest).zip(c_rest) {
            for (row, factor) in rows.iter().zip(&factor) {
                let l = row[at];
                *a = l.mul_add(-factor[0], *a);
                *b = l.mul_add(-factor[1], *b);
                *c = l.mul_add(-factor[2], *c);
            }
            at += 1;
        }
    }
}

/// The columns of one grain, from the row of its first pivot on.
#[inline(always)]
fn columns_of(columns: &[f64], m: usize, first: usize) -> [&[f64]; FREEDOMS] {
    std::array::from_fn(|k| &columns[k * m + first..(k + 1) * m])
}

/// Products of three columns with `right`, in parts that a processor can add up side by side.
#[inline(always)]
fn dots(columns: [&[f64]; FREEDOMS], right: &[f64]) -> [f64; FREEDOMS] {
    let (right, right_rest) = right.as_chunks::<WIDE>();
    let [a, b, c] = columns.map(|column| column.as_chunks::<WIDE>());
    let mut sums = [[0.0; WIDE]; FREEDOMS];
    for (((a, b), c), x) in a.0.iter().zip(b.0).zip(c.0).zip(right) {
        for (sum, l) in sums.iter_mut().zip([a, b, c]) {
            sum.iter_mut()
                .zip(l.iter().zip(x))
                .for_each(|(sum, (l, x))| *sum = l.mul_add(*x, *sum));
        }
    }
    let mut dots = sums.map(|[a, b, c, d]| (a + b) + (c + d));
    for (dot, rest) in dots.iter_mut().zip([a.1, b.1, c.1]) {
        rest.iter().zip(right_rest).for_each(|(l, x)| *dot = l.mul_add(*x, *dot));
    }
    dots
}

/// Substitution, forward and backward, with the instructions of the machine. What is fetched of a front
/// serves all right sides.
struct Substitute<'a> {
    fronts: &'a [Front],
    tree: &'a Tree,
    factors: &'a [f64],
    rights: &'a mut [Vec<f64>],
    local: &'a mut Vec<f64>,
}

impl Kernel for Substitute<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, _: L) {
        let Self { fronts, tree, factors, rights, local } = self;
        // Closures would not have the instructions of the machine.
        for front in fronts {
            for right in rights.iter_mut() {
                front.forward(tree, factors, right, local);
            }
        }
        for front in fronts.iter().rev() {
            for right in rights.iter_mut() {
                front.backward(tree, factors, right, local);
            }
        }
    }
}

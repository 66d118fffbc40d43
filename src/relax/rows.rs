//! Rows of entries a grain: every pair both ways, for what takes one grain at a time.

use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::model::Model;

/// Entries of each grain, one grain after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows<T> {
    start: Vec<u32>,
    length: Vec<u32>,
    entries: Vec<T>,
}

impl<T: Copy + Default> Rows<T> {
    /// Sorts `entries`, given with their grain below `n`, into rows; they keep their order.
    pub(super) fn fill<I: Iterator<Item = (usize, T)>>(
        &mut self,
        n: usize,
        entries: impl Fn() -> I,
    ) {
        self.start.clear();
        self.start.resize(n + 1, 0);
        for (i, _) in entries() {
            self.start[i + 1] += 1;
        }
        for i in 0..n {
            self.start[i + 1] += self.start[i];
        }
        self.entries.clear();
        self.entries.resize(self.start[n] as usize, T::default());
        self.length.clear();
        self.length.resize(n, 0);
        for (i, entry) in entries() {
            self.entries[(self.start[i] + self.length[i]) as usize] = entry;
            self.length[i] += 1;
        }
    }

    /// The entries of grain `i`.
    pub(super) fn row(&self, i: usize) -> &[T] {
        &self.entries[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.start) + heap::bytes(&self.length) + heap::bytes(&self.entries)
    }

    /// The number of entries of each grain, shape (n).
    pub(super) fn lengths(&self) -> &[u32] {
        &self.length
    }
}

/// A grain that another can touch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Near {
    pub(super) second: u32,
    /// Hertz' M \[N/m^1.5\].
    pub(super) modulus: f64,
    /// Distance of the centres below which they press \[m\].
    pub(super) reach: f64,
}

impl Rows<Near> {
    /// Lists the pairs of grains both ways that satisfy `keep`.
    pub(super) fn fill_pairs(
        &mut self,
        neighbours: &Neighbours,
        model: &Model,
        keep: impl Fn(usize, usize, f64) -> bool,
    ) {
        let pairs =
            |i: usize| neighbours.row(i).map(move |k| (i, neighbours.second[k] as usize, k));
        let both = |(i, j, k): (usize, usize, usize)| {
            let (modulus, reach) = (neighbours.modulus[k], neighbours.reach(model, i, k));
            let near = |second: usize| Near { second: second as u32, modulus, reach };
            [(i, near(j)), (j, near(i))]
        };
        let keeps = |&(i, j, k): &(usize, usize, usize)| keep(i, j, neighbours.reach(model, i, k));
        self.fill(model.len(), || (0..model.len()).flat_map(pairs).filter(keeps).flat_map(both));
    }
}

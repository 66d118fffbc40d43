//! Rows of entries a grain: every pair both ways, for what takes one grain at a time.

use crate::contact::neighbours::Neighbours;
use crate::heap;

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

impl Rows<(u32, f64)> {
    /// Lists the pairs of grains both ways that satisfy `keep`, with Hertz' M.
    pub(super) fn fill_pairs(
        &mut self,
        neighbours: &Neighbours,
        n: usize,
        keep: impl Fn(usize, usize) -> bool,
    ) {
        let pairs = |i: usize| {
            neighbours
                .row(i)
                .map(move |k| (i, neighbours.second[k] as usize, neighbours.modulus[k]))
        };
        self.fill(n, || {
            (0..n)
                .flat_map(pairs)
                .filter(|&(i, j, _)| keep(i, j))
                .flat_map(|(i, j, modulus)| [(i, (j as u32, modulus)), (j, (i as u32, modulus))])
        });
    }
}

//! The linear system of a Newton step: a symmetric matrix of 3x3 blocks, one a grain, factorised
//! exactly.
//!
//! In the plane a direct factorisation is cheap: nested dissection (`tree`) cuts the pack along lines
//! of grains, and the fronts along them are small dense matrices (`front`). So rolling grains and
//! grains that slide on all sides, which make iterative solvers crawl, cost nothing extra.

mod front;
mod tree;

use crate::heap;
use front::Fronts;
use tree::Tree;

/// Freedoms of a grain: x, y and its turn times its radius.
pub const FREEDOMS: usize = 3;

/// A 3x3 block, row by row.
pub type Block = [[f64; FREEDOMS]; FREEDOMS];

/// The system and its factors. Lengths are in m, entries in N/m.
#[derive(Clone, Debug, Default)]
pub struct Matrix {
    /// Block of each grain, shape (n).
    pub diagonal: Vec<Block>,
    /// Block of each pair (i, j), row of the smaller number and column of the other, in the order of the
    /// list, and of each link.
    pub pairs: Vec<Block>,
    /// Places in the list of the pairs whose block is not empty, in order.
    pub filled: Vec<u32>,
    tree: Tree,
    fronts: Fronts,
    /// Factors of all fronts, column by column.
    factors: Vec<f64>,
    /// What the fronts leave to those above them, as a stack.
    stack: Vec<f64>,
    scratch: Vec<f64>,
    factorised: bool,
    /// How often it was factorised.
    pub factorisations: u64,
}

impl Matrix {
    /// Takes the pattern: which pairs there are, `start` and `second` in rows as in the neighbour list and
    /// after them `links`, of grains at `position` \[m\]. The entries of pairs that `couples` says no to
    /// are zero.
    pub fn arrange(
        &mut self,
        position: &[[f64; 2]],
        start: &[u32],
        second: &[u32],
        couples: impl Fn(usize) -> bool,
        links: &[(u32, u32)],
    ) {
        self.factorised = false;
        self.tree.build(position, start, second, couples, links);
        self.diagonal.resize(position.len(), [[0.0; FREEDOMS]; FREEDOMS]);
        self.pairs.clear();
        self.pairs.resize(second.len() + links.len(), [[0.0; FREEDOMS]; FREEDOMS]);
        self.filled.clear();
        self.fronts.lay_out(&self.tree);
    }

    /// Empties all entries.
    pub fn clear(&mut self) {
        self.diagonal.fill([[0.0; FREEDOMS]; FREEDOMS]);
        for k in self.filled.drain(..) {
            self.pairs[k as usize] = [[0.0; FREEDOMS]; FREEDOMS];
        }
    }

    /// Fills the block of pair `k`, behind those that are filled.
    #[inline]
    pub fn fill(&mut self, k: usize, block: Block) {
        self.filled.push(k as u32);
        self.pairs[k] = block;
    }

    /// Factorises, with `shift` \[N/m\] added to the diagonal. Says whether the matrix is positive
    /// definite; if not the factors are of no use.
    pub fn factorise(&mut self, shift: f64) -> bool {
        self.factorisations += 1;
        let Self { diagonal, pairs, tree, fronts, factors, stack, .. } = self;
        self.factorised = fronts.factorise(tree, (diagonal, pairs), shift, factors, stack);
        self.factorised
    }

    /// Whether the factors at hand are those of such a pattern.
    #[must_use]
    pub fn is_factorised(&self) -> bool {
        self.factorised
    }

    /// Solves in place for right sides of three numbers a grain.
    pub fn solve(&mut self, rights: &mut [Vec<f64>]) {
        let Self { tree, fronts, factors, scratch, .. } = self;
        fronts.solve(tree, factors, rights, scratch);
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.diagonal)
            + heap::bytes(&self.pairs)
            + heap::bytes(&self.filled)
            + self.fronts.heap_bytes()
            + heap::bytes(&self.factors)
            + heap::bytes(&self.stack)
            + heap::bytes(&self.scratch)
            + self.tree.heap_bytes()
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    use super::*;

    /// Points at random with pairs up to a distance, in rows.
    fn points(n: usize) -> (Vec<[f64; 2]>, Vec<u32>, Vec<u32>) {
        let mut rng = Pcg64::seed_from_u64(n as u64);
        let at: Vec<[f64; 2]> = (0..n).map(|_| [rng.random(), rng.random()]).collect();
        let reach = 2.2 / (n as f64).sqrt();
        let (mut start, mut second) = (vec![0], Vec::new());
        for i in 0..n {
            for j in i + 1..n {
                if (at[i][0] - at[j][0]).hypot(at[i][1] - at[j][1]) < reach {
                    second.push(j as u32);
                }
            }
            start.push(second.len() as u32);
        }
        (at, start, second)
    }

    #[test]
    fn solutions_are_those_of_a_dense_factorisation() {
        for n in [1, 2, 7, 40, 150] {
            let (at, start, second) = points(n);
            let mut rng = Pcg64::seed_from_u64(1);
            let mut matrix = Matrix::default();
            matrix.arrange(&at, &start, &second, |_| true, &[]);
            matrix.clear();
            let mut dense = DMatrix::<f64>::zeros(3 * n, 3 * n);
            for i in 0..n {
                for a in 0..3 {
                    matrix.diagonal[i][a][a] += 30.0;
                    dense[(3 * i + a, 3 * i + a)] += 30.0 + 0.5;
                }
                let row = start[i] as usize..start[i + 1] as usize;
                for (k, j) in row.clone().zip(&second[row]) {
                    let j = *j as usize;
                    let block: Block = rng.random();
                    matrix.fill(k, block);
                    for a in 0..3 {
                        for b in 0..3 {
                            let x = block[a][b];
                            dense[(3 * i + a, 3 * j + b)] = x;
                            dense[(3 * j + b, 3 * i + a)] = x;
                        }
                    }
                }
            }
            let right = DVector::from_fn(3 * n, |_, _| rng.random::<f64>());
            let want = dense.clone().cholesky().unwrap().solve(&right);
            assert!(matrix.factorise(0.5));
            let twice = (2.0 * &right).as_slice().to_vec();
            let mut got = [right.as_slice().to_vec(), twice];
            matrix.solve(&mut got);
            for k in 0..3 * n {
                assert!((got[0][k] - want[k]).abs() < 1e-13, "{n}: {} {}", got[0][k], want[k]);
                assert_eq!(got[1][k], 2.0 * got[0][k]);
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_told() {
        let (at, start, second) = points(40);
        let mut matrix = Matrix::default();
        matrix.arrange(&at, &start, &second, |_| true, &[]);
        matrix.clear();
        matrix.diagonal.iter_mut().for_each(|block| (0..3).for_each(|a| block[a][a] = 1.0));
        matrix.diagonal[17][1][1] = -1e-3;
        assert!(!matrix.factorise(0.0));
        assert!(matrix.factorise(2e-3));
    }
}

//! Flexible GMRES: solves A x = b with a preconditioner that need not be the same twice (Saad,
//! SIAM J. Sci. Comput. 14, 461, 1993). A need not be symmetric.

use crate::Vec3;

/// Directions kept before a restart.
const DIRECTIONS: usize = 24;
/// A product that points back along its direction by less than this share is rounding.
const ROUNDING: f64 = 1e-10;

/// What a solve came to.
pub(super) struct Solution {
    /// x.
    pub(super) x: Vec<Vec3>,
    /// b - A x.
    pub(super) left: Vec<Vec3>,
    /// Whether a direction p with p·A p < 0 was met.
    pub(super) concave: bool,
}

/// Solves `times`(x) = `right` until the residual fell by `reduction`, in at most `most` directions
/// or until `precondition` gives none any more.
pub(super) fn solve(
    times: impl Fn(&[Vec3]) -> Vec<Vec3>,
    mut precondition: impl FnMut(&[Vec3]) -> Option<Vec<Vec3>>,
    right: &[Vec3],
    reduction: f64,
    most: u32,
) -> Solution {
    let mut solution =
        Solution { x: vec![Vec3::zeros(); right.len()], left: right.to_vec(), concave: false };
    let target = reduction * norm(right);
    let mut spent = 0;
    let mut before = f64::INFINITY;
    loop {
        let size = norm(&solution.left);
        // Rounding leaves no less, or there is no number at all.
        let stalls = size > 0.5 * before || !size.is_finite();
        if size <= target || spent >= most || stalls {
            return solution;
        }
        before = size;
        let mut cycle = Cycle::new(scaled(&solution.left, 1.0 / size), size);
        while cycle.left > target && cycle.directions.len() < DIRECTIONS && spent < most {
            spent += 1;
            let Some(direction) = precondition(&cycle.basis[cycle.basis.len() - 1]) else { break };
            let product = times(&direction);
            let back = -dot(&direction, &product);
            solution.concave |= back > ROUNDING * norm(&direction) * norm(&product);
            if !cycle.take(direction, product) {
                break;
            }
        }
        for (direction, share) in cycle.directions.iter().zip(cycle.shares()) {
            add(&mut solution.x, direction, share);
        }
        let product = times(&solution.x);
        solution.left = right.iter().zip(&product).map(|(b, ax)| b - ax).collect();
    }
}

/// The directions since the last restart.
struct Cycle {
    /// Orthonormal, one more than there are directions.
    basis: Vec<Vec<Vec3>>,
    /// Preconditioned.
    directions: Vec<Vec<Vec3>>,
    /// The columns of the triangle that the rotations leave.
    columns: Vec<Vec<f64>>,
    rotations: Vec<(f64, f64)>,
    /// The rotated right-hand side.
    right: Vec<f64>,
    /// Size of the residual.
    left: f64,
}

impl Cycle {
    fn new(first: Vec<Vec3>, size: f64) -> Self {
        Self {
            basis: vec![first],
            directions: Vec::new(),
            columns: Vec::new(),
            rotations: Vec::new(),
            right: vec![size],
            left: size,
        }
    }

    /// Takes a direction and its product; says whether another can follow.
    fn take(&mut self, direction: Vec<Vec3>, mut product: Vec<Vec3>) -> bool {
        let size = norm(&product);
        if !(size > 0.0 && size.is_finite()) {
            return false;
        }
        let mut column = vec![0.0; self.basis.len()];
        // Twice is enough.
        for _ in 0..2 {
            for (share, basis) in column.iter_mut().zip(&self.basis) {
                let along = dot(basis, &product);
                *share += along;
                add(&mut product, basis, -along);
            }
        }
        let beyond = norm(&product);
        for (k, &(c, s)) in self.rotations.iter().enumerate() {
            let (a, b) = (column[k], column[k + 1]);
            (column[k], column[k + 1]) = (c * a + s * b, c * b - s * a);
        }
        let last = column.len() - 1;
        let length = column[last].hypot(beyond);
        if length == 0.0 {
            return false;
        }
        let (c, s) = (column[last] / length, beyond / length);
        column[last] = length;
        self.left = (s * self.right[last]).abs();
        self.right.push(-s * self.right[last]);
        self.right[last] *= c;
        self.rotations.push((c, s));
        self.columns.push(column);
        self.directions.push(direction);
        let more = beyond > f64::EPSILON * size;
        if more {
            self.basis.push(scaled(&product, 1.0 / beyond));
        }
        more
    }

    /// How much of each direction leaves the least residual.
    fn shares(&self) -> Vec<f64> {
        let mut shares = vec![0.0; self.columns.len()];
        for k in (0..shares.len()).rev() {
            let known: f64 = (k + 1..shares.len()).map(|l| self.columns[l][k] * shares[l]).sum();
            shares[k] = (self.right[k] - known) / self.columns[k][k];
        }
        shares
    }
}

pub(super) fn dot(one: &[Vec3], other: &[Vec3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.dot(b)).sum()
}

pub(super) fn norm(of: &[Vec3]) -> f64 {
    dot(of, of).sqrt()
}

fn add(to: &mut [Vec3], by: &[Vec3], share: f64) {
    for (to, by) in to.iter_mut().zip(by) {
        *to += by * share;
    }
}

fn scaled(of: &[Vec3], by: f64) -> Vec<Vec3> {
    of.iter().map(|v| v * by).collect()
}

//! Symmetric 6x6 blocks in single precision, for a grain's displacement u and its rotation times
//! radius w = ΩR.

use crate::relax::sym3::Sym3;

/// A block by its parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sym6 {
    /// What u does to the forces.
    pub(super) u: Sym3,
    /// What w does to the moments over radius.
    pub(super) w: Sym3,
    /// What w does to the forces, by rows.
    pub(super) uw: [[f32; 3]; 3],
}

impl Sym6 {
    /// self += other.
    pub(super) fn add(&mut self, other: &Self) {
        self.u.add(&other.u);
        self.w.add(&other.w);
        for (row, other) in self.uw.iter_mut().zip(&other.uw) {
            for (entry, other) in row.iter_mut().zip(other) {
                *entry += other;
            }
        }
    }

    /// self times (u, w).
    #[must_use]
    pub(super) fn times(&self, [u, w]: [[f32; 3]; 2]) -> [[f32; 3]; 2] {
        let own = |block: &Sym3, v: [f32; 3]| block.times(&[v[0], v[1], v[2], 0.0]);
        let (uu, ww) = (own(&self.u, u), own(&self.w, w));
        let row = |k: usize| (0..3).map(|c| self.uw[k][c] * w[c]).sum::<f32>();
        let column = |k: usize| (0..3).map(|r| self.uw[r][k] * u[r]).sum::<f32>();
        [[0, 1, 2].map(|k| uu[k] + row(k)), [0, 1, 2].map(|k| ww[k] + column(k))]
    }

    /// The inverse of this block with `shift` on its diagonal. Where a pivot is below `floor`
    /// times the mean diagonal of its part the diagonal is lifted first, so that the inverse is
    /// positive definite.
    #[must_use]
    pub(super) fn inverse(&self, shift: f32, floor: f32) -> Self {
        let (u, w) = (self.u.shifted(shift), self.w.shifted(shift));
        let least = |part: &Sym3| floor * (part.trace().abs() / 3.0).max(f32::MIN_POSITIVE);
        // By the Schur complement S = W - Bᵀ U⁻¹ B of U, with B = uw.
        let (_, inverse_u) = u.inverse_lifted(least(&u));
        let [x, y, z] = [0, 1, 2].map(|k| {
            let column = [self.uw[0][k], self.uw[1][k], self.uw[2][k], 0.0];
            inverse_u.times(&column)
        });
        let dot = |row: usize, v: &[f32; 4]| {
            self.uw[0][row] * v[0] + self.uw[1][row] * v[1] + self.uw[2][row] * v[2]
        };
        let complement = w.minus(&Sym3::new([
            dot(0, &x),
            dot(1, &y),
            dot(2, &z),
            dot(0, &y),
            dot(0, &z),
            dot(1, &z),
        ]));
        let (_, inverse_w) = complement.inverse_lifted(least(&w));
        // Below the diagonal -S⁻¹ (U⁻¹B)ᵀ; in the corner U⁻¹ + (U⁻¹B) S⁻¹ (U⁻¹B)ᵀ.
        let uw: [[f32; 3]; 3] = [0, 1, 2].map(|row| {
            let of_row = inverse_w.times(&[x[row], y[row], z[row], 0.0]);
            [-of_row[0], -of_row[1], -of_row[2]]
        });
        let corner = |i: usize, k: usize| -(uw[i][0] * x[k] + uw[i][1] * y[k] + uw[i][2] * z[k]);
        let u = inverse_u.minus(&Sym3::new([
            -corner(0, 0),
            -corner(1, 1),
            -corner(2, 2),
            -corner(0, 1),
            -corner(0, 2),
            -corner(1, 2),
        ]));
        Self { u, w: inverse_w, uw }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block() -> Sym6 {
        Sym6 {
            u: Sym3::new([4.0, 3.0, 5.0, 0.5, -0.25, 0.75]),
            w: Sym3::new([2.0, 3.5, 2.5, -0.5, 0.25, 0.5]),
            uw: [[0.3, -0.6, 0.2], [0.9, 0.1, -0.4], [-0.2, 0.5, 0.7]],
        }
    }

    fn times(block: &Sym6, x: &[f32; 6]) -> [f32; 6] {
        let (u, w) = (block.u.columns(), block.w.columns());
        std::array::from_fn(|row| {
            (0..6)
                .map(|column| {
                    let entry = match (row / 3, column / 3) {
                        (0, 0) => u[column][row],
                        (0, _) => block.uw[row][column - 3],
                        (_, 0) => block.uw[column][row - 3],
                        _ => w[column - 3][row - 3],
                    };
                    entry * x[column]
                })
                .sum()
        })
    }

    #[test]
    fn the_inverse_undoes_the_product() {
        let x = [1.0, -2.0, 0.5, 3.0, 0.25, -1.5];
        let mut y = times(&block(), &x);
        for (y, x) in y.iter_mut().zip(x) {
            *y += 0.125 * x;
        }
        let back = times(&block().inverse(0.125, 0.02), &y);
        for (back, x) in back.iter().zip(x) {
            assert!((back - x).abs() < 1e-5, "{back} {x}");
        }
    }

    #[test]
    fn an_indefinite_block_gets_a_positive_inverse() {
        let mut indefinite = block();
        indefinite.u = indefinite.u.shifted(-4.0);
        let inverse = indefinite.inverse(0.0, 0.02);
        for k in 0..64u32 {
            let x: [f32; 6] = std::array::from_fn(|i| {
                ((k * 6 + i as u32).wrapping_mul(2_654_435_761) >> 16) as f32 / 32768.0 - 1.0
            });
            let energy: f32 = times(&inverse, &x).iter().zip(x).map(|(y, x)| y * x).sum();
            assert!(energy > 0.0, "{energy}");
        }
    }
}

//! Symmetric 6x6 blocks in single precision, for a grain's displacement u and its rotation times
//! radius w = ΩR: rows and columns 0..3 are u, 4..7 are w, 3 and 7 are padding.

/// Displacement and rotation times radius, padded.
pub(super) type V6 = [f32; 8];

/// The places of the six unknowns in a padded row.
const PLACES: [usize; 6] = [0, 1, 2, 4, 5, 6];

/// Columns of a block in the order of [`PLACES`], each padded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sym6([V6; 6]);

impl Sym6 {
    /// A diagonal block.
    #[must_use]
    pub(super) fn diagonal(d: [f32; 6]) -> Self {
        let mut block = Self::default();
        for (k, place) in PLACES.into_iter().enumerate() {
            block.0[k][place] = d[k];
        }
        block
    }

    /// self += scale v vᵀ.
    #[inline(always)]
    pub(super) fn add_outer(&mut self, scale: f32, v: &V6) {
        for (k, place) in PLACES.into_iter().enumerate() {
            let factor = scale * v[place];
            for row in 0..8 {
                self.0[k][row] += factor * v[row];
            }
        }
    }

    /// self += other.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        for (column, other) in self.0.iter_mut().zip(&other.0) {
            for row in 0..8 {
                column[row] += other[row];
            }
        }
    }

    /// self v.
    #[must_use]
    #[inline(always)]
    pub(super) fn times(&self, v: &V6) -> V6 {
        let mut product = [0.0; 8];
        for (column, place) in self.0.iter().zip(PLACES) {
            for row in 0..8 {
                product[row] += column[row] * v[place];
            }
        }
        product
    }

    /// Traces of the blocks of u and of w.
    #[must_use]
    pub(super) fn traces(&self) -> [f32; 2] {
        let d = |k: usize| self.0[k][PLACES[k]];
        [d(0) + d(1) + d(2), d(3) + d(4) + d(5)]
    }

    /// The inverse of this block with `shift` added to its diagonal. Pivots of its Cholesky
    /// factor below `floor` times the mean diagonal of u or of w are lifted to it, so that the
    /// inverse is positive definite.
    #[must_use]
    pub(super) fn inverse(&self, shift: f32, floor: f32) -> Self {
        let [u, w] = self.traces();
        let least = [u, w].map(|trace| (floor * (trace / 3.0 + shift)).max(f32::MIN_POSITIVE));
        let mut l = [[0.0f32; 6]; 6];
        let mut reciprocal = [0.0f32; 6];
        for k in 0..6 {
            let mut pivot = self.0[k][PLACES[k]] + shift;
            for m in 0..k {
                pivot -= l[k][m] * l[k][m];
            }
            let pivot = pivot.max(least[k / 3]).sqrt();
            l[k][k] = pivot;
            reciprocal[k] = 1.0 / pivot;
            for row in k + 1..6 {
                let mut entry = self.0[k][PLACES[row]];
                for m in 0..k {
                    entry -= l[row][m] * l[k][m];
                }
                l[row][k] = entry * reciprocal[k];
            }
        }
        // L⁻¹ by columns, then (L Lᵀ)⁻¹ = L⁻ᵀ L⁻¹.
        let mut inverse = [[0.0f32; 6]; 6];
        for column in 0..6 {
            inverse[column][column] = reciprocal[column];
            for row in column + 1..6 {
                let mut entry = 0.0;
                for m in column..row {
                    entry -= l[row][m] * inverse[m][column];
                }
                inverse[row][column] = entry * reciprocal[row];
            }
        }
        let mut block = Self::default();
        for (i, place) in PLACES.into_iter().enumerate() {
            for k in 0..6 {
                let from = i.max(k);
                block.0[k][place] = (from..6).map(|m| inverse[m][i] * inverse[m][k]).sum();
            }
        }
        block
    }
}

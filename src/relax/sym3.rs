//! Symmetric 3x3 blocks in single precision.

/// xx, yy, zz, xy, xz, yz.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sym3([f32; 6]);

impl Sym3 {
    /// A block by its entries xx, yy, zz, xy, xz, yz.
    #[must_use]
    #[inline(always)]
    pub(super) fn new(entries: [f32; 6]) -> Self {
        Self(entries)
    }

    /// The columns of the block.
    #[must_use]
    pub(super) fn columns(&self) -> [[f32; 3]; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }

    /// self - other.
    #[must_use]
    pub(super) fn minus(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - other.0[k]))
    }

    /// A diagonal block.
    #[must_use]
    pub(super) fn diagonal(d: [f32; 3]) -> Self {
        Self([d[0], d[1], d[2], 0.0, 0.0, 0.0])
    }

    /// m mᵀ - b I.
    #[must_use]
    #[inline(always)]
    pub(super) fn outer_minus(m: [f32; 3], b: f32) -> Self {
        Self([
            m[0] * m[0] - b,
            m[1] * m[1] - b,
            m[2] * m[2] - b,
            m[0] * m[1],
            m[0] * m[2],
            m[1] * m[2],
        ])
    }

    /// Trace.
    #[must_use]
    pub(super) fn trace(&self) -> f32 {
        self.0[0] + self.0[1] + self.0[2]
    }

    /// self + s I.
    #[must_use]
    pub(super) fn shifted(&self, s: f32) -> Self {
        let a = &self.0;
        Self([a[0] + s, a[1] + s, a[2] + s, a[3], a[4], a[5]])
    }

    /// self += other.
    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        for k in 0..6 {
            self.0[k] += other.0[k];
        }
    }

    /// self v.
    #[must_use]
    #[inline(always)]
    pub(super) fn times(&self, v: &[f32; 4]) -> [f32; 4] {
        let a = &self.0;
        [
            a[0] * v[0] + a[3] * v[1] + a[4] * v[2],
            a[3] * v[0] + a[1] * v[1] + a[5] * v[2],
            a[4] * v[0] + a[5] * v[1] + a[2] * v[2],
            0.0,
        ]
    }

    /// This block and its inverse; when a pivot of L D Lᵀ is below `floor` the diagonal is lifted
    /// first, so that the block is positive definite.
    #[must_use]
    pub(super) fn inverse_lifted(&self, floor: f32) -> (Self, Self) {
        let mut lifted = *self;
        let mut lift = floor;
        loop {
            if let Some(inverse) = lifted.inverse_above(floor) {
                return (lifted, inverse);
            }
            lifted = self.shifted(lift);
            lift *= 2.0;
            if !lift.is_finite() {
                return (Self::diagonal([1.0; 3]), Self::diagonal([1.0; 3]));
            }
        }
    }

    /// The inverse when all pivots of L D Lᵀ are at least `floor`.
    fn inverse_above(&self, floor: f32) -> Option<Self> {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        let pivot1 = yy - xy * xy / xx;
        let cross = yz - xy * xz / xx;
        let pivot2 = zz - xz * xz / xx - cross * cross / pivot1;
        if !(xx >= floor && pivot1 >= floor && pivot2 >= floor) {
            return None;
        }
        let minor = [yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy];
        let determinant = xx * minor[0] + xy * minor[1] + xz * minor[2];
        let s = 1.0 / determinant;
        (s > 0.0 && s.is_finite()).then(|| {
            Self([
                minor[0] * s,
                (xx * zz - xz * xz) * s,
                (xx * yy - xy * xy) * s,
                minor[1] * s,
                minor[2] * s,
                (xy * xz - xx * yz) * s,
            ])
        })
    }
}

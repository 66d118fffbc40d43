//! Double sliding (A.30-A.38): a block that fails along two families of planes.

use super::strength::MohrCoulomb;
use super::tensor::Tensor;

/// Small shears along both families, as seen along the axes of σ1 and σ3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slides {
    /// Shear strain a >= 0 along the left planes.
    pub left: f64,
    /// Shear strain b >= 0 along the right planes.
    pub right: f64,
    /// Angle θ \[rad\] between the planes and the axis of σ3 (A.36).
    pub plane: f64,
}

impl Slides {
    /// Slides along the planes on which a material fails.
    #[must_use]
    pub fn of(strength: &MohrCoulomb, left: f64, right: f64) -> Self {
        Self { left, right, plane: strength.plane() }
    }

    /// The strain (A.35): xx along σ3 and yy along σ1.
    #[must_use]
    pub fn strain(&self) -> Tensor {
        let (s, c) = self.plane.sin_cos();
        let (both, odd) = (self.left + self.right, self.left - self.right);
        Tensor { xx: -both * s * c, yy: both * s * c, xy: 0.5 * odd * (c * c - s * s) }
    }

    /// Rotations \[rad\] of a line along σ1 and of one along σ3 (A.33, A.34), counter-clockwise with
    /// σ3 along x and σ1 along y.
    #[must_use]
    pub fn rotations(&self) -> [f64; 2] {
        let (s, c) = self.plane.sin_cos();
        let odd = self.left - self.right;
        let axial = (odd * c * c).atan2(1.0 - odd * s * c);
        let lateral = (odd * s * s).atan2(1.0 + odd * s * c);
        [axial, lateral]
    }

    /// i \[rad\], by which the major strain is turned from σ1, clockwise with σ1 along y (A.37): at
    /// most φ'/2 either way (A.38). Nothing when nothing slides.
    #[must_use]
    pub fn non_coaxiality(&self) -> Option<f64> {
        let strain = self.strain();
        let turned = 0.5 * (2.0 * strain.xy).atan2(strain.yy - strain.xx);
        (self.left + self.right > 0.0).then_some(turned)
    }
}

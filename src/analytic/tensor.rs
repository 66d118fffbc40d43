//! Stresses and strains in the plane, their principal values and Mohr circles (A.10, A.11).

/// A symmetric tensor in the plane, stress \[Pa\] or strain, compression positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tensor {
    /// Across the planes x = const.
    pub xx: f64,
    /// Across the planes y = const.
    pub yy: f64,
    /// The tensor's own shear: of a strain half of γ.
    pub xy: f64,
}

impl Tensor {
    /// The tensor with these principal values, the `major` one at the angle β = `direction` \[rad\]
    /// to the x-axis (A.10, where α = π/2 - β).
    #[must_use]
    pub fn of_principal(major: f64, minor: f64, direction: f64) -> Self {
        let (mean, radius) = (0.5 * (major + minor), 0.5 * (major - minor));
        let (sine, cosine) = (2.0 * direction).sin_cos();
        Self { xx: mean + radius * cosine, yy: mean - radius * cosine, xy: radius * sine }
    }

    /// Centre of the Mohr circle, half of the trace.
    #[must_use]
    pub fn mean(&self) -> f64 {
        0.5 * (self.xx + self.yy)
    }

    /// Radius of the Mohr circle, the largest shear.
    #[must_use]
    pub fn radius(&self) -> f64 {
        (0.5 * (self.xx - self.yy)).hypot(self.xy)
    }

    /// The greater principal value.
    #[must_use]
    pub fn major(&self) -> f64 {
        self.mean() + self.radius()
    }

    /// The lesser principal value.
    #[must_use]
    pub fn minor(&self) -> f64 {
        self.mean() - self.radius()
    }

    /// β \[rad\], from -π/2 to π/2 (A.11); nothing when all directions are alike.
    #[must_use]
    pub fn direction(&self) -> Option<f64> {
        let double = (2.0 * self.xy).atan2(self.xx - self.yy);
        (self.radius() > 0.0).then_some(0.5 * double)
    }

    /// The vector that the tensor makes of the unit vector at `angle` \[rad\] to the x-axis: of a
    /// stress the traction on the plane with that normal.
    #[must_use]
    pub fn along(&self, angle: f64) -> [f64; 2] {
        let (sine, cosine) = angle.sin_cos();
        [self.xx * cosine + self.xy * sine, self.xy * cosine + self.yy * sine]
    }

    /// What is added from `before` to this tensor.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        Self { xx: self.xx - before.xx, yy: self.yy - before.yy, xy: self.xy - before.xy }
    }
}

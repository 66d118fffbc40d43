//! The box of discs and its strains, and the stresses that do work on them.
//!
//! A box of the width W and the height H that leans by γ goes, per unit of strain, by
//!
//! ```text
//! εxx: Ẇ = -W, γ̇ = -γ    εyy: Ḣ = -H, γ̇ = γ    γxy = 2 εxy: γ̇ = -1
//! ```
//!
//! compression positive. With the motions b_m of the boundary that are these, V σ_m = b_m·F are the
//! stresses that do work on them, and
//!
//! ```text
//! V dσ_l/dε_m = b_l·S b_m + (∂b_l/∂ε_m)·F - σ_l ∂V/∂ε_m
//! ```

use nalgebra::{Matrix3, SMatrix, SVector};

use super::{MOTIONS, STRAINS};
use crate::model::Model;
use crate::plane::Vec2;
use crate::plane::boundary::SIDES;
use crate::state::State;

/// A box as it leans.
pub(super) struct Leaning {
    width: f64,
    height: f64,
    depth: f64,
    tilt: f64,
    /// Its middle where it would not lean \[m\].
    middle: Vec2,
    /// Height of what the tilt does not move \[m\].
    hinge: f64,
}

/// How a box goes per unit of a strain.
struct Rate {
    width: f64,
    height: f64,
    tilt: f64,
}

impl Leaning {
    pub(super) fn new(model: &Model, state: &State) -> Self {
        let bounds = state.bounds(model);
        let ([width, height, depth], [x, y, _]) = (bounds.sides(), bounds.center());
        let [_, hinge, _] = model.start.center();
        Self { width, height, depth, tilt: state.tilt, middle: Vec2::new(x, y), hinge }
    }

    pub(super) fn volume(&self) -> f64 {
        self.width * self.height * self.depth
    }

    pub(super) fn height(&self) -> f64 {
        self.height
    }

    fn rate(&self, m: usize) -> Rate {
        let Self { width, height, tilt, .. } = *self;
        match m {
            0 => Rate { width: -width, height: 0.0, tilt: -tilt },
            1 => Rate { width: 0.0, height: -height, tilt },
            _ => Rate { width: 0.0, height: 0.0, tilt: -1.0 },
        }
    }

    /// b_m.
    pub(super) fn motion(&self, m: usize) -> SVector<f64, MOTIONS> {
        let Rate { width, height, tilt } = self.rate(m);
        SVector::from([-0.5 * width, -0.5 * width, -0.5 * height, -0.5 * height, tilt])
    }

    /// Where the strain m takes what is at `at` \[m\], and how far it turns it: the grains as they are
    /// under xx and yy, and with the box under γ.
    pub(super) fn carry(&self, m: usize, at: Vec2) -> (Vec2, f64) {
        match m {
            0 => (Vec2::new(self.middle.x - at.x, 0.0), 0.0),
            1 => {
                let along = self.tilt * (self.middle.y - self.hinge);
                (Vec2::new(along, self.middle.y - at.y), 0.0)
            }
            _ => (Vec2::new(self.hinge - at.y, 0.0), 0.5),
        }
    }

    /// b_l·S b_m/V \[Pa\].
    pub(super) fn over_strains(&self, stiff: &SMatrix<f64, MOTIONS, MOTIONS>) -> Matrix3<f64> {
        let motion =
            SMatrix::<f64, MOTIONS, STRAINS>::from_columns(&[0, 1, 2].map(|m| self.motion(m)));
        motion.transpose() * stiff * motion / self.volume()
    }

    /// What areas and directions that go along make of the stresses \[Pa\], for the forces F = `force` of
    /// the boundary.
    pub(super) fn turning(&self, force: &SVector<f64, MOTIONS>) -> Matrix3<f64> {
        Matrix3::from_fn(|l, m| {
            let Rate { width, height, tilt } = self.rate(m);
            let longer = match l {
                0 => 0.5 * width * (force[0] + force[1]) - tilt * force[SIDES],
                1 => 0.5 * height * (force[2] + force[3]) + tilt * force[SIDES],
                _ => 0.0,
            };
            let shrinks = if m == 2 { 0.0 } else { self.motion(l).dot(force) };
            (longer + shrinks) / self.volume()
        })
    }
}

/// `of` without what smooth sides do not tell.
pub(super) fn without_shear(of: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|l, m| if l < 2 && m < 2 { of[(l, m)] } else { f64::NAN })
}

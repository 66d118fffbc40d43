//! Relaxation to equilibrium.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// What [`Solver::tolerance`] may be.
pub const TOLERANCE: RangeInclusive<f64> = 1e-13..=1e-2;

/// Largest [`Solver::max_strain_increment`]; it must be above 0.
pub const MAX_STRAIN_INCREMENT: f64 = 0.1;

/// Relaxation to equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Method.
    pub method: Method,
    /// Largest unbalanced force of a grain over the mean contact force, 1e-13 to 1e-2.
    pub tolerance: f64,
    /// Largest strain between two equilibria, above 0 and at most 0.1; larger commands are
    /// sub-stepped.
    pub max_strain_increment: f64,
    /// Largest strain between two equilibria, as a share of the mean overlap strain h/(2R), above 0
    /// and at most 100.
    pub max_overlap_share: f64,
    /// Steps of the method before an increment is given up, 1 to 10 million; without it as many as
    /// [`Method::max_iterations`] says.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_iterations: Option<u32>,
    /// Sweeps of `gauss_seidel` over discs with which an increment ends, whatever is out of balance then,
    /// 1 to 10 million (B table 1, n_i). The walls do not take the grains along before the first one.
    /// Without it an increment ends with an equilibrium.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sweeps: Option<u32>,
    /// Longest step of a grain over its radius, 1e-4 to 0.5; for all methods but Newton's, which
    /// measures its steps in overlaps.
    pub step_cap: f64,
    /// Share of the unbalanced force that damps the motion of `dynamic`, above 0 and below 1.
    pub damping: f64,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            method: Method::Newton,
            tolerance: 1.0e-8,
            max_strain_increment: 1.0e-4,
            max_overlap_share: 0.05,
            max_iterations: None,
            sweeps: None,
            step_cap: 1.0e-2,
            damping: 0.7,
        }
    }
}

impl Solver {
    /// Steps before an increment is given up.
    #[must_use]
    pub fn most_iterations(&self) -> u32 {
        self.max_iterations.unwrap_or_else(|| self.method.max_iterations())
    }

    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.number(
            at.key("tolerance"),
            self.tolerance,
            "1e-13 <= tolerance <= 1e-2",
            |tolerance| TOLERANCE.contains(&tolerance),
        );
        problems.number(
            at.key("max_strain_increment"),
            self.max_strain_increment,
            "0 < max_strain_increment <= 0.1",
            |strain| 0.0 < strain && strain <= MAX_STRAIN_INCREMENT,
        );
        problems.number(
            at.key("max_overlap_share"),
            self.max_overlap_share,
            "0 < max_overlap_share <= 100",
            |share| 0.0 < share && share <= 100.0,
        );
        if let Some(iterations) = self.max_iterations {
            problems.count(at.key("max_iterations"), u64::from(iterations), 1, 10_000_000);
        }
        if let Some(sweeps) = self.sweeps {
            problems.count(at.key("sweeps"), u64::from(sweeps), 1, 10_000_000);
        }
        problems.number(at.key("step_cap"), self.step_cap, "1e-4 <= step_cap <= 0.5", |cap| {
            (1e-4..=0.5).contains(&cap)
        });
        problems.number(at.key("damping"), self.damping, "0 < damping < 1", |damping| {
            0.0 < damping && damping < 1.0
        });
    }
}

/// Relaxation method. All seek the same equilibrium to the same residual.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Newton steps, each solved by preconditioned conjugate gradients.
    Newton,
    /// The conjugate gradients of the thesis on the energy itself (T appendix A); a step is one
    /// search along a line.
    ConjugateGradient,
    /// Grain by grain to its own equilibrium (B 2.3); a step is a sweep over all grains.
    GaussSeidel,
    /// Equations of motion with local damping (B 2.2, 13-14); a step is one of time.
    Dynamic,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 4] =
        [Self::Newton, Self::ConjugateGradient, Self::GaussSeidel, Self::Dynamic];

    /// Whether it relaxes packs of this dimension: spheres by all, discs by all but conjugate gradients.
    #[must_use]
    pub const fn relaxes(self, dimension: u8) -> bool {
        dimension != 2 || !matches!(self, Self::ConjugateGradient)
    }

    /// The name that scenes know it by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Newton => "newton",
            Self::ConjugateGradient => "conjugate_gradient",
            Self::GaussSeidel => "gauss_seidel",
            Self::Dynamic => "dynamic",
        }
    }

    /// Steps before an increment is given up, where the scene does not say.
    #[must_use]
    pub fn max_iterations(self) -> u32 {
        match self {
            Self::Newton => 500,
            Self::ConjugateGradient | Self::Dynamic => 100_000,
            Self::GaussSeidel => 1_000_000,
        }
    }
}

//! Relaxation to equilibrium.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

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
    /// Newton steps before an increment is given up, at least 1.
    pub max_iterations: u32,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            method: Method::Newton,
            tolerance: 1.0e-8,
            max_strain_increment: 1.0e-4,
            max_overlap_share: 0.05,
            max_iterations: 500,
        }
    }
}

impl Solver {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.number(
            at.key("tolerance"),
            self.tolerance,
            "1e-13 <= tolerance <= 1e-2",
            |tolerance| (1e-13..=1e-2).contains(&tolerance),
        );
        problems.number(
            at.key("max_strain_increment"),
            self.max_strain_increment,
            "0 < max_strain_increment <= 0.1",
            |strain| 0.0 < strain && strain <= 0.1,
        );
        problems.number(
            at.key("max_overlap_share"),
            self.max_overlap_share,
            "0 < max_overlap_share <= 100",
            |share| 0.0 < share && share <= 100.0,
        );
        problems.count(at.key("max_iterations"), u64::from(self.max_iterations), 1, 1_000_000);
    }
}

/// Relaxation method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Newton steps, each solved by preconditioned conjugate gradients.
    Newton,
}

impl Method {
    /// Every method.
    pub const ALL: [Self; 1] = [Self::Newton];

    /// The name that scenes know it by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Newton => "newton",
        }
    }
}

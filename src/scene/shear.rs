//! The step of a load path that tilts a box of discs.

use serde::{Deserialize, Serialize};

use super::Targets;
use super::check::{Field, Problems};

/// See [`Step::Shear`](super::Step::Shear).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShearStep {
    /// What the step adds to the shear γ of the box, between -1 and 1.
    pub tilt: f64,
    /// What each wall does at the step's end; one that is not named does what it did.
    #[serde(default, skip_serializing_if = "Targets::is_empty")]
    pub targets: Targets,
    /// Equal parts, at least 1.
    pub increments: u32,
}

impl ShearStep {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let inside = |tilt: f64| tilt.abs() < 1.0;
        problems.number(at.key("tilt"), self.tilt, "-1 < tilt < 1", inside);
        self.targets.check(&at.key("targets"), true, problems);
    }
}

//! How far, how fast and how hard commands may move the walls.

use serde::{Deserialize, Serialize};

use crate::scene::check::{Field, Problems};

/// Limits of what commands may ask; 0 is no limit.
///
/// What lies beyond a limit already may come back, but not go further.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Limits {
    /// Displacement of a wall since the start, either way \[m\].
    pub travel: f64,
    /// Change of a wall's target over the time between the stamps of the last accepted command and
    /// of this one \[m/s\].
    pub rate: f64,
    /// Engineering strain of an axis against the box at the start, either way.
    pub strain: f64,
    /// Normal force on a wall \[N\].
    pub force: f64,
    /// What goes beyond a limit goes up to it instead of being refused.
    pub clamp: bool,
}

impl Limits {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let mut limit = |key: &str, value: f64, unit: &str| {
            let allowed = format!("{key} >= 0{unit}, 0 = no limit");
            problems.number(at.key(key), value, &allowed, |value| value >= 0.0);
        };
        limit("travel", self.travel, " m");
        limit("rate", self.rate, " m/s");
        limit("strain", self.strain, "");
        limit("force", self.force, " N");
    }
}

/// What makes the twin hold until its faults are reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Fault {
    /// A command that found no equilibrium.
    NotConverged,
    /// A command that was refused at a limit.
    Limit,
}

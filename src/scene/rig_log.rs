//! A rig's measured strain history as a load path.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Axis;
use super::check::{Field, Problems};

/// See [`Step::RigLog`](super::Step::RigLog).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigLog {
    /// CSV file, relative to the scene file.
    pub file: PathBuf,
    /// Column with the time \[s\].
    pub time: String,
    /// Column with the axial strain (compression positive).
    pub axial_strain: String,
    /// Unit of the axial strain.
    #[serde(default)]
    pub unit: StrainUnit,
    /// What the other two axes do.
    #[serde(default)]
    pub lateral: Lateral,
    /// Axis of the axial strain.
    #[serde(default)]
    pub axis: Axis,
}

impl RigLog {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        if self.time == self.axial_strain {
            problems.add(
                at.key("axial_strain"),
                format!("`{}` is the column of the time as well; allowed: another", self.time),
            );
        }
    }
}

/// Unit of a strain column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrainUnit {
    /// A plain ratio.
    #[default]
    Ratio,
    /// Per cent.
    Percent,
    /// Millionths.
    Microstrain,
}

/// What the lateral walls do while the axial ones follow a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lateral {
    /// They keep the volume: undrained.
    #[default]
    ConstantVolume,
    /// They stay.
    Fixed,
    /// They carry the stress that they have when the log begins: drained.
    Free,
}

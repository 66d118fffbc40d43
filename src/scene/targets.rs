//! Targets of the walls by name.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use crate::wall::{self, WallTarget};

/// A target of each wall; those without one do what they did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Targets {
    #[serde(skip_serializing_if = "Option::is_none")]
    x_min: Option<WallTarget>,
    #[serde(skip_serializing_if = "Option::is_none")]
    x_max: Option<WallTarget>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y_min: Option<WallTarget>,
    #[serde(skip_serializing_if = "Option::is_none")]
    y_max: Option<WallTarget>,
    #[serde(skip_serializing_if = "Option::is_none")]
    z_min: Option<WallTarget>,
    #[serde(skip_serializing_if = "Option::is_none")]
    z_max: Option<WallTarget>,
}

impl From<[WallTarget; wall::COUNT]> for Targets {
    fn from(targets: [WallTarget; wall::COUNT]) -> Self {
        let [x_min, x_max, y_min, y_max, z_min, z_max] =
            targets.map(|target| (target != WallTarget::Keep).then_some(target));
        Self { x_min, x_max, y_min, y_max, z_min, z_max }
    }
}

impl Targets {
    /// In the order of the walls.
    #[must_use]
    pub fn in_order(&self) -> [WallTarget; wall::COUNT] {
        self.all().map(|target| target.unwrap_or(WallTarget::Keep))
    }

    /// Whether no wall has one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all().iter().all(Option::is_none)
    }

    fn all(&self) -> [Option<WallTarget>; wall::COUNT] {
        [self.x_min, self.x_max, self.y_min, self.y_max, self.z_min, self.z_max]
    }

    /// The two walls of a pair carry the same load where they are `paired`, those across z always.
    pub(super) fn check(&self, at: &Field, paired: bool, problems: &mut Problems) {
        let targets = self.in_order();
        for (name, target) in wall::NAMES.iter().zip(targets) {
            let at = at.key(name);
            match target {
                WallTarget::Force(force) => problems.positive(at, force, "force > 0 N"),
                WallTarget::Stress(stress) => problems.positive(at, stress, "stress > 0 Pa"),
                WallTarget::Displacement(displacement) => {
                    problems.number(at, displacement, "a finite number of m", |_| true);
                }
                WallTarget::Keep | WallTarget::Unknown(..) => {}
            }
        }
        for pair in 0..3 {
            let (low, high) = (targets[2 * pair], targets[2 * pair + 1]);
            let load = |target| matches!(target, WallTarget::Force(_) | WallTarget::Stress(_));
            if (paired || pair == 2) && load(low) && load(high) && low != high {
                let name = wall::NAMES[2 * pair + 1];
                problems.add(
                    at.key(name),
                    format!(
                        "another load than {}; allowed: the same one, or a wall that stands",
                        wall::NAMES[2 * pair]
                    ),
                );
            }
        }
    }
}

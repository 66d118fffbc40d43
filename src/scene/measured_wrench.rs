//! The real rig's load cells, which the twin is compared with.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use crate::measure::discrepancy::Cells;
use crate::wall;

/// The load cells: `~/measured_wrench/<wall>`. Their forces are in axes as the pack's, and of each
/// the part along the wall's normal counts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MeasuredWrench {
    /// Walls with a load cell, by name; without any, nothing is compared.
    #[serde(with = "wall_names")]
    pub walls: [bool; wall::COUNT],
    /// 1 when a cell shows the force of the pack on the wall, as the twin's own wrenches do; -1
    /// when it shows that of the wall on the pack.
    pub sign: f64,
    /// Longest time between a command and the measurement that it is compared with \[s\]; 0 = any.
    pub max_delay: f64,
}

impl Default for MeasuredWrench {
    fn default() -> Self {
        Self { walls: [false; wall::COUNT], sign: 1.0, max_delay: 0.0 }
    }
}

impl MeasuredWrench {
    /// The cells, when there is one.
    #[must_use]
    pub fn cells(&self) -> Option<Cells> {
        let Self { walls, sign, max_delay } = *self;
        walls.contains(&true).then_some(Cells { walls, sign, max_delay })
    }

    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.number(at.key("sign"), self.sign, "1 and -1", |sign| sign.abs() == 1.0);
        problems.number(at.key("max_delay"), self.max_delay, "max_delay >= 0 s", |seconds| {
            seconds >= 0.0
        });
    }
}

/// `[x_min, z_max]`.
mod wall_names {
    use std::fmt;

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::{Deserializer, Serializer};

    use crate::wall::{COUNT, NAMES};

    pub(super) fn serialize<S: Serializer>(
        walls: &[bool; COUNT],
        to: S,
    ) -> Result<S::Ok, S::Error> {
        to.collect_seq(NAMES.iter().zip(walls).filter(|(_, on)| **on).map(|(name, _)| name))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<[bool; COUNT], D::Error> {
        from.deserialize_seq(Names)
    }

    struct Names;

    impl<'de> Visitor<'de> for Names {
        type Value = [bool; COUNT];

        fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
            to.write_str("a list of walls, as in `[z_min, z_max]`")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Self::Value, A::Error> {
            let mut walls = [false; COUNT];
            while let Some(name) = list.next_element::<String>()? {
                let Some(wall) = NAMES.iter().position(|known| *known == name) else {
                    let allowed = NAMES.join(", ");
                    return Err(A::Error::custom(format!(
                        "`{name}` is no wall; allowed: {allowed}"
                    )));
                };
                if std::mem::replace(&mut walls[wall], true) {
                    return Err(A::Error::custom(format!(
                        "{name} stands here twice; allowed: each wall once"
                    )));
                }
            }
            Ok(walls)
        }
    }
}

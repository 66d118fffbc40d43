//! What a wall shall do: stand somewhere, or carry a load.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::COUNT;

/// What is asked of one wall; the numbers are those of `graintwin_msgs/WallTargets`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WallTarget {
    /// What it does already: a wall under a load keeps it, another one stays.
    #[serde(skip)]
    Keep,
    /// Inward displacement \[m\].
    Displacement(f64),
    /// Normal force \[N\], above 0.
    Force(f64),
    /// Normal force over the wall's present area \[Pa\], above 0.
    Stress(f64),
    /// A number without a meaning, and its value: such a command is refused.
    #[serde(skip)]
    Unknown(u8, f64),
}

impl WallTarget {
    /// From the number of its kind and its value.
    #[must_use]
    pub fn from_numbers(control: u8, value: f64) -> Self {
        match control {
            0 => Self::Keep,
            1 => Self::Displacement(value),
            2 => Self::Force(value),
            3 => Self::Stress(value),
            other => Self::Unknown(other, value),
        }
    }

    /// The number of its kind and its value, 0 where there is none.
    #[must_use]
    pub fn numbers(self) -> (u8, f64) {
        match self {
            Self::Keep => (0, 0.0),
            Self::Displacement(value) => (1, value),
            Self::Force(value) => (2, value),
            Self::Stress(value) => (3, value),
            Self::Unknown(number, value) => (number, value),
        }
    }
}

/// The load of a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Normal force \[N\].
    Force(f64),
    /// Normal force over the wall's present area \[Pa\].
    Stress(f64),
}

impl Load {
    /// Normal force \[N\] on a wall of `area` \[m²\].
    #[must_use]
    pub fn force(self, area: f64) -> f64 {
        match self {
            Self::Force(force) => force,
            Self::Stress(stress) => stress * area,
        }
    }
}

impl fmt::Display for Load {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Force(force) => write!(to, "{force:e} N"),
            Self::Stress(stress) => write!(to, "{stress:e} Pa"),
        }
    }
}

/// What a wall does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Control {
    /// It stands at this inward displacement since the start \[m\].
    Displacement(f64),
    /// It carries this load, wherever that takes it.
    Load(Load),
}

impl Control {
    /// The load, if there is one.
    #[must_use]
    pub fn load(self) -> Option<Load> {
        match self {
            Self::Displacement(_) => None,
            Self::Load(load) => Some(load),
        }
    }
}

/// What the six walls do. Two walls of a pair that carry a load carry the same one.
pub type Setpoint = [Control; COUNT];

/// Walls at `displacement` \[m\].
#[must_use]
pub fn standing(displacement: &[f64; COUNT]) -> Setpoint {
    displacement.map(Control::Displacement)
}

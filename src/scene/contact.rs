//! Contact laws.

use serde::{Deserialize, Serialize};

/// Contact laws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Normal law.
    pub normal: Normal,
    /// Tangential law.
    pub friction: Friction,
    /// Torsional couple of frictional contacts.
    pub torsion: bool,
}

impl Default for Contact {
    fn default() -> Self {
        Self { normal: Normal::Hertz, friction: Friction::None, torsion: true }
    }
}

/// Normal contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normal {
    /// Hertz (T 2.2).
    Hertz,
}

/// Tangential contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Friction {
    /// Ideally smooth grains (T chapter 2).
    None,
}

impl Friction {
    /// Coefficient of friction μ between grains whose pack does not tell their own.
    #[must_use]
    pub fn coefficient(self) -> f64 {
        match self {
            Self::None => 0.0,
        }
    }
}

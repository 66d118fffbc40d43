//! What is computed when.

use serde::{Deserialize, Serialize};

/// When a measure is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// At every increment.
    Always,
    /// When somebody subscribed, records, or the summary shows it.
    #[default]
    OnDemand,
    /// Never.
    Never,
}

/// Which moduli.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModuliKind {
    /// Hooke fit of each interval (T 2.15).
    #[default]
    Secant,
    /// Of the state itself.
    Tangent,
    /// Both; the scalars of `~/moduli` are those of the interval.
    Both,
    /// None.
    None,
}

impl ModuliKind {
    /// Whether those of the state are among them.
    #[must_use]
    pub fn takes_tangent(self) -> bool {
        matches!(self, Self::Tangent | Self::Both)
    }
}

/// What is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Outputs {
    /// Every contact.
    pub contact_network: When,
    /// Pictures for viewers: the grains, and markers.
    pub markers: When,
    /// Moduli.
    pub moduli: ModuliKind,
}

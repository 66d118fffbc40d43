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
    /// None.
    None,
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
    /// What each event did to grains and contacts.
    pub rearrangements: When,
    /// All grains before and after each event; recorded only.
    pub snapshots: When,
}

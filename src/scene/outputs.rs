//! What is computed when.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

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
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Outputs {
    /// Every contact.
    pub contact_network: When,
    /// Pictures for viewers: the grains, and markers.
    pub markers: When,
    /// Displacements and rotations of the grains in each increment. Never, unless the scene asks:
    /// they take a tenth of a small increment, which every recording would.
    pub grain_motion: When,
    /// Moduli.
    pub moduli: ModuliKind,
    /// Statistics of the force network.
    pub fabric: When,
    /// τ_FC (T 2.7.4.1): share of the contacts, those with the largest normal forces, that make the
    /// force chains of `fabric`; above 0, at most 1.
    pub chain_share: f64,
    /// What each event did to grains and contacts.
    pub rearrangements: When,
    /// All grains before and after each stress drop; recorded only.
    pub snapshots: When,
    /// What cement carries, bond by bond.
    pub bonds: When,
    /// Which bonds broke.
    pub cracks: When,
}

impl Default for Outputs {
    fn default() -> Self {
        Self {
            contact_network: When::default(),
            markers: When::default(),
            grain_motion: When::Never,
            moduli: ModuliKind::default(),
            fabric: When::default(),
            chain_share: 0.1,
            rearrangements: When::default(),
            snapshots: When::default(),
            bonds: When::default(),
            cracks: When::default(),
        }
    }
}

impl Outputs {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let inside = |share| 0.0 < share && share <= 1.0;
        problems.number(at.key("chain_share"), self.chain_share, "above 0, at most 1", inside);
    }
}

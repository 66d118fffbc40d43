//! What a pack remembers of its cement.

use serde::{Deserialize, Serialize};

use super::wall_index;
use crate::contact::Other;
use crate::contact::cement::strength::Mode;
use crate::state::{Bond, Condition};

/// A pair of bodies that was close when the cement was deposited.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a bond, `{first: 0, second: 1, ...}`")]
pub struct BondMemory {
    /// Grain index.
    pub first: u32,
    /// Grain index above `first`, or `u32::MAX - w` for wall w.
    pub second: u32,
    /// Distance of the centres, or of the centre from the wall, at the deposition \[m\].
    pub distance: f64,
    /// Mutual approach at the deposition \[m\], negative across a gap.
    pub overlap: f64,
    /// Radius of the cross-section at the deposition \[m\].
    pub radius: f64,
    /// Share of the cement that is left, 0 to 1.
    pub share: f64,
    /// Work against the tangential force and the couple since the deposition \[J\].
    pub work: f64,
    /// Normal force \[N\], negative in tension, where `contact.normal.cement.solution: two_step` has it
    /// remembered; left out where the law gives it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal_force: Option<f64>,
    /// `intact`, `bare` (never cemented), `tension` or `shear` (how it broke).
    pub condition: Kept,
}

/// What became of a bond.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kept {
    /// It holds.
    Intact,
    /// There never was any cement.
    Bare,
    /// It broke by the tensile stress.
    Tension,
    /// It broke by the shear stress.
    Shear,
}

impl BondMemory {
    /// `bond` of a solver whose grains have the pack's indices `order`.
    #[must_use]
    pub(crate) fn of(bond: &Bond, order: &[u32]) -> Self {
        let first = order[bond.first as usize];
        let second = match bond.second {
            Other::Grain(j) => order[j as usize],
            Other::Wall(w) => wall_index(w),
        };
        Self {
            first: first.min(second),
            second: first.max(second),
            distance: bond.distance,
            overlap: bond.overlap,
            radius: bond.radius,
            share: bond.share,
            work: bond.work,
            normal_force: bond.normal_force,
            condition: match bond.condition {
                Condition::Intact => Kept::Intact,
                Condition::Bare => Kept::Bare,
                Condition::Broken(Mode::Tension) => Kept::Tension,
                Condition::Broken(Mode::Shear) => Kept::Shear,
            },
        }
    }

    /// This bond between bodies with the solver's numbers.
    pub(crate) fn bond(&self, first: u32, second: Other) -> Bond {
        Bond {
            first,
            second,
            distance: self.distance,
            overlap: self.overlap,
            radius: self.radius,
            share: self.share,
            work: self.work,
            normal_force: self.normal_force,
            condition: match self.condition {
                Kept::Intact => Condition::Intact,
                Kept::Bare => Condition::Bare,
                Kept::Tension => Condition::Broken(Mode::Tension),
                Kept::Shear => Condition::Broken(Mode::Shear),
            },
        }
    }
}

//! The messages about simple shear.

use serde::{Deserialize, Serialize};

use crate::msg::standard::Header;
use crate::wall;

/// How far a box of discs shall lean, and what its walls do meanwhile.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShearCommand {
    /// When the rig measured or issued it.
    pub header: Header,
    /// A new session restarts the sequence.
    pub session: String,
    /// Increases by one within a session, other commands counted too.
    pub sequence: u64,
    /// A [`Mode`](crate::command::Mode) as a number.
    pub mode: u8,
    /// Shear γ of the box.
    pub tilt: f64,
    /// Kind of each wall's target, as [`WallTargets`](super::WallTargets) numbers them.
    pub control: [u8; wall::COUNT],
    /// Value of each wall's target.
    pub value: [f64; wall::COUNT],
}

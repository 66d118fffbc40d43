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

/// How a box of discs is sheared.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShearState {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Shear γ of the box.
    pub tilt: f64,
    /// Small strain of the box, row by row.
    pub strain: [f64; 4],
    /// Mean stress of the grains in the middle \[Pa\], row by row.
    pub inner_stress: [f64; 4],
    /// Number of these grains.
    pub inner_grains: u32,
    /// Angle from x to the major principal direction of that stress \[rad\].
    pub stress_direction: f64,
    /// The same of the strain \[rad\].
    pub strain_direction: f64,
    /// Mean rotation of the grains that carry load and are free \[rad\].
    pub mean_rotation: f64,
}

//! The messages about gas hydrate.

use serde::{Deserialize, Serialize};

use crate::msg::standard::Header;

/// Hydrate dissociates.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dissociation {
    /// When the rig measured or issued it.
    pub header: Header,
    /// A new session restarts the sequence.
    pub session: String,
    /// Increases by one within a session, other commands counted too.
    pub sequence: u64,
    /// A [`Mode`](crate::command::Mode) as a number.
    pub mode: u8,
    /// Hydrate saturation that is lost.
    pub saturation_loss: f64,
    /// Excess pore pressure \[Pa\].
    pub pore_pressure: f64,
    /// Biot-Willis coefficient.
    pub biot: f64,
}

/// Hydrate and pore pressure.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Hydrate {
    /// Stamp of the command served.
    pub header: Header,
    /// 0 for the initial equilibrium, then one more per command served.
    pub increment: u64,
    /// Hydrate over the pore volume at the start.
    pub saturation: f64,
    /// Hydrate over the pore volume, both now.
    pub present_saturation: f64,
    /// Excess pore pressure \[Pa\].
    pub pore_pressure: f64,
    /// Mean normal stress on the walls \[Pa\].
    pub effective_stress: f64,
    /// That with what the pore pressure took over \[Pa\].
    pub total_stress: f64,
    /// Fluid over total volume.
    pub porosity: f64,
    /// Fluid and hydrate over total volume.
    pub pore_fraction: f64,
}

//! Gas hydrate in the pores, and the pore pressure.

use serde::Serialize;

/// What became of the hydrate, and who carries the stress (T 5.2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Hydrate {
    /// S - ΔS, of the pore volume at the start.
    pub saturation: f64,
    /// Volume of hydrate over that of the pores with the hydrate in them, both now.
    pub present_saturation: f64,
    /// Excess pore pressure \[Pa\].
    pub pore_pressure: f64,
    /// Mean normal stress on the walls \[Pa\].
    pub effective_stress: f64,
    /// Effective stress and Σ α_b Δp, what the pore pressure has taken over of it \[Pa\].
    pub total_stress: f64,
    /// Fluid over total volume (T 2.19).
    pub porosity: f64,
    /// Fluid and hydrate over total volume.
    pub pore_fraction: f64,
}

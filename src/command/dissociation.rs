//! Dissociation of gas hydrate: what a command asks for (T 5.2.2).

/// Where a dissociation leads, counted from the start of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dissociation {
    /// Hydrate saturation that is lost, ΔS: part of the pore volume at the start.
    pub saturation_loss: f64,
    /// Excess pore pressure p_ex \[Pa\].
    pub pore_pressure: f64,
    /// Biot-Willis coefficient α_b with which a change of the pore pressure takes effective stress
    /// away, 0 to 1. It is not cumulative.
    pub biot: f64,
}

impl Dissociation {
    /// Its numbers with their names as messages have them.
    #[must_use]
    pub fn named(&self) -> [(&'static str, f64); 3] {
        let Self { saturation_loss, pore_pressure, biot } = *self;
        [("saturation_loss", saturation_loss), ("pore_pressure", pore_pressure), ("biot", biot)]
    }
}

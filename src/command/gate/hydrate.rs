//! What of a dissociation can be asked for.

use super::Gate;
use crate::command::{Dissociation, Mode};
use crate::model::hydrate::{Hydrate, MOST_LOST, MOST_PRESSURE};

/// Twice the same saturation may come out different by rounding.
const ROUNDING: f64 = 1e-12;

/// What hydrate there is, and what became of it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stock {
    /// Saturation at the start.
    saturation: f64,
    /// Most of it that can be lost.
    most_lost: f64,
    /// Largest pore pressure \[Pa\].
    most_pressure: f64,
    /// Saturation that is lost.
    lost: f64,
    /// Pore pressure now \[Pa\].
    pressure: f64,
}

impl Stock {
    /// Everything is as it was at the start.
    pub(super) fn forget(&mut self) {
        (self.lost, self.pressure) = (0.0, 0.0);
    }
}

impl Gate {
    /// The same gate for a pack with this hydrate.
    #[must_use]
    pub fn with_hydrate(mut self, hydrate: &Hydrate) -> Self {
        let Hydrate { saturation, softest, .. } = *hydrate;
        let (most_lost, most_pressure) = (MOST_LOST * saturation, MOST_PRESSURE * softest);
        self.hydrate = Stock { saturation, most_lost, most_pressure, lost: 0.0, pressure: 0.0 };
        self
    }

    /// Remembers that it has come to `to`.
    pub fn dissociated(&mut self, to: &Dissociation) {
        self.hydrate.lost = to.saturation_loss;
        self.hydrate.pressure = to.pore_pressure;
    }

    /// Where a dissociation leads, counted from the start, or what is wrong with it.
    pub(super) fn dissociation(
        &self,
        asked: &Dissociation,
        mode: Mode,
    ) -> Result<Dissociation, String> {
        let Stock { saturation, most_lost, most_pressure, lost, pressure } = self.hydrate;
        if saturation == 0.0 {
            return Err("the pack has no hydrate (pack.hydrate)".into());
        }
        let biot = asked.biot;
        if !(0.0..=1.0).contains(&biot) {
            return Err(format!("biot is {biot:e}: 0 to 1 is allowed"));
        }
        let mut to = *asked;
        if mode == Mode::Increment {
            to.saturation_loss += lost;
            to.pore_pressure += pressure;
        }
        let loss = to.saturation_loss;
        if loss < lost * (1.0 - ROUNDING) || loss > most_lost * (1.0 + ROUNDING) {
            return Err(format!(
                "saturation_loss would be {loss:e} since the start: from {lost:e}, which is lost \
                 already, to {most_lost:e} of the {saturation:e} at the start is allowed"
            ));
        }
        to.saturation_loss = loss.clamp(lost, most_lost);
        let p = to.pore_pressure;
        if !(0.0..=most_pressure).contains(&p) {
            return Err(format!(
                "pore_pressure would be {p:e} Pa: 0 to {most_pressure:e} Pa is allowed, a tenth of \
                 the softest grain's bulk modulus"
            ));
        }
        let loaded = self.now.iter().position(|control| control.load().is_some());
        match loaded {
            Some(w) if biot * (p - pressure) != 0.0 => Err(format!(
                "pore_pressure would change while {} carries a load: walls that stand are expanded \
                 by it, and a load is an effective stress already; biot 0 compresses the grains alone",
                crate::wall::NAMES[w]
            )),
            _ => Ok(to),
        }
    }
}

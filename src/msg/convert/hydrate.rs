//! Dissociation and hydrate as messages.

use super::pack_header;
use crate::command::{self, Ask, Command};
use crate::msg::{Dissociation, Hydrate};
use crate::report::{self, Measures};

/// A command whose age nobody has measured yet.
impl From<Dissociation> for Command {
    fn from(message: Dissociation) -> Self {
        let Dissociation { saturation_loss, pore_pressure, biot, .. } = message;
        let asked = command::Dissociation { saturation_loss, pore_pressure, biot };
        Self {
            stamp: message.header.stamp.into(),
            session: message.session,
            sequence: message.sequence,
            mode: message.mode.into(),
            ask: Ask::Dissociation(asked),
            age: None,
        }
    }
}

/// Hydrate and pore pressure, when they were asked for and there is hydrate.
#[must_use]
pub fn hydrate(measures: &Measures) -> Option<Hydrate> {
    let report::Hydrate {
        saturation,
        present_saturation,
        pore_pressure,
        effective_stress,
        total_stress,
        porosity,
        pore_fraction,
    } = measures.hydrate?;
    Some(Hydrate {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        saturation,
        present_saturation,
        pore_pressure,
        effective_stress,
        total_stress,
        porosity,
        pore_fraction,
    })
}

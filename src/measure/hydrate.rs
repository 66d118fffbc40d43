//! Gas hydrate in the pores, and the pore pressure (T 5.2).

use crate::measure::contacts::Contact;
use crate::measure::porosity::pores;
use crate::model::Model;
use crate::report::Hydrate;
use crate::state::{Dissociated, State};

/// What became of the hydrate; `None` for a pack without. `effective_stress` is the mean normal
/// stress \[Pa\].
#[must_use]
pub fn hydrate(
    model: &Model,
    state: &State,
    contacts: &[Contact],
    effective_stress: f64,
) -> Option<Hydrate> {
    let saturation = model.hydrate.saturation;
    if saturation == 0.0 {
        return None;
    }
    let cement = model.cement.map_or(0.0, |cement| cement.saturation);
    let bounds = state.bounds(model);
    let pores = pores(model, contacts, &bounds);
    let Dissociated { lost, pressure, borne, .. } = state.dissociated;
    Some(Hydrate {
        saturation: saturation - lost,
        present_saturation: pores.saturation() + cement * model.hydrate.left(lost),
        pore_pressure: pressure,
        effective_stress,
        total_stress: effective_stress + borne,
        porosity: (pores.all - pores.hydrate) / bounds.volume(),
        pore_fraction: pores.all / bounds.volume(),
    })
}

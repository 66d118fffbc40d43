//! Equal parts of what dissociates, and of the pore pressure.

use super::{Course, INCREMENT_NANOSECONDS, PathError};
use crate::command::Dissociation;
use crate::scene::Dissociate;

pub(super) fn follow(step: &Dissociate, course: &mut Course) -> Result<(), PathError> {
    let (lost, pressure) = course.dissociated;
    let ends = (step.saturation_loss.unwrap_or(lost), step.pore_pressure.unwrap_or(pressure));
    for increment in 1..=step.increments {
        // From the step's start each time, so that rounding does not add up.
        let share = f64::from(increment) / f64::from(step.increments);
        let part = |from: f64, end: f64| match increment == step.increments {
            true => end,
            false => from + share * (end - from),
        };
        course.dissociate(
            course.clock + INCREMENT_NANOSECONDS,
            Dissociation {
                saturation_loss: part(lost, ends.0),
                pore_pressure: part(pressure, ends.1),
                biot: step.biot,
            },
        )?;
    }
    Ok(())
}

//! Equal parts of the tilt of a box of discs, and of the way of each wall to its target.

use super::targets::parts;
use super::{Course, INCREMENT_NANOSECONDS, PathError};
use crate::scene::ShearStep;

pub(super) fn follow(step: &ShearStep, course: &mut Course) -> Result<(), PathError> {
    let from = course.tilt;
    let targets = parts(step.targets.in_order(), step.increments, course);
    for (increment, targets) in (1..=step.increments).zip(targets) {
        // From the step's start each time, so that rounding does not add up.
        let share = f64::from(increment) / f64::from(step.increments);
        course.shear(course.clock + INCREMENT_NANOSECONDS, from + share * step.tilt, targets)?;
    }
    Ok(())
}

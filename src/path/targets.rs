//! Equal parts of the way of each wall to its target.

use super::{Course, INCREMENT_NANOSECONDS, PathError};
use crate::scene::WallsStep;
use crate::wall::{self, WallTarget};

pub(super) fn follow(step: &WallsStep, course: &mut Course) -> Result<(), PathError> {
    in_parts(step.targets.in_order(), step.increments, course)
}

/// Goes to `ends` in equal parts. The two walls of a pair that carry the same load start from the
/// mean of what they carry.
pub(super) fn in_parts(
    ends: [WallTarget; wall::COUNT],
    increments: u32,
    course: &mut Course,
) -> Result<(), PathError> {
    for targets in parts(ends, increments, course) {
        course.push(course.clock + INCREMENT_NANOSECONDS, targets)?;
    }
    Ok(())
}

/// The targets on the way to `ends` in equal parts.
pub(super) fn parts(
    ends: [WallTarget; wall::COUNT],
    increments: u32,
    course: &Course,
) -> impl Iterator<Item = [WallTarget; wall::COUNT]> + use<> {
    let from = std::array::from_fn::<_, { wall::COUNT }, _>(|w| {
        let paired = course.cell.as_ref().is_none_or(|cell| cell.is_paired(wall::axis(w)));
        let together = paired && ends[w] == ends[w ^ 1];
        let mean = |of: &dyn Fn(usize) -> f64| match together {
            true => 0.5 * (of(w) + of(w ^ 1)),
            false => of(w),
        };
        match ends[w] {
            WallTarget::Stress(_) => mean(&|w| course.stress(w)),
            WallTarget::Force(_) => mean(&|w| course.force[w]),
            _ => course.displacement[w],
        }
    });
    (1..=increments).map(move |increment| {
        // From the step's start each time, so that rounding does not add up.
        let share = f64::from(increment) / f64::from(increments);
        std::array::from_fn(|w| {
            let part = |end: f64| match increment == increments {
                true => end,
                false => from[w] + share * (end - from[w]),
            };
            match ends[w] {
                WallTarget::Displacement(end) => WallTarget::Displacement(part(end)),
                WallTarget::Force(end) => WallTarget::Force(part(end)),
                WallTarget::Stress(end) => WallTarget::Stress(part(end)),
                other => other,
            }
        })
    })
}

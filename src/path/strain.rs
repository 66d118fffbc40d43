//! Strain steps: equal parts of a displacement of the walls.

use super::{Course, INCREMENT_NANOSECONDS, PathError};
use crate::scene::{Isotropic, Moving, Polyaxial, Triaxial, Uniaxial, Unload};
use crate::wall;

pub(super) fn isotropic(step: &Isotropic, course: &mut Course) -> Result<(), PathError> {
    by_strain([step.strain; 3], step.moving, step.increments, course)
}

pub(super) fn uniaxial(step: &Uniaxial, course: &mut Course) -> Result<(), PathError> {
    let mut strain = [0.0; 3];
    strain[step.axis.index()] = step.strain;
    by_strain(strain, step.moving, step.increments, course)
}

pub(super) fn triaxial(step: &Triaxial, course: &mut Course) -> Result<(), PathError> {
    let mut strain = [step.lateral_strain; 3];
    strain[step.axis.index()] = step.axial_strain;
    by_strain(strain, step.moving, step.increments, course)
}

pub(super) fn polyaxial(step: &Polyaxial, course: &mut Course) -> Result<(), PathError> {
    by_strain(step.strain, step.moving, step.increments, course)
}

pub(super) fn unload(step: &Unload, course: &mut Course) -> Result<(), PathError> {
    let change = course.displacement.map(|now| (step.to - 1.0) * now);
    in_parts(change, step.increments, course)
}

/// Strains of x, y, z, of the box at the step's start.
fn by_strain(
    strain: [f64; 3],
    moving: Moving,
    increments: u32,
    course: &mut Course,
) -> Result<(), PathError> {
    let sides = course.bounds().sides();
    let shares = moving.shares();
    let change = std::array::from_fn(|wall| {
        let axis = wall::axis(wall);
        shares[wall % 2] * strain[axis] * sides[axis]
    });
    in_parts(change, increments, course)
}

fn in_parts(
    change: [f64; wall::COUNT],
    increments: u32,
    course: &mut Course,
) -> Result<(), PathError> {
    let from = course.displacement;
    for increment in 1..=increments {
        // From the step's start each time, so that rounding does not add up.
        let share = f64::from(increment) / f64::from(increments);
        let displacement = std::array::from_fn(|wall| from[wall] + share * change[wall]);
        course.push(course.clock + INCREMENT_NANOSECONDS, displacement)?;
    }
    Ok(())
}

//! Strain and stress steps: equal parts of the way of the walls.

use super::targets::in_parts;
use super::{Course, PathError};
use crate::scene::{Isotropic, Moving, Polyaxial, Triaxial, Uniaxial, Unload};
use crate::wall::{self, WallTarget};

/// What a step does along one axis.
#[derive(Clone, Copy)]
enum Way {
    /// Strains it, of the box at the step's start.
    Strain(f64),
    /// Ends at this stress \[Pa\].
    Stress(f64),
}

impl Way {
    /// Of a checked step, which has one of the two.
    fn new(strain: Option<f64>, stress: Option<f64>) -> Self {
        stress.map_or(Self::Strain(strain.unwrap_or(0.0)), Self::Stress)
    }
}

pub(super) fn isotropic(step: &Isotropic, course: &mut Course) -> Result<(), PathError> {
    go([Way::new(step.strain, step.stress); 3], step.moving, step.increments, course)
}

pub(super) fn uniaxial(step: &Uniaxial, course: &mut Course) -> Result<(), PathError> {
    let mut ways = [Way::Strain(0.0); 3];
    ways[step.axis.index()] = Way::new(step.strain, step.stress);
    go(ways, step.moving, step.increments, course)
}

pub(super) fn triaxial(step: &Triaxial, course: &mut Course) -> Result<(), PathError> {
    let mut ways = [Way::new(step.lateral_strain, step.lateral_stress); 3];
    ways[step.axis.index()] = Way::new(step.axial_strain, step.axial_stress);
    go(ways, step.moving, step.increments, course)
}

pub(super) fn polyaxial(step: &Polyaxial, course: &mut Course) -> Result<(), PathError> {
    let way = |axis: usize| {
        Way::new(step.strain.map(|strain| strain[axis]), step.stress.map(|stress| stress[axis]))
    };
    go(std::array::from_fn(way), step.moving, step.increments, course)
}

pub(super) fn unload(step: &Unload, course: &mut Course) -> Result<(), PathError> {
    let ends = course.displacement.map(|now| WallTarget::Displacement(now + (step.to - 1.0) * now));
    in_parts(ends, step.increments, course)
}

fn go(
    ways: [Way; 3],
    moving: Moving,
    increments: u32,
    course: &mut Course,
) -> Result<(), PathError> {
    let sides = course.bounds().sides();
    let shares = moving.shares();
    let ends = std::array::from_fn(|w| {
        let axis = wall::axis(w);
        let share = shares[w % 2];
        match ways[axis] {
            Way::Stress(stress) if share > 0.0 => WallTarget::Stress(stress),
            Way::Stress(_) => WallTarget::Displacement(course.displacement[w]),
            Way::Strain(strain) => {
                WallTarget::Displacement(course.displacement[w] + share * strain * sides[axis])
            }
        }
    });
    in_parts(ends, increments, course)
}

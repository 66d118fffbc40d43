//! A rig's measured strain history as commands.
//!
//! The axial strain ε is of the box at the step's start, compression positive, and both walls of a
//! pair move by half. With `lateral: constant_volume` the lateral sides grow by the exact factor
//!
//! ```text
//! L/L0 = 1/sqrt(1 - ε)
//! ```
//!
//! so that (1 - ε) (L/L0)² = 1 whatever ε is; the usual lateral strain of -ε/2 is its first term. With
//! `lateral: free` the lateral walls carry the mean stress that each pair has when the log begins.

use std::path::Path;

use super::csv::Clock;
use super::{Course, PathError};
use crate::scene::{Lateral, RigLog, StrainUnit};
use crate::table::Table;
use crate::wall::{self, WallTarget};

/// Adds one command per row of `file`, which `step` describes.
pub(super) fn follow(step: &RigLog, file: &Path, course: &mut Course) -> Result<(), PathError> {
    let table = Table::read(file, None)?;
    let time = table.require(&step.time)?;
    let strain = table.require(&step.axial_strain)?;
    let one = match step.unit {
        StrainUnit::Ratio => 1.0,
        StrainUnit::Percent => 1e2,
        StrainUnit::Microstrain => 1e6,
    };
    let (from, sides) = (course.displacement, course.bounds().sides());
    let held = std::array::from_fn::<_, 3, _>(|axis| {
        WallTarget::Stress(0.5 * (course.stress(2 * axis) + course.stress(2 * axis + 1)))
    });

    let mut clock = Clock::new(course.clock);
    let mut empty = true;
    for row in table.rows() {
        let row = row?;
        let nanoseconds = clock.read(&row, time)?;
        let axial = row.number(strain)? / one;
        if axial >= 1.0 {
            let text = format!("`{}` is a strain of {axial:?}; allowed: below 1", row.text(strain));
            return Err(row.wrong(strain, text).into());
        }
        let lateral = match step.lateral {
            Lateral::ConstantVolume => lateral_at_constant_volume(axial),
            Lateral::Fixed | Lateral::Free => 0.0,
        };
        let targets = std::array::from_fn(|wall| {
            let axis = wall::axis(wall);
            let is_axial = axis == step.axis.index();
            if !is_axial && step.lateral == Lateral::Free {
                return held[axis];
            }
            let strain = if is_axial { axial } else { lateral };
            WallTarget::Displacement(from[wall] + 0.5 * strain * sides[axis])
        });
        course.push(nanoseconds, targets)?;
        empty = false;
    }
    if empty {
        return Err(table.in_header("no row follows the header; allowed: at least one").into());
    }
    Ok(())
}

/// Lateral strain 1 - 1/sqrt(1 - ε) that keeps the volume, written without cancellation.
fn lateral_at_constant_volume(axial: f64) -> f64 {
    let root = (1.0 - axial).sqrt();
    -axial / (root * (1.0 + root))
}

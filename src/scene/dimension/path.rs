//! Steps of a load path that a pack of discs cannot walk: there is no z in the plane.

use crate::scene::check::{Field, Problems};
use crate::scene::{Axis, Step, Targets};
use crate::wall::{self, WallTarget};

const AXES: &str = "there is no z in the plane; allowed: x, y";

pub(super) fn check(steps: &[Step], at: &Field, problems: &mut Problems) {
    for (index, step) in steps.iter().enumerate() {
        let at = at.index(index);
        match step {
            Step::Uniaxial(step) if step.axis == Axis::Z => {
                problems.add(at.key("uniaxial").key("axis"), AXES);
            }
            Step::Triaxial(step) if step.axis == Axis::Z => {
                problems.add(at.key("triaxial").key("axis"), AXES);
            }
            Step::Polyaxial(step) if step.strain.is_some_and(|[.., z]| z != 0.0) => {
                let at = at.key("polyaxial").key("strain").index(2);
                problems.add(at, "there is no z in the plane; allowed: 0");
            }
            Step::Walls(step) => targets(&step.targets, &at.key("walls").key("targets"), problems),
            Step::Repeat(step) => check(&step.steps, &at.key("repeat").key("steps"), problems),
            _ => {}
        }
    }
}

/// Walls that discs do not have do nothing.
pub(super) fn targets(targets: &Targets, at: &Field, problems: &mut Problems) {
    for (name, target) in wall::NAMES.iter().zip(targets.in_order()).skip(4) {
        if target != WallTarget::Keep {
            problems.add(at.key(name), "discs have no such wall; allowed: no such key");
        }
    }
}

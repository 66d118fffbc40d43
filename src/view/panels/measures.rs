//! What the pack and its walls carried.

use super::events;
use super::strain::Strain;
use crate::msg::{PackState, WallForces};
use crate::view::chart::{Chart, Pattern, Series, Stroke};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;
use crate::{plane, wall};

/// A line of one value of the pack.
pub(super) fn series(
    number: usize,
    name: &str,
    run: &Run,
    strain: &Strain,
    value: impl Fn(&PackState) -> f64,
) -> Series {
    let point = |state: &PackState| [strain.at(state.increment), value(state)];
    Series::new(number, name, run.states.iter().map(point))
}

/// Confining and deviatoric stress.
pub(super) fn stress(run: &Run, strain: &Strain) -> Chart {
    let mut lines = vec![
        series(0, "confining stress", run, strain, |state| state.confining_stress),
        series(1, "deviatoric stress", run, strain, |state| state.deviatoric_stress),
    ];
    lines.extend(events::marks(run, strain));
    Chart {
        title: format!("Stress against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("stress", Unit::Si("Pa")),
        series: lines,
        notes: Vec::new(),
    }
}

/// The stress path: deviatoric over mean stress.
pub(super) fn path(run: &Run) -> Chart {
    let point = |state: &PackState| [state.confining_stress, state.deviatoric_stress];
    let mut start = Series::new(1, "start", run.states.first().map(point));
    start.stroke.pattern = Pattern::Dots;
    start.stroke.width = 2.4;
    Chart {
        title: "Stress path".into(),
        x: Axis::linear("mean stress p", Unit::Si("Pa")),
        y: Axis::linear("deviatoric stress q", Unit::Si("Pa")),
        series: vec![Series::new(0, "path", run.states.iter().map(point)), start],
        notes: vec![match run.is_plane() {
            false => {
                "p: a third of the trace of the stress on the walls. q: stress along z minus the mean \
                 of the other two."
            }
            true => "p: half of the trace of the stress on the walls. q: stress along y minus that along x.",
        }
        .into()],
    }
}

/// Strokes of the walls, many of which often carry the same: each shows within the one before.
const WALLS: [Stroke; wall::COUNT] = [
    Stroke::solid("#9cc9e8", 9.0),
    Stroke::solid("#0072b2", 1.4),
    Stroke::solid("#f7d08a", 6.5),
    Stroke::solid("#c77f00", 1.4),
    Stroke::solid("#94d8c4", 4.5),
    Stroke::solid("#00795a", 1.4),
];

/// Normal forces on the six walls.
pub(super) fn wall_forces(run: &Run) -> Chart {
    let line = |(wall, stroke): (usize, &Stroke)| {
        let point = |walls: &WallForces| [walls.increment as f64, walls.normal_force[wall]];
        let points = run.walls.iter().map(point).collect();
        Series { name: wall::NAMES[wall].into(), points, spread: Vec::new(), stroke: *stroke }
    };
    let sides = if run.is_plane() { plane::boundary::SIDES } else { wall::COUNT };
    Chart {
        title: "Wall forces".into(),
        x: Axis::count("increment"),
        y: Axis::linear("normal force", Unit::Si("N")),
        series: WALLS.iter().enumerate().take(sides).map(line).collect(),
        notes: Vec::new(),
    }
}

/// Mean number of contacts a grain.
pub(super) fn coordination(run: &Run, strain: &Strain) -> Chart {
    Chart {
        title: format!("Coordination against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("coordination number", Unit::None),
        series: vec![series(0, "coordination number", run, strain, |state| {
            state.coordination_number
        })],
        notes: Vec::new(),
    }
}

//! What the pack and its walls did.

use super::strain::Strain;
use crate::msg::{PackState, WallForces};
use crate::view::chart::{Chart, Series, Stroke};
use crate::view::forces::density;
use crate::view::history::History;
use crate::view::scale::Axis;
use crate::view::unit::Unit;
use crate::wall;

fn series(
    number: usize,
    name: &str,
    history: &History,
    strain: &Strain,
    value: impl Fn(&PackState) -> f64,
) -> Series {
    let point = |state: &PackState| [strain.at(state.increment), value(state)];
    Series::new(number, name, history.states.iter().map(point))
}

/// Confining and deviatoric stress.
pub(super) fn stress(history: &History, strain: &Strain) -> Chart {
    Chart {
        title: format!("Stress against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("stress", Unit::Si("Pa")),
        series: vec![
            series(0, "confining stress", history, strain, |state| state.confining_stress),
            series(1, "deviatoric stress", history, strain, |state| state.deviatoric_stress),
        ],
        notes: Vec::new(),
    }
}

/// Strokes of two opposite walls, which often carry the same: the second shows within the first.
const WALLS: [Stroke; wall::COUNT] = [
    Stroke::solid("#9cc9e8", 5.0),
    Stroke::solid("#0072b2", 1.4),
    Stroke::solid("#f7d08a", 5.0),
    Stroke::solid("#c77f00", 1.4),
    Stroke::solid("#94d8c4", 5.0),
    Stroke::solid("#00795a", 1.4),
];

/// Normal forces on the six walls.
pub(super) fn wall_forces(history: &History) -> Chart {
    let line = |(wall, stroke): (usize, &Stroke)| {
        let point = |walls: &WallForces| [walls.increment as f64, walls.normal_force[wall]];
        let points = history.walls.iter().map(point).collect();
        Series { name: wall::NAMES[wall].into(), points, spread: Vec::new(), stroke: *stroke }
    };
    Chart {
        title: "Wall forces".into(),
        x: Axis::count("increment"),
        y: Axis::linear("normal force", Unit::Si("N")),
        series: WALLS.iter().enumerate().map(line).collect(),
        notes: Vec::new(),
    }
}

/// Mean number of contacts a grain.
pub(super) fn coordination(history: &History, strain: &Strain) -> Chart {
    Chart {
        title: format!("Coordination against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("coordination number", Unit::None),
        series: vec![series(0, "coordination number", history, strain, |state| {
            state.coordination_number
        })],
        notes: Vec::new(),
    }
}

/// Pore volume over total volume.
pub(super) fn porosity(history: &History, strain: &Strain) -> Chart {
    Chart {
        title: format!("Porosity against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("porosity", Unit::None),
        series: vec![series(2, "porosity", history, strain, |state| state.porosity)],
        notes: Vec::new(),
    }
}

/// Energies since the start.
pub(super) fn energy(history: &History, strain: &Strain) -> Chart {
    let start = history.states.first().map_or(f64::NAN, |state| state.stored_energy);
    let work = work(&history.walls).into_iter();
    let work = work.map(|(increment, work)| [strain.at(increment), work]);
    let mut notes =
        vec!["Work: normal forces of the walls over their travel, by trapezoids.".into()];
    if start.is_finite() {
        notes.push(format!("Stored at the start: {start:.4e} J."));
    }
    Chart {
        title: "Energy since the start".into(),
        x: strain.axis(),
        y: Axis::linear("energy", Unit::Si("J")),
        series: vec![
            series(0, "stored", history, strain, |state| state.stored_energy - start),
            Series::new(1, "work of the walls", work),
            series(2, "dissipated", history, strain, |state| state.dissipated_energy),
        ],
        notes,
    }
}

/// Work of the walls up to each increment \[J\].
fn work(walls: &[WallForces]) -> Vec<(u64, f64)> {
    let mut sum = 0.0;
    let step = |pair: &[WallForces]| {
        let travel = |wall: usize| pair[1].displacement[wall] - pair[0].displacement[wall];
        let mean = |wall: usize| 0.5 * (pair[0].normal_force[wall] + pair[1].normal_force[wall]);
        sum += (0..wall::COUNT).map(|wall| mean(wall) * travel(wall)).sum::<f64>();
        (pair[1].increment, sum)
    };
    let start = walls.first().map(|walls| (walls.increment, 0.0));
    start.into_iter().chain(walls.windows(2).map(step)).collect()
}

/// Distribution of the normal contact forces, at the start and at the end.
pub(super) fn force_distribution(history: &History) -> Chart {
    let networks = history.networks.as_ref().map_or(&[][..], |both| match both {
        [first, last] if first.increment == last.increment => &both[..1],
        _ => &both[..],
    });
    let line = |(number, forces): (usize, &crate::view::Forces)| {
        let name = format!("increment {} ({} contacts)", forces.increment, forces.normal.len());
        Series::new(number, &name, density(&forces.normal))
    };
    Chart {
        title: "Distribution of contact forces".into(),
        x: Axis::linear("normal force f over its mean", Unit::None),
        y: Axis::log("probability density P(f)"),
        series: networks.iter().enumerate().map(line).collect(),
        notes: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_work_of_a_spring_is_the_area_under_its_force() {
        // F = 3 δ on one wall: W = 3 δ² / 2, which trapezoids meet.
        let walls = |increment: u64| {
            let travel = 0.5 * increment as f64;
            let at = |value: f64| [0.0, 0.0, 0.0, 0.0, value, 0.0];
            let (normal_force, displacement) = (at(3.0 * travel), at(travel));
            WallForces { increment, normal_force, displacement, ..WallForces::default() }
        };
        let walls: Vec<WallForces> = (0..=2).map(walls).collect();
        assert_eq!(work(&walls), [(0, 0.0), (1, 0.375), (2, 1.5)]);
    }
}

//! Where the work of the walls went.

use super::events;
use super::measures::series;
use super::strain::Strain;
use crate::msg::WallForces;
use crate::view::chart::{Chart, Series, Stroke};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;
use crate::wall;

/// Without friction all work is stored: the line of that shows within.
const WORK: Stroke = Stroke::solid("#f2b98c", 5.0);

/// Changes by a smaller share come from sums in another order.
const ROUNDING: f64 = 1e-12;

/// Energies since the start.
pub(super) fn energy(run: &Run, strain: &Strain) -> Chart {
    let start = run.states.first().map_or(f64::NAN, |state| state.stored_energy);
    // On a path that turns, the lines of every cycle would lie over each other.
    let strain = &strain.or_increment_where_it_turns();
    let work = work(&run.walls).into_iter();
    let work = work.map(|(increment, work)| [strain.at(increment), work]);
    let mut notes =
        vec!["Work: normal forces of the walls over their travel, by trapezoids.".into()];
    if start.is_finite() {
        notes.push(format!("Stored at the start: {}.", Unit::Si("J").written(start)));
    }
    let mut lines = vec![
        Series { stroke: WORK, ..Series::new(1, "work of the walls", work) },
        series(0, "stored", run, strain, |state| told(state.stored_energy - start, start)),
        series(2, "dissipated", run, strain, |state| told(state.dissipated_energy, start)),
    ];
    lines.extend(events::released(run, strain));
    Chart {
        title: format!("Energy since the start, against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("energy", Unit::Si("J")),
        series: lines,
        notes,
    }
}

/// A change of the energy, which is 0 when it is a rounding of `start`.
fn told(change: f64, start: f64) -> f64 {
    if change.abs() < ROUNDING * start.abs() { 0.0 } else { change }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rounding_of_the_stored_energy_is_no_change() {
        let start = 2.0e-4_f64;
        assert_eq!(told(start.next_up() - start, start), 0.0);
        assert_eq!(told(-1e-12, start), -1e-12);
        assert!(told(f64::NAN, start).is_nan());
    }

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

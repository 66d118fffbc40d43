//! Simple shear of a box of discs (B figures 29 to 33).

use crate::msg::ShearState;
use crate::view::chart::{Chart, Series};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Charts for a run in which the box leans; empty ones for any other.
pub(super) fn charts(run: &Run) -> Vec<Chart> {
    vec![stress(run), directions(run), rotation(run)]
}

fn chart(title: &str, y: Axis, series: Vec<Series>) -> Chart {
    let x = Axis::linear("tilt of the box", Unit::Strain);
    Chart { title: title.into(), x, y, series, notes: Vec::new() }
}

fn line(number: usize, name: &str, run: &Run, value: impl Fn(&ShearState) -> f64) -> Series {
    let leans = run.shears.iter().any(|state| state.tilt != 0.0);
    let point = |state: &ShearState| [state.tilt, value(state)];
    Series::new(number, name, run.shears.iter().filter(|_| leans).map(point))
}

fn stress(run: &Run) -> Chart {
    let of = |number, name, k: usize| line(number, name, run, move |one| one.inner_stress[k]);
    let series = vec![of(0, "xx", 0), of(1, "yy", 3), of(2, "xy", 1), of(3, "yx", 2)];
    chart("Stress in the middle", Axis::linear("stress", Unit::Si("Pa")), series)
}

fn directions(run: &Run) -> Chart {
    let series = vec![
        line(0, "stress", run, |one| one.stress_direction),
        line(1, "strain", run, |one| one.strain_direction),
    ];
    chart("Major principal directions", Axis::linear("angle to x", Unit::Si("rad")), series)
}

fn rotation(run: &Run) -> Chart {
    let series = vec![
        line(0, "mean of the grains", run, |one| -one.mean_rotation),
        line(1, "half of the walls", run, |one| 0.5 * one.tilt.atan()),
    ];
    chart("Rotation to the right", Axis::linear("rotation", Unit::Si("rad")), series)
}

//! The figures: what of the samples is drawn, over which axes.

mod friction;
mod increments;
mod preparation;
pub(crate) mod sliding;
pub(crate) mod smooth;

use graintwin::view::{Axis, Chart, Kind, Pattern, Series, Sheet, Stroke, Unit};

use crate::curve::{Curve, Spread, even, over_seeds};
use crate::intervals::{Interval, by_strain};
use crate::runs::{Sample, Test};
use crate::specimen::Equilibrium;
use crate::theory::{self, Slip};

/// Axial strain of the intervals of which moduli are taken.
pub(crate) const INTERVAL: f64 = 1e-3;

/// Solid fraction and mean coordination number of the effective-medium lines.
const MEDIUM: (f64, f64) = (0.64, 6.0);

/// The sheets by the name of their file without its ending.
pub(crate) fn sheets(samples: &[Sample]) -> Vec<(&'static str, Sheet)> {
    vec![
        ("validation_frictionless", smooth::sheet(samples)),
        ("validation_sliding", sliding::sheet(samples)),
        ("validation_friction", friction::sheet(samples)),
        ("validation_preparation", preparation::sheet(samples)),
        ("validation_increments", increments::sheet(samples)),
        ("validation_coefficient", friction::coefficients(samples)),
    ]
}

/// What the sheets have in common.
fn subtitle(samples: &[Sample], of: &str) -> String {
    let seeds: Vec<String> = samples.iter().map(|sample| sample.seed.to_string()).collect();
    format!(
        "2740 glass beads; lines: mean of the seeds {}, bands: lowest to highest. {of}",
        seeds.join(", ")
    )
}

/// A chart over the confining stress.
fn against_stress(title: &str, y: Axis, series: Vec<Series>) -> Chart {
    Chart {
        title: format!("{title} against confining stress"),
        x: stress_axis(),
        y,
        series,
        notes: Vec::new(),
    }
}

/// One measure of the intervals of a run against their stress.
pub(crate) fn modulus(intervals: &[Interval], of: fn(&Interval) -> f64) -> Curve {
    intervals.iter().map(|interval| [interval.stress, of(interval)]).collect()
}

/// One measure of the equilibria of a run against their stress.
pub(crate) fn measure(course: &[Equilibrium], of: fn(&Equilibrium) -> f64) -> Curve {
    course.iter().map(|at| [at.state.confining_stress, of(at)]).collect()
}

/// A modulus of `test` against stress, a curve for each seed.
pub(crate) fn moduli_of(samples: &[Sample], test: &Test, of: fn(&Interval) -> f64) -> Vec<Curve> {
    let curve = |sample: &Sample| modulus(&by_strain(sample.of(test), INTERVAL), of);
    samples.iter().map(curve).collect()
}

/// A measure of the equilibria of `test` against stress, a curve for each seed.
pub(crate) fn measures_of(
    samples: &[Sample],
    test: &Test,
    of: fn(&Equilibrium) -> f64,
) -> Vec<Curve> {
    samples.iter().map(|sample| measure(sample.of(test), of)).collect()
}

/// The mean of `curves` and their spread, in the colour of `number`.
fn line(number: usize, name: &str, curves: &[Curve], grid: &[f64]) -> Series {
    drawn(number, name, &over_seeds(curves, grid))
}

pub(crate) fn drawn(number: usize, name: &str, places: &[(f64, Spread)]) -> Series {
    Series {
        name: name.into(),
        points: places.iter().map(|(x, y)| [*x, y.mean]).collect(),
        spread: places.iter().map(|(_, y)| [y.low, y.high]).collect(),
        stroke: Stroke::of(number),
    }
}

/// A dashed grey line.
pub(crate) fn guide(name: &str, points: Vec<[f64; 2]>) -> Series {
    let stroke = Stroke { color: "#57606a", width: 1.4, pattern: Pattern::Dashed };
    Series { name: name.into(), points, spread: Vec::new(), stroke }
}

/// The effective-medium line of K (0) or G (1).
fn medium(name: &str, which: usize, slip: Slip, grid: &[f64]) -> Series {
    let (fraction, coordination) = MEDIUM;
    let value = |stress: f64| theory::moduli(fraction * coordination, stress, slip)[which];
    guide(name, grid.iter().map(|&stress| [stress, value(stress)]).collect())
}

/// Stresses at which lines are drawn, over all runs with friction \[Pa\].
fn grid() -> Vec<f64> {
    even(4e6, 100e6, 0.25e6)
}

fn stress_axis() -> Axis {
    Axis::linear("confining stress", Unit::Si("Pa"))
}

fn modulus_axis(name: &str) -> Axis {
    Axis::linear(name, Unit::Si("Pa"))
}

/// A logarithmic axis; its values are given in `unit`.
fn log_axis(label: &str, unit: &'static str) -> Axis {
    Axis { label: label.into(), unit: Unit::Si(unit), kind: Kind::Log }
}

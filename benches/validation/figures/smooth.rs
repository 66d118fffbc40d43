//! T fig. 2.9: moduli without friction.

use graintwin::view::{Axis, Chart, Pattern, Series, Sheet, Stroke, Unit};

use super::{drawn, guide, log_axis, medium, subtitle};
use crate::curve::{Curve, by_place};
use crate::intervals::{Interval, between_events, whole};
use crate::runs::{Sample, Smooth};
use crate::specimen::Equilibrium;
use crate::theory::{self, Slip};

pub(super) fn sheet(samples: &[Sample]) -> Sheet {
    Sheet {
        title: "Without friction (thesis fig. 2.9)".into(),
        subtitle: subtitle(
            samples,
            "Packs compacted isotropically to nine stresses, ten increments of uniaxial strain at \
             each: the median of their secant moduli, and the secant over all ten. Dashed: \
             effective medium with a solid fraction of 0.64 and 6 contacts.",
        ),
        charts: vec![
            against_stress(samples, "Bulk modulus", "K", 0, |interval| interval.bulk),
            against_stress(samples, "Shear modulus", "G", 1, |interval| interval.shear),
            against(samples, "coordination number", |at| at.state.coordination_number),
            against(samples, "porosity", |at| at.state.porosity),
        ],
    }
}

fn against_stress(
    samples: &[Sample],
    title: &str,
    symbol: &str,
    which: usize,
    of: fn(&Interval) -> f64,
) -> Chart {
    let line = |number, name, curves: &[Curve]| drawn(number, name, &by_place(curves));
    let mut series = vec![
        line(0, "between rearrangements", &curves(samples, between_events, of)),
        line(1, "over all ten increments", &curves(samples, whole, of)),
        line(2, "effective medium, φZ of the packs", &own_medium(samples, which)),
    ];
    if which == 0 {
        series.push(line(3, "of the compaction itself", &compaction(samples)));
    }
    let slips: &[(&str, Slip)] = match which {
        0 => &[("effective medium, φZ = 3.84", Slip::None)],
        _ => &[("no slip", Slip::None), ("free slip", Slip::Free)],
    };
    let ends = [1e6, 100e6];
    series.extend(slips.iter().map(|(name, slip)| medium(name, which, *slip, &ends)));
    for series in &mut series {
        for point in &mut series.points {
            *point = [point[0] / 1e6, point[1] / 1e9];
        }
        for between in &mut series.spread {
            *between = between.map(|y| y / 1e9);
        }
    }
    Chart {
        title: format!("{title} against confining stress"),
        x: log_axis("confining stress", "MPa"),
        y: log_axis(&format!("{} {symbol}", title.to_lowercase()), "GPa"),
        series,
        notes: Vec::new(),
    }
}

/// How moduli are taken of a course.
type Taken = fn(&[Equilibrium]) -> Option<Interval>;

/// A modulus of the frictionless tests against stress, a curve for each seed.
pub(crate) fn curves(samples: &[Sample], taken: Taken, of: fn(&Interval) -> f64) -> Vec<Curve> {
    let curve = |sample: &Sample| {
        let intervals = sample.smooth.iter().filter_map(|test| taken(&test.course));
        intervals.map(|interval| [interval.stress, of(&interval)]).collect()
    };
    samples.iter().map(curve).collect()
}

/// A measure of the frictionless packs against stress, a curve for each seed.
pub(crate) fn packs(samples: &[Sample], of: fn(&Equilibrium) -> f64) -> Vec<Curve> {
    let curve = |sample: &Sample| {
        let starts = sample.smooth.iter().filter_map(|test| test.course.first());
        starts.map(|at| [at.state.confining_stress, of(at)]).collect()
    };
    samples.iter().map(curve).collect()
}

/// Bulk modulus from one isotropic stress to the next: dp / d(ln V).
pub(crate) fn compaction(samples: &[Sample]) -> Vec<Curve> {
    let curve = |sample: &Sample| {
        let place = |pair: &[Smooth]| {
            let [low, high] =
                [&pair[0], &pair[1]].map(|test| test.course[0].state.confining_stress);
            [(low * high).sqrt(), (high - low) / (pair[0].volume / pair[1].volume).ln()]
        };
        sample.smooth.windows(2).map(place).collect()
    };
    samples.iter().map(curve).collect()
}

/// The effective-medium modulus with free slip of the packs as they are at each stress.
pub(crate) fn own_medium(samples: &[Sample], which: usize) -> Vec<Curve> {
    let contacts = packs(samples, |at| (1.0 - at.state.porosity) * at.state.coordination_number);
    let value = |&[stress, contacts]: &[f64; 2]| {
        [stress, theory::moduli(contacts, stress, Slip::Free)[which]]
    };
    contacts.iter().map(|curve| curve.iter().map(value).collect()).collect()
}

/// G against a property of the pack, a dot for each pack of each seed.
fn against(samples: &[Sample], name: &str, of: fn(&Equilibrium) -> f64) -> Chart {
    let dots = |(number, sample): (usize, &Sample)| {
        let place =
            |test: &Smooth| Some([of(test.course.first()?), between_events(&test.course)?.shear]);
        let points = sample.smooth.iter().filter_map(place).collect();
        let stroke = Stroke { pattern: Pattern::Dots, ..Stroke::of(number) };
        Series { name: format!("seed {}", sample.seed), points, spread: Vec::new(), stroke }
    };
    let limit = match name {
        "porosity" => 0.37,
        _ => 6.0,
    };
    let limit = guide("thesis: rigidity lost", vec![[limit, 0.0], [limit, 0.5e9]]);
    Chart {
        title: format!("Shear modulus against {name}"),
        x: Axis::linear(name, Unit::None),
        y: Axis::linear("shear modulus G", Unit::Si("Pa")),
        series: samples.iter().enumerate().map(dots).chain([limit]).collect(),
        notes: Vec::new(),
    }
}

//! T fig. 3.6: packs that were compacted without friction to different stresses.

use graintwin::view::{Axis, Series, Sheet, Unit};

use super::{against_stress, grid, line, measures_of, moduli_of, modulus_axis, subtitle};
use crate::curve::Curve;
use crate::runs::{FROM, Sample, Test};

pub(super) fn sheet(samples: &[Sample]) -> Sheet {
    let grid = grid();
    let runs = |of: &dyn Fn(&Test) -> Vec<Curve>| -> Vec<Series> {
        let run = |(number, test): (usize, &Test)| {
            line(number, &format!("from {} MPa", test.start / 1e6), &of(test), &grid)
        };
        FROM.iter().enumerate().map(run).collect()
    };
    let bulk = runs(&|test| moduli_of(samples, test, |interval| interval.bulk));
    let shear = runs(&|test| moduli_of(samples, test, |interval| interval.shear));
    let force = runs(&|test| measures_of(samples, test, |at| at.state.mean_normal_force));
    let sliding = runs(&|test| measures_of(samples, test, |at| at.state.sliding_ratio));
    Sheet {
        title: "Stress of the frictionless compaction (thesis fig. 3.6)".into(),
        subtitle: subtitle(
            samples,
            "Uniaxial compression with μ = 0.3 in increments of 2e-4; secant moduli of intervals \
             of 1e-3.",
        ),
        charts: vec![
            against_stress("Bulk modulus", modulus_axis("bulk modulus K"), bulk),
            against_stress("Shear modulus", modulus_axis("shear modulus G"), shear),
            against_stress(
                "Mean normal force",
                Axis::linear("mean normal force", Unit::Si("N")),
                force,
            ),
            against_stress(
                "Sliding ratio",
                Axis::linear("share of the contacts", Unit::None),
                sliding,
            ),
        ],
    }
}

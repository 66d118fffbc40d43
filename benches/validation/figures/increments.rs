//! T fig. 3.7: increments of different size.

use graintwin::view::{Axis, Series, Sheet, Unit};

use super::{against_stress, line, measures_of, moduli_of, modulus_axis, subtitle};
use crate::curve::{Curve, even};
use crate::runs::{COARSE, COARSE_THEN_FINE, FINE, Sample, Test};

pub(super) fn sheet(samples: &[Sample]) -> Sheet {
    let grid = even(10e6, FINE.end, 0.25e6);
    let runs = |of: &dyn Fn(&Test) -> Vec<Curve>| -> Vec<Series> {
        vec![
            line(0, "5e-5", &of(&FINE), &grid),
            line(1, "5e-4", &of(&COARSE), &grid),
            line(2, "5e-4 to 19 MPa, then 5e-5", &of(&COARSE_THEN_FINE), &grid),
        ]
    };
    let bulk = runs(&|test| moduli_of(samples, test, |interval| interval.bulk));
    let shear = runs(&|test| moduli_of(samples, test, |interval| interval.shear));
    let sliding = runs(&|test| measures_of(samples, test, |at| at.state.sliding_ratio));
    let near = runs(&|test| measures_of(samples, test, |at| at.near_limit));
    Sheet {
        title: "Size of the increments (thesis fig. 3.7)".into(),
        subtitle: subtitle(
            samples,
            "Uniaxial compression with μ = 0.3 from a frictionless pack at 10 MPa; secant moduli \
             of intervals of 1e-3.",
        ),
        charts: vec![
            against_stress("Bulk modulus", modulus_axis("bulk modulus K"), bulk),
            against_stress("Shear modulus", modulus_axis("shear modulus G"), shear),
            against_stress(
                "Sliding ratio (at the limit)",
                Axis::linear("share of the contacts", Unit::None),
                sliding,
            ),
            against_stress(
                "Contacts above 0.9 of the limit",
                Axis::linear("share of the contacts", Unit::None),
                near,
            ),
        ],
    }
}

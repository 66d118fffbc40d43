//! T fig. 3.4: shear modulus and sliding ratio while the frictional loads build up.

use graintwin::view::{Axis, Sheet, Unit};

use super::{against_stress, guide, line, measures_of, modulus, modulus_axis, subtitle};
use crate::curve::{Curve, even};
use crate::intervals::by_strain;
use crate::runs::{FINE, Sample, phase_end};

/// Axial strain of the intervals: short, to see the build-up.
const INTERVAL: f64 = 2.5e-4;

/// Sliding ratios between which the thesis' settles.
pub(crate) const THESIS: [f64; 2] = [0.09, 0.11];

pub(super) fn sheet(samples: &[Sample]) -> Sheet {
    let grid = even(10e6, FINE.end, 0.2e6);
    let shear = shear(samples);
    let sliding = measures_of(samples, &FINE, |at| at.state.sliding_ratio);
    let near = measures_of(samples, &FINE, |at| at.near_limit);
    let switch = phase_end(FINE.start).unwrap_or(FINE.start);
    let level = |ratio: f64| vec![[FINE.start, ratio], [FINE.end, ratio]];
    Sheet {
        title: "Build-up of the frictional loads (thesis fig. 3.4)".into(),
        subtitle: subtitle(
            samples,
            "Uniaxial compression with μ = 0.3 in increments of 5e-5 from a frictionless pack at \
             10 MPa; phase (b) ends at 19 MPa.",
        ),
        charts: vec![
            against_stress(
                "Shear modulus",
                modulus_axis("shear modulus G"),
                vec![
                    line(0, "G over intervals of 2.5e-4", &shear, &grid),
                    guide("end of phase (b)", vec![[switch, 0.0], [switch, 2.5e9]]),
                ],
            ),
            against_stress(
                "Sliding ratio",
                Axis::linear("share of the contacts", Unit::None),
                vec![
                    line(0, "at the limit", &sliding, &grid),
                    line(1, "above 0.9 of the limit", &near, &grid),
                    guide("thesis: 0.09 to 0.11", level(THESIS[0])),
                    guide("", level(THESIS[1])),
                    guide("", vec![[switch, 0.0], [switch, 0.6]]),
                ],
            ),
        ],
    }
}

/// G against stress, a curve for each seed.
pub(crate) fn shear(samples: &[Sample]) -> Vec<Curve> {
    let curve = |sample: &Sample| {
        modulus(&by_strain(sample.of(&FINE), INTERVAL), |interval| interval.shear)
    };
    samples.iter().map(curve).collect()
}

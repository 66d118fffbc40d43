//! T figs. 3.5 and 3.8: moduli with friction.

use graintwin::view::{Axis, Series, Sheet, Unit};

use super::smooth;
use super::{
    against_stress, drawn, grid, guide, line, measures_of, medium, moduli_of, modulus_axis,
    subtitle,
};
use crate::curve::{by_place, even};
use crate::intervals::{Interval, between_events};
use crate::runs::{FROM, ROUGH, Sample, Test};
use crate::theory::Slip;

/// Young's moduli between which the thesis' frictional model stays, and the frictionless one
/// \[Pa\].
pub(crate) const YOUNG: [[f64; 2]; 2] = [[1.3e9, 1.5e9], [0.0, 0.6e9]];

/// Highest stress of fig. 3.5 \[Pa\].
const END: f64 = 40e6;

pub(super) fn sheet(samples: &[Sample]) -> Sheet {
    let chart = |title: &str, which: usize, of: fn(&Interval) -> f64| {
        let grid = even(4e6, END, 0.25e6);
        let run = |number, name: &str, test: &Test| {
            line(number, name, &moduli_of(samples, test, of), &grid)
        };
        let mut series = vec![
            run(0, "from 4 MPa, μ = 0.3", &FROM[0]),
            run(1, "from 10 MPa, μ = 0.3", &FROM[1]),
            run(2, "from 10 MPa, μ = 0.5", &ROUGH),
            medium("effective medium, no slip", which, Slip::None, &grid),
        ];
        if which == 1 {
            series.push(medium("free slip", which, Slip::Free, &grid));
        }
        against_stress(title, modulus_axis(title), series)
    };
    Sheet {
        title: "With friction (thesis fig. 3.5)".into(),
        subtitle: subtitle(
            samples,
            "Uniaxial compression in increments of 2e-4 from frictionless packs; secant moduli of \
             intervals of 1e-3. Dashed: effective medium with a solid fraction of 0.64 and 6 \
             contacts.",
        ),
        charts: vec![
            chart("Bulk modulus K", 0, |interval| interval.bulk),
            chart("Shear modulus G", 1, |interval| interval.shear),
        ],
    }
}

/// Three coefficients of friction side by side.
pub(super) fn coefficients(samples: &[Sample]) -> Sheet {
    let grid: Vec<f64> = grid().into_iter().filter(|stress| *stress <= 60e6).collect();
    let runs = |of: fn(&Interval) -> f64| -> Vec<Series> {
        let mut smooth = by_place(&smooth::curves(samples, between_events, of));
        smooth.retain(|(stress, _)| *stress <= 60e6);
        let smooth = drawn(4, "μ = 0", &smooth);
        vec![
            smooth,
            line(0, "μ = 0.3", &moduli_of(samples, &FROM[1], of), &grid),
            line(2, "μ = 0.5", &moduli_of(samples, &ROUGH, of), &grid),
        ]
    };
    let mut young = runs(|interval| interval.young);
    let from_4 = moduli_of(samples, &FROM[0], |interval| interval.young);
    young.push(line(5, "μ = 0.3, from 4 MPa", &from_4, &grid));
    for (name, level) in [("thesis, μ = 0.3: 1.3 to 1.5 GPa", 0), ("", 1)] {
        young.push(guide(name, grid.iter().map(|&stress| [stress, YOUNG[0][level]]).collect()));
    }
    let sliding = [(0, "μ = 0.3", &FROM[1]), (2, "μ = 0.5", &ROUGH)].map(|(number, name, test)| {
        line(number, name, &measures_of(samples, test, |at| at.state.sliding_ratio), &grid)
    });
    Sheet {
        title: "Coefficient of friction (thesis fig. 3.8)".into(),
        subtitle: subtitle(
            samples,
            "Uniaxial compression from a frictionless pack at 10 MPa in increments of 2e-4; without \
             friction as in the figure of the frictionless packs, between rearrangements.",
        ),
        charts: vec![
            against_stress(
                "Bulk modulus K",
                modulus_axis("Bulk modulus K"),
                runs(|interval| interval.bulk),
            ),
            against_stress(
                "Shear modulus G",
                modulus_axis("Shear modulus G"),
                runs(|interval| interval.shear),
            ),
            against_stress("Young's modulus E", modulus_axis("Young's modulus E"), young),
            against_stress(
                "Sliding ratio",
                Axis::linear("share of the contacts", Unit::None),
                sliding.into(),
            ),
        ],
    }
}

//! The figures.

use graintwin::measure::coordination::Histograms;
use graintwin::view::{Axis, Chart, Pattern, Series, Sheet, Unit};

use super::{LATERAL, Networks, Point, STAGES, THESIS_RATIO, curves};
use crate::curve::{Curve, Spread, by_place, even, over_seeds};
use crate::figures::{drawn, guide};

/// Shares of fig. 2.13 (a) and (b).
pub(super) const THESIS: [f64; 2] = [0.28, 0.37];

/// The sheets by the name of their file without its ending.
pub(crate) fn sheets(networks: &[Networks]) -> Vec<(&'static str, Sheet)> {
    vec![
        ("validation_coordination", coordination(networks)),
        ("validation_directions", directions(networks)),
    ]
}

fn subtitle(networks: &[Networks], of: &str) -> String {
    let seeds: Vec<String> = networks.iter().map(|one| one.seed.to_string()).collect();
    format!(
        "2740 glass beads without friction; lines: mean of the seeds {}, bands: lowest to \
         highest. {of}",
        seeds.join(", ")
    )
}

fn coordination(networks: &[Networks]) -> Sheet {
    let chart = |title: &str, of: fn(&Histograms) -> &Vec<u32>| {
        let line = |(stage, stress): (usize, &f64)| {
            let shares = |one: &Networks| shares(of(&one.stages[stage].coordination));
            let curves: Vec<Curve> = networks.iter().map(shares).collect();
            drawn(stage, &format!("{} MPa", stress / 1e6), &padded(&curves))
        };
        Chart {
            title: title.into(),
            x: Axis::count("contacts of a grain"),
            y: Axis::linear("share of the grains", Unit::None),
            series: STAGES.iter().enumerate().map(line).collect(),
            notes: Vec::new(),
        }
    };
    Sheet {
        title: "Coordination numbers (thesis fig. 2.6)".into(),
        subtitle: subtitle(
            networks,
            "Isotropic stress; interior grains are further from every wall than the largest \
             diameter.",
        ),
        charts: vec![
            chart("All grains", |histograms| &histograms.all),
            chart("Interior grains", |histograms| &histograms.interior),
        ],
    }
}

/// Share of the grains with each number of contacts.
fn shares(counts: &[u32]) -> Curve {
    let all = counts.iter().sum::<u32>();
    let share =
        |(number, &count): (usize, &u32)| [number as f64, f64::from(count) / f64::from(all)];
    counts.iter().enumerate().map(share).collect()
}

/// [`by_place`] of curves that count on as long as any of them does.
fn padded(curves: &[Curve]) -> Vec<(f64, Spread)> {
    let longest = curves.iter().map(Vec::len).max().unwrap_or(0);
    let longer = |curve: &Curve| -> Curve {
        let more = (curve.len()..longest).map(|number| [number as f64, 0.0]);
        curve.iter().copied().chain(more).collect()
    };
    by_place(&curves.iter().map(longer).collect::<Vec<_>>())
}

fn directions(networks: &[Networks]) -> Sheet {
    let end = networks.iter().flat_map(|one| &one.axial).flatten().map(|at| at.ratio);
    let end = end.fold(0.0, f64::max);
    let grid = even(0.0, end, 0.004);
    let lines = |of: &dyn Fn(&Point) -> f64| -> Vec<Series> {
        let line = |(number, lateral): (usize, &f64)| {
            let curves = curves(networks, number, of);
            let name = format!("lateral stress {} MPa", lateral / 1e6);
            drawn(number, &name, &over_seeds(&curves, &grid))
        };
        LATERAL.iter().enumerate().map(line).collect()
    };
    let chart = |title: &str, y: &str, series: Vec<Series>| Chart {
        title: title.into(),
        x: Axis::linear("axial minus lateral over mean stress", Unit::None),
        y: Axis::linear(y, Unit::None),
        series,
        notes: Vec::new(),
    };
    let mut share = lines(&|at| at.fabric.directions.cone_largest[2]);
    let ratio = 3.0 * (THESIS_RATIO - 1.0) / (THESIS_RATIO + 2.0);
    let mut thesis = guide("thesis, (a) and (b)", vec![[0.0, THESIS[0]], [ratio, THESIS[1]]]);
    thesis.stroke.pattern = Pattern::Dots;
    thesis.stroke.width = 3.0;
    share.push(thesis);
    share
        .push(guide("all directions alike", [0.0, end].map(|at| [at, 1.0 - 0.5f64.sqrt()]).into()));
    let all = lines(&|at| at.fabric.directions.cone_all[2]);
    Sheet {
        title: "Directions of the largest forces (thesis fig. 2.13)".into(),
        subtitle: subtitle(
            networks,
            "Isotropic stress, then axial strain while the side walls carry the lateral stress. \
             Contacts between grains within 45° of the axis.",
        ),
        charts: vec![
            chart("Largest 10 % of the forces", "share within 45° of z", share),
            chart("All contacts", "share within 45° of z", all),
            chart(
                "Anisotropy of the normal forces",
                "a_n",
                lines(&|at| at.fabric.directions.normal_anisotropy),
            ),
            chart(
                "Anisotropy of the contacts",
                "a_c",
                lines(&|at| at.fabric.directions.contact_anisotropy),
            ),
        ],
    }
}

//! How far the force network reaches, and how many contacts its grains have.

use super::strain::Strain;
use crate::msg::Fabric;
use crate::view::chart::{Chart, Series};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// The weakest contact of the strongest path between opposite walls, over the mean force.
pub(super) fn strongest_paths(run: &Run, strain: &Strain) -> Chart {
    let line = |(axis, name): (usize, &str)| {
        let point = |fabric: &Fabric| {
            let force = fabric.strongest_path[axis] / fabric.mean_normal_force;
            [strain.at(fabric.increment), force]
        };
        Series::new(axis, name, run.fabrics.iter().map(point))
    };
    let axes = if run.is_plane() { 2 } else { 3 };
    let threshold = |fabric: &Fabric| {
        [strain.at(fabric.increment), fabric.chain_threshold / fabric.mean_normal_force]
    };
    let mut series: Vec<Series> =
        ["along x", "along y", "along z"].into_iter().take(axes).enumerate().map(line).collect();
    let chains = run.fabrics.iter().map(threshold).collect();
    series.push(super::fabric::guide("#57606a", "least force of the force chains", chains));
    Chart {
        title: format!("Strongest path from wall to wall against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("weakest normal force over the mean", Unit::None),
        series,
        notes: Vec::new(),
    }
}

/// Share of the grains with each number of contacts, at the start and at the end.
pub(super) fn coordination(run: &Run) -> Chart {
    let shares = |counts: &[u32]| -> Vec<[f64; 2]> {
        let all = counts.iter().map(|&count| f64::from(count)).sum::<f64>();
        let share = |(number, &count): (usize, &u32)| [number as f64, f64::from(count) / all];
        counts.iter().enumerate().map(share).collect()
    };
    let ends = super::contacts::ends(&run.fabrics);
    let lines = ends.iter().enumerate().flat_map(|(number, fabric)| {
        let name = |which: &str| format!("{which}, increment {}", fabric.increment);
        [
            Series::new(2 * number, &name("all grains"), shares(&fabric.coordination)),
            Series::new(2 * number + 1, &name("interior"), shares(&fabric.interior_coordination)),
        ]
    });
    Chart {
        title: "Coordination numbers".into(),
        x: Axis::count("contacts of a grain"),
        y: Axis::linear("share of the grains", Unit::None),
        series: lines.collect(),
        notes: vec!["Interior: further from every wall than the largest grain's diameter.".into()],
    }
}

/// How much of their friction contacts have used up, at the end.
pub(super) fn mobilised(run: &Run) -> Chart {
    let last = run.fabrics.last().filter(|fabric| fabric.mean_tangential_force > 0.0);
    let density = |fabric: &Fabric| {
        let counts = &fabric.mobilised_histogram;
        let width = 1.0 / counts.len().max(1) as f64;
        let all = counts.iter().map(|&count| f64::from(count)).sum::<f64>();
        let place = |(bin, &count): (usize, &u32)| {
            [(bin as f64 + 0.5) * width, f64::from(count) / (all * width)]
        };
        Series::new(0, "", counts.iter().enumerate().map(place).collect::<Vec<_>>())
    };
    let end = last.map_or(0, |fabric| fabric.increment);
    Chart {
        title: format!("Mobilised friction, increment {end}"),
        x: Axis::linear("tangential force over its limit μP", Unit::None),
        y: Axis::linear("probability density", Unit::None),
        series: last.map(density).into_iter().collect(),
        notes: vec!["All contacts; the last bin holds those beyond the limit, too.".into()],
    }
}

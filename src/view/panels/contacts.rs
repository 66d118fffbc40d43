//! How the contact forces are distributed.

use super::fabric::guide;
use crate::measure::fabric::distribution::FORCE_BIN;
use crate::msg::Fabric;
use crate::view::chart::{Chart, Series};
use crate::view::forces::density;
use crate::view::run::{Forces, Run};
use crate::view::scale::Axis;
use crate::view::unit::Unit;

const NEWTON: Unit = Unit::Si("N");

/// Distribution of the normal forces, at the start and at the end, and from where on they make the
/// force chains. Without networks that of the histograms is shown.
pub(super) fn normal(run: &Run) -> Chart {
    let mut chart = distribution(run, "normal", |forces| &forces.normal);
    if chart.series.is_empty() {
        chart.series = ends(&run.fabrics).iter().enumerate().map(histogram).collect();
    }
    chart.series.extend(run.fabrics.last().and_then(|last| chains(last, &chart)));
    chart
}

/// The first and the last of them.
pub(super) fn ends(fabrics: &[Fabric]) -> Vec<&Fabric> {
    let last = fabrics.last().filter(|_| fabrics.len() > 1);
    fabrics.first().into_iter().chain(last).collect()
}

fn histogram((number, fabric): (usize, &&Fabric)) -> Series {
    let counts = &fabric.force_histogram;
    let all = counts.iter().map(|&count| f64::from(count)).sum::<f64>();
    let place = |(bin, &count): (usize, &u32)| {
        let density = f64::from(count) / (all * FORCE_BIN);
        [(bin as f64 + 0.5) * FORCE_BIN, if count == 0 { f64::NAN } else { density }]
    };
    // The last bin has no end.
    let places = counts.iter().enumerate().map(place).take(counts.len().saturating_sub(1));
    let name = format!("increment {} ({} contacts)", fabric.increment, fabric.contacts);
    Series::new(number, &name, places)
}

/// The least force of the force chains, across the height of `chart`.
fn chains(fabric: &Fabric, chart: &Chart) -> Option<Series> {
    let places = chart.series.iter().flat_map(|series| &series.points);
    let densities = places.map(|[_, density]| *density).filter(|density| density.is_finite());
    let (low, high) = densities.fold((f64::INFINITY, 0.0_f64), |(low, high), density| {
        (low.min(density), high.max(density))
    });
    let at = fabric.chain_threshold / fabric.mean_normal_force;
    let name = format!("largest {} % of the forces", 100.0 * fabric.chain_share);
    (low < high).then(|| guide("#57606a", &name, vec![[at, low], [at, high]]))
}

/// Distribution of the magnitudes of the tangential forces; without a series when no contact
/// carried any.
pub(super) fn tangential(run: &Run) -> Chart {
    distribution(run, "tangential", |forces| &forces.tangential)
}

fn distribution(run: &Run, which: &str, of: fn(&Forces) -> &Vec<f64>) -> Chart {
    let networks = run.networks.as_ref().map_or(&[][..], |both| match both {
        [first, last] if first.increment == last.increment => &both[..1],
        _ => &both[..],
    });
    let line = |(number, forces): (usize, &Forces)| {
        let name = format!("increment {} ({} contacts)", forces.increment, of(forces).len());
        Series::new(number, &name, density(of(forces)))
    };
    let mean = |forces: &Forces| {
        let mean = of(forces).iter().sum::<f64>() / of(forces).len() as f64;
        let increment = forces.increment;
        (mean > 0.0).then(|| format!("{} at increment {increment}", NEWTON.written(mean)))
    };
    let means: Vec<String> = networks.iter().filter_map(mean).collect();
    let notes = match means.is_empty() {
        true => Vec::new(),
        false => vec![format!("Mean {which} force: {}.", means.join(", "))],
    };
    Chart {
        title: format!("Distribution of {which} contact forces"),
        x: Axis::linear(&format!("{which} force f over its mean"), Unit::None),
        y: Axis::log("probability density P(f)"),
        series: networks.iter().enumerate().map(line).collect(),
        notes,
    }
}

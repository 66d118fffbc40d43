//! How the contact forces are distributed.

use crate::view::chart::{Chart, Series};
use crate::view::forces::density;
use crate::view::run::{Forces, Run};
use crate::view::scale::Axis;
use crate::view::unit::Unit;

const NEWTON: Unit = Unit::Si("N");

/// Distribution of the normal forces, at the start and at the end.
pub(super) fn normal(run: &Run) -> Chart {
    distribution(run, "normal", |forces| &forces.normal)
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

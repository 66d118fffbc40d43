//! How the contact forces are distributed.

use crate::view::chart::{Chart, Series};
use crate::view::forces::density;
use crate::view::history::{Forces, History};
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Distribution of the normal forces, at the start and at the end.
pub(super) fn normal(history: &History) -> Chart {
    distribution(history, "normal", |forces| &forces.normal)
}

/// Distribution of the magnitudes of the tangential forces; without a series when no contact
/// carried any.
pub(super) fn tangential(history: &History) -> Chart {
    distribution(history, "tangential", |forces| &forces.tangential)
}

fn distribution(history: &History, which: &str, of: fn(&Forces) -> &Vec<f64>) -> Chart {
    let networks = history.networks.as_ref().map_or(&[][..], |both| match both {
        [first, last] if first.increment == last.increment => &both[..1],
        _ => &both[..],
    });
    let line = |(number, forces): (usize, &Forces)| {
        let name = format!("increment {} ({} contacts)", forces.increment, of(forces).len());
        Series::new(number, &name, density(of(forces)))
    };
    let mean = |forces: &Forces| of(forces).iter().sum::<f64>() / of(forces).len() as f64;
    let means = networks.iter().filter(|forces| !of(forces).is_empty());
    let means =
        means.map(|forces| format!("{:.3e} N at increment {}", mean(forces), forces.increment));
    let means: Vec<String> = means.collect();
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

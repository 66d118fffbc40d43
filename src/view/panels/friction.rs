//! What friction did.

use super::strain::Strain;
use crate::msg::PackState;
use crate::view::chart::{Chart, Series};
use crate::view::run::{Load, Run};
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Share of the contacts that slide, and how large the tangential forces are beside the normal
/// ones. Without a series when no contact ever carried a tangential force.
pub(super) fn mobilised(run: &Run, strain: &Strain) -> Chart {
    let sliding = |state: &PackState| [strain.at(state.increment), state.sliding_ratio];
    let load = |load: &Load| [strain.at(load.increment), load.tangential / load.normal];
    let rubs = run.loads.iter().any(|load| load.tangential > 0.0)
        || run.states.iter().any(|state| state.sliding_ratio > 0.0);
    let series = || {
        vec![
            Series::new(0, "sliding ratio", run.states.iter().map(sliding)),
            Series::new(1, "tangential over normal force", run.loads.iter().map(load)),
        ]
    };
    Chart {
        title: format!("Friction against {}", strain.name()),
        x: strain.axis(),
        y: Axis::linear("ratio", Unit::None),
        series: if rubs { series() } else { Vec::new() },
        notes: vec![
            "Sliding: contacts at the limit of friction, over all. Forces: sums over the contacts."
                .into(),
        ],
    }
}

//! Where the pack lost its stability.

use std::collections::BTreeMap;

use super::strain::Strain;
use crate::msg::PackState;
use crate::view::chart::{Pattern, Series, Stroke};
use crate::view::run::Run;

const MARK: Stroke = Stroke { color: "#a50f15", width: 2.4, pattern: Pattern::Dots };

/// A mark on the confining stress of each increment with an event; none where there is no event.
pub(super) fn marks(run: &Run, strain: &Strain) -> Option<Series> {
    let stress: BTreeMap<u64, f64> =
        run.states.iter().map(|state| (state.increment, state.confining_stress)).collect();
    let mark = |&increment: &u64| {
        let stress = stress.get(&increment).copied().unwrap_or(f64::NAN);
        [strain.at(increment), stress]
    };
    let marks = Series { stroke: MARK, ..Series::new(2, "event", run.eventful.iter().map(mark)) };
    (!run.eventful.is_empty()).then_some(marks)
}

/// Energy that events released up to each increment \[J\]; none where no recording tells it.
pub(super) fn released(run: &Run, strain: &Strain) -> Option<Series> {
    let mut left = run.released.iter().peekable();
    let mut sum = 0.0;
    let point = |state: &PackState| {
        while let Some((_, energy)) = left.next_if(|(at, _)| *at <= state.increment) {
            sum += energy;
        }
        [strain.at(state.increment), sum]
    };
    let mut series = Series::new(3, "released in events", run.states.iter().map(point));
    // Without friction it lies on what was dissipated.
    series.stroke.pattern = Pattern::Dashed;
    (!run.released.is_empty()).then_some(series)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_events_released_adds_up_and_stays() {
        let state = |increment| PackState { increment, ..PackState::default() };
        let run = Run {
            states: [0, 1, 2, 4].map(state).to_vec(),
            // The state of increment 3 was not recorded.
            released: vec![(1, 2.0), (3, 0.5)],
            ..Run::default()
        };
        let strain = Strain::of(&run);
        let series = released(&run, &strain).unwrap();
        assert_eq!(series.points, [[0.0, 0.0], [1.0, 2.0], [2.0, 2.0], [4.0, 2.5]]);
        assert!(released(&Run::default(), &strain).is_none());
        assert!(marks(&Run::default(), &strain).is_none());
    }
}

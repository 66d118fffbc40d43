//! Leaves out what would flatten all the rest of a chart.

use crate::view::chart::{Chart, Series};

/// Share of the values at either end that do not count as typical.
const TAIL: f64 = 0.1;

/// How far beyond the typical values others may lie, over the largest of them, at least.
const MARGIN: f64 = 0.5;

/// Takes the values far beyond the typical ones of every line out of `chart`, and notes how many
/// they are, between which they lie, and `why` there are such.
pub(super) fn keep_typical(chart: &mut Chart, why: &str) {
    let ranges = chart.series.iter().filter_map(range);
    let Some((low, high)) = ranges.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))) else { return };
    let mut out = Vec::new();
    for [_, value] in chart.series.iter_mut().flat_map(|series| &mut series.points) {
        if value.is_finite() && !(low..=high).contains(value) {
            out.push(*value);
            *value = f64::NAN;
        }
    }
    let (least, most) = extremes(&out);
    let text = |value: f64| chart.y.unit.written(value);
    let values = match out.len() {
        0 => return,
        1 => format!("1 value ({})", text(least)),
        count => format!("{count} values ({} to {})", text(least), text(most)),
    };
    chart.notes.push(format!("Left out, far beyond the others: {values}. {why}"));
}

/// The typical values of a line with as much room again on both sides.
fn range(series: &Series) -> Option<(f64, f64)> {
    let values = series.points.iter().map(|point| point[1]).filter(|value| value.is_finite());
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    let tail = (TAIL * last as f64).round() as usize;
    let (low, high) = (values[tail], values[last - tail]);
    let room = (high - low).max(MARGIN * low.abs().max(high.abs()));
    Some((low - room, high + room))
}

fn extremes(values: &[f64]) -> (f64, f64) {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    (least, values.iter().copied().fold(f64::NEG_INFINITY, f64::max))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::scale::Axis;
    use crate::view::unit::Unit;

    fn chart(values: impl IntoIterator<Item = f64>) -> Chart {
        let points = values.into_iter().enumerate().map(|(number, value)| [number as f64, value]);
        Chart {
            title: String::new(),
            x: Axis::count("x"),
            y: Axis::linear("y", Unit::Si("Pa")),
            series: vec![Series::new(0, "G", points)],
            notes: Vec::new(),
        }
    }

    fn kept(chart: &Chart) -> usize {
        chart.series[0].points.iter().filter(|point| point[1].is_finite()).count()
    }

    #[test]
    fn spikes_are_left_out_and_told_of() {
        let value = |at: u32| match at {
            20 => 1.5e12,
            40 => -7e9,
            _ => 80e6 + 1e5 * f64::from(at),
        };
        let mut chart = chart((0..60).map(value));
        keep_typical(&mut chart, "The strain turns.");
        assert_eq!(kept(&chart), 58);
        assert_eq!(
            chart.notes,
            [
                "Left out, far beyond the others: 2 values (−7.000 GPa to 1.500 TPa). The strain turns."
            ]
        );
    }

    #[test]
    fn growth_steps_and_few_points_stay_whole() {
        let growth = (0..100).map(|at| f64::from(at).powi(3));
        let step = (0..40).map(|at| if at < 20 { 4e9 } else { 1e9 });
        for values in
            [growth.collect::<Vec<_>>(), step.collect(), vec![1.0, 1e6], vec![5.0], vec![]]
        {
            let mut chart = chart(values.clone());
            keep_typical(&mut chart, "");
            assert_eq!(kept(&chart), values.len());
            assert!(chart.notes.is_empty());
        }
    }

    #[test]
    fn a_value_far_from_its_own_line_but_near_another_stays() {
        let mut chart = chart([1.0; 30]);
        chart.series[0].points[7][1] = 9.0;
        chart.series.push(Series::new(1, "E", (0..30).map(|at| [f64::from(at), 10.0])));
        keep_typical(&mut chart, "");
        assert_eq!(kept(&chart), 30);
    }
}

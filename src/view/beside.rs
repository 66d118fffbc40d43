//! Measurements with what theory predicts beside them: unbroken and dashed in one colour.

use super::{Pattern, Series, Stroke};

/// A quantity of a test.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// Its name in the legend.
    pub name: String,
    /// Places as they were measured, in the units of the axes.
    pub measured: Vec<[f64; 2]>,
    /// Places of the theory's line; none when it says nothing.
    pub predicted: Vec<[f64; 2]>,
}

/// The lines of a chart of these quantities, in their order.
#[must_use]
pub fn lines(quantities: &[Beside]) -> Vec<Series> {
    let pair = |(number, quantity): (usize, &Beside)| {
        let stroke = Stroke { pattern: Pattern::Dashed, width: 1.4, ..Stroke::of(number) };
        let predicted = quantity.predicted.iter().copied();
        let measured = Series::new(number, &quantity.name, quantity.measured.iter().copied());
        let predicted = Series { stroke, ..Series::new(number, "", predicted) };
        [measured, predicted].into_iter().filter(|series| !series.points.is_empty())
    };
    quantities.iter().enumerate().flat_map(pair).collect()
}

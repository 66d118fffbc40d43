//! Curves of several seeds, their mean and spread.

use std::fmt;

/// Places in rising x.
pub(crate) type Curve = Vec<[f64; 2]>;

/// y of `curve` at `x`, linear between its places; NaN beyond its ends.
pub(crate) fn at(curve: &[[f64; 2]], x: f64) -> f64 {
    let between = curve.windows(2).find(|pair| pair[0][0] <= x && x <= pair[1][0]);
    between.map_or(f64::NAN, |pair| {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        if x1 > x0 { y0 + (x - x0) / (x1 - x0) * (y1 - y0) } else { y0 }
    })
}

/// A number of several seeds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Spread {
    /// Of one number a seed; NaN when one is missing.
    pub(crate) fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { mean, low, high }
    }

    /// In another unit.
    pub(crate) fn over(self, unit: f64) -> Self {
        Self { mean: self.mean / unit, low: self.low / unit, high: self.high / unit }
    }
}

impl fmt::Display for Spread {
    /// Mean and range, with the decimals asked for.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let Self { mean, low, high } = self;
        write!(f, "{mean:.digits$} [{low:.digits$}, {high:.digits$}]")
    }
}

/// The curves of all seeds at the places `grid`, where all have a value.
pub(crate) fn over_seeds(curves: &[Curve], grid: &[f64]) -> Vec<(f64, Spread)> {
    let spread = |x: &f64| (*x, Spread::of(curves.iter().map(|curve| at(curve, *x))));
    grid.iter().map(spread).filter(|(_, spread)| spread.mean.is_finite()).collect()
}

/// Curves whose places correspond: the mean of each place and the spread of its values.
pub(crate) fn by_place(curves: &[Curve]) -> Vec<(f64, Spread)> {
    let places = curves.iter().map(Vec::len).min().unwrap_or(0);
    let place = |k: usize| {
        let x = Spread::of(curves.iter().map(|curve| curve[k][0])).mean;
        (x, Spread::of(curves.iter().map(|curve| curve[k][1])))
    };
    (0..places).map(place).collect()
}

/// Numbers from `low` to `high` in steps of `step`.
pub(crate) fn even(low: f64, high: f64, step: f64) -> Vec<f64> {
    let count = ((high - low) / step).round() as usize;
    (0..=count).map(|k| low + k as f64 * step).collect()
}

/// Exponent of the power law through the places of `curve` with x from `low` to `high`, by least
/// squares of the logarithms.
pub(crate) fn exponent(curve: &[[f64; 2]], low: f64, high: f64) -> f64 {
    let inside = curve.iter().filter(|[x, y]| (low..=high).contains(x) && *y > 0.0);
    let logs: Vec<[f64; 2]> = inside.map(|at| at.map(f64::ln)).collect();
    let mean = |which: usize| logs.iter().map(|log| log[which]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let above: f64 = logs.iter().map(|log| (log[0] - x) * (log[1] - y)).sum();
    let below: f64 = logs.iter().map(|log| (log[0] - x).powi(2)).sum();
    above / below
}

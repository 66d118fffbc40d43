//! The straight line of least squares.

/// y = intercept + slope x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// dy/dx.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
    /// Root of the mean square of what is left.
    pub residual: f64,
}

/// The line through `points`, x and y; nothing unless two of them differ in x.
#[must_use]
pub fn line(points: &[[f64; 2]]) -> Option<Line> {
    let share = 1.0 / points.len() as f64;
    let [x, y] = [0, 1].map(|k| points.iter().map(|point| point[k] * share).sum::<f64>());
    let spread = points.iter().map(|point| (point[0] - x).powi(2)).sum::<f64>();
    let common = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum::<f64>();
    let slope = common / spread;
    (spread > 0.0 && slope.is_finite()).then(|| fitted(points, slope, y - slope * x))
}

/// The line through `points` and the origin; nothing when all x are 0.
#[must_use]
pub fn through_origin(points: &[[f64; 2]]) -> Option<Line> {
    let [mut xx, mut xy] = [0.0; 2];
    for [x, y] in points {
        xx += x * x;
        xy += x * y;
    }
    let slope = xy / xx;
    (xx > 0.0 && slope.is_finite()).then(|| fitted(points, slope, 0.0))
}

fn fitted(points: &[[f64; 2]], slope: f64, intercept: f64) -> Line {
    let squares = points.iter().map(|[x, y]| (y - intercept - slope * x).powi(2));
    let residual = (squares.sum::<f64>() / points.len() as f64).sqrt();
    Line { slope, intercept, residual }
}

//! Axes, and how values become places on them.

use super::ticks::Ticks;
use super::unit::Unit;

/// How an axis is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Evenly.
    Linear,
    /// Evenly, in whole numbers.
    Count,
    /// By powers of ten; what is not positive has no place.
    Log,
    /// Evenly, both axes of the chart alike: a circle is round.
    Plane,
}

/// An axis of a chart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// What is on it, without the unit.
    pub label: String,
    /// Unit of the values.
    pub unit: Unit,
    /// How it is divided.
    pub kind: Kind,
}

/// Larger magnitudes have no place on any axis.
const LARGEST: f64 = 1e30;

/// Smallest place on a logarithmic axis.
const SMALLEST: f64 = 1e-300;

/// Zero is shown when the data begins below this share of its height.
const NEAR_ZERO: f64 = 0.4;

/// Data beyond zero by a smaller share of the rest ends at zero: it is a rounding, or would not be
/// seen.
const NEGLIGIBLE: f64 = 1e-3;

impl Axis {
    /// An evenly divided axis.
    #[must_use]
    pub fn linear(label: &str, unit: Unit) -> Self {
        Self { label: label.into(), unit, kind: Kind::Linear }
    }

    /// An axis of whole numbers.
    #[must_use]
    pub fn count(label: &str) -> Self {
        Self { label: label.into(), unit: Unit::None, kind: Kind::Count }
    }

    /// A logarithmic axis of pure numbers.
    #[must_use]
    pub fn log(label: &str) -> Self {
        Self { label: label.into(), unit: Unit::None, kind: Kind::Log }
    }

    /// One of two axes that a plane is seen over.
    #[must_use]
    pub fn plane(label: &str, unit: Unit) -> Self {
        Self { label: label.into(), unit, kind: Kind::Plane }
    }

    /// Whether `value` has a place.
    #[must_use]
    pub fn takes(&self, value: f64) -> bool {
        match self.kind {
            Kind::Linear | Kind::Count | Kind::Plane => value.abs() <= LARGEST,
            Kind::Log => (SMALLEST..=LARGEST).contains(&value),
        }
    }
}

/// An axis fitted to data.
pub(super) struct Scale {
    /// Label with its unit.
    pub(super) title: String,
    pub(super) ticks: Ticks,
    factor: f64,
    log: bool,
}

impl Scale {
    /// For `values`, all of which the axis takes; `None` when there are none.
    pub(super) fn fit(axis: &Axis, values: impl Iterator<Item = f64>, about: u32) -> Option<Self> {
        let (low, high) = values.fold(None, |range: Option<(f64, f64)>, value| {
            let (low, high) = range.unwrap_or((value, value));
            Some((low.min(value), high.max(value)))
        })?;
        let (factor, unit) = match axis.kind {
            Kind::Log => (1.0, axis.unit.name().to_owned()),
            _ => axis.unit.for_magnitude(low.abs().max(high.abs())),
        };
        let (low, high) = (low / factor, high / factor);
        let (from, to) = with_zero(low, high);
        let ticks = match axis.kind {
            Kind::Linear | Kind::Plane => Ticks::linear(from, to, about),
            Kind::Count => Ticks::whole(from, to, about),
            Kind::Log => Ticks::decades(low, high),
        };
        let title = match unit.as_str() {
            "" => axis.label.clone(),
            unit => format!("{} [{unit}]", axis.label),
        };
        Some(Self { title, ticks, factor, log: axis.kind == Kind::Log })
    }

    /// Where `value` is between the first tick, 0, and the last, 1.
    pub(super) fn place(&self, value: f64) -> f64 {
        self.place_of_tick(value / self.factor)
    }

    /// From the first tick to the last, in the unit of the values.
    pub(super) fn span(&self) -> f64 {
        let (first, last) = self.ticks.range();
        (last - first) * self.factor
    }

    /// Where a tick is.
    pub(super) fn place_of_tick(&self, value: f64) -> f64 {
        let (first, last) = self.ticks.range();
        if self.log {
            (value / first).log10() / (last / first).log10()
        } else {
            (value - first) / (last - first)
        }
    }
}

fn with_zero(low: f64, high: f64) -> (f64, f64) {
    if low > -NEGLIGIBLE * high && low < NEAR_ZERO * high {
        (0.0, high)
    } else if high < -NEGLIGIBLE * low && high > NEAR_ZERO * low {
        (low, 0.0)
    } else {
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_begins_at_zero_when_the_data_all_but_does() {
        let range = |values: [f64; 2]| {
            let axis = Axis::linear("y", Unit::None);
            Scale::fit(&axis, values.into_iter(), 5).map(|scale| scale.ticks.range())
        };
        assert_eq!(range([-1e-4, 10.0]), Some((0.0, 10.0)));
        assert_eq!(range([3.0, 10.0]), Some((0.0, 10.0)));
        assert_eq!(range([-0.1, 10.0]), Some((-2.0, 10.0)));
        assert_eq!(range([-10.0, 1e-4]), Some((-10.0, 0.0)));
        assert_eq!(range([-10.0, 0.1]), Some((-10.0, 2.0)));
        assert_eq!(range([0.0, 0.0]), Some((-1.0, 1.0)));
    }
}

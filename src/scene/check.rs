//! Collecting what is wrong with a scene: fields, and the ranges that values must keep.

use std::fmt;

use crate::wall::Bounds;

/// The way from the root of the scene to a value.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Field(pub(super) Vec<Segment>);

/// One step of that way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Segment {
    Key(String),
    Index(usize),
}

impl Field {
    pub(super) fn root() -> Self {
        Self::default()
    }

    pub(super) fn key(&self, key: &str) -> Self {
        self.with(Segment::Key(key.into()))
    }

    pub(super) fn index(&self, index: usize) -> Self {
        self.with(Segment::Index(index))
    }

    fn with(&self, segment: Segment) -> Self {
        let mut segments = self.0.clone();
        segments.push(segment);
        Self(segments)
    }
}

impl fmt::Display for Field {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Key(key) if place == 0 => write!(to, "{key}")?,
                Segment::Key(key) => write!(to, ".{key}")?,
                Segment::Index(index) => write!(to, "[{index}]")?,
            }
        }
        Ok(())
    }
}

/// Everything that was found so far.
#[derive(Debug, Default)]
pub(super) struct Problems(pub(super) Vec<(Field, String)>);

impl Problems {
    pub(super) fn add(&mut self, field: Field, text: impl Into<String>) {
        self.0.push((field, text.into()));
    }

    /// A number that must be finite and `inside`; `allowed` says the same in words.
    pub(super) fn number(
        &mut self,
        field: Field,
        value: f64,
        allowed: &str,
        inside: impl Fn(f64) -> bool,
    ) {
        if !value.is_finite() {
            self.add(field, format!("{value} is not a finite number; allowed: {allowed}"));
        } else if !inside(value) {
            self.add(field, format!("{value:?} is outside {allowed}"));
        }
    }

    pub(super) fn positive(&mut self, field: Field, value: f64, allowed: &str) {
        self.number(field, value, allowed, |value| value > 0.0);
    }

    /// A number from 0 on; infinity is one of them.
    pub(super) fn at_least_zero(&mut self, field: Field, value: f64, allowed: &str) {
        if value.is_nan() || value < 0.0 {
            self.add(field, format!("{value:?} is outside {allowed}"));
        }
    }

    /// A whole number between `low` and `high`.
    pub(super) fn count(&mut self, field: Field, value: u64, low: u64, high: u64) {
        if !(low..=high).contains(&value) {
            self.add(field, format!("{value} is outside {low} to {high}"));
        }
    }

    /// Finite components.
    pub(super) fn finite(&mut self, field: &Field, values: &[f64]) {
        for (index, &value) in values.iter().enumerate() {
            self.number(field.index(index), value, "a finite number", |_| true);
        }
    }

    /// A box with a volume.
    pub(super) fn bounds(&mut self, field: &Field, bounds: &Bounds) {
        let before = self.0.len();
        self.finite(&field.key("min"), &bounds.min);
        self.finite(&field.key("max"), &bounds.max);
        if self.0.len() > before {
            return;
        }
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let (min, max) = (bounds.min[axis], bounds.max[axis]);
            if min >= max {
                let text = format!("{name}: {max:?} is outside max > min = {min:?}");
                self.add(field.key("max").index(axis), text);
            }
        }
    }
}

//! Colours for numbers: viridis, which rises evenly in lightness and is told apart by those who
//! see red and green alike.

use crate::msg::picture::ColorRGBA;

/// Every eighth of viridis (S. van der Walt and N. Smith, CC0), from its first colour to its last;
/// straight lines between them miss it by 0.07 at most.
const VIRIDIS: [[f32; 3]; 9] = [
    [0.267, 0.005, 0.329],
    [0.279, 0.175, 0.483],
    [0.230, 0.322, 0.546],
    [0.173, 0.449, 0.558],
    [0.128, 0.567, 0.551],
    [0.154, 0.680, 0.504],
    [0.361, 0.786, 0.388],
    [0.668, 0.862, 0.196],
    [0.993, 0.906, 0.144],
];

/// Shades between the two ends: more are not told apart, and fewer repeat more often, which
/// compresses.
const SHADES: f32 = 128.0;

/// Gives colours to the numbers of a range.
pub(super) struct Colormap {
    low: f64,
    high: f64,
    opacity: f32,
}

impl Colormap {
    /// From `low` to `high`; numbers outside have the colour of the nearer end.
    pub(super) fn new([low, high]: [f64; 2], opacity: f64) -> Self {
        Self { low, high, opacity: opacity as f32 }
    }

    /// That of `value`; what is no number has the first.
    pub(super) fn color(&self, value: f64) -> ColorRGBA {
        let value = if value.is_nan() { self.low } else { value };
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0) as f32;
        let at = (share * SHADES).round() / SHADES * (VIRIDIS.len() - 1) as f32;
        let below = (at as usize).min(VIRIDIS.len() - 2);
        let [low, high] = [VIRIDIS[below], VIRIDIS[below + 1]];
        let part = at - below as f32;
        let [r, g, b] = std::array::from_fn(|c| low[c] + part * (high[c] - low[c]));
        ColorRGBA { r, g, b, a: self.opacity }
    }
}

/// From 0 to three times the mean of `values`: contact forces fall off exponentially, and hardly
/// any grain lies above. Where the mean is 0, from 0 to 1. What is not a number does not count.
pub(super) fn range_of(values: &[f64]) -> [f64; 2] {
    let known = || values.iter().filter(|value| !value.is_nan());
    let mean = known().sum::<f64>() / known().count().max(1) as f64;
    [0.0, if mean > 0.0 { 3.0 * mean } else { 1.0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_the_range_have_the_first_and_the_last_colour_and_so_has_what_lies_beyond() {
        let map = Colormap::new([2.0, 4.0], 0.5);
        let color = |[r, g, b]: [f32; 3]| ColorRGBA { r, g, b, a: 0.5 };
        for value in [f64::NEG_INFINITY, 1.9, 2.0, f64::NAN] {
            assert_eq!(map.color(value), color([0.267, 0.005, 0.329]));
        }
        for value in [4.0, 4.1, f64::INFINITY] {
            let ColorRGBA { r, g, b, .. } = map.color(value);
            for (found, last) in [r, g, b].into_iter().zip([0.993, 0.906, 0.144]) {
                assert!((found - last).abs() < 1e-6);
            }
        }
    }

    /// Lightness in the sense of the luma of Rec. 709.
    #[test]
    fn colours_grow_lighter_from_one_end_to_the_other() {
        let map = Colormap::new([0.0, 1.0], 1.0);
        let luma = |step: u32| {
            let ColorRGBA { r, g, b, .. } = map.color(f64::from(step) / 50.0);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        assert!((0..50).all(|step| luma(step) < luma(step + 1)));
    }
}

//! Grains as spheres: a list of spheres has one size for all, so grains are binned by radius.

use super::Canvas;
use super::colormap::{Colormap, range_of};
use crate::msg::picture::Marker;
use crate::report::Grains;
use crate::scene::{Choice, View};

/// Fewest and most bins of radii that differ.
const BINS: [usize; 2] = [6, 16];

/// Width of a bin over the largest radius, where the number of bins allows it.
const WIDTH: f64 = 0.03;

/// Depth of a disc over its diameter: the lines of the chains stay in sight above it.
const FLAT: f64 = 0.02;

/// Radii that differ by less than this share are equal.
const EQUAL: f64 = 1e-6;

/// One marker a bin, from the smallest radius to the largest; bins without a grain are deleted.
/// Each sphere is as large as the middle of its bin, and coloured by its number in `values`.
pub(super) fn spheres(
    canvas: &Canvas,
    view: &View,
    grains: &Grains,
    values: &[f64],
) -> Vec<Marker> {
    let range = match view.range {
        Choice::Given(range) => range,
        Choice::Auto => range_of(values),
    };
    let colors = Colormap::new(range, view.opacity);
    let bins = Bins::of(&grains.radius);
    let mut markers: Vec<Marker> = (0..bins.count)
        .map(|bin| {
            let diameter = 2.0 * bins.middle(bin) * canvas.scale;
            let mut marker = canvas.marker("spheres", bin, Marker::SPHERE_LIST);
            let depth = if canvas.plane { FLAT * diameter } else { diameter };
            marker.scale = [diameter, diameter, depth].into();
            marker.color = colors.color(range[0]);
            marker
        })
        .collect();
    for (grain, &radius) in grains.radius.iter().enumerate() {
        let marker = &mut markers[bins.bin(radius)];
        marker.points.push(canvas.point(grains.position[grain]));
        marker.colors.push(colors.color(values[grain]));
    }
    for marker in markers.iter_mut().filter(|marker| marker.points.is_empty()) {
        marker.action = Marker::DELETE;
    }
    markers
}

/// Bins of equal width between the smallest and the largest radius.
#[derive(Debug, PartialEq)]
struct Bins {
    smallest: f64,
    width: f64,
    count: usize,
}

impl Bins {
    fn of(radii: &[f64]) -> Self {
        let smallest = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let spread = largest - smallest;
        if spread <= EQUAL * largest {
            return Self { smallest, width: spread, count: 1 };
        }
        let [fewest, most] = BINS;
        let count = ((spread / (WIDTH * largest)).ceil() as usize).clamp(fewest, most);
        Self { smallest, width: spread / count as f64, count }
    }

    fn bin(&self, radius: f64) -> usize {
        match self.count {
            1 => 0,
            // The largest radius ends the last bin.
            count => (((radius - self.smallest) / self.width) as usize).min(count - 1),
        }
    }

    fn middle(&self, bin: usize) -> f64 {
        self.smallest + (bin as f64 + 0.5) * self.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_radii_are_one_bin_and_keep_their_size() {
        let bins = Bins::of(&[2e-3; 4]);
        assert_eq!((bins.count, bins.bin(2e-3), bins.middle(0)), (1, 0, 2e-3));
    }

    #[test]
    fn radii_that_differ_are_6_to_16_bins_and_each_is_within_half_a_bin_of_its_middle() {
        for (largest, count) in [(1.001, 6), (1.3, 8), (10.0, 16)] {
            let radii: Vec<f64> =
                (0..=100).map(|k| 1.0 + f64::from(k) / 100.0 * (largest - 1.0)).collect();
            let bins = Bins::of(&radii);
            assert_eq!(bins.count, count, "{largest}");
            for &radius in &radii {
                let off = (bins.middle(bins.bin(radius)) - radius).abs();
                assert!(off <= 0.5 * (largest - 1.0) / count as f64 * (1.0 + 1e-9), "{radius}");
            }
            assert_eq!([bins.bin(1.0), bins.bin(largest)], [0, count - 1]);
        }
    }
}

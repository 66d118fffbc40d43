//! The distribution of contact forces.

/// Width of a bin over the mean force.
const BIN: f64 = 0.25;

/// Bins at most; what is further out makes them wider.
const MOST_BINS: f64 = 200.0;

/// Probability density of `forces` over their mean: the middle of each bin and the density there,
/// NaN where no force is. Empty when there is no mean to divide by.
pub(super) fn density(forces: &[f64]) -> Vec<[f64; 2]> {
    let forces: Vec<f64> = forces.iter().copied().filter(|force| force.is_finite()).collect();
    let count = forces.len() as f64;
    let mean = forces.iter().map(|force| force / count).sum::<f64>();
    if !(mean > 0.0 && mean.is_finite()) {
        return Vec::new();
    }
    let (low, high) = forces.iter().fold((0.0, 0.0), |(low, high): (f64, f64), force| {
        (low.min(force / mean), high.max(force / mean))
    });
    let width = BIN.max((high - low) / MOST_BINS);
    let first = (low / width).floor();
    let mut bins = vec![0u64; ((high / width).floor() - first) as usize + 1];
    for force in &forces {
        // A rounding may put the largest on the far edge of the last bin.
        let bin = ((force / mean / width).floor() - first) as usize;
        let last = bins.len() - 1;
        bins[bin.min(last)] += 1;
    }
    let point = |(bin, &members): (usize, &u64)| {
        let middle = (first + bin as f64 + 0.5) * width;
        let density = members as f64 / (count * width);
        [middle, if members == 0 { f64::NAN } else { density }]
    };
    bins.iter().enumerate().map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_of_four_forces_is_that_of_their_bins() {
        // Mean 1: one of four in the bins 0.5..0.75 and 1.25..1.5, two in 1..1.25.
        let density = density(&[1.2, 3.0, 2.0, 2.0].map(|force| force * (4.0 / 8.2)));
        let known: Vec<_> = density.iter().filter(|[_, p]| p.is_finite()).copied().collect();
        assert_eq!(known, [[0.625, 1.0], [0.875, 2.0], [1.375, 1.0]]);
    }

    #[test]
    fn no_mean_no_density() {
        for forces in [vec![], vec![0.0; 3], vec![-1.0, 1.0], vec![f64::NAN]] {
            assert!(density(&forces).is_empty(), "{forces:?}");
        }
    }

    #[test]
    fn an_outlier_widens_the_bins_instead_of_adding_them() {
        let mut forces = vec![1.0; 1_000_000];
        forces.push(1e9);
        assert!(density(&forces).len() <= 202);
    }
}

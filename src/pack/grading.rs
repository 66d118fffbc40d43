//! Radii of the gradings A and B of B appendix 4 as functions of a number x from 0 to 1 that is
//! drawn evenly; their shares by number, whatever the dimension.

use crate::scene::Grading;

/// Radius of grading A \[m\] (A.4): the sieve curve, the share by weight of the grains up to r, is
/// straight in ln r (A.1), the density by number goes with r⁻⁴ (A.3).
///
/// (A.6) is printed with the mean of grading B. The mean of this one (A.5) over the r50 = √M r_min
/// of its sieve curve is 3/2 √M (M+1)/(M²+M+1).
#[must_use]
pub fn type_a(of: Grading, x: f64) -> f64 {
    let Grading { mean, ratio } = of;
    // (A.5) with M - 1 cancelled, so that one size has a meaning too.
    let largest = mean * (2.0 / 3.0) * (ratio * ratio + ratio + 1.0) / (ratio + 1.0);
    let cube = ratio.powi(3);
    largest / (cube - (cube - 1.0) * x).cbrt()
}

/// Radius of grading B \[m\] (A.7-A.8): evenly between the smallest and the largest.
#[must_use]
pub fn type_b(of: Grading, x: f64) -> f64 {
    let Grading { mean, ratio } = of;
    let smallest = 2.0 * mean / (ratio + 1.0);
    smallest + (ratio - 1.0) * smallest * x
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DRAWS: usize = 200_000;

    /// One radius of each of as many equal shares of the numbers from 0 to 1.
    fn even(of: Grading, radius: fn(Grading, f64) -> f64) -> Vec<f64> {
        (0..DRAWS).map(|k| radius(of, (k as f64 + 0.5) / DRAWS as f64)).collect()
    }

    fn grading() -> impl Strategy<Value = Grading> {
        (1e-6..1.0, 1.0..10.0).prop_map(|(mean, ratio)| Grading { mean, ratio })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        #[test]
        fn both_have_the_mean_and_the_ratio_asked_for(of in grading()) {
            for radius in [type_a, type_b] {
                let mean = even(of, radius).iter().sum::<f64>() / DRAWS as f64;
                prop_assert!((mean / of.mean - 1.0).abs() < 1e-6, "{mean}");
                let ratio = radius(of, 1.0) / radius(of, 0.0);
                prop_assert!((ratio / of.ratio - 1.0).abs() < 1e-11, "{ratio}");
            }
        }

        /// Weights (A.2) summed up to a grain, against the straight line (A.1) there.
        #[test]
        fn the_sieve_curve_of_a_is_straight_in_the_logarithm(of in grading()) {
            prop_assume!(of.ratio > 1.01);
            let weights: Vec<f64> = even(of, type_a).iter().map(|r| r.powi(3)).collect();
            let whole: f64 = weights.iter().sum();
            let smallest = type_a(of, 0.0);
            let mut finer = 0.0;
            for (k, weight) in weights.iter().enumerate() {
                finer += weight;
                if k % 1000 == 999 {
                    let radius = type_a(of, (k + 1) as f64 / DRAWS as f64);
                    let line = (radius / smallest).ln() / of.ratio.ln();
                    prop_assert!((finer / whole - line).abs() < 1e-5, "{radius} {line}");
                }
            }
        }

        /// r50 by weight, found in the draws; for B the printed (A.6) is no share by weight but the
        /// mean over the geometric mean of the limits.
        #[test]
        fn the_mean_over_the_size_of_half_the_weight_is_not_1(of in grading()) {
            prop_assume!(of.ratio > 1.5);
            let radii = even(of, type_a);
            let whole: f64 = radii.iter().map(|r| r.powi(3)).sum();
            let mut finer = 0.0;
            let half = radii.iter().find(|r| { finer += r.powi(3); finer >= 0.5 * whole });
            let m = of.ratio;
            let expected = 1.5 * m.sqrt() * (m + 1.0) / (m * m + m + 1.0);
            prop_assert!((of.mean / half.unwrap() / expected - 1.0).abs() < 1e-4);
        }

        #[test]
        fn one_size_is_both(mean in 1e-6..1.0, x in 0.0..=1.0) {
            let of = Grading { mean, ratio: 1.0 };
            prop_assert!((type_a(of, x) / mean - 1.0).abs() < 1e-15);
            prop_assert_eq!(type_b(of, x), mean);
        }
    }

    /// Default sand of B table 1 and figure 12: r̄ = 0.1 mm, M = 4, from 0.07 to 0.28 mm by (A.5)
    /// and from 0.04 to 0.16 mm by (A.8).
    #[test]
    fn the_sand_of_table_1_has_the_limits_of_figure_12() {
        let of = Grading { mean: 0.1e-3, ratio: 4.0 };
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-14, "{a} {b}");
        close(type_a(of, 0.0), 0.07e-3);
        close(type_a(of, 1.0), 0.28e-3);
        close(type_b(of, 0.0), 0.04e-3);
        close(type_b(of, 1.0), 0.16e-3);
    }
}

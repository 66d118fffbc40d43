//! Drawing what differs from grain to grain: moduli (T 2.7.1) and radii.
//!
//! The generator is PCG XSL RR 128/64 (`rand_pcg::Pcg64`), seeded by `seed_from_u64` with the
//! scene's seed, so that a scene gives the same grains everywhere.

use rand::RngExt;
use rand_pcg::Pcg64;

use super::grading;
use crate::scene::{Material, Radius};

/// Redraws before the mean is taken; half of the draws or more are within the limits.
const MAX_DRAWS: u32 = 1000;

/// Young's modulus \[Pa\] and Poisson's ratio of one grain.
///
/// Both are normal with the material's relative standard deviation, redrawn until E is above 0.2 of
/// its mean and -0.99 < ν < 0.495. Without spread nothing is drawn from `rng`.
#[must_use]
pub fn draw(material: &Material, rng: &mut Pcg64) -> (f64, f64) {
    if material.spread == 0.0 {
        return (material.young, material.poisson);
    }
    let young = within(rng, material.young, material.spread, |young| young > 0.2 * material.young);
    let poisson = within(rng, material.poisson, material.spread, |nu| -0.99 < nu && nu < 0.495);
    (young, poisson)
}

/// A radius of the distribution \[m\].
#[must_use]
pub fn radius(of: Radius, rng: &mut Pcg64) -> f64 {
    match of {
        Radius::Uniform([low, high]) => low + (high - low) * rng.random::<f64>(),
        Radius::Constant(radius) => radius,
        Radius::GradingA(of) => grading::type_a(of, rng.random()),
        Radius::GradingB(of) => grading::type_b(of, rng.random()),
    }
}

fn within(rng: &mut Pcg64, mean: f64, spread: f64, inside: impl Fn(f64) -> bool) -> f64 {
    (0..MAX_DRAWS)
        .map(|_| mean * (1.0 + spread * normal(rng)))
        .find(|&value| inside(value))
        .unwrap_or(mean)
}

/// Standard normal, by the method of Box and Muller.
fn normal(rng: &mut Pcg64) -> f64 {
    // 1 - u is never 0, where the logarithm ends.
    let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
    radius * (std::f64::consts::TAU * rng.random::<f64>()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;

    const GLASS: Material = Material { young: 70e9, poisson: 0.2, density: 2420.0, spread: 0.1 };

    /// Mean and standard deviation over the mean.
    fn moments(values: &[f64]) -> (f64, f64) {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / n;
        (mean, variance.sqrt() / mean)
    }

    #[test]
    fn moduli_have_the_mean_and_spread_of_the_material() {
        let mut rng = Pcg64::seed_from_u64(1);
        let drawn: Vec<_> = (0..20_000).map(|_| draw(&GLASS, &mut rng)).collect();
        let (young, spread) = moments(&drawn.iter().map(|grain| grain.0).collect::<Vec<_>>());
        assert!((young / 70e9 - 1.0).abs() < 3e-3, "{young}");
        assert!((spread - 0.1).abs() < 2e-3, "{spread}");
        let (poisson, spread) = moments(&drawn.iter().map(|grain| grain.1).collect::<Vec<_>>());
        assert!((poisson / 0.2 - 1.0).abs() < 3e-3, "{poisson}");
        assert!((spread - 0.1).abs() < 2e-3, "{spread}");
        // 68.3 % of a normal distribution lie within one standard deviation, 99.7 % within three.
        let share = |limit: f64| {
            let inside = drawn.iter().filter(|grain| (grain.0 / 70e9 - 1.0).abs() < 0.1 * limit);
            inside.count() as f64 / drawn.len() as f64
        };
        assert!((share(1.0) - 0.6827).abs() < 0.01, "{}", share(1.0));
        assert!((share(3.0) - 0.9973).abs() < 0.002, "{}", share(3.0));
    }

    #[test]
    fn draws_stay_within_the_limits_of_wide_and_nearly_incompressible_materials() {
        let rubber = Material { young: 1e6, poisson: 0.494, density: 1e3, spread: 0.3 };
        let foam = Material { young: 1e6, poisson: -0.98, density: 1e2, spread: 0.3 };
        let mut rng = Pcg64::seed_from_u64(2);
        for material in [rubber, foam] {
            for _ in 0..10_000 {
                let (young, poisson) = draw(&material, &mut rng);
                assert!(young > 0.2e6 && -0.99 < poisson && poisson < 0.495);
            }
        }
    }

    #[test]
    fn without_spread_every_grain_is_the_mean_and_the_generator_rests() {
        let (mut rng, untouched) = (Pcg64::seed_from_u64(3), Pcg64::seed_from_u64(3));
        let hydrate = Material { young: 6.6e9, poisson: 0.32, density: 900.0, spread: 0.0 };
        assert_eq!(draw(&hydrate, &mut rng), (6.6e9, 0.32));
        assert_eq!(rng, untouched);
    }

    #[test]
    fn radii_fill_their_range_evenly() {
        let mut rng = Pcg64::seed_from_u64(4);
        let range = Radius::Uniform([0.07e-3, 0.13e-3]);
        let mut counts = [0_usize; 6];
        for _ in 0..60_000 {
            let value = radius(range, &mut rng);
            assert!((0.07e-3..0.13e-3).contains(&value));
            counts[((value - 0.07e-3) / 0.01e-3) as usize] += 1;
        }
        // 10 000 a bin; four standard deviations are 365.
        assert!(counts.iter().all(|&count| count.abs_diff(10_000) < 365), "{counts:?}");
        assert_eq!(radius(Radius::Constant(1e-3), &mut rng), 1e-3);
    }
}

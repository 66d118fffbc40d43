//! How far an equilibrium is from the reference.

use serde::Serialize;

use super::reference::Moment;

/// Distance of one equilibrium from the reference.
#[derive(Clone, Copy, Debug)]
pub(super) struct Error {
    /// Largest difference of a wall's normal force over the largest normal force.
    pub(super) force: f64,
    /// Root mean square of the distances of the load-carrying grains over the mean radius.
    pub(super) position: f64,
    /// Largest relative difference of the secant bulk and shear moduli; NaN where neither is known.
    pub(super) modulus: f64,
}

impl Error {
    /// Of `moment` against `reference`, whose load-carrying grains count.
    pub(super) fn of(moment: &Moment, reference: &Moment, mean_radius: f64) -> Self {
        let largest = reference.force.iter().copied().fold(0.0, f64::max);
        let forces = moment.force.iter().zip(&reference.force);
        let force = forces.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
        let moduli = moment.moduli.iter().zip(&reference.moduli);
        // The larger of a number and none is the number.
        let modulus = moduli.map(|(a, b)| ((a - b) / b).abs()).fold(f64::NAN, f64::max);
        Self { force, position: distance(moment, reference) / mean_radius, modulus }
    }
}

/// Root mean square distance of the load-carrying grains \[m\]; NaN where there are none.
fn distance(moment: &Moment, reference: &Moment) -> f64 {
    let pairs = moment.position.iter().zip(&reference.position).zip(&reference.carries);
    let carrying = pairs.filter(|(_, carries)| **carries);
    let (sum, count) = carrying.fold((0.0, 0u32), |(sum, count), ((a, b), _)| {
        let square: f64 = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum();
        (sum + square, count + 1)
    });
    (sum / f64::from(count)).sqrt()
}

/// Median and largest of the increments' errors; NaN where none is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Half of the increments are as good.
    pub median: f64,
    /// The worst increment.
    pub worst: f64,
}

impl Spread {
    /// Of `values`, those that are NaN left out.
    pub(super) fn of(values: impl Iterator<Item = f64>) -> Self {
        let known: Vec<f64> = values.filter(|value| !value.is_nan()).collect();
        Self { worst: known.iter().copied().fold(f64::NAN, f64::max), median: median(known) }
    }
}

/// The middle of `values`, or the mean of the two in the middle; NaN of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count => 0.5 * (values[(count - 1) / 2] + values[count / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment() -> Moment {
        Moment {
            force: [1.0, 1.0, 2.0, 2.0, 4.0, 4.0],
            position: vec![[0.0; 3], [1.0; 3], [2.0; 3]],
            carries: vec![true, true, false],
            moduli: [10.0, f64::NAN],
        }
    }

    #[test]
    fn floating_grains_and_unknown_moduli_do_not_count() {
        let mut other = moment();
        other.force[0] = 1.4;
        other.position[0] = [3.0, 4.0, 0.0];
        other.position[2] = [7.0; 3];
        other.moduli = [11.0, 5.0];
        let error = Error::of(&other, &moment(), 2.0);
        // 0.4 of 4 N; two grains of which one is 5 m off, in units of 2 m; 10 to 11.
        assert!((error.force - 0.1).abs() < 1e-15);
        assert!((error.position - 12.5f64.sqrt() / 2.0).abs() < 1e-15);
        assert!((error.modulus - 0.1).abs() < 1e-15);
    }

    #[test]
    fn the_median_of_an_even_number_lies_between_the_two_in_the_middle() {
        assert_eq!(median(vec![4.0, 1.0, 2.0, 100.0]), 3.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0]), 2.0);
        let spread = Spread::of([f64::NAN, 3.0, 1.0].into_iter());
        assert_eq!((spread.median, spread.worst), (2.0, 3.0));
        assert!(Spread::of([f64::NAN].into_iter()).worst.is_nan());
    }
}

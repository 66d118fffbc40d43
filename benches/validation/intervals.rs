//! Moduli of the intervals of a load path (T 2.6.3).

use graintwin::measure::moduli;

use crate::specimen::Equilibrium;

/// What was measured over an interval.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    /// Mean of the confining stress at its ends \[Pa\].
    pub(crate) stress: f64,
    /// Bulk modulus \[Pa\].
    pub(crate) bulk: f64,
    /// Shear modulus \[Pa\].
    pub(crate) shear: f64,
    /// Young's modulus \[Pa\].
    pub(crate) young: f64,
}

/// Intervals of at least `width` of axial strain.
pub(crate) fn by_strain(course: &[Equilibrium], width: f64) -> Vec<Interval> {
    let mut intervals = Vec::new();
    let mut from = 0;
    for to in 1..course.len() {
        let strain = course[to].state.strain[2] - course[from].state.strain[2];
        // Strains add up with rounding.
        if strain >= width * (1.0 - 1e-3) {
            intervals.push(interval(&course[from], &course[to]));
            from = to;
        }
    }
    intervals
}

fn interval(from: &Equilibrium, to: &Equilibrium) -> Interval {
    let change = |to: [f64; 3], from: [f64; 3]| std::array::from_fn(|k| to[k] - from[k]);
    let stress = change(to.stress(), from.stress());
    let strain = change(to.state.strain, from.state.strain);
    // The density matters to wave speeds only.
    let moduli = moduli::secant(stress, strain, 1.0);
    Interval {
        stress: 0.5 * (from.state.confining_stress + to.state.confining_stress),
        bulk: moduli.bulk,
        shear: moduli.shear,
        young: moduli.young,
    }
}

/// Each modulus in the middle of those of the increments: single rearrangements, which take most
/// of their increment's stress away, do not count. `None` without increments.
pub(crate) fn between_events(course: &[Equilibrium]) -> Option<Interval> {
    let (first, last) = course.first().zip(course.last())?;
    let increments: Vec<Interval> =
        course.windows(2).map(|pair| interval(&pair[0], &pair[1])).collect();
    let middle = |of: fn(&Interval) -> f64| {
        let mut values: Vec<f64> = increments.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let half = values.len() / 2;
        let pair = [values.get(half)?, values.get((values.len() - 1) / 2)?];
        Some(0.5 * (pair[0] + pair[1]))
    };
    let (bulk, shear) = (middle(|i| i.bulk)?, middle(|i| i.shear)?);
    let stress = 0.5 * (first.state.confining_stress + last.state.confining_stress);
    Some(Interval { stress, bulk, shear, young: 9.0 * bulk * shear / (3.0 * bulk + shear) })
}

/// The whole course as one interval. `None` without increments.
pub(crate) fn whole(course: &[Equilibrium]) -> Option<Interval> {
    match course {
        [first, .., last] => Some(interval(first, last)),
        _ => None,
    }
}

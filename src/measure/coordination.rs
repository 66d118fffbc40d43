//! Coordination numbers (T fig. 2.6).

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::state::State;

/// How many contacts each grain has, shape (n), in the solver's order.
#[must_use]
pub fn numbers<'a>(model: &Model, counted: impl Iterator<Item = &'a Contact>) -> Vec<u32> {
    let mut numbers = vec![0; model.len()];
    for contact in counted {
        numbers[contact.first as usize] += 1;
        if let Other::Grain(j) = contact.second {
            numbers[j as usize] += 1;
        }
    }
    numbers
}

/// Histograms of the coordination number: entry k counts the grains with k contacts.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Histograms {
    /// All grains.
    pub all: Vec<u32>,
    /// Grains further from every wall than the largest grain diameter.
    pub interior: Vec<u32>,
}

/// Sorts the coordination numbers into histograms.
#[must_use]
pub fn histograms(model: &Model, state: &State, numbers: &[u32]) -> Histograms {
    let bounds = state.bounds(model);
    let margin = 2.0 * model.max_radius;
    let mut histograms = Histograms::default();
    for (at, &number) in state.position.iter().zip(numbers) {
        count(&mut histograms.all, number);
        let between = |axis: usize| {
            at[axis] - bounds.min[axis] > margin && bounds.max[axis] - at[axis] > margin
        };
        let interior = match (&model.plane, &model.cell) {
            (None, None) => (0..3).all(between),
            (None, Some(cell)) => {
                cell.is_interior(at.xy(), margin, &state.displacement) && between(2)
            }
            (Some(setup), _) => setup.cell.is_interior(at.xy(), margin, &state.displacement),
        };
        if interior {
            count(&mut histograms.interior, number);
        }
    }
    histograms
}

fn count(histogram: &mut Vec<u32>, number: u32) {
    let number = number as usize;
    if histogram.len() <= number {
        histogram.resize(number + 1, 0);
    }
    histogram[number] += 1;
}

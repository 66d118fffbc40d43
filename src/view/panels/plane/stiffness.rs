//! Stiffness of discs beside what theory makes of their contacts (B 24, A.80-A.95).

use std::collections::BTreeMap;

use crate::analytic::cemented;
use crate::analytic::fit::biaxial::Test;
use crate::analytic::hooke::Hooke;
use crate::analytic::sand;
use crate::analytic::strength::MohrCoulomb;
use crate::msg::PlaneState;
use crate::view::chart::{Chart, Pattern, Series};
use crate::view::run::Run;
use crate::view::run::plane::grains::Contacts;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// What theory says of a state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Theory {
    /// E50 of sand (A.89), and E and ν of cemented grains (A.80).
    pub(super) averaged: Hooke,
    /// The same when every grain moves with the strain of the pack and no contact slides, the first bit of
    /// a strain.
    pub(super) uniform: Hooke,
    /// Strength of cemented grains (A.90-A.95).
    pub(super) strength: Option<MohrCoulomb>,
}

impl Theory {
    /// Under the mean stress `stress` \[Pa\].
    pub(super) fn of(contacts: &Contacts, state: &PlaneState, stress: f64) -> Option<Self> {
        let density = state.contact_density;
        let known = density > 0.0 && stress > 0.0;
        known.then(|| match *contacts {
            Contacts::Hertz { shear_modulus, poisson } => {
                let reference = sand::reference_modulus(shear_modulus, poisson, density);
                let kappa = crate::analytic::contact::stiffness_ratio(poisson);
                let averaged = cemented::averaged(density, 1.0, 1.0, kappa);
                let young = sand::young(reference, stress);
                Self {
                    averaged: Hooke { young, ..averaged },
                    uniform: sand::first(shear_modulus, poisson, density, stress),
                    strength: None,
                }
            }
            Contacts::Linear { stiffness, kappa, cohesion } => Self {
                averaged: cemented::averaged(density, stiffness, state.mean_diameter, kappa),
                uniform: cemented::uniform(density, stiffness, state.mean_diameter, kappa),
                strength: cohesion.map(|cohesion| cemented::strength(density, cohesion)),
            },
        })
    }

    /// What theory says of the first state of `run`, under the mean stress `stress` \[Pa\].
    pub(super) fn at_start(run: &Run, stress: f64) -> Option<Self> {
        Self::of(run.plane.contacts.as_ref()?, run.plane.states.first()?, stress)
    }
}

/// Young's modulus and the modulus of the area against the mean stress, with the E50 of the biaxial `test`
/// if there is one.
pub(super) fn chart(run: &Run, test: Option<&Test<'_>>) -> Chart {
    let stress: BTreeMap<u64, f64> =
        run.states.iter().map(|state| (state.increment, state.confining_stress)).collect();
    let at = |increment: u64| stress.get(&increment).copied().unwrap_or(f64::NAN);
    let tangents = || run.tangents.iter().map(|one| (at(one.increment), one));
    let mut series = vec![
        dots(0, "E, all stick", tangents().map(|(at, one)| [at, one.sticks.young])),
        dots(1, "E, as they stand", tangents().map(|(at, one)| [at, one.stands.young])),
        dots(2, "K, all stick", tangents().map(|(at, one)| [at, one.sticks.bulk])),
    ];
    if run.tangents.is_empty() {
        let secants = run.moduli.iter().filter(|one| one.increment > 0 && one.bulk > 0.0);
        // Mean stress at the middle of the increment.
        let middle = |increment: u64| 0.5 * (at(increment) + at(increment - 1));
        series = vec![dots(
            2,
            "K of the increment",
            secants.map(|one| [middle(one.increment), one.bulk]),
        )];
    }
    if let Some((at, young)) = test.and_then(half) {
        series.push(dots(3, "E50 of the test", [[at, young]]));
    }
    let measured: usize = series.iter().map(|one| one.points.len()).sum();
    let mut notes = Vec::new();
    if let Some(contacts) = run.plane.contacts.as_ref().filter(|_| measured > 0) {
        let mut predicted: Vec<(f64, Theory)> = (run.plane.states.iter())
            .filter_map(|state| {
                let at = at(state.increment);
                Some((at, Theory::of(contacts, state, at)?))
            })
            .collect();
        predicted.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        let mut line = |number: usize, name: &str, value: fn(&Theory) -> f64| {
            let points = predicted.iter().map(|(at, one)| [*at, value(one)]);
            let mut line = Series::new(number, name, points);
            line.stroke.pattern = Pattern::Dashed;
            line.stroke.width = 1.4;
            series.push(line);
        };
        line(0, "E, uniform strain", |one| one.uniform.young);
        line(2, "K, uniform strain", |one| one.uniform.bulk_modulus());
        let name = match contacts {
            Contacts::Hertz { .. } => "E50 (24, A.89)",
            Contacts::Linear { .. } => "E (A.80)",
        };
        line(3, name, |one| one.averaged.young);
        notes.push("Dashed: predicted from n_c/v of each state and the grains.".into());
    }
    Chart {
        title: "Stiffness against mean stress".into(),
        x: Axis::linear("mean stress", Unit::Si("Pa")),
        y: Axis::linear("modulus", Unit::Si("Pa")),
        series,
        notes,
    }
}

/// E50 \[Pa\] of a biaxial test, at the mean stress \[Pa\] where half of the strength is reached.
fn half(test: &Test<'_>) -> Option<(f64, f64)> {
    let material = test.material()?;
    let minor = *test.minor.last()?;
    let peak = test.major.iter().copied().fold(minor, f64::max);
    Some((minor + 0.25 * (peak - minor), material.elastic.young))
}

fn dots(number: usize, name: &str, points: impl IntoIterator<Item = [f64; 2]>) -> Series {
    let mut series = Series::new(number, name, points);
    series.stroke.pattern = Pattern::Dots;
    series
}

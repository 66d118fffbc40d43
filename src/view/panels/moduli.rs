//! The elastic moduli of the intervals.

use std::collections::BTreeMap;

use super::strain::Strain;
use super::typical::keep_typical;
use crate::msg;
use crate::view::chart::{Chart, Series};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

type Value = fn(&msg::Moduli) -> f64;

const MODULI: [(&str, Value); 5] = [
    ("bulk K", |moduli| moduli.bulk),
    ("shear G", |moduli| moduli.shear),
    ("Young's E", |moduli| moduli.young),
    ("Lamé's λ", |moduli| moduli.lame),
    ("P-wave M", |moduli| moduli.p_wave),
];

/// The confining stress is the better abscissa once it changes by this share.
const TELLING: f64 = 0.05;

/// Why a few moduli lie far from all others.
const WHY: &str = "Where the strain turns or the stress drops, an increment tells no stiffness.";

/// What the moduli depend on most.
struct Abscissa<'a> {
    strain: &'a Strain,
    stress: Option<BTreeMap<u64, f64>>,
}

impl<'a> Abscissa<'a> {
    fn of(run: &Run, strain: &'a Strain) -> Self {
        let known = run.states.iter().map(|state| (state.increment, state.confining_stress));
        let known: BTreeMap<u64, f64> = known.collect();
        let finite = || known.values().copied().filter(|stress| stress.is_finite());
        let low = finite().fold(f64::INFINITY, f64::min);
        let high = finite().fold(f64::NEG_INFINITY, f64::max);
        let stress = (high - low > TELLING * high.abs()).then_some(known);
        Self { strain, stress }
    }

    fn axis(&self) -> Axis {
        match self.stress {
            Some(_) => Axis::linear("confining stress", Unit::Si("Pa")),
            None => self.strain.axis(),
        }
    }

    fn name(&self) -> &'static str {
        if self.stress.is_some() { "confining stress" } else { self.strain.name() }
    }

    fn at(&self, increment: u64) -> f64 {
        match &self.stress {
            Some(stress) => stress.get(&increment).copied().unwrap_or(f64::NAN),
            None => self.strain.at(increment),
        }
    }

    fn series(&self, number: usize, name: &str, run: &Run, value: Value) -> Series {
        // At the start there was no interval yet: moduli that are known there are of the states.
        let of_states = run.moduli.first().is_some_and(|first| first.increment == 0 && first.valid);
        let later = run.moduli.iter().filter(|moduli| moduli.increment > 0 && !of_states);
        Series::new(number, name, later.map(|moduli| [self.at(moduli.increment), value(moduli)]))
    }
}

/// Those that have the unit of a stress.
pub(super) fn moduli(run: &Run, strain: &Strain) -> Chart {
    let abscissa = Abscissa::of(run, strain);
    let line = |(number, (name, value)): (usize, &(&str, Value))| {
        abscissa.series(number, name, run, *value)
    };
    let mut chart = Chart {
        title: format!("Moduli against {}", abscissa.name()),
        x: abscissa.axis(),
        y: Axis::linear("secant modulus", Unit::Si("Pa")),
        series: MODULI.iter().enumerate().map(line).collect(),
        notes: vec!["Secant over each increment, shown at its end.".into()],
    };
    keep_typical(&mut chart, WHY);
    chart
}

type OfState = fn(&msg::Tangent) -> f64;

const OF_STATE: [(&str, OfState); 4] = [
    ("K, all stick", |tangent| tangent.sticks.bulk),
    ("G, all stick", |tangent| tangent.sticks.shear),
    ("K, as they stand", |tangent| tangent.stands.bulk),
    ("G, as they stand", |tangent| tangent.stands.shear),
];

/// Those of the states themselves; without friction both sets are the same, and one is shown.
pub(super) fn tangent(run: &Run, strain: &Strain) -> Chart {
    let abscissa = Abscissa::of(run, strain);
    let slides = run.tangents.iter().any(|one| one.stands.relaxed != one.sticks.relaxed);
    let (shown, note) = match slides {
        true => {
            (&OF_STATE[..], "Of each state: sliding contacts as they stand, and with all sticking.")
        }
        false => (&OF_STATE[2..], "Of each state; no contact slides."),
    };
    let line = |(number, (name, value)): (usize, &(&str, OfState))| {
        let points = run.tangents.iter().map(|one| [abscissa.at(one.increment), value(one)]);
        Series::new(number, name, points)
    };
    Chart {
        title: format!("Tangent moduli against {}", abscissa.name()),
        x: abscissa.axis(),
        y: Axis::linear("tangent modulus", Unit::Si("Pa")),
        series: shown.iter().enumerate().map(line).collect(),
        notes: vec![note.into()],
    }
}

/// Poisson's ratio.
pub(super) fn poisson(run: &Run, strain: &Strain) -> Chart {
    let abscissa = Abscissa::of(run, strain);
    let mut chart = Chart {
        title: format!("Poisson's ratio against {}", abscissa.name()),
        x: abscissa.axis(),
        y: Axis::linear("Poisson's ratio", Unit::None),
        series: vec![abscissa.series(3, "", run, |moduli| moduli.poisson)],
        notes: Vec::new(),
    };
    keep_typical(&mut chart, WHY);
    chart
}

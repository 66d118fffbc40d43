//! Hydrate that dissociates, and what is left of the stiffness.

use crate::msg::{Hydrate, Moduli};
use crate::view::chart::{Chart, Series};
use crate::view::run::Run;
use crate::view::scale::Axis;
use crate::view::unit::Unit;

/// Charts for a run with hydrate; empty ones for any other.
pub(super) fn charts(run: &Run) -> Vec<Chart> {
    vec![saturation(run), stresses(run), moduli(run)]
}

fn chart(title: &str, y: Axis, series: Vec<Series>) -> Chart {
    let x = Axis::count("increment");
    Chart { title: title.into(), x, y, series, notes: Vec::new() }
}

fn line(number: usize, name: &str, run: &Run, value: impl Fn(&Hydrate) -> f64) -> Series {
    let point = |hydrate: &Hydrate| [hydrate.increment as f64, value(hydrate)];
    Series::new(number, name, run.hydrates.iter().map(point))
}

fn saturation(run: &Run) -> Chart {
    let series = vec![
        line(0, "of the pores at the start", run, |hydrate| hydrate.saturation),
        line(1, "of the pores now", run, |hydrate| hydrate.present_saturation),
    ];
    chart("Hydrate saturation", Axis::linear("saturation", Unit::None), series)
}

fn stresses(run: &Run) -> Chart {
    let series = vec![
        line(0, "effective stress", run, |hydrate| hydrate.effective_stress),
        line(1, "with what the pore pressure bears", run, |hydrate| hydrate.total_stress),
        line(2, "pore pressure", run, |hydrate| hydrate.pore_pressure),
    ];
    chart("Stress and pore pressure", Axis::linear("stress", Unit::Si("Pa")), series)
}

fn moduli(run: &Run) -> Chart {
    let of = |number, name, value: fn(&Moduli) -> f64| {
        let known = run.moduli.iter().filter(|_| !run.hydrates.is_empty());
        Series::new(number, name, known.map(|one| [one.increment as f64, value(one)]))
    };
    let series =
        vec![of(0, "bulk modulus K", |one| one.bulk), of(1, "shear modulus G", |one| one.shear)];
    chart("Moduli as dissociation goes on", Axis::linear("modulus", Unit::Si("Pa")), series)
}

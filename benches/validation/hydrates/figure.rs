//! The figure.

use graintwin::view::{Axis, Chart, Series, Sheet, Unit};

use super::{CHOICES, Choice, Dissociations, Point};
use crate::curve::{Curve, by_place};
use crate::figures::drawn;

/// The sheet by the name of its file without its ending.
pub(crate) fn sheet(all: &[Dissociations]) -> (&'static str, Sheet) {
    let mut seeds: Vec<u64> = all.iter().map(|one| one.seed).collect();
    seeds.dedup();
    seeds.sort_unstable();
    seeds.dedup();
    let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
    let charts = vec![
        chart(all, "Bulk modulus against excess pore pressure, ΔS = 0.01", 0, true),
        chart(all, "Shear modulus against excess pore pressure, ΔS = 0.01", 1, true),
        chart(all, "Bulk modulus against lost saturation, 1 MPa", 0, false),
        chart(all, "Shear modulus against lost saturation, 1 MPa", 1, false),
    ];
    let sheet = Sheet {
        title: "Dissociation of hydrate (thesis fig. 5.4)".into(),
        subtitle: format!(
            "2740 grains of quartz and hydrate without friction, at 21 MPa before anything happens: \
             the first point of every line. Lines: mean of the seeds {}, bands: lowest to highest. \
             Of the state: tangent moduli; test: secant of a uniaxial strain of 2e-4.",
            seeds.join(", ")
        ),
        charts,
    };
    ("validation_hydrate", sheet)
}

fn chart(all: &[Dissociations], title: &str, which: usize, pressure: bool) -> Chart {
    let mut series = Vec::new();
    for (number, choice) in CHOICES.into_iter().enumerate() {
        let name = match choice {
            Choice::Saturation(saturation) => format!("S = {saturation}"),
            Choice::Radius(radius) => format!("R below {} mm", radius * 1e3),
        };
        let of = |value: fn(&Point) -> [f64; 2]| -> Vec<Curve> {
            let course = |one: &Dissociations| -> Curve {
                let points = if pressure { &one.by_pressure } else { &one.by_loss };
                let place = |at: &Point| if pressure { at.pressure } else { at.loss };
                points.iter().map(|at| [place(at), value(at)[which]]).collect()
            };
            all.iter().filter(|one| one.choice == choice).map(course).collect()
        };
        let line = |number, name: &str, curves: &[Curve]| -> Series {
            drawn(number, name, &by_place(curves))
        };
        series.push(line(2 * number, &format!("{name}, of the state"), &of(|at| at.tangent)));
        series.push(line(2 * number + 1, &format!("{name}, test"), &of(|at| at.secant)));
    }
    let x = match pressure {
        true => Axis::linear("excess pore pressure", Unit::Si("Pa")),
        false => Axis::linear("lost saturation ΔS", Unit::None),
    };
    let y = if which == 0 { "bulk modulus K" } else { "shear modulus G" };
    Chart { title: title.into(), x, y: Axis::linear(y, Unit::Si("Pa")), series, notes: Vec::new() }
}

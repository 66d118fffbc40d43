//! The numbers.

use super::{CHOICES, Choice, Dissociations, Point};
use crate::curve::Spread;
use crate::tables::head;

/// Prints all of them.
pub(crate) fn print(all: &[Dissociations]) {
    samples(all);
    for choice in CHOICES {
        let of: Vec<&Dissociations> = all.iter().filter(|one| one.choice == choice).collect();
        course(&format!("{choice:?}, pore pressure at ΔS = 0.01"), &of, |one| &one.by_pressure);
        course(&format!("{choice:?}, saturation at 1 MPa"), &of, |one| &one.by_loss);
    }
}

fn samples(all: &[Dissociations]) {
    head(
        "Samples",
        &[
            "choice",
            "seed",
            "grains of hydrate",
            "up to [mm]",
            "S",
            "porosity",
            "with hydrate",
            "stress [MPa]",
            "coordination",
            "K [GPa]",
            "G [GPa]",
        ],
    );
    for one in all {
        let Point { hydrate, state, tangent, .. } = one.by_pressure[0];
        let choice = match one.choice {
            Choice::Saturation(saturation) => format!("S = {saturation}"),
            Choice::Radius(radius) => format!("R < {} mm", radius * 1e3),
        };
        println!(
            "| {choice} | {} | {} | {:.4} | {:.4} | {:.4} | {:.4} | {:.2} | {:.2} | {:.3} | {:.3} |",
            one.seed,
            one.grains.0,
            one.grains.1 * 1e3,
            hydrate.saturation,
            hydrate.porosity,
            hydrate.pore_fraction,
            hydrate.effective_stress / 1e6,
            state.coordination_number,
            tangent[0] / 1e9,
            tangent[1] / 1e9,
        );
    }
}

fn course(title: &str, all: &[&Dissociations], of: fn(&Dissociations) -> &Vec<Point>) {
    head(
        title,
        &[
            "ΔS",
            "p [MPa]",
            "K [GPa]",
            "G [GPa]",
            "K, test",
            "G, test",
            "effective [MPa]",
            "total [MPa]",
            "coordination",
        ],
    );
    let places = all.iter().map(|one| of(one).len()).min().unwrap_or(0);
    for k in 0..places {
        let spread =
            |value: &dyn Fn(&Point) -> f64| Spread::of(all.iter().map(|one| value(&of(one)[k])));
        let Point { loss, pressure, .. } = of(all[0])[k];
        println!(
            "| {loss:.3} | {:.1} | {:.3} | {:.3} | {:.3} | {:.3} | {:.2} | {:.2} | {:.2} |",
            pressure / 1e6,
            spread(&|at| at.tangent[0] / 1e9),
            spread(&|at| at.tangent[1] / 1e9),
            spread(&|at| at.secant[0] / 1e9),
            spread(&|at| at.secant[1] / 1e9),
            spread(&|at| at.hydrate.effective_stress / 1e6),
            spread(&|at| at.hydrate.total_stress / 1e6),
            spread(&|at| at.state.coordination_number),
        );
    }
}

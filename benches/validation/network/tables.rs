//! The numbers.

use graintwin::report::Fabric;

use super::{LATERAL, Networks, Point, STAGES, THESIS_RATIO, curves};
use crate::curve::{Spread, at};
use crate::tables::head;

/// A grain without friction needs as many contacts.
const STABLE: usize = 4;

/// Prints all of them.
pub(crate) fn print(networks: &[Networks]) {
    coordination(networks);
    directions(networks);
    chains(networks);
}

fn coordination(networks: &[Networks]) {
    head(
        "Coordination numbers",
        &[
            "stress [MPa]",
            "grains",
            "mean",
            "no contact [%]",
            "1 to 3 contacts [%]",
            "most frequent",
            "largest",
        ],
    );
    for (stage, stress) in STAGES.iter().enumerate() {
        for (name, interior) in [("all", false), ("interior", true)] {
            let counts = |one: &Networks| {
                let histograms = &one.stages[stage].coordination;
                if interior { histograms.interior.clone() } else { histograms.all.clone() }
            };
            let of = |value: &dyn Fn(&[u32]) -> f64| {
                Spread::of(networks.iter().map(|one| value(&counts(one))))
            };
            let share = |counts: &[u32], from: usize, to: usize| {
                let part: u32 = counts.iter().take(to).skip(from).sum();
                100.0 * f64::from(part) / f64::from(counts.iter().sum::<u32>())
            };
            let mean = of(&|counts| {
                let sum: usize = counts.iter().enumerate().map(|(k, &n)| k * n as usize).sum();
                sum as f64 / f64::from(counts.iter().sum::<u32>())
            });
            let none = of(&|counts| share(counts, 0, 1));
            let few = of(&|counts| share(counts, 1, STABLE));
            let mode = of(&|counts| {
                let most = counts.iter().enumerate().max_by_key(|(_, count)| **count);
                most.map_or(0.0, |(number, _)| number as f64)
            });
            let largest = of(&|counts| counts.len() as f64 - 1.0);
            println!(
                "| {} | {name} | {mean:.2} | {none:.1} | {few:.1} | {mode:.0} | {largest:.0} |",
                stress / 1e6
            );
        }
    }
}

fn directions(networks: &[Networks]) {
    head(
        "Share within 45° of the axis [%]",
        &[
            "lateral [MPa]",
            "axial over lateral",
            "all contacts",
            "largest 10 %",
            "x and y, largest 10 %",
            "largest 10 %, walls too",
            "a_c",
            "a_n",
        ],
    );
    for (which, lateral) in LATERAL.iter().enumerate() {
        for stress in [1.0, 1.04, THESIS_RATIO] {
            let ratio = 3.0 * (stress - 1.0) / (stress + 2.0);
            let spread = |of: &dyn Fn(&Point) -> f64| {
                Spread::of(curves(networks, which, of).iter().map(|curve| at(curve, ratio)))
            };
            let cone = |largest: bool, axes: &'static [usize]| {
                spread(&move |point: &Point| {
                    let directions = &point.fabric.directions;
                    let cone = if largest { directions.cone_largest } else { directions.cone_all };
                    100.0 * axes.iter().map(|&axis| cone[axis]).sum::<f64>() / axes.len() as f64
                })
            };
            println!(
                "| {} | {stress:.3} | {:.1} | {:.1} | {:.1} | {:.1} | {:.3} | {:.3} |",
                lateral / 1e6,
                cone(false, &[2]),
                cone(true, &[2]),
                cone(true, &[0, 1]),
                spread(&|point| 100.0 * point.with_walls),
                spread(&|point| point.fabric.directions.contact_anisotropy),
                spread(&|point| point.fabric.directions.normal_anisotropy),
            );
        }
    }
}

fn chains(networks: &[Networks]) {
    head(
        "Force chains of the largest 10 % of the forces, isotropic stress",
        &[
            "stress [MPa]",
            "least force over mean",
            "load [%]",
            "grains in chains [%]",
            "chains",
            "grains in the largest",
            "strongest path over mean",
        ],
    );
    for (stage, stress) in STAGES.iter().enumerate() {
        row(*stress, &networks.iter().map(|one| &one.stages[stage]).collect::<Vec<_>>());
    }
    for (which, lateral) in LATERAL.iter().enumerate().skip(1) {
        row(*lateral, &networks.iter().map(|one| &one.axial[which][0].fabric).collect::<Vec<_>>());
    }
}

fn row(stress: f64, fabrics: &[&Fabric]) {
    let of = |value: fn(&Fabric) -> f64| Spread::of(fabrics.iter().map(|one| value(one)));
    println!(
        "| {} | {:.2} | {:.1} | {:.1} | {:.0} | {:.0} | {:.2} |",
        stress / 1e6,
        of(|one| one.chains.threshold / one.mean_normal_force),
        of(|one| 100.0 * one.chains.load),
        of(|one| 100.0 * f64::from(one.chains.grains) / 2740.0),
        of(|one| f64::from(one.chains.count)),
        of(|one| f64::from(one.chains.largest)),
        of(|one| one.chains.strongest_path.iter().sum::<f64>() / 3.0 / one.mean_normal_force),
    );
}

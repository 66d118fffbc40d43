//! The numbers of docs/validation.md, as its tables: mean over the seeds, lowest to highest.

use crate::curve::{Curve, Spread, at, by_place, exponent};
use crate::figures::{measures_of, moduli_of, sliding as build_up, smooth};
use crate::intervals::{Interval, between_events, whole};
use crate::runs::{COARSE, COARSE_THEN_FINE, CURRENT, FINE, FROM, ROUGH, Sample, Test};
use crate::theory::{self, Slip};

const MPA: f64 = 1e6;
const GPA: f64 = 1e9;

/// Grains of a sample.
const GRAINS: f64 = 2740.0;

/// Stresses of the exponents at low and high stress \[Pa\].
const EXPONENTS: [[f64; 2]; 2] = [[1e6, 11e6], [20e6, 115e6]];

/// Prints all of them.
pub(crate) fn print(samples: &[Sample]) {
    frictionless(samples);
    exponents(samples);
    sliding(samples);
    friction(samples);
    preparation(samples);
    increments(samples);
    laws(samples);
}

/// The values of `curves` at a stress.
fn spread(curves: &[Curve], stress: f64) -> Spread {
    Spread::of(curves.iter().map(|curve| at(curve, stress)))
}

pub(crate) fn head(title: &str, columns: &[&str]) {
    println!("\n{title}\n");
    println!("| {} |", columns.join(" | "));
    println!("|{}", " --- |".repeat(columns.len()));
}

fn frictionless(samples: &[Sample]) {
    head(
        "Frictionless packs",
        &[
            "stress [MPa]",
            "Z",
            "Z without rattlers",
            "porosity",
            "K [GPa]",
            "EMT K [GPa]",
            "G [GPa]",
            "E [GPa]",
            "K over ten increments [GPa]",
            "G over ten increments [GPa]",
        ],
    );
    let z = smooth::packs(samples, |at| at.state.coordination_number);
    let carrying = smooth::packs(samples, |at| {
        let state = &at.state;
        state.coordination_number * GRAINS / (GRAINS - f64::from(state.rattlers))
    });
    let porosity = smooth::packs(samples, |at| at.state.porosity);
    let [bulk, shear, young]: [Vec<Curve>; 3] =
        [|i: &Interval| i.bulk, |i: &Interval| i.shear, |i: &Interval| i.young]
            .map(|of| smooth::curves(samples, between_events, of));
    let [all_bulk, all_shear]: [Vec<Curve>; 2] = [|i: &Interval| i.bulk, |i: &Interval| i.shear]
        .map(|of| smooth::curves(samples, whole, of));
    let [z, carrying, porosity, bulk, shear, young, all_bulk, all_shear] =
        [&z, &carrying, &porosity, &bulk, &shear, &young, &all_bulk, &all_shear]
            .map(|curves| by_place(curves));
    for (k, (stress, z)) in z.iter().enumerate() {
        let (carrying, porosity) = (carrying[k].1, porosity[k].1);
        let medium = theory::moduli((1.0 - porosity.mean) * z.mean, *stress, Slip::Free)[0] / GPA;
        let [bulk, shear, young, all_bulk, all_shear] =
            [&bulk, &shear, &young, &all_bulk, &all_shear].map(|places| places[k].1.over(GPA));
        println!(
            "| {:.0} | {z:.2} | {carrying:.2} | {porosity:.3} | {bulk:.2} | {medium:.2} | {shear:.3} | \
             {young:.2} | {all_bulk:.2} | {all_shear:.3} |",
            stress / MPA
        );
    }
}

fn exponents(samples: &[Sample]) {
    head("Exponents of the power laws", &["modulus", "1 to 10 MPa", "20 to 110 MPa"]);
    let curves = [
        ("K", smooth::curves(samples, between_events, |i| i.bulk)),
        ("G", smooth::curves(samples, between_events, |i| i.shear)),
        ("K, effective medium of the packs", smooth::own_medium(samples, 0)),
        ("K of the compaction", smooth::compaction(samples)),
    ];
    for (name, curves) in curves {
        let [low, high] = EXPONENTS
            .map(|[from, to]| Spread::of(curves.iter().map(|curve| exponent(curve, from, to))));
        println!("| {name} | {low:.2} | {high:.2} |");
    }
}

fn sliding(samples: &[Sample]) {
    head(
        "Build-up of friction from 10 MPa, μ = 0.3, increments of 5e-5",
        &["stress [MPa]", "G [GPa]", "sliding ratio", "above 0.9 of the limit"],
    );
    let shear = build_up::shear(samples);
    let ratio = measures_of(samples, &FINE, |at| at.state.sliding_ratio);
    let near = measures_of(samples, &FINE, |at| at.near_limit);
    for stress in [10.5, 11.0, 12.0, 13.0, 15.0, 17.0, 19.0, 22.0, 25.0, 29.0] {
        let at = stress * MPA;
        let (shear, ratio, near) = (spread(&shear, at), spread(&ratio, at), spread(&near, at));
        println!("| {stress} | {:.2} | {ratio:.3} | {near:.3} |", shear.over(GPA));
    }
}

fn row(samples: &[Sample], name: &str, test: &Test, stress: f64) {
    let at = stress * MPA;
    let [bulk, shear, young] = [
        moduli_of(samples, test, |interval| interval.bulk),
        moduli_of(samples, test, |interval| interval.shear),
        moduli_of(samples, test, |interval| interval.young),
    ]
    .map(|curves| spread(&curves, at).over(GPA));
    let sliding = spread(&measures_of(samples, test, |at| at.state.sliding_ratio), at);
    let near = spread(&measures_of(samples, test, |at| at.near_limit), at);
    println!(
        "| {name} | {stress} | {bulk:.2} | {shear:.2} | {young:.2} | {sliding:.3} | {near:.3} |"
    );
}

const ROW: [&str; 7] = [
    "run",
    "stress [MPa]",
    "K [GPa]",
    "G [GPa]",
    "E [GPa]",
    "sliding ratio",
    "above 0.9 of the limit",
];

fn friction(samples: &[Sample]) {
    head("Uniaxial compression with friction, increments of 2e-4", &ROW);
    let runs: [(&str, &Test, &[f64]); 3] = [
        ("from 4 MPa, μ = 0.3", &FROM[0], &[6.0, 7.0, 9.0, 15.0, 19.0, 30.0, 60.0]),
        ("from 10 MPa, μ = 0.3", &FROM[1], &[12.0, 15.0, 19.0, 30.0, 60.0]),
        ("from 10 MPa, μ = 0.5", &ROUGH, &[12.0, 15.0, 19.0, 30.0, 55.0]),
    ];
    for (name, test, stresses) in runs {
        stresses.iter().for_each(|stress| row(samples, name, test, *stress));
    }
}

fn preparation(samples: &[Sample]) {
    head(
        "Start of the frictional compression, μ = 0.3",
        &["from [MPa]", "at [MPa]", "K/K(10)", "G/G(10)", "mean force/that from 10 MPa"],
    );
    for (stress, tests) in [(19.0, &FROM[..1]), (35.0, &FROM[..3]), (65.0, &FROM[..4])] {
        for test in tests {
            let ratio = |of: &dyn Fn(&Test) -> Vec<Curve>| {
                let (these, those) = (of(test), of(&FROM[1]));
                let pairs = these.iter().zip(&those);
                Spread::of(
                    pairs.map(|(this, that)| at(this, stress * MPA) / at(that, stress * MPA)),
                )
            };
            println!(
                "| {} | {stress} | {:.3} | {:.3} | {:.3} |",
                test.start / MPA,
                ratio(&|test| moduli_of(samples, test, |interval| interval.bulk)),
                ratio(&|test| moduli_of(samples, test, |interval| interval.shear)),
                ratio(&|test| measures_of(samples, test, |at| at.state.mean_normal_force)),
            );
        }
    }
}

fn increments(samples: &[Sample]) {
    head("Size of the increments, from 10 MPa, μ = 0.3", &ROW);
    for stress in [12.0, 15.0, 19.0, 25.0] {
        row(samples, "5e-5", &FINE, stress);
        row(samples, "2e-4", &FROM[1], stress);
        row(samples, "5e-4", &COARSE, stress);
        row(samples, "5e-4, then 5e-5", &COARSE_THEN_FINE, stress);
    }
}

fn laws(samples: &[Sample]) {
    head("Laws of friction, from 10 MPa, μ = 0.3, increments of 2e-4", &ROW);
    for stress in [15.0, 25.0] {
        row(samples, "return_map, frozen", &FROM[1], stress);
        row(samples, "return_map, current", &CURRENT, stress);
    }
}

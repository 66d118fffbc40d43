//! The numbers of the section on cement, as its tables.

use super::runs::{
    CONTENTS, EVOLUTIONS, EXPONENTIAL, FIXED, LAWS, Named, RENEWED, SIZES, SLIPS, STEPS, Sample,
    Samples, Test, UNCEMENTED,
};
use crate::curve::{Curve, Spread, at};
use crate::tables::head;

const MPA: f64 = 1e6;
const GPA: f64 = 1e9;

/// Stresses at which moduli are told \[MPa\].
const STRESSES: [f64; 5] = [1.0, 2.0, 3.0, 4.0, 5.0];

/// Axial strains at which increments of different size are compared.
const STRAINS: [f64; 2] = [5e-4, 1e-3];

/// Prints all of them.
pub(crate) fn print(samples: &Samples) {
    packs(samples);
    laws(samples);
    paths(samples);
    constant(samples);
    let young = |test: &Test| samples.young(test);
    moduli(
        "Young's modulus [GPa] against axial stress, evolution of the stiffness",
        &EVOLUTIONS,
        &young,
    );
    ratios(samples);
    moduli("Young's modulus [GPa] against axial stress, partial slip", &SLIPS, &young);
    moduli("Young's modulus [GPa] against axial stress, cement content", &CONTENTS, &young);
    increments(samples);
    let deviatoric = |test: &Test| samples.young_deviatoric(test);
    let beside = [LAWS[0], UNCEMENTED[0], UNCEMENTED[1]];
    moduli("Young's modulus [GPa] against deviatoric stress, without cement", &beside, &deviatoric);
    moduli("Young's modulus [GPa] against deviatoric stress, step by step", &STEPS, &deviatoric);
}

fn spread(curves: &[Curve], x: f64) -> Spread {
    Spread::of(curves.iter().map(|curve| at(curve, x)))
}

/// What the first interval of every seed has.
fn first(curves: &[Curve]) -> Spread {
    Spread::of(curves.iter().map(|curve| curve[0][1]))
}

fn packs(samples: &Samples) {
    head("Packs", &["seed", "porosity", "Z", "bonds of touching bodies", "bonds across gaps"]);
    for sample in &samples.seeds {
        let course = sample.of(&EXPONENTIAL);
        let before = sample.of(&UNCEMENTED[1].1).states[0];
        let [touching, across] = course.bonds;
        println!(
            "| {} | {:.3} | {:.2} | {touching} | {across} |",
            sample.seed, before.porosity, before.coordination_number
        );
    }
}

fn laws(samples: &Samples) {
    let young = |test: &Test| samples.young_deviatoric(test);
    moduli("Young's modulus [GPa] against deviatoric stress, five laws", &LAWS, &young);
}

/// Rows of moduli at the first increment and at [`STRESSES`].
fn moduli(title: &str, tests: &[Named], young: &dyn Fn(&Test) -> Vec<Curve>) {
    let columns = STRESSES.map(|stress| format!("{stress:.0} MPa"));
    let mut names = vec!["", "first increment"];
    names.extend(columns.iter().map(String::as_str));
    names.push("5 MPa over first");
    head(title, &names);
    for (name, test) in tests {
        let curves = young(test);
        let growth = |curve: &Curve| at(curve, 5.0 * MPA) / curve[0][1];
        print!("| {name} | {:.2} |", first(&curves).over(GPA));
        for stress in STRESSES {
            match spread(&curves, stress * MPA) {
                there if there.mean.is_finite() => print!(" {:.2} |", there.over(GPA)),
                _ => print!(" - |"),
            }
        }
        match Spread::of(curves.iter().map(growth)) {
            growth if growth.mean.is_finite() => println!(" {growth:.2} |"),
            _ => println!(" - |"),
        }
    }
}

/// How the tests went.
fn paths(samples: &Samples) {
    head(
        "Path of the tests",
        &[
            "",
            "axial strain at a deviatoric stress of 5 MPa [1e-3]",
            "lateral stress there [MPa]",
            "Poisson's ratio, first increment",
            "Poisson's ratio there",
        ],
    );
    for (name, test) in LAWS.iter().chain(&[SLIPS[0], SLIPS[2]]) {
        let turned: Vec<Curve> = samples
            .stress(test)
            .iter()
            .map(|curve| curve.iter().map(|[strain, stress]| [*stress, *strain]).collect())
            .collect();
        let lateral = samples.curves(test, |at| at.deviatoric, |at| at.lateral);
        let poisson = samples.curves(test, |at| at.deviatoric, |at| at.poisson);
        println!(
            "| {name} | {:.2} | {:.2} | {:.3} | {:.3} |",
            spread(&turned, 5.0 * MPA).over(1e-3),
            spread(&lateral, 5.0 * MPA).over(MPA),
            first(&poisson),
            spread(&poisson, 5.0 * MPA),
        );
    }
}

/// How constant the modulus of the fixed law is.
fn constant(samples: &Samples) {
    head(
        "Young's modulus of the fixed law, all increments up to 5 MPa",
        &["seed", "lowest over first", "highest over first"],
    );
    for (sample, curve) in samples.seeds.iter().zip(samples.young_deviatoric(&FIXED)) {
        let inside = curve.iter().filter(|[stress, _]| *stress <= 5.0 * MPA);
        let all = Spread::of(inside.map(|[_, young]| young / curve[0][1]));
        println!("| {} | {:.4} | {:.4} |", sample.seed, all.low, all.high);
    }
}

fn ratios(samples: &Samples) {
    let mut names = vec!["ratio of E", "first increment"];
    let columns = STRESSES.map(|stress| format!("{stress:.0} MPa"));
    names.extend(columns.iter().map(String::as_str));
    head("Ratios of Young's moduli at the same axial stress", &names);
    let pairs = [
        ("γ = 1000 over (1111, 1)", EVOLUTIONS[1], EVOLUTIONS[4]),
        ("γ = 3000 over (1428, 2)", EVOLUTIONS[0], EVOLUTIONS[2]),
        ("(1428, 1) over (1111, 1)", EVOLUTIONS[3], EVOLUTIONS[4]),
        ("κ = 0.2 over 0.01", CONTENTS[1], CONTENTS[0]),
        ("Cs = 0 over 0.1", SLIPS[0], SLIPS[1]),
        ("Cs = 1 over 0.1", SLIPS[2], SLIPS[1]),
    ];
    for (name, (_, over), (_, under)) in pairs {
        let (over, under) = (samples.young(&over), samples.young(&under));
        let pairs = || over.iter().zip(&under);
        print!("| {name} | {:.3} |", Spread::of(pairs().map(|(a, b)| a[0][1] / b[0][1])));
        for stress in STRESSES.map(|stress| stress * MPA) {
            let ratio = Spread::of(pairs().map(|(a, b)| at(a, stress) / at(b, stress)));
            print!(" {ratio:.3} |");
        }
        println!();
    }
}

/// Deviation of `of` the runs of `test` from the smallest increments with stiffnesses of their middle, per cent.
fn deviation(samples: &Samples, test: &Test, of: impl Fn(&Sample, &Test) -> f64) -> Spread {
    let of = |sample: &Sample| of(sample, test) / of(sample, &RENEWED[0]) - 1.0;
    Spread::of(samples.seeds.iter().map(of)).over(0.01)
}

fn increments(samples: &Samples) {
    head(
        "Size of the increments, exponential law, deviation from renewed increments of 1.25e-5 [%]",
        &[
            "increments",
            "shear stiffness of",
            "stress at 5e-4",
            "stress at 1e-3",
            "E from 0 to 5e-4",
            "E from 5e-4 to 1e-3",
        ],
    );
    for (test, of) in SIZES
        .iter()
        .map(|test| (test, "the start"))
        .chain(RENEWED[1..].iter().map(|test| (test, "the middle")))
    {
        let stress = STRAINS.map(|strain| {
            deviation(samples, test, |sample, test| {
                let states = &sample.of(test).states;
                let curve: Curve =
                    states.iter().map(|s| [s.strain[2], s.deviatoric_stress]).collect();
                at(&curve, strain * (1.0 - 1e-9))
            })
        });
        let young = [0, 1].map(|k| {
            deviation(samples, test, |sample, test| sample.of(test).intervals(STRAINS[0])[k].young)
        });
        println!(
            "| {:e} | {of} | {:.2} | {:.2} | {:.2} | {:.2} |",
            test.increment, stress[0], stress[1], young[0], young[1]
        );
    }
}

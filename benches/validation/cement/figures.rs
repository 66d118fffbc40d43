//! Figures 4.7 to 4.12.

use graintwin::view::{Axis, Chart, Series, Sheet, Unit};

use super::runs::{
    CONTENTS, EVOLUTIONS, LAWS, Named, RENEWED, SIZES, SLIPS, Samples, Test, UNCEMENTED,
};
use crate::curve::{Curve, Spread, at, even, over_seeds};
use crate::figures::{drawn, guide};

/// Highest stress that is drawn \[Pa\].
const HIGHEST: f64 = 5e6;

/// Least and largest Young's modulus of the thesis' exponential law \[Pa\] (T 4.8.4.3).
const THESIS: [f64; 2] = [2.7e9, 9.5e9];

/// Strain up to which the increments are compared.
const COMPARED: f64 = 1e-3;

/// The sheets by the name of their file without its ending.
pub(crate) fn sheets(samples: &Samples) -> Vec<(&'static str, Sheet)> {
    vec![("validation_cement", laws(samples)), ("validation_cement_constants", constants(samples))]
}

fn subtitle(samples: &Samples, of: &str) -> String {
    let seeds: Vec<String> = samples.seeds.iter().map(|sample| sample.seed.to_string()).collect();
    format!(
        "2699 grains of quartz, cemented at 10 MPa; axial compression in increments of 5e-5 with \
         a quarter of it as lateral expansion; lines: mean of the seeds {}, bands: lowest to \
         highest. {of}",
        seeds.join(", ")
    )
}

fn stresses() -> Vec<f64> {
    even(0.0, HIGHEST, 0.05e6)
}

fn lines(tests: &[Named], of: &dyn Fn(&Test) -> Vec<Curve>) -> Vec<Series> {
    let line = |(number, (name, test)): (usize, &Named)| {
        drawn(number, name, &over_seeds(&of(test), &stresses()))
    };
    tests.iter().enumerate().map(line).collect()
}

fn against(title: &str, stress: &str, series: Vec<Series>) -> Chart {
    Chart {
        title: title.into(),
        x: Axis::linear(stress, Unit::Si("Pa")),
        y: Axis::linear("Young's modulus E", Unit::Si("Pa")),
        series,
        notes: Vec::new(),
    }
}

fn laws(samples: &Samples) -> Sheet {
    let axial = |test: &Test| samples.young(test);
    let deviatoric = |test: &Test| samples.young_deviatoric(test);
    let mut reproduced = lines(&LAWS[..1], &axial);
    for (number, modulus) in THESIS.into_iter().enumerate() {
        let name = if number == 0 { "thesis: from 2.7 to 9.5 GPa" } else { "" };
        reproduced.push(guide(name, vec![[0.0, modulus], [HIGHEST, modulus]]));
    }
    let strains = even(0.0, 2.2e-3, 5e-6);
    let curves = LAWS.iter().enumerate().map(|(number, (name, test))| {
        let places = over_seeds(&samples.stress(test), &strains);
        let inside: Vec<(f64, Spread)> =
            places.into_iter().filter(|(_, stress)| stress.mean <= 1.1 * HIGHEST).collect();
        drawn(number, name, &inside)
    });
    let curves = curves.collect();
    Sheet {
        title: "Cemented quartz: five laws (thesis figs. 4.7 to 4.9)".into(),
        subtitle: subtitle(samples, "E by least squares over each increment."),
        charts: vec![
            against("E against axial stress (4.7)", "axial stress", reproduced),
            Chart {
                title: "Deviatoric stress against axial strain (4.8)".into(),
                x: Axis::linear("axial strain", Unit::Strain),
                y: Axis::linear("deviatoric stress", Unit::Si("Pa")),
                series: curves,
                notes: Vec::new(),
            },
            against(
                "E against deviatoric stress (4.9)",
                "deviatoric stress",
                lines(&LAWS, &deviatoric),
            ),
            against(
                "The same packs without cement, from 10 MPa",
                "deviatoric stress",
                lines(&[LAWS[0], UNCEMENTED[0], UNCEMENTED[1]], &deviatoric),
            ),
        ],
    }
}

fn constants(samples: &Samples) -> Sheet {
    let axial = |test: &Test| samples.young(test);
    let sensitivity =
        |title: &str, tests: &[Named]| against(title, "axial stress", lines(tests, &axial));
    Sheet {
        title: "Cemented quartz: constants of the laws (thesis figs. 4.10 to 4.12)".into(),
        subtitle: subtitle(samples, "E by least squares over each increment."),
        charts: vec![
            sensitivity("Evolution of the stiffness (4.10)", &EVOLUTIONS),
            sensitivity("Partial slip (4.11)", &SLIPS),
            sensitivity("Cement content (4.12)", &CONTENTS),
            sizes(samples),
        ],
    }
}

/// Deviation of the stress from that of the smallest increments with stiffnesses of their middle.
fn sizes(samples: &Samples) -> Chart {
    let reference = samples.stress(&RENEWED[0]);
    let line = |number: usize, name: String, test: &Test| {
        let count = (COMPARED / test.increment).round() as usize;
        let place = |k: usize| {
            let strain = test.increment * k as f64 * (1.0 - 1e-9);
            let curves = samples.stress(test);
            let off = curves.iter().zip(&reference).map(|(curve, reference)| {
                100.0 * (at(curve, strain) / at(reference, strain) - 1.0)
            });
            (strain, Spread::of(off))
        };
        drawn(number, &name, &(1..=count).map(place).collect::<Vec<_>>())
    };
    let frozen = SIZES.iter().map(|test| (format!("{:e}", test.increment), test));
    let renewed = (format!("{:e}, renewed within", RENEWED[3].increment), &RENEWED[3]);
    let all = frozen.chain([renewed]).enumerate();
    Chart {
        title: "Stress against that of renewed increments of 1.25e-5".into(),
        x: Axis::linear("axial strain", Unit::Strain),
        y: Axis::linear("deviation of the deviatoric stress [%]", Unit::None),
        series: all.map(|(number, (name, test))| line(number, name, test)).collect(),
        notes: Vec::new(),
    }
}

//! The tests on the sample of one seed.

use graintwin::scene::{Cement, CementLaw, Exponential, Parallel, Power, Update};

use super::course::{Course, Interval};
use super::sample::compacted;
use crate::curve::Curve;

/// Axial and deviatoric stress beyond which a test ends \[Pa\]: the thesis' 5 MPa and some.
pub(crate) const END: f64 = 7e6;

/// Axial strain beyond which it ends at the latest.
pub(crate) const LONGEST: f64 = 3e-3;

/// Axial strain of the increments when nothing else is said.
pub(crate) const STANDARD: f64 = 5e-5;

/// A uniaxial stress test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Test {
    pub(crate) name: &'static str,
    /// Without it the grains are as they were compacted.
    pub(crate) cement: Option<Cement>,
    /// Friction of contacts without cement.
    pub(crate) friction: f64,
    /// Whether stiffnesses in shear are those of the increment's start.
    pub(crate) update: Update,
    /// Axial strain of an increment.
    pub(crate) increment: f64,
}

const fn cemented(name: &'static str, law: CementLaw) -> Test {
    let cement =
        Cement { law, kappa: 0.01, partial_slip: 0.1, bridge: 0.1, walls: true, strength: None };
    Test { name, cement: Some(cement), friction: 0.0, update: Update::Frozen, increment: STANDARD }
}

const fn exponential(name: &'static str, gamma: f64) -> Test {
    cemented(name, CementLaw::Exponential(Exponential { gamma }))
}

const fn power(name: &'static str, eta: f64, omega: f64) -> Test {
    cemented(name, CementLaw::Power(Power { eta, omega }))
}

/// The exponential law of sample Q2699-1 % (T 4.8.1).
pub(crate) const EXPONENTIAL: Test = exponential("exponential, γ = 3000", 3000.0);
pub(crate) const POWER: Test = power("power, η = 1111, ω = 1", 1111.0, 1.0);
pub(crate) const FIXED: Test = cemented("fixed, γ = 0", CementLaw::Fixed);
pub(crate) const LINEAR_ELASTIC: Test = cemented("linear-elastic cement", CementLaw::LinearElastic);
/// The thesis gives the moduli of glass in MPa; glass has them in GPa.
pub(crate) const PARALLEL: Test = cemented(
    "parallel bond",
    CementLaw::Parallel(Parallel {
        young: 70e9,
        shear: 29.2e9,
        radius_ratio: 0.003,
        length_ratio: 0.001,
    }),
);
/// The five laws of figures 4.8 and 4.9.
pub(crate) const LAWS: [Test; 5] = [EXPONENTIAL, POWER, FIXED, LINEAR_ELASTIC, PARALLEL];

pub(crate) const SLOW: Test = exponential("exponential, γ = 1000", 1000.0);
pub(crate) const SQUARE: Test = power("power, η = 1428, ω = 2", 1428.0, 2.0);
pub(crate) const STEEP: Test = power("power, η = 1428, ω = 1", 1428.0, 1.0);
/// Those of figure 4.10.
pub(crate) const EVOLUTIONS: [Test; 5] = [EXPONENTIAL, SLOW, SQUARE, STEEP, POWER];

const fn with(name: &'static str, kappa: f64, partial_slip: f64) -> Test {
    let Test { cement: Some(cement), .. } = EXPONENTIAL else { return EXPONENTIAL };
    Test { name, cement: Some(Cement { kappa, partial_slip, ..cement }), ..EXPONENTIAL }
}

/// Those of figure 4.11.
pub(crate) const SLIPS: [Test; 3] =
    [with("exponential, Cs = 0", 0.01, 0.0), EXPONENTIAL, with("exponential, Cs = 1", 0.01, 1.0)];
/// Those of figure 4.12.
pub(crate) const CONTENTS: [Test; 2] = [EXPONENTIAL, with("exponential, κ = 0.2", 0.2, 0.1)];

/// Increments of other sizes; the first is the measure of the others.
pub(crate) const SIZES: [Test; 5] = [
    Test { increment: 1.25e-5, ..EXPONENTIAL },
    Test { increment: 2.5e-5, ..EXPONENTIAL },
    EXPONENTIAL,
    Test { increment: 1e-4, ..EXPONENTIAL },
    Test { increment: 5e-4, ..EXPONENTIAL },
];

/// Shear stiffnesses of the middle of the increment. Contacts without cement, of which there are
/// none, have friction: without any the program does not renew.
const fn renewed(increment: f64) -> Test {
    Test { increment, friction: 0.3, update: Update::Current, ..EXPONENTIAL }
}
pub(crate) const RENEWED: [Test; 3] = [renewed(5e-5), renewed(1e-4), renewed(5e-4)];

/// The same pack without cement.
pub(crate) const ROUGH: Test =
    Test { name: "without cement, μ = 0.3", cement: None, friction: 0.3, ..EXPONENTIAL };
pub(crate) const SMOOTH: Test = Test { name: "without cement, μ = 0", friction: 0.0, ..ROUGH };
/// Both.
pub(crate) const UNCEMENTED: [Test; 2] = [ROUGH, SMOOTH];

/// The tests of a seed.
pub(crate) struct Sample {
    pub(crate) seed: u64,
    tests: Vec<(Test, Course)>,
}

impl Sample {
    /// Makes the pack of `seed` and runs all tests on it.
    pub(crate) fn run(seed: u64) -> Self {
        let pack = compacted(seed);
        let mut all: Vec<Test> = Vec::new();
        let groups = [&LAWS[..], &EVOLUTIONS, &SLIPS, &CONTENTS, &SIZES, &RENEWED, &UNCEMENTED];
        for test in groups.into_iter().flatten() {
            if !all.contains(test) {
                all.push(*test);
            }
        }
        let tests: Vec<(Test, Course)> =
            all.into_iter().map(|test| (test, Course::run(&test, seed, &pack))).collect();
        Self { seed, tests }
    }

    pub(crate) fn of(&self, test: &Test) -> &Course {
        let found = self.tests.iter().find(|(other, _)| other == test);
        &found.expect("every test is run").1
    }
}

/// The samples of all seeds.
pub(crate) struct Samples {
    pub(crate) seeds: Vec<Sample>,
}

impl Samples {
    /// A measure of the intervals of `test`, of one increment each, against another, by seed.
    pub(crate) fn curves(
        &self,
        test: &Test,
        x: fn(&Interval) -> f64,
        y: fn(&Interval) -> f64,
    ) -> Vec<Curve> {
        let curve = |sample: &Sample| -> Curve {
            let intervals = sample.of(test).intervals(test.increment);
            intervals.iter().map(|interval| [x(interval), y(interval)]).collect()
        };
        self.seeds.iter().map(curve).collect()
    }

    /// Young's modulus against axial stress.
    pub(crate) fn young(&self, test: &Test) -> Vec<Curve> {
        self.curves(test, |interval| interval.axial, |interval| interval.young)
    }

    /// Young's modulus against deviatoric stress.
    pub(crate) fn young_deviatoric(&self, test: &Test) -> Vec<Curve> {
        self.curves(test, |interval| interval.deviatoric, |interval| interval.young)
    }

    /// Deviatoric stress against axial strain.
    pub(crate) fn stress(&self, test: &Test) -> Vec<Curve> {
        let curve = |sample: &Sample| -> Curve {
            let states = &sample.of(test).states;
            states.iter().map(|state| [state.strain[2], state.deviatoric_stress]).collect()
        };
        self.seeds.iter().map(curve).collect()
    }
}

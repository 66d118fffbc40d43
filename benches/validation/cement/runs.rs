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
    /// Without it the grains are as they were compacted.
    pub(crate) cement: Option<Cement>,
    /// Friction of contacts without cement.
    pub(crate) friction: f64,
    /// Whether stiffnesses in shear are those of the increment's start.
    pub(crate) update: Update,
    /// Axial strain of an increment.
    pub(crate) increment: f64,
}

/// A test by the name that it has beside others.
pub(crate) type Named = (&'static str, Test);

/// The cement of sample Q2699-1 % (T 4.8.1).
const CEMENT: Cement = Cement {
    law: CementLaw::Fixed,
    kappa: 0.01,
    partial_slip: 0.1,
    bridge: 0.1,
    walls: true,
    strength: None,
};

const fn of(cement: Cement) -> Test {
    let cement = Some(cement);
    Test { cement, friction: 0.0, update: Update::Frozen, increment: STANDARD }
}

const fn law(law: CementLaw) -> Test {
    of(Cement { law, ..CEMENT })
}

const fn growing(gamma: f64) -> CementLaw {
    CementLaw::Exponential(Exponential { gamma })
}

const fn power(eta: f64, omega: f64) -> Test {
    law(CementLaw::Power(Power { eta, omega }))
}

/// The law of figure 4.7.
pub(crate) const EXPONENTIAL: Test = law(growing(3000.0));
pub(crate) const FIXED: Test = of(CEMENT);
/// The thesis gives the moduli of glass in MPa; glass has them in GPa.
const PARALLEL: Test = law(CementLaw::Parallel(Parallel {
    young: 70e9,
    shear: 29.2e9,
    radius_ratio: 0.003,
    length_ratio: 0.001,
}));

/// The five laws of figures 4.8 and 4.9.
pub(crate) const LAWS: [Named; 5] = [
    ("exponential, γ = 3000", EXPONENTIAL),
    ("power, η = 1111, ω = 1", power(1111.0, 1.0)),
    ("fixed, γ = 0", FIXED),
    ("linear-elastic cement", law(CementLaw::LinearElastic)),
    ("parallel bond", PARALLEL),
];

/// Those of figure 4.10.
pub(crate) const EVOLUTIONS: [Named; 5] = [
    ("γ = 3000", EXPONENTIAL),
    ("γ = 1000", law(growing(1000.0))),
    ("η = 1428, ω = 2", power(1428.0, 2.0)),
    ("η = 1428, ω = 1", power(1428.0, 1.0)),
    ("η = 1111, ω = 1", power(1111.0, 1.0)),
];

const fn slip(partial_slip: f64) -> Test {
    of(Cement { law: growing(3000.0), partial_slip, ..CEMENT })
}

/// Those of figure 4.11.
pub(crate) const SLIPS: [Named; 3] =
    [("Cs = 0", slip(0.0)), ("Cs = 0.1", EXPONENTIAL), ("Cs = 1", slip(1.0))];

const MORE: Test = of(Cement { law: growing(3000.0), kappa: 0.2, ..CEMENT });

/// Those of figure 4.12.
pub(crate) const CONTENTS: [Named; 2] = [("κ = 0.01", EXPONENTIAL), ("κ = 0.2", MORE)];

/// Increments of other sizes; the first is the measure of the others.
pub(crate) const SIZES: [Test; 5] = [
    Test { increment: 1.25e-5, ..EXPONENTIAL },
    Test { increment: 2.5e-5, ..EXPONENTIAL },
    EXPONENTIAL,
    Test { increment: 1e-4, ..EXPONENTIAL },
    Test { increment: 5e-4, ..EXPONENTIAL },
];

/// Stiffnesses in shear of the middle of the increment. Contacts without cement, of which there
/// are none, have friction: without any the program does not renew.
const fn renewed(increment: f64) -> Test {
    Test { increment, friction: 0.3, update: Update::Current, ..EXPONENTIAL }
}
pub(crate) const RENEWED: [Test; 4] =
    [renewed(1.25e-5), renewed(5e-5), renewed(1e-4), renewed(5e-4)];

const fn without(friction: f64) -> Test {
    Test { cement: None, friction, ..EXPONENTIAL }
}

/// The same packs without cement.
pub(crate) const UNCEMENTED: [Named; 2] =
    [("no cement, μ = 0.3", without(0.3)), ("no cement, μ = 0", without(0.0))];

/// What the cement adds, step by step: from contacts that stick and no more to the fixed law.
pub(crate) const STEPS: [Named; 5] = [
    ("no cement, μ = ∞", without(f64::INFINITY)),
    ("fixed, touching only, κ = 0, Cs = 1", {
        of(Cement { kappa: 0.0, partial_slip: 1.0, bridge: 0.0, ..CEMENT })
    }),
    ("fixed, touching only, κ = 0.01, Cs = 1", {
        of(Cement { partial_slip: 1.0, bridge: 0.0, ..CEMENT })
    }),
    ("fixed, touching only, κ = 0.01, Cs = 0.1", of(Cement { bridge: 0.0, ..CEMENT })),
    ("fixed", FIXED),
];

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
        let groups = [&LAWS[..], &EVOLUTIONS, &SLIPS, &CONTENTS, &UNCEMENTED, &STEPS];
        let named = groups.into_iter().flatten().map(|(_, test)| *test);
        for test in named.chain(SIZES).chain(RENEWED) {
            if !all.contains(&test) {
                all.push(test);
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

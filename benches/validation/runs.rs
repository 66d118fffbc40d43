//! The runs on the sample of one seed.

use graintwin::pack::Pack;
use graintwin::scene::{Solver, Update};
use graintwin::wall::Bounds;

use crate::specimen::{Equilibrium, Press, Setting, TOLERANCE, compact, loose};

/// Stresses to which the sample is compacted without friction \[Pa\] (T 3.6.4.1).
pub(crate) const STARTS: [f64; 6] = [4e6, 10e6, 20e6, 41e6, 54e6, 74e6];

/// Strain of the increments when nothing else is said.
pub(crate) const STANDARD: f64 = 2e-4;

/// Stresses of the frictionless tests besides `LOOSE` and [`STARTS`]: the lowest \[Pa\].
const FIRST: f64 = 2e6;

/// The highest \[Pa\].
const LAST: f64 = 110e6;

/// Increments of a frictionless test.
const SMOOTH_INCREMENTS: usize = 10;

/// Their strain at 10 MPa; it follows the overlaps, which grow as the stress to the power 2/3.
const SMOOTH_STRAIN: f64 = 1e-4;

/// A pack that was compacted without friction, and a short uniaxial compression of it.
#[derive(Clone, Debug)]
pub(crate) struct Smooth {
    /// Volume of its box \[m³\].
    pub(crate) volume: f64,
    /// Equilibria of the compression.
    pub(crate) course: Vec<Equilibrium>,
}

/// A uniaxial compression with friction that starts from an isotropic stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Test {
    /// Isotropic stress at the start \[Pa\].
    pub(crate) start: f64,
    pub(crate) friction: f64,
    pub(crate) update: Update,
    /// Axial strain of the increments in phase (b) and in the test.
    pub(crate) increments: [f64; 2],
    /// Confining stress at the end of the test \[Pa\].
    pub(crate) end: f64,
}

/// The default: μ = 0.3 from 10 MPa to 70 MPa.
const TEST: Test = Test {
    start: 10e6,
    friction: 0.3,
    update: Update::Frozen,
    increments: [STANDARD; 2],
    end: 70e6,
};

/// From each of [`STARTS`]. The later ones end higher, so that they too get beyond the build-up.
pub(crate) const FROM: [Test; 6] = [
    Test { start: STARTS[0], ..TEST },
    TEST,
    Test { start: STARTS[2], ..TEST },
    Test { start: STARTS[3], end: 80e6, ..TEST },
    Test { start: STARTS[4], end: 100e6, ..TEST },
    Test { start: STARTS[5], end: 100e6, ..TEST },
];

/// With more friction.
pub(crate) const ROUGH: Test = Test { friction: 0.5, end: 60e6, ..TEST };

/// Small increments.
pub(crate) const FINE: Test = Test { increments: [5e-5; 2], end: 30e6, ..TEST };

/// Large increments.
pub(crate) const COARSE: Test = Test { increments: [5e-4; 2], end: 30e6, ..TEST };

/// Large increments in phase (b), small ones after it.
pub(crate) const COARSE_THEN_FINE: Test = Test { increments: [5e-4, 5e-5], end: 30e6, ..TEST };

/// The limit of the tangential force renewed within the increment.
pub(crate) const CURRENT: Test = Test { update: Update::Current, end: 30e6, ..TEST };

/// Confining stress at which phase (b) ends and the test begins \[Pa\] (T 3.6.3.2); for the other
/// starts the thesis names none.
pub(crate) fn phase_end(start: f64) -> Option<f64> {
    [(4e6, 9e6), (10e6, 19e6)].into_iter().find(|(from, _)| *from == start).map(|(_, end)| end)
}

/// The runs of a seed.
pub(crate) struct Sample {
    pub(crate) seed: u64,
    /// Without friction, stress rising.
    pub(crate) smooth: Vec<Smooth>,
    /// With friction.
    pub(crate) tests: Vec<(Test, Vec<Equilibrium>)>,
}

impl Sample {
    /// Makes the sample of `seed` and runs all tests on it.
    pub(crate) fn run(seed: u64) -> Self {
        let loose = loose(seed);
        let reference = loose.bounds;
        let mut starts: Vec<Pack> = Vec::new();
        for stress in STARTS {
            let before = starts.last().unwrap_or(&loose);
            starts.push(compact(before, seed, stress));
        }
        let first = compact(&loose, seed, FIRST);
        let last = compact(starts.last().unwrap_or(&loose), seed, LAST);
        let all = [&loose, &first].into_iter().chain(&starts).chain([&last]);
        let smooth = all.map(|pack| smooth(seed, pack)).collect();
        let tests = Self::all().into_iter().map(|test| {
            let pack = STARTS.iter().zip(&starts).find(|(stress, _)| **stress == test.start);
            let (_, pack) = pack.expect("the tests start from STARTS");
            (test, run(&test, seed, pack, reference))
        });
        Self { seed, smooth, tests: tests.collect() }
    }

    /// The tests with friction.
    pub(crate) fn all() -> Vec<Test> {
        FROM.into_iter().chain([ROUGH, FINE, COARSE, COARSE_THEN_FINE, CURRENT]).collect()
    }

    /// The equilibria of a test.
    pub(crate) fn of(&self, test: &Test) -> &[Equilibrium] {
        let found = self.tests.iter().find(|(other, _)| other == test);
        &found.expect("every test is run").1
    }
}

fn smooth(seed: u64, pack: &Pack) -> Smooth {
    let solver = Solver { tolerance: TOLERANCE, ..Solver::default() };
    let mut press = Press::new(
        seed,
        Setting { friction: 0.0, update: Update::Frozen, solver },
        pack,
        pack.bounds,
    );
    let strain = SMOOTH_STRAIN * (press.confining_stress() / 10e6).powf(2.0 / 3.0);
    for _ in 0..SMOOTH_INCREMENTS {
        if !press.strain(strain) {
            break;
        }
    }
    Smooth { volume: pack.bounds.volume(), course: press.course }
}

fn run(test: &Test, seed: u64, pack: &Pack, reference: Bounds) -> Vec<Equilibrium> {
    let [first, then] = test.increments;
    // Increments as asked for, whatever the overlaps are.
    let solver = Solver {
        max_strain_increment: first.max(then),
        max_overlap_share: 100.0,
        tolerance: TOLERANCE,
        ..Solver::default()
    };
    let Test { friction, update, .. } = *test;
    let mut press = Press::new(seed, Setting { friction, update, solver }, pack, reference);
    let phase_end = phase_end(test.start).unwrap_or(test.start);
    while press.confining_stress() < test.end {
        let phase_b = press.confining_stress() < phase_end;
        if !press.strain(if phase_b { first } else { then }) {
            break;
        }
    }
    press.course
}

//! The estimate of the error of the wall forces against the error itself: every increment is
//! solved again from where it ended, to the last digit that double precision gives.

use graintwin::contact::hertz;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::advance::advance;
use graintwin::relax::{Status, Workspace, newton, relax};
use graintwin::scene::{Coulomb, Friction, Law, Method, Scene, Update};
use graintwin::state::State;
use graintwin::wall::{self, standing};

use crate::packs::{E_WALL, Rig, bead, by_strain, centered, close, made, scene_to};

/// Tolerance of the solution that counts as exact.
const EXACT: f64 = 1e-12;
/// Increments that every pack takes.
const INCREMENTS: u32 = 5;

/// Numbers that look random (xorshift64).
struct Random(u64);

impl Random {
    /// Between 0 and 1.
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Between `low` and `high`, as likely in each decade.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// One increment.
struct Sample {
    estimate: f64,
    error: f64,
    tight: bool,
}

/// Takes `pack` along a random path and compares every increment that was solved in one piece.
fn walk(scene: &Scene, pack: &Pack, random: &mut Random, samples: &mut Vec<Sample>) {
    let model = Model::new(pack, scene);
    let mut exact = model.clone();
    exact.solver.method = Method::Newton;
    exact.solver.tolerance = EXACT;
    exact.solver.max_iterations = Some(100);
    let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
    let mut again = Workspace::new(&exact);
    // Nobody is there to follow an instability downhill.
    again.follows = false;
    work.start(&model, &state);
    let mut here = relax(&model, &mut state, &mut work);
    if !here.status.is_equilibrium() {
        // Rounding allows no such tolerance.
        return;
    }
    work.commit(&model, &mut state);
    let size = random.decades(1e-6, 1e-3);
    for _ in 0..INCREMENTS {
        let strain = [(); 3].map(|()| size * (random.next() - 0.3));
        let step = by_strain(&pack.bounds, strain);
        let target = std::array::from_fn(|w| state.displacement[w] + step[w]);
        let start = state.clone();
        let reached = advance(&model, &mut state, &mut work, &standing(&target), here);
        here = reached.outcome;
        if here.status != Status::Converged || reached.substeps != 1 {
            break;
        }
        let mut end = state.clone();
        again.begin(&exact, &start);
        newton::solve(&exact, &mut end, &mut again);
        let force = walls::normal_forces(&model, &state, &work.neighbours);
        let truth = walls::normal_forces(&exact, &end, &again.neighbours);
        let error = (0..wall::COUNT).map(|w| (force[w] - truth[w]).abs()).fold(0.0, f64::max);
        let tight = scene.solver.tolerance < 1e-9;
        samples.push(Sample { estimate: reached.wall_force_error, error, tight });
    }
}

/// The samples of `packs` random packs; `solver` chooses method and tolerance.
fn suite(seed: u64, packs: u64, mut solver: impl FnMut(&mut Random) -> Scene) -> Vec<Sample> {
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ seed);
    let mut samples = Vec::new();
    for k in 0..packs {
        let grains = random.decades(20.0, 200.0) as usize;
        let mut pack = made(grains, random.decades(2e4, 2e7), 1000 * seed + k);
        let mut scene = solver(&mut random);
        // In one piece, whatever it does to the pack.
        scene.solver.max_strain_increment = 0.1;
        scene.solver.max_overlap_share = 100.0;
        if random.next() < 0.5 {
            let (coefficient, law, update) = (0.3, Law::ReturnMap, Update::Frozen);
            scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
            pack.grains.iter_mut().for_each(|grain| grain.friction = coefficient);
        }
        walk(&scene, &pack, &mut random, &mut samples);
    }
    samples
}

/// Asserts that at least 99 % of the errors are within the estimate, and that half of the
/// estimates are less than ten times too large.
fn trusted(samples: &[&Sample], least: usize) {
    let count = samples.len();
    assert!(count >= least, "{count} increments are too few");
    let bounded = samples.iter().filter(|s| s.error <= s.estimate).count();
    assert!(100 * bounded >= 99 * count, "{bounded} of {count} are bounded");
    let mut ratios: Vec<f64> = samples.iter().map(|s| s.estimate / s.error).collect();
    ratios.sort_by(f64::total_cmp);
    let median = ratios[count / 2];
    assert!((1.0..10.0).contains(&median), "the median is {median} times too large");
}

#[test]
fn newtons_wall_forces_are_within_the_estimate() {
    let samples = suite(1, 110, |random| scene_to(random.decades(1e-12, 1e-3)));
    trusted(&samples.iter().collect::<Vec<_>>(), 450);
    // Down there rounding is as large as the residual.
    let tight: Vec<_> = samples.iter().filter(|sample| sample.tight).collect();
    trusted(&tight, 100);
}

#[test]
fn the_other_methods_wall_forces_are_within_the_estimate() {
    let mut k = 0;
    let samples = suite(2, 45, |random| {
        let methods = [Method::ConjugateGradient, Method::GaussSeidel, Method::Dynamic];
        let mut scene = scene_to(random.decades(1e-7, 1e-3));
        scene.solver.method = methods[k % 3];
        k += 1;
        scene
    });
    trusted(&samples.iter().collect::<Vec<_>>(), 180);
}

/// A sphere between two walls `h` into each of them, in a box 2 mm wide across.
fn between(h: f64, off: f64) -> Pack {
    let radius = 1e-4;
    let bounds = centered([2e-3, 2e-3, 2.0 * (radius - h)]);
    Pack { bounds, grains: vec![bead([0.0, 0.0, off], radius)], history: None }
}

#[test]
fn the_estimate_of_a_sphere_off_its_place_is_that_of_hertz() {
    // Off by d a sphere presses k d harder on one wall and k d less on the other, k = 3/2 M √h.
    // With one unknown the linear solve is exact: s = -d, a·s = k d, g·s = 2k d². Friction alone
    // lets two contacts carry a sphere; the centre is on the line between them, so none acts.
    let (h, d) = (1e-7, 1e-12);
    let k = hertz::stiffness(hertz::modulus(1e-4, 1.0 / E_WALL), h);
    let mut scene = scene_to(1e-2);
    let (coefficient, law, update) = (0.3, Law::ReturnMap, Update::Frozen);
    scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
    let mut pack = between(h, d);
    pack.grains[0].friction = coefficient;
    let (_, report) = Rig::start(&scene, &pack);
    let estimate = report.measures.unwrap().wall_force_error;
    // The difference of the two forces, 2 k d, is below the tolerance: nothing was moved.
    assert_eq!(report.substeps, 0);
    close("estimate", estimate, (2.0 + 0.1 * 2f64.sqrt()) * k * d, 1e-4);
}

#[test]
fn a_pack_without_load_has_no_error() {
    let (_, report) = Rig::start(&scene_to(1e-8), &between(-1e-6, 0.0));
    assert_eq!(report.measures.unwrap().wall_force_error, 0.0);
}

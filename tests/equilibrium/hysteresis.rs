//! Loading and unloading: the area of the loop is the energy that went away on it, and that is what
//! events released and what slip took.

use graintwin::pack::Pack;
use graintwin::report::Measures;
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::wall;

use crate::packs::{Rig, by_strain, made, scene, state};

/// What a loop came to \[J\].
#[derive(Debug, Default)]
struct Loop {
    /// ∮ F dx over the walls by trapezoids, of what was published.
    area: f64,
    /// The same on the way up.
    up: f64,
    /// Change of the stored energy.
    stored: f64,
    dissipated: f64,
    slip: f64,
    renewal: f64,
    /// Sum of what the events released, and their number.
    released: f64,
    events: usize,
    /// What the trapezoids make of the jumps: the area has the force after a jump for half of the
    /// increment, while the energy that is released is that of a pack which carried the force before
    /// it all the way.
    jumps: f64,
    /// The same, all of one sign.
    bound: f64,
    /// Wall forces at the end against those at the start, the largest change over the largest.
    apart: f64,
}

/// Strains `pack` up to `most` along `direction` and back, in `parts` increments each.
fn drive(scene: &Scene, pack: &Pack, direction: [f64; 3], most: f64, parts: u32) -> Loop {
    let (mut rig, first) = Rig::start(scene, pack);
    let start = first.measures.unwrap();
    let mut last = start.clone();
    let mut around = Loop::default();
    let strains =
        (0..=parts).chain((0..parts).rev()).map(|k| most * f64::from(k) / f64::from(parts));
    let strains: Vec<f64> = strains.collect();
    for step in strains.windows(2) {
        let target = by_strain(&pack.bounds, direction.map(|d| d * step[1]));
        let report = rig.send(target);
        assert_eq!(report.substeps, 1, "the test must see every equilibrium");
        let measures = report.measures.unwrap();
        around.area += work(&last, &measures);
        if step[1] == most {
            around.up = around.area;
        }
        // Σ σ A dL = 3 σ V dε / (1 - ε) where all axes strain alike.
        let volume = |strain: f64| pack.bounds.volume() * (1.0 - strain).powi(3);
        let travelled = 3.0 * volume(step[1]) / (1.0 - step[1]) * (step[1] - step[0]);
        for event in &measures.events {
            let jump = 0.5 * (event.stress_after - event.stress_before) * travelled;
            around.jumps += jump;
            around.bound += jump.abs();
            around.released += event.energy_released;
            around.events += 1;
        }
        last = measures;
    }
    let [before, after] = [&start, &last].map(state);
    around.stored = after.stored_energy - before.stored_energy;
    around.dissipated = after.dissipated_energy;
    around.slip = after.slip_energy;
    around.renewal = after.renewal_energy;
    assert_eq!(after.event_energy, around.released);
    let [was, is] = [&start, &last].map(|one| one.walls.normal_force);
    let largest = was.iter().copied().fold(0.0, f64::max);
    around.apart =
        was.iter().zip(is).map(|(was, is)| (was - is).abs()).fold(0.0, f64::max) / largest;
    around
}

fn work(from: &Measures, to: &Measures) -> f64 {
    let [from, to] = [from.walls, to.walls];
    (0..wall::COUNT)
        .map(|w| {
            let travel = to.displacement[w] - from.displacement[w];
            0.5 * (from.normal_force[w] + to.normal_force[w]) * travel
        })
        .sum()
}

#[test]
fn a_loop_without_an_event_has_no_area() {
    for (direction, seed) in [([0.0, 0.0, 1.0], 2), ([1.0; 3], 7)] {
        let around = drive(&scene(), &made(120, 1e7, seed), direction, 5e-4, 15);
        assert_eq!(around.events, 0, "{around:?}");
        // The way back is the way there: the errors of the trapezoids cancel.
        assert!(around.area.abs() <= 1e-9 * around.up, "{around:?}");
        assert!(around.apart <= 1e-6, "{around:?}");
    }
}

#[test]
fn the_area_of_a_frictionless_loop_is_what_its_events_released() {
    let pack = made(306, 1e7, 1);
    let mut worst = f64::INFINITY;
    for parts in [200, 400, 800] {
        let around = drive(&scene(), &pack, [1.0; 3], 1e-2, parts);
        assert!(around.events >= 10, "{around:?}");
        // By its definition.
        let sum = around.stored + around.dissipated;
        assert!((around.area - sum).abs() <= 1e-9 * around.area, "{around:?}");
        // The statement: of first order in the increment, within what jumps do to trapezoids.
        let rest = around.dissipated - around.released;
        assert!(rest.abs() <= 1.1 * around.bound, "{parts}: {around:?}");
        assert!(rest.abs() <= 0.6 * worst, "{parts}: {rest:e} after {worst:e}");
        worst = rest.abs();
        let left = rest - around.jumps;
        assert!(left.abs() <= 0.1 * around.jumps.abs(), "{parts}: {left:e} left of {around:?}");
    }
}

#[test]
fn a_frictionless_loop_that_closes_has_the_area_that_its_events_released() {
    let around = drive(&scene(), &made(306, 1e6, 5), [1.0; 3], 5e-3, 400);
    assert!(around.events > 0 && around.apart <= 1e-6, "{around:?}");
    assert!(around.stored.abs() <= 1e-6 * around.area, "it came back to where it was: {around:?}");
    assert!((around.area - around.released).abs() <= 1.1 * around.bound, "{around:?}");
}

#[test]
fn the_area_of_a_frictional_loop_is_what_slip_and_events_took() {
    let mut scene = scene();
    let coulomb = Coulomb { coefficient: 0.3, law: Law::ReturnMap, update: Update::Frozen };
    scene.contact.friction = Friction::Coulomb(coulomb);
    let mut pack = made(120, 1e7, 1);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    for (parts, share) in [(25, 1e-3), (100, 3e-4)] {
        let around = drive(&scene, &pack, [0.0, 0.0, 1.0], 2e-3, parts);
        let told = around.slip + around.renewal + around.released;
        let lost = around.area - around.stored;
        assert!((lost - told).abs() <= share * lost, "{parts}: {lost:e}, {told:e}, {around:?}");
        assert!(around.slip > 0.9 * lost, "{around:?}");
    }
}

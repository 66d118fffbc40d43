//! What each grain tells, against closed forms and against what the pack tells as a whole.

use std::f64::consts::PI;
use std::path::Path;

use graintwin::pack::Pack;
use graintwin::report::{Demand, Grains, Measures};
use graintwin::scene::{self, Scene};
use graintwin::twin::Twin;
use graintwin::wall::Bounds;

use crate::packs::{
    E_GRAINS, E_WALL, Rig, bead, by_strain, centered, close, made, scene, scene_to, state,
};

/// Radius of the beads \[m\].
const R: f64 = 1e-4;

fn grains(measures: &Measures) -> &Grains {
    measures.grains.as_ref().unwrap()
}

/// Force of an overlap under an effective modulus and radius \[N\].
fn hertz(modulus: f64, radius: f64, overlap: f64) -> f64 {
    4.0 / 3.0 * modulus * radius.sqrt() * overlap.powf(1.5)
}

/// Overlap that carries a force \[m\].
fn overlap(modulus: f64, radius: f64, force: f64) -> f64 {
    (force / (4.0 / 3.0 * modulus * radius.sqrt())).powf(2.0 / 3.0)
}

/// The mean of the three stresses 2 P (R - h) / V.
#[test]
fn the_pressure_in_a_sphere_between_six_walls_is_force_times_lever_over_volume() {
    let overlaps = [1e-3 * R, 2e-3 * R, 5e-3 * R];
    let pack = Pack {
        bounds: centered(overlaps.map(|overlap| 2.0 * (R - overlap))),
        grains: vec![bead([0.0; 3], R)],
        history: None,
    };
    let (_, report) = Rig::start(&scene(), &pack);
    let moment: f64 = overlaps.iter().map(|&h| 2.0 * hertz(E_WALL, R, h) * (R - h)).sum();
    let volume = 4.0 / 3.0 * PI * R.powi(3);
    close("p", grains(&report.measures.unwrap()).pressure[0], moment / 3.0 / volume, 1e-9);
}

/// A small bead on a large one between floor and ceiling carries one force F in all three contacts.
/// Nothing holds them aside, so they start in equilibrium, and stay.
#[test]
fn beads_of_a_column_carry_one_force_and_each_its_own_pressure() {
    let force = 1e-2;
    let (large, small) = (R, 0.6 * R);
    let reduced = large * small / (large + small);
    let low = overlap(E_WALL, large, force);
    let between = overlap(E_GRAINS, reduced, force);
    let high = overlap(E_WALL, small, force);
    let first = large - low;
    let second = first + large + small - between;
    let ceiling = second + small - high;
    let half = 2.0 * large;
    let bounds = Bounds { min: [-half, -half, 0.0], max: [half, half, ceiling] };
    let grains = vec![bead([0.0, 0.0, first], large), bead([0.0, 0.0, second], small)];
    let (_, report) = Rig::start(&scene_to(1e-6), &Pack { bounds, grains, history: None });
    let measures = report.measures.unwrap();
    assert_eq!(report.substeps, 0, "{}", report.text);
    let found = measures.grains.unwrap();
    // The contact of two elastic spheres lies where their surfaces would intersect.
    let distance = large + small - between;
    let lever = (distance * distance + large * large - small * small) / (2.0 * distance);
    for (grain, radius, levers) in
        [(0, large, large - low + lever), (1, small, small - high + distance - lever)]
    {
        let volume = 4.0 / 3.0 * PI * f64::powi(radius, 3);
        close("p", found.pressure[grain], force * levers / (3.0 * volume), 1e-6);
    }
}

/// `measures` of a pack in equilibrium: Love and Weber summed the other way round.
fn check_sum(measures: &Measures) {
    let found = grains(measures);
    let walls = measures.walls.position;
    let volume: f64 = (0..3).map(|axis| walls[2 * axis + 1] - walls[2 * axis]).product();
    let weighted: f64 = found
        .radius
        .iter()
        .zip(&found.pressure)
        .map(|(radius, pressure)| 4.0 / 3.0 * PI * radius.powi(3) * pressure)
        .sum();
    let stress = state(measures).stress_contacts;
    close("σ", weighted / volume, (stress[0] + stress[4] + stress[8]) / 3.0, 1e-12);
}

fn frictional() -> Scene {
    let text = "pack: {file: none.csv, material: glass}\n\
                contact: {friction: {coefficient: 0.3, law: return_map}}\n";
    scene::parse(text, Path::new("scene.yaml")).unwrap()
}

#[test]
fn the_stresses_of_the_grains_add_up_to_that_of_the_pack_with_and_without_friction() {
    let pack = made(200, 5e6, 7);
    for scene in [scene(), frictional()] {
        let (mut rig, report) = Rig::start(&scene, &pack);
        check_sum(&report.measures.unwrap());
        check_sum(&rig.go(by_strain(&pack.bounds, [0.0, 0.0, 1e-3])));
    }
}

#[test]
fn grains_are_told_in_the_order_of_the_pack_with_their_way_since_the_start() {
    let pack = made(200, 5e6, 7);
    let (mut rig, report) = Rig::start(&scene(), &pack);
    let start = report.measures.unwrap();
    for (grain, given) in pack.grains.iter().enumerate() {
        assert_eq!(grains(&start).radius[grain], given.radius);
        assert_eq!(grains(&start).position[grain], given.position, "an equilibrium as given");
        assert_eq!(grains(&start).displacement[grain], [0.0; 3]);
    }
    rig.go(by_strain(&pack.bounds, [0.0, 0.0, 5e-4]));
    let end = rig.go(by_strain(&pack.bounds, [0.0, 0.0, 1e-3]));
    let found = grains(&end);
    for (grain, now) in rig.twin.pack().grains.iter().enumerate() {
        assert_eq!(found.position[grain], now.position);
        let given = pack.grains[grain].position;
        let way: [f64; 3] = std::array::from_fn(|axis| now.position[axis] - given[axis]);
        assert_eq!(found.displacement[grain], way);
    }
    assert!(found.displacement.iter().any(|way| way[2] != 0.0));
}

#[test]
fn grains_that_nobody_asked_for_are_not_there() {
    let pack = made(20, 5e6, 7);
    let mut twin = Twin::new(&scene(), &pack, 1).unwrap();
    let report = twin.start(Demand { grains: false, ..Demand::ALL });
    assert_eq!(report.measures.unwrap().grains, None);
}

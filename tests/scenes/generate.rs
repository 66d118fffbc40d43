//! Packs made from a seed: the stress asked for, equilibrium, and what the grains are made of.

use std::sync::OnceLock;

use graintwin::command::Disposition;
use graintwin::pack::generate::generate;
use graintwin::pack::{self, Pack};
use graintwin::report::Measures;
use graintwin::scene::{Generate, Loaded, Material, Radius, Solver, Walls};

use crate::packs::{GLASS, Rig, bits, recipe, scene, state};

/// Glass as T table 2.1 has it, with its spread.
const SPREAD: Material = Material { spread: 0.1, ..GLASS };

fn make(recipe: &Generate, material: &Material) -> Pack {
    generate(recipe, material, &Walls::default(), 0.0, Solver::default()).unwrap()
}

/// 300 grains that all differ.
fn varied() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| make(&recipe(300, 1e6, 8), &SPREAD))
}

/// Loads a pack as a twin does; it must be in equilibrium as it is.
fn found(pack: &Pack) -> Measures {
    let (_, report) = Rig::start(&scene(), pack);
    assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
    report.measures.unwrap()
}

/// How many contacts each grain has.
fn numbers(measures: &Measures, grains: usize) -> Vec<u32> {
    let network = measures.network.as_ref().unwrap();
    let mut numbers = vec![0; grains];
    for grain in network.first.iter().chain(&network.second) {
        if let Some(number) = numbers.get_mut(*grain as usize) {
            *number += 1;
        }
    }
    numbers
}

#[test]
fn every_axis_has_the_stress_asked_for_and_the_grains_are_in_equilibrium() {
    for stress in [0.2e6, 10e6] {
        for grains in [50, 300] {
            let measures = found(&make(&recipe(grains, stress, 2), &SPREAD));
            for axis in 0..3 {
                let off = state(&measures).stress_walls[4 * axis] / stress - 1.0;
                // The tolerance of `generate` is 1e-3.
                assert!(off.abs() <= 1.001e-3, "{grains} grains, {stress} Pa, axis {axis}: {off}");
            }
            assert!(state(&measures).residual <= 1e-8);
        }
    }
}

#[test]
fn one_and_eight_grains_can_be_made() {
    for grains in [1, 8] {
        for stress in [0.2e6, 10e6] {
            let pack = make(&recipe(grains, stress, 3), &SPREAD);
            assert_eq!(pack.grains.len(), grains);
            let measures = found(&pack);
            for axis in 0..3 {
                let off = state(&measures).stress_walls[4 * axis] / stress - 1.0;
                assert!(off.abs() <= 1.001e-3, "{grains} grains, {stress} Pa, axis {axis}: {off}");
            }
        }
    }
}

#[test]
fn radii_of_1_to_20_and_stresses_near_jamming_and_far_from_it_can_be_asked_for() {
    let mixed = Radius::Uniform([0.01e-3, 0.2e-3]);
    let narrow = Radius::Uniform([0.07e-3, 0.13e-3]);
    for (radius, stress) in [(mixed, 1e6), (mixed, 10e6), (narrow, 20e3), (narrow, 500e6)] {
        let measures = found(&make(&Generate { radius, ..recipe(200, stress, 9) }, &SPREAD));
        for axis in 0..3 {
            let off = state(&measures).stress_walls[4 * axis] / stress - 1.0;
            assert!(off.abs() <= 1.001e-3, "{radius:?}, {stress} Pa, axis {axis}: {off}");
        }
    }
}

#[test]
fn a_box_of_other_proportions_keeps_them_roughly_and_its_stress_exactly() {
    let tall = Generate { aspect: [1.0, 1.0, 2.0], ..recipe(150, 1e6, 4) };
    let pack = make(&tall, &SPREAD);
    let sides = pack.bounds.sides();
    assert!((1.8..2.2).contains(&(sides[2] / sides[0])), "{sides:?}");
    let measures = found(&pack);
    assert!((state(&measures).stress_walls[8] / 1e6 - 1.0).abs() <= 1.001e-3);
}

#[test]
fn a_saved_pack_is_loaded_to_the_same_bits_and_forces() {
    let folder = tempfile::tempdir().unwrap();
    let csv = folder.path().join("pack.csv");
    pack::save(varied(), &csv).unwrap();
    let mut scene = scene();
    scene.pack.file = Some("pack.csv".into());
    let loaded = Loaded { scene: scene.clone(), file: folder.path().join("scene.yaml") };
    let again = pack::build(&loaded).unwrap();
    assert_eq!(bits(&again), bits(varied()));
    let (before, after) = (found(varied()), found(&again));
    let bits = |measures: &Measures| measures.walls.normal_force.map(f64::to_bits);
    assert_eq!(bits(&before), bits(&after));
    assert_eq!(before.network, after.network);
}

#[test]
fn a_seed_gives_the_same_bits_and_another_seed_another_pack() {
    let spec = recipe(60, 1e6, 5);
    let once = make(&spec, &SPREAD);
    assert_eq!(bits(&once), bits(&make(&spec, &SPREAD)));
    let other = make(&Generate { seed: 6, ..spec }, &SPREAD);
    assert!(once.grains.iter().zip(&other.grains).all(|(a, b)| a.radius != b.radius));
    assert_ne!(once.bounds, other.bounds);
}

#[test]
fn radii_and_moduli_follow_the_recipe() {
    let grains = &varied().grains;
    assert!(grains.iter().all(|g| (0.07e-3..=0.13e-3).contains(&g.radius)));
    let moments = |value: &dyn Fn(usize) -> f64| {
        let n = grains.len() as f64;
        let mean = (0..grains.len()).map(value).sum::<f64>() / n;
        let square = (0..grains.len()).map(|i| (value(i) - mean).powi(2)).sum::<f64>() / n;
        (mean, square.sqrt() / mean)
    };
    // Of 300 draws the mean scatters by s.d./sqrt(300), the s.d. by s.d./sqrt(600): four of each.
    let (mean, deviation) = moments(&|i| grains[i].young);
    assert!((mean / 70e9 - 1.0).abs() < 4.0 * 0.1 / 300f64.sqrt(), "{mean}");
    assert!((deviation - 0.1).abs() < 4.0 * 0.1 / 600f64.sqrt(), "{deviation}");
    let (mean, deviation) = moments(&|i| grains[i].poisson);
    assert!((mean / 0.2 - 1.0).abs() < 4.0 * 0.1 / 300f64.sqrt(), "{mean}");
    assert!((deviation - 0.1).abs() < 4.0 * 0.1 / 600f64.sqrt(), "{deviation}");
    // Uniform: the s.d. is the width over sqrt(12), relative to the mean 0.1 mm 0.1732.
    let (mean, deviation) = moments(&|i| grains[i].radius);
    assert!((mean / 1e-4 - 1.0).abs() < 4.0 * 0.1732 / 300f64.sqrt(), "{mean}");
    assert!((deviation - 0.1732).abs() < 0.03, "{deviation}");

    let equal = Generate { radius: Radius::Constant(0.1e-3), ..recipe(50, 1e6, 7) };
    let pack = make(&equal, &GLASS);
    assert!(pack.grains.iter().all(|g| (g.radius, g.young, g.poisson) == (1e-4, 70e9, 0.2)));
    found(&pack);
}

#[test]
fn expanded_floaters_carry_load() {
    let spec = recipe(300, 1e6, 8);
    let plain = make(&spec, &GLASS);
    let floaters = |pack: &Pack| -> Vec<usize> {
        let numbers = numbers(&found(pack), pack.grains.len());
        (0..numbers.len()).filter(|&i| numbers[i] < 4).collect()
    };
    let before = floaters(&plain);
    assert!(before.len() >= 5, "{} floaters to begin with", before.len());
    let expanded = make(&Generate { expand_floaters: 10, ..spec }, &GLASS);
    let after = floaters(&expanded);
    assert!(before.iter().all(|grain| !after.contains(grain)), "{before:?} {after:?}");
    assert!(4 * after.len() <= before.len(), "{before:?} {after:?}");
    let before = before.len();
    // Radii only grow, and only those of grains that floated at some time.
    let grown = expanded.grains.iter().zip(&plain.grains);
    assert!(grown.clone().all(|(now, then)| now.radius >= then.radius));
    let grown = grown.filter(|(now, then)| now.radius > then.radius).count();
    assert!((before..=4 * before).contains(&grown), "{grown} of {before}");
    let measures = found(&expanded);
    for axis in 0..3 {
        assert!((state(&measures).stress_walls[4 * axis] / 1e6 - 1.0).abs() <= 1.001e-3);
    }
}

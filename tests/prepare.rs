//! Packs prepared by the steps of their scene.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/packs.rs"]
mod packs;

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::pack::prepare::{Reached, prepare};
use graintwin::pack::{self, Pack};
use graintwin::path;
use graintwin::scene::{self, Scene};
use packs::{Rig, bits, close, made, state};

/// A scene with the steps of a preparation, and `more` of a scene.
fn scene(steps: &[&str], more: &str) -> Scene {
    let steps: String = steps.iter().map(|step| format!("  - {step}\n")).collect();
    let text = format!("pack:\n  file: none.csv\n  prepare:\n{steps}{more}");
    scene::parse(&text, Path::new("scene.yaml")).unwrap()
}

fn prepared(scene: &Scene, pack: &Pack) -> (Pack, Vec<Reached>) {
    let mut heard = Vec::new();
    let pack = prepare(scene, pack.clone(), &mut |reached| heard.push(*reached)).unwrap();
    (pack, heard)
}

/// Normal stresses of a pack as a twin finds it; it must be in equilibrium as it is.
fn stress(scene: &Scene, pack: &Pack) -> [f64; 3] {
    let (_, report) = Rig::start(scene, pack);
    assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
    let stress = state(&report.measures.unwrap()).stress_walls;
    [stress[0], stress[4], stress[8]]
}

#[test]
fn an_isotropic_step_raises_and_lowers_the_stress_to_what_is_asked() {
    let pack = made(150, 4e6, 11);
    for asked in [0.4e6, 3.9e6, 4e6, 10e6, 74e6] {
        let scene = scene(&[&format!("isotropic: {{confining_stress: {asked:e}}}")], "");
        let (pack, _) = prepared(&scene, &pack);
        for found in stress(&scene, &pack) {
            // The tolerance of a pack that is made is 1e-3.
            assert!((found / asked - 1.0).abs() <= 1.001e-3, "{found} of {asked}");
        }
    }
}

#[test]
fn an_isotropic_step_leaves_the_grains_what_they_are_and_drops_the_history() {
    let mut pack = made(40, 1e6, 12);
    for (index, grain) in pack.grains.iter_mut().enumerate() {
        (grain.friction, grain.density) = (0.01 * index as f64, 1e3 + index as f64);
    }
    pack.history = Some(pack::History { rotation: vec![[1.0; 3]; 40], contacts: Vec::new() });
    let (after, _) = prepared(&scene(&["isotropic: {confining_stress: 2.0e6}"], ""), &pack);
    assert_eq!(after.history, None);
    assert_eq!(after.grains.len(), 40);
    for (after, before) in after.grains.iter().zip(&pack.grains) {
        assert_ne!(after.position, before.position);
        let back = pack::Grain { position: before.position, ..*after };
        assert_eq!(back, *before);
    }
}

#[test]
fn a_uniaxial_step_to_a_strain_is_the_run_of_the_same_increments() {
    let pack = made(150, 4e6, 11);
    for moving in ["both", "min", "max"] {
        let step = format!("uniaxial: {{axis: y, moving: {moving}, strain: 1.0e-3");
        let scene = scene(
            &[&format!("{step}, strain_increment: 2.5e-4}}")],
            &format!("load_path: [{step}, increments: 4}}]"),
        );
        let (mut rig, _) = Rig::start(&scene, &pack);
        for command in path::commands(&scene.load_path, Path::new(""), &pack.bounds).unwrap() {
            rig.go(command.displacement);
        }
        let (after, heard) = prepared(&scene, &pack);
        assert_eq!(bits(&after), bits(&rig.twin.pack()));
        let strains: Vec<_> = heard.iter().map(|reached| reached.strain).collect();
        assert_eq!(strains, [0.0, 2.5e-4, 5e-4, 7.5e-4, 1e-3]);
    }
}

#[test]
fn an_increment_is_no_longer_than_asked_and_no_shorter_than_it_must_be() {
    let pack = made(10, 4e6, 13);
    for (strain, increment, increments) in
        [(1e-3, 1e-4, 10), (1e-3, 3e-4, 4), (-1e-3, 3e-4, 4), (1e-5, 1e-4, 1), (3e-4, 1e-4, 3)]
    {
        let step = format!("uniaxial: {{strain: {strain:?}, strain_increment: {increment:?}}}");
        let (after, heard) = prepared(&scene(&[&step], ""), &pack);
        assert_eq!(heard.len(), increments + 1, "{step}");
        let shortened = 1.0 - after.bounds.sides()[2] / pack.bounds.sides()[2];
        close(&step, shortened, strain, 1e-9);
    }
}

#[test]
fn steps_follow_each_other_and_are_told_by_their_index() {
    let pack = made(60, 1e6, 14);
    let steps = [
        "uniaxial: {strain: 1.0e-4}",
        "isotropic: {confining_stress: 5.0e6}",
        "uniaxial: {axis: x, strain: 1.0e-4}",
    ];
    let scene = scene(&steps, "");
    let (after, heard) = prepared(&scene, &pack);
    let steps: Vec<_> = heard.iter().map(|reached| reached.step).collect();
    assert_eq!(steps, [0, 0, 1, 2, 2]);
    assert_eq!(heard[2].confining_stress, 5e6);
    let [x, y, z] = stress(&scene, &after);
    assert!(x > y && x > z && y > 5e6, "{x} {y} {z}");
}

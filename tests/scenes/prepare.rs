//! Packs prepared by the steps of their scene.

use std::path::Path;
use std::sync::OnceLock;

use graintwin::command::Disposition;
use graintwin::pack::prepare::{PrepareError, Reached, prepare};
use graintwin::pack::{self, Pack};
use graintwin::path;
use graintwin::scene::{self, Loaded, Scene};

use crate::histories;
use crate::packs::{Rig, bits, by_strain, close, made, state};

/// A scene with the steps of a preparation, and `more` of a scene.
fn scene(steps: &[&str], more: &str) -> Scene {
    let steps: String = steps.iter().map(|step| format!("  - {step}\n")).collect();
    let text = format!("pack:\n  file: none.csv\n  prepare:\n{steps}{more}");
    scene::parse(&text, Path::new("scene.yaml")).unwrap()
}

const FRICTION: &str = "contact: {friction: {coefficient: 0.3}}\n";

/// Beads with friction, without tangential load.
fn rough(grains: usize, stress: f64, seed: u64) -> Pack {
    let mut pack = made(grains, stress, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
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
    pack.history = Some(pack::History {
        rotation: vec![[1.0; 3]; 40],
        contacts: Vec::new(),
        ..pack::History::default()
    });
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
    let pack = rough(150, 4e6, 11);
    for (moving, friction) in [("both", ""), ("min", FRICTION), ("max", FRICTION)] {
        let step = format!("uniaxial: {{axis: y, moving: {moving}, strain: 1.0e-3");
        let scene = scene(
            &[&format!("{step}, strain_increment: 2.5e-4}}")],
            &format!("load_path: [{step}, increments: 4}}]\n{friction}"),
        );
        let (mut rig, _) = Rig::start(&scene, &pack);
        for command in path::commands(&scene.load_path, Path::new(""), &pack.bounds).unwrap() {
            rig.go(command.ask.numbers());
        }
        let (after, heard) = prepared(&scene, &pack);
        assert_eq!(bits(&after), bits(&rig.twin.pack()));
        assert_eq!(after.history, rig.twin.pack().history);
        assert_eq!(after.history.is_some(), !friction.is_empty());
        let strains: Vec<_> = heard.iter().map(|reached| reached.strain.unwrap()).collect();
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
    assert_eq!((heard[2].strain, heard[2].confining_stress), (None, 5e6));
    let [x, y, z] = stress(&scene, &after);
    assert!(x > y && x > z && y > 5e6, "{x} {y} {z}");
}

/// 150 beads prepared in the two phases of T 3.6.2.
fn built_up() -> &'static (Scene, Pack, Vec<Reached>) {
    static BUILT: OnceLock<(Scene, Pack, Vec<Reached>)> = OnceLock::new();
    BUILT.get_or_init(|| {
        let steps = [
            "isotropic: {confining_stress: 10.0e6}",
            "uniaxial: {strain_increment: 2.0e-4, steady: 0.015, window: 4, max_strain: 0.02}",
        ];
        let scene = scene(&steps, FRICTION);
        let (pack, heard) = prepared(&scene, &rough(150, 4e6, 11));
        (scene, pack, heard)
    })
}

#[test]
fn frictional_loads_build_up_until_the_sliding_ratio_is_steady() {
    let (_, pack, heard) = built_up();
    let uniaxial = &heard[1..];
    assert_eq!((uniaxial[0].strain, uniaxial[0].sliding_ratio), (Some(0.0), 0.0));
    let end = uniaxial.last().unwrap();
    assert!(end.sliding_ratio > 0.0 && end.strain < Some(0.02), "{end:?}");
    let last: Vec<_> = uniaxial.iter().rev().take(5).map(|reached| reached.sliding_ratio).collect();
    assert_eq!(last.len(), 5);
    assert!(last.iter().all(|a| last.iter().all(|b| a - b < 0.015)), "{last:?}");
    // Not before: the build-up from nothing is steeper than that.
    assert!(uniaxial[4].sliding_ratio - uniaxial[0].sliding_ratio >= 0.015, "{uniaxial:?}");

    let history = pack.history.as_ref().unwrap();
    assert!(history.contacts.len() > 300, "{} contacts", history.contacts.len());
    assert!(history.rotation.iter().any(|&rotation| rotation != [0.0; 3]));
}

/// The report numbers grains as the pack does, whatever order the solver has.
#[test]
fn a_prepared_pack_is_found_in_equilibrium_with_the_loads_of_its_history() {
    let (scene, pack, heard) = built_up();
    let (_, report) = Rig::start(scene, pack);
    assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
    let measures = report.measures.unwrap();
    let end = heard.last().unwrap();
    assert_eq!(state(&measures).sliding_ratio, end.sliding_ratio);
    close("stress", state(&measures).confining_stress, end.confining_stress, 1e-9);
    let contacts = &pack.history.as_ref().unwrap().contacts;
    let network = measures.network.unwrap();
    assert!(network.first.len() > 300);
    for (k, (&first, &second)) in network.first.iter().zip(&network.second).enumerate() {
        let memory = contacts.iter().find(|one| (one.first, one.second) == (first, second));
        let shear = memory.map_or([0.0; 3], |memory| memory.shear);
        assert_eq!(network.tangential_force[3 * k..3 * k + 3], shear, "{first} {second}");
    }
}

/// Three increments from `pack`; its end to the bit, walls, grains and history.
fn continued(scene: &Scene, pack: &Pack) -> Vec<u64> {
    let (mut rig, report) = Rig::start(scene, pack);
    assert_eq!(report.disposition, Disposition::Applied);
    let mut all = Vec::new();
    for part in 1..=3 {
        let strain = 1e-4 * f64::from(part);
        let measures = rig.go(by_strain(&pack.bounds, [0.0, -0.5 * strain, strain]));
        all.extend(measures.walls.force.as_flattened().iter().map(|force| force.to_bits()));
    }
    let end = rig.twin.pack();
    all.extend(bits(&end));
    all.extend(histories::bits(end.history.as_ref().unwrap()));
    all
}

#[test]
fn a_prepared_pack_goes_on_from_its_files_as_from_memory_to_the_bit() {
    let (scene, pack, _) = built_up();
    let folder = tempfile::tempdir().unwrap();
    pack::save(pack, &folder.path().join("none.csv")).unwrap();
    let mut scene = scene.clone();
    scene.pack.prepare.clear();
    let file = folder.path().join("scene.yaml");
    let again = pack::build(&Loaded { scene: scene.clone(), file }).unwrap();
    assert_eq!(&again, pack);
    let expected = continued(&scene, pack);
    assert!(continued(&scene, &again) == expected, "other bits from the files");
    // The same grains without what their contacts remember go another way.
    let forgetful = Pack { history: None, ..again };
    assert!(continued(&scene, &forgetful) != expected, "the history does not matter");
}

#[test]
fn a_preparation_does_not_depend_on_the_threads() {
    let pack = rough(60, 4e6, 15);
    let steps = ["isotropic: {confining_stress: 5.0e6}", "uniaxial: {strain: 5.0e-4}"];
    let scene = scene(&steps, FRICTION);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let pack = pool.install(|| prepared(&scene, &pack).0);
        (bits(&pack), histories::bits(pack.history.as_ref().unwrap()))
    };
    let one = on(1);
    assert!(on(2) == one && on(7) == one);
}

#[test]
fn a_ratio_that_is_not_steady_at_the_largest_strain_is_an_error_that_says_what_was_reached() {
    let pack = rough(60, 10e6, 16);
    let step = "uniaxial: {steady: 1.0e-6, window: 5, max_strain: 1.0e-3}";
    let error = prepare(&scene(&[step], FRICTION), pack, &mut |_| ()).unwrap_err();
    let text = error.to_string();
    let PrepareError::Unsteady { step: 0, ratio, change, .. } = error else { panic!("{text}") };
    assert!(ratio > 0.0 && change > 1e-6, "{text}");
    assert!(
        text.starts_with("pack.prepare[0].uniaxial: not steady at max_strain = 0.001: the "),
        "{text}"
    );
}

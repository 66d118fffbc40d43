//! Packs of discs made by a scene.

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::pack::{self, Pack};
use graintwin::report::Measures;
use graintwin::scene::{self, Loaded, Scene};

use crate::packs::{Rig, bits, state};

/// A scene of B's sand (table 1) with `generate` as its recipe, and `more`.
fn sand(grains: usize, generate: &str, more: &str) -> Scene {
    let yaml = format!(
        "dimension: 2\nmaterials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
         pack:\n  generate: {{grains: {grains}, radius: {{grading_a: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, confining_stress: 1.0e5, {generate}}}\n\
         walls: {{friction: 0.0}}\ncontact: {{friction: {{coefficient: 0.6}}}}\n{more}"
    );
    scene::parse(&yaml, Path::new("scene.yaml")).unwrap()
}

fn built(scene: &Scene) -> Pack {
    pack::build(&Loaded { scene: scene.clone(), file: "scene.yaml".into() }).unwrap()
}

/// The pack as a twin finds it under the friction of the test: it must be in equilibrium as it is.
fn found(scene: &Scene, pack: &Pack) -> Measures {
    let (_, report) = Rig::start(scene, pack);
    assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
    report.measures.unwrap()
}

#[test]
fn the_walls_have_the_stress_asked_for_and_the_box_its_depth() {
    for friction in [0.0, 0.6] {
        let scene = sand(200, &format!("aspect: [1, 2.5, 1], compaction_friction: {friction}"), "");
        let pack = built(&scene);
        let measures = found(&scene, &pack);
        let stress = state(&measures).stress_walls;
        for axis in [0, 1] {
            // Shear that counts from where the contacts have come to changes the stress a little.
            assert!((stress[4 * axis] / 1e5 - 1.0).abs() < 2e-5, "{stress:?}");
        }
        let [x, y, z] = pack.bounds.sides();
        assert!((2.3..2.7).contains(&(y / x)), "{x} {y}");
        let mean = pack.grains.iter().map(|grain| grain.radius).sum::<f64>() / 200.0;
        assert!((z / (2.0 * mean) - 1.0).abs() < 1e-12);
        assert!(pack.grains.iter().all(|grain| grain.friction == 0.6 && grain.position[2] == 0.0));
        assert_eq!(pack.history.is_some(), friction > 0.0);
    }
}

/// B table 2, of a thousand grains: 3.9 to 4.1 and 3.0 to 3.1.
#[test]
fn compaction_friction_sets_the_number_of_contacts() {
    let contacts = [0.0, 0.2, 0.6].map(|friction| {
        let scene = sand(300, &format!("compaction_friction: {friction}"), "");
        state(&found(&scene, &built(&scene))).coordination_number
    });
    assert!((3.75..4.2).contains(&contacts[0]), "{contacts:?}");
    assert!((2.8..3.2).contains(&contacts[2]), "{contacts:?}");
    assert!(contacts[0] > contacts[1] && contacts[1] > contacts[2], "{contacts:?}");
}

#[test]
fn a_seed_gives_the_same_bits_on_any_number_of_threads() {
    let scene = sand(100, "compaction_friction: 0.3", "");
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let pack = pool.install(|| built(&scene));
        (bits(&pack), pack.history)
    };
    let one = on(1);
    assert!(on(3) == one);
    let other = built(&sand(100, "seed: 2", ""));
    assert_ne!(bits(&other), one.0);
}

#[test]
fn a_step_brings_discs_to_another_stress_and_back_to_another_size() {
    let steps = "  prepare: [isotropic: {confining_stress: 4.0e5}, rescale: {lengths: 2.0}]\n";
    let mut scene = sand(150, "seed: 4", "");
    let yaml = format!("pack: {{file: a.csv,{}}}", steps.trim().replace("  ", ""));
    scene.pack.prepare = scene::parse(&yaml, Path::new("a.yaml")).unwrap().pack.prepare;
    let pack = built(&scene);
    assert_eq!(pack.history, None);
    let stress = state(&found(&scene, &pack)).stress_walls;
    for axis in [0, 1] {
        assert!((stress[4 * axis] / 1e5 - 1.0).abs() < 1e-6, "{stress:?}");
    }
    let mean = pack.grains.iter().map(|grain| grain.radius).sum::<f64>() / 150.0;
    assert!((mean / 2e-4 - 1.0).abs() < 0.1, "{mean}");
}

#[test]
fn discs_are_stored_and_cut_with_their_depth() {
    let folder = tempfile::tempdir().unwrap();
    let scene = sand(100, "compaction_friction: 0.6", "");
    let pack = built(&scene);
    pack::save(&pack, &folder.path().join("discs.csv")).unwrap();
    let read = |more: &str| {
        let yaml =
            format!("dimension: 2\npack: {{file: discs.csv{more}}}\ncontact: {{friction: {{}}}}");
        let scene = scene::parse(&yaml, Path::new("scene.yaml")).unwrap();
        pack::build(&Loaded { scene, file: folder.path().join("scene.yaml") }).unwrap()
    };
    let again = read("");
    assert_eq!((bits(&again), &again.history), (bits(&pack), &pack.history));
    // Grains that are wider than the box is deep stay too.
    let sides = pack.bounds.sides();
    let far = 0.3 * sides[0];
    let half = read(&format!(", cut: {{min: [-{far}, -{far}, 0], max: [{far}, {far}, 1.0e-9]}}"));
    assert!((20..60).contains(&half.grains.len()), "{}", half.grains.len());
    assert_eq!(half.bounds.sides()[2], sides[2]);
    for grain in &half.grains {
        assert!(grain.position[0].abs() + grain.radius <= far);
    }
}

/// Sandstone of B table 8 before it is cemented: linear contacts of 1 MN/m.
#[test]
fn discs_of_linear_contacts_are_made_too() {
    for seed in 1..=2 {
        let mut scene = sand(150, &format!("seed: {seed}, aspect: [2.5, 1, 1]"), "");
        let normal =
            "contact: {normal: {linear: {stiffness: 1.0e6}}, friction: {coefficient: 0.6}}";
        let yaml = format!("dimension: 2\npack: {{file: a.csv}}\n{normal}");
        scene.contact = scene::parse(&yaml, Path::new("a.yaml")).unwrap().contact;
        scene.pack.generate.as_mut().unwrap().confining_stress = 1e6;
        let stress = state(&found(&scene, &built(&scene))).stress_walls;
        assert!((stress[0] / 1e6 - 1.0).abs() < 1e-6, "{stress:?}");
    }
}

#[test]
fn what_is_only_for_discs_or_only_for_spheres_is_named() {
    let with = |dimension: u8, generate: &str, prepare: &str| {
        let yaml = format!(
            "dimension: {dimension}\npack: {{generate: {{grains: 9, radius: {{constant: 1.0e-4}}, \
             material: glass, confining_stress: 1.0e6, {generate}}}, prepare: [{prepare}]}}"
        );
        scene::parse(&yaml, Path::new("scene.yaml")).map_err(|error| error.to_string())
    };
    let echoed = with(2, "compaction_friction: .inf", "").unwrap();
    let again = scene::parse(&echoed.to_yaml().unwrap(), Path::new("scene.yaml")).unwrap();
    assert_eq!(again, echoed);
    for (dimension, generate, prepare, text) in [
        (3, "compaction_friction: 0.1", "", "generate.compaction_friction: spheres are compacted"),
        (2, "compaction_friction: -1", "", "generate.compaction_friction: -1.0 is outside"),
        (2, "expand_floaters: 1", "", "generate.expand_floaters: only spheres are expanded"),
        (2, "seed: 1", "uniaxial: {strain: 1e-3}", "prepare[0].uniaxial.axis: there is no z"),
    ] {
        let said = with(dimension, generate, prepare).unwrap_err();
        assert!(said.contains(text), "{said}");
    }
}

#[test]
fn discs_are_made_between_two_circles() {
    let inner = 7e-4;
    let yaml = format!(
        "dimension: 2\nmaterials: {{sand: {{young: 2.32e9, poisson: 0.16, density: 2650.0}}}}\n\
         pack: {{generate: {{grains: 300, radius: {{grading_b: {{mean: 0.1e-3, ratio: 4.0}}}}, \
         material: sand, confining_stress: 1.0e5}}}}\n\
         walls: {{friction: 0.0, cell: {{annulus: {{inner: {inner}}}}}}}"
    );
    let scene = scene::parse(&yaml, Path::new("scene.yaml")).unwrap();
    let pack = built(&scene);
    let measures = found(&scene, &pack);
    let outer = pack.bounds.max[0];
    let depth = pack.bounds.sides()[2];
    let stress = measures.walls.normal_force[1] / (2.0 * std::f64::consts::PI * outer * depth);
    assert!((stress / 1e5 - 1.0).abs() < 1e-6, "{stress}");
    for grain in &pack.grains {
        let far = grain.position[0].hypot(grain.position[1]);
        assert!(far + 0.9 * grain.radius < outer && far - 0.9 * grain.radius > inner);
    }
}

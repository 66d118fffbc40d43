//! Whatever a file holds, reading it ends with a value or an error that names the file.

use std::fs;
use std::path::Path;

use graintwin::wall::Bounds;
use graintwin::{pack, path, scene};
use proptest::prelude::*;

/// A text with a few of its bytes replaced, taken out or doubled.
fn damaged(whole: &'static str) -> impl Strategy<Value = Vec<u8>> {
    let piece = prop_oneof![
        any::<u8>().prop_map(|byte| vec![byte]),
        prop::sample::select(vec![
            "",
            "-",
            "{",
            "}",
            "[",
            "]",
            ": ",
            "\n",
            "&a ",
            "*a",
            "<<: ",
            "!x ",
            ".nan",
            "1e999",
            "-1",
            "\"",
            ",",
            "0x",
            "99999999999999999999",
            "~",
            "|",
            "? ",
            "\t",
            "#",
            "1_0",
        ])
        .prop_map(|text| text.as_bytes().to_vec()),
    ];
    let edits = prop::collection::vec((any::<prop::sample::Index>(), 0..4_usize, piece), 1..5);
    edits.prop_map(move |edits| {
        let mut bytes = whole.as_bytes().to_vec();
        for (place, removed, piece) in edits {
            let start = place.index(bytes.len().max(1)).min(bytes.len());
            let end = (start + removed).min(bytes.len());
            bytes.splice(start..end, piece);
        }
        bytes
    })
}

const SCENE: &str = "name: all
materials: {m: &m {young: 1e9, poisson: 0.2, density: 1e3, spread: 0.1}, n: {<<: *m}}
walls: {young: 7e12, poisson: 0.495, friction: 0.3}
pack:
  generate: {grains: 9, radius: {uniform: [1e-4, 2e-4]}, material: m, confining_stress: 1e6}
  cut: {min: [-1, -1, -1], max: [1, 1, 1]}
  prepare: [isotropic: {confining_stress: 1e6}, uniaxial: {axis: x, steady: 0.1, max_strain: 0.1}]
contact: {normal: hertz, friction: {coefficient: .inf, law: secant}, torsion: true}
load_path:
  - isotropic: {strain: 1e-3, increments: 2, moving: both}
  - repeat: {times: 2, steps: [unload: {to: 0.5, increments: 1}]}
  - rig_log: {file: a.csv, time: t, axial_strain: e, unit: percent}
outputs: {contact_network: always, markers: never, moduli: none}
record: {chunk: 4 MiB, compression: lz4}
view: {scale: 1e3, color: displacement, range: [0, 1e-6], opacity: 0.5, every: 3}
";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_scene(bytes in damaged(SCENE)) {
        let text = String::from_utf8_lossy(&bytes);
        match scene::parse(&text, Path::new("scene.yaml")) {
            // What is left is a scene, and its echo another.
            Ok(scene) => prop_assert!(scene.to_yaml().is_ok()),
            Err(error) => prop_assert!(error.to_string().starts_with("scene.yaml:"), "{error}"),
        }
    }
}

proptest! {
    #[test]
    fn a_damaged_pack_with_its_box(
        csv in damaged("# c\nx,y,z,radius,material\n0,0,0,1e-4,glass\n\"1e-3\",0,-0.0,1e-4,quartz\n"),
        json in damaged(r#"{"box": {"min": [-1, -1, -1], "max": [1, 1, 1]}, "other": null}"#),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("p.csv");
        fs::write(&file, csv).unwrap();
        fs::write(folder.path().join("p.json"), json).unwrap();
        let name = folder.path().display().to_string();
        let scene = scene::Loaded {
            scene: scene::parse("pack: {file: p.csv}", Path::new("scene.yaml")).unwrap(),
            file: folder.path().join("scene.yaml"),
        };
        match pack::build(&scene) {
            Ok(pack) => prop_assert!(!pack.grains.is_empty()),
            Err(error) => prop_assert!(error.to_string().starts_with(&name), "{error}"),
        }
    }

    #[test]
    fn a_damaged_contact_history(json in damaged(
        "{\"rotations\": [[0, -1e-3, 0.0], [0, 0, 0]], \"contacts\": [{\"first\": 0, \"second\": 1, \
         \"shear\": [1, 0, 0], \"torsion\": -0.5, \"sliding\": true, \"layers\": [{\"reach\": 1, \
         \"ratio\": [0.5, 0, 0]}]}, {\"first\": 1, \"second\": 4294967295, \"shear\": [0, 0, 0], \
         \"torsion\": 0, \"sliding\": false}]}",
    )) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("p.csv");
        fs::write(&file, "x,y,z,radius\n0,0,0,1e-4\n1e-4,0,0,1e-4\n").unwrap();
        fs::write(folder.path().join("p.json"), "{\"history\": \"h.json\"}").unwrap();
        fs::write(folder.path().join("h.json"), json).unwrap();
        let name = folder.path().join("h.json").display().to_string();
        match pack::read(&file).unwrap().read_history() {
            Ok(history) => {
                let history = history.unwrap();
                prop_assert_eq!(history.rotation.len(), 2);
                for contact in &history.contacts {
                    prop_assert!(contact.first < 2 && contact.first < contact.second);
                    prop_assert!(contact.shear.iter().all(|force| force.is_finite()));
                }
            }
            Err(error) => prop_assert!(error.to_string().starts_with(&name), "{error}"),
        }
    }

    #[test]
    fn a_damaged_history(csv in damaged("stamp,x_min,z_max\n0,0,1e-6\n1.5,1e-6,-2e-6 # c\n")) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("c.csv");
        fs::write(&file, csv).unwrap();
        let name = file.display().to_string();
        match path::read_csv(&file) {
            Ok(commands) => prop_assert!(
                commands.iter().all(|c| c.ask.numbers().iter().all(|d| d.is_finite()))
            ),
            Err(error) => prop_assert!(error.to_string().starts_with(&name), "{error}"),
        }
        let steps = scene::parse(
            "pack: {file: p}\nload_path: {rig_log: {file: c.csv, time: stamp, axial_strain: x_min}}",
            Path::new("scene.yaml"),
        );
        let bounds = Bounds { min: [0.0; 3], max: [1.0; 3] };
        match path::commands(&steps.unwrap().load_path, folder.path(), &bounds) {
            Ok(commands) => prop_assert!(!commands.is_empty()),
            Err(error) => prop_assert!(error.to_string().starts_with(&name), "{error}"),
        }
    }
}

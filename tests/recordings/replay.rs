//! `graintwin replay` and `run --resume`: the same bits again, and what is said where they differ.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::Arc;

use graintwin::command::{Ask, Mode, Stamp};
use graintwin::pack;
use graintwin::record::{Closing, Provenance, Recorder};
use graintwin::relax::lanes;
use graintwin::report::{Demand, Report};
use graintwin::scene::{self, Record, Scene, When};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;
use serde_json::Value;

use crate::packs::{self, made};

/// Two sheared, sliding increments a line, then walls under loads: everything that has a memory.
const SCENE: &str = "
name: replayed
pack:
  generate: {grains: 80, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass,
             confining_stress: 5.0e6}
contact: {friction: {coefficient: 0.3}}
record: {chunk: 1 MiB}
load_path:
  - uniaxial: {axis: z, strain: 2.0e-3, increments: 20}
  - triaxial: {axis: z, axial_strain: 1.0e-3, lateral_stress: 5.0e6, increments: 20}
";

fn graintwin(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    let ended = command.args(arguments).current_dir(folder).env_remove("RUST_LOG").output();
    let Output { status, stdout, stderr } = ended.unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

/// A folder with `scene.yaml` and its recording `whole`.
fn recorded() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.yaml"), SCENE).unwrap();
    let (code, _, said) = graintwin(folder.path(), &["run", "scene.yaml", "--record", "whole"]);
    assert_eq!(code, 0, "{said}");
    folder
}

/// The verdict on a recording.
fn verdict(folder: &Path, bag: &str, more: &[&str]) -> (i32, Value) {
    let arguments = [&["replay", bag, "--verify", "--json"], more].concat();
    let (code, verdict, said) = graintwin(folder, &arguments);
    let verdict = serde_json::from_str(&verdict).unwrap_or_else(|_| panic!("{code}: {said}"));
    (code, verdict)
}

#[test]
fn a_run_is_made_again_to_the_bit_on_any_number_of_threads() {
    let folder = recorded();
    let mut states = Vec::new();
    for threads in ["1", "2", "7"] {
        let (code, verdict) = verdict(folder.path(), "whole", &["--threads", threads]);
        assert_eq!(code, 0, "{verdict}");
        assert_eq!(verdict["equal"], true);
        assert_eq!(verdict["whole"], true);
        assert_eq!(verdict["compared"]["answers"], 41);
        assert_eq!(verdict["compared"]["increment"], 40);
        assert_eq!(verdict["threads"].to_string(), threads);
        states.push(verdict["compared"]["state"].as_str().unwrap().to_owned());
    }
    assert_eq!(states[0].len(), 64);
    assert!(states.iter().all(|state| *state == states[0]));
}

#[test]
fn a_replay_that_is_recorded_is_the_same_recording_again() {
    let folder = recorded();
    let (code, _, said) = graintwin(folder.path(), &["replay", "whole", "--record", "again"]);
    assert_eq!(code, 0, "{said}");
    let of = |bag| verdict(folder.path(), bag, &[]);
    assert_eq!(of("again"), of("whole"));
}

#[test]
fn another_tolerance_gives_other_bits_and_the_first_of_them_is_named() {
    let folder = recorded();
    let path = folder.path();
    fs::write(path.join("other.yaml"), format!("{SCENE}solver: {{tolerance: 1.0e-10}}\n")).unwrap();
    let (code, said, error) =
        graintwin(path, &["replay", "whole", "--verify", "--scene", "other.yaml"]);
    assert_eq!(code, 1);
    assert!(said.starts_with("different "), "{said}");
    for told in ["increment 0", "/graintwin/wall_forces", "normal_force[0]", "in the recording"] {
        assert!(error.contains(told), "{told}: {error}");
    }
}

/// A twin of some grains and what it answers, `change`d before it is recorded.
fn altered(folder: &Path, change: fn(&mut Report)) -> Value {
    let mut scene: Scene = packs::scene();
    scene.outputs.grain_motion = When::OnDemand;
    let pack = made(30, 5e6, 3);
    let mut twin = Twin::new(&scene, &pack, 1).unwrap();
    let texts = pack::texts(&pack, "pack.history.json").unwrap();
    let provenance = Provenance {
        scene: scene.to_yaml().unwrap(),
        pack_csv: texts.csv.into_bytes(),
        pack_json: texts.json.into_bytes(),
        pack_history: None,
        threads: 1,
        seed: 3,
        painter: Some(Painter::new(&scene, &pack.bounds, pack.grains.len())),
    };
    let mut recorder =
        Recorder::create(&folder.join("bag"), &Record::default(), &provenance).unwrap();
    let demand = Demand { contact_network: true, ..Demand::ALL };
    recorder.served(&Arc::new(Served { command: None, report: twin.start(demand) }));
    for sequence in 1..=3_u64 {
        let command = graintwin::command::Command {
            stamp: Stamp { sec: sequence as i32, nanosec: 0 },
            session: "s".into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, 0.0, 1e-8 * sequence as f64]),
            age: None,
        };
        let mut report = twin.apply(&command, demand);
        if sequence == 2 {
            change(&mut report);
        }
        recorder.served(&Arc::new(Served { command: Some(command), report }));
    }
    recorder.close_with(Closing { increment: 3, digest: twin.digest() });
    recorder.finish().unwrap();
    let (code, verdict) = verdict(folder, "bag", &[]);
    assert_eq!(code, i32::from(verdict["equal"] == false), "{verdict}");
    verdict
}

/// Which topic and field are named when one number of the second answer is another one.
#[test]
fn one_bit_in_one_field_is_found_and_named() {
    type Case = (fn(&mut Report), &'static str, &'static str);
    let cases: [Case; 9] = [
        (
            |report| {
                let force = &mut report.measures.as_mut().unwrap().walls.normal_force[5];
                *force = force.next_up();
            },
            "wall_forces",
            "normal_force[5]",
        ),
        (
            |report| {
                let state = report.measures.as_mut().unwrap().state.as_mut().unwrap();
                state.stress_walls[4] = state.stress_walls[4].next_down();
            },
            "state",
            "stress_walls[4]",
        ),
        (
            |report| {
                let network = report.measures.as_mut().unwrap().network.as_mut().unwrap();
                network.overlap[7] = network.overlap[7].next_up();
            },
            "contact_network",
            "overlap[7]",
        ),
        (
            |report| {
                let network = report.measures.as_mut().unwrap().network.as_mut().unwrap();
                let last = network.state.last_mut().unwrap();
                *last = 1 - *last;
            },
            "contact_network",
            "state[",
        ),
        (
            |report| {
                let motion = report.measures.as_mut().unwrap().motion.as_mut().unwrap();
                motion.d2min[4] = motion.d2min[4].next_up();
            },
            "grain_motion",
            "d2min[4]",
        ),
        (
            |report| {
                let grains = report.measures.as_mut().unwrap().grains.as_mut().unwrap();
                grains.pressure[3] *= 1.5;
            },
            "grains",
            "data[",
        ),
        (
            |report| {
                let fabric = report.measures.as_mut().unwrap().fabric.as_mut().unwrap();
                fabric.force_histogram[3] += 1;
            },
            "fabric",
            "force_histogram[3]",
        ),
        (|report| report.substeps += 1, "report", "substeps"),
        (|report| report.text = "said otherwise".into(), "report", "text"),
    ];
    for (change, topic, field) in cases {
        let folder = tempfile::tempdir().unwrap();
        let found = altered(folder.path(), change);
        let difference = &found["difference"];
        assert_eq!(difference["topic"], format!("/graintwin/{topic}"), "{found}");
        assert!(difference["field"].as_str().unwrap().starts_with(field), "{found}");
        assert_eq!(difference["increment"], 2, "{found}");
        assert_ne!(difference["recorded"], difference["replayed"], "{found}");
    }
    let folder = tempfile::tempdir().unwrap();
    let found = altered(folder.path(), |report| {
        let state = report.measures.as_mut().unwrap().state.as_mut().unwrap();
        state.solve_seconds = 42.0;
    });
    assert_eq!(found["equal"], true, "a wall clock is no difference: {found}");
}

#[test]
fn the_kernels_of_a_recording_are_named_and_missing_ones_said() {
    assert!(lanes::choose("avx1024").unwrap_err().contains("avx1024"));
    let folder = recorded();
    let (_, verdict) = verdict(folder.path(), "whole", &[]);
    assert_eq!(verdict["recorded_kernels"], lanes::kernels());
    assert_eq!(verdict["kernels"], lanes::kernels());
}

/// Copies the recording `whole` as if its writer had been killed after `share` of its bytes.
fn broken_off(folder: &Path, name: &str, share: f64) {
    let (from, to) = (folder.join("whole"), folder.join(name));
    fs::create_dir(&to).unwrap();
    let bytes = fs::read(from.join("whole_0.mcap")).unwrap();
    let length = (share * bytes.len() as f64) as usize;
    fs::write(to.join(format!("{name}_0.mcap")), &bytes[..length]).unwrap();
}

#[test]
fn a_recording_that_was_broken_off_goes_on_with_the_same_bits() {
    let folder = recorded();
    let path = folder.path();
    let (_, undisturbed) = verdict(path, "whole", &[]);
    for (k, share) in [0.35, 0.6, 0.8, 0.97, 1.0].into_iter().enumerate() {
        let name = format!("cut_{k}");
        broken_off(path, &name, share);
        let (code, summary, said) =
            graintwin(path, &["run", "scene.yaml", "--resume", &name, "--json"]);
        assert_eq!(code, 0, "{share}: {said}");
        let summary: Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["increments"], 40, "{share}");
        assert_eq!(summary["commands"]["APPLIED"], 40, "{share}");
        let (code, found) = verdict(path, &name, &[]);
        assert_eq!(code, 0, "{share}: {found}");
        for same in ["answers", "messages", "increment", "state"] {
            assert_eq!(found["compared"][same], undisturbed["compared"][same], "{share}: {same}");
        }
        let (code, _, said) = graintwin(path, &["check", &name]);
        assert_eq!(code, 0, "{share}: {said}");
    }
}

#[test]
fn a_recording_goes_on_without_its_scene_file_and_more_than_once() {
    let folder = recorded();
    let path = folder.path();
    broken_off(path, "cut", 0.5);
    fs::remove_file(path.join("scene.yaml")).unwrap();
    for _ in 0..2 {
        let (code, _, said) = graintwin(path, &["run", "--resume", "cut"]);
        assert_eq!(code, 0, "{said}");
    }
    let (_, undisturbed) = verdict(path, "whole", &[]);
    let (_, found) = verdict(path, "cut", &[]);
    assert_eq!(found["compared"]["state"], undisturbed["compared"]["state"]);
    assert_eq!(found["compared"]["answers"], undisturbed["compared"]["answers"]);
}

#[test]
fn another_specimen_law_or_path_is_not_gone_on_with() {
    let folder = recorded();
    let path = folder.path();
    broken_off(path, "cut", 0.6);
    let changed = [
        ("coefficient: 0.3", "coefficient: 0.4", "coefficient"),
        ("strain: 2.0e-3, increments: 20", "strain: 2.0e-3, increments: 25", "load path"),
    ];
    for (from, to, told) in changed {
        fs::write(path.join("other.yaml"), SCENE.replace(from, to)).unwrap();
        let (code, _, said) = graintwin(path, &["run", "other.yaml", "--resume", "cut"]);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains(told), "{said}");
    }
    let (code, _, said) = graintwin(path, &["run", "scene.yaml", "--resume", "cut"]);
    assert_eq!(code, 0, "nothing was spoilt by the attempts: {said}");
}

#[test]
fn what_cannot_be_replayed_is_refused_with_a_sentence() {
    let folder = recorded();
    let path = folder.path();
    fs::write(path.join("none.mcap"), b"no bag").unwrap();
    fs::create_dir(path.join("empty")).unwrap();
    for (bag, to_replay, to_resume) in [
        ("none.mcap", "damaged at byte 0", "is no recording of graintwin"),
        ("empty", "no .mcap", "no .mcap"),
        ("nowhere", "cannot read", "cannot read"),
    ] {
        for (verb, told) in [
            (vec!["replay", bag, "--verify"], to_replay),
            (vec!["run", "--resume", bag], to_resume),
        ] {
            let (code, _, said) = graintwin(path, &verb);
            assert_eq!(code, 2, "{verb:?}: {said}");
            assert!(said.contains(told), "{verb:?}: {said}");
        }
    }
    for rate in ["0", "-1", "fast"] {
        let (code, _, said) = graintwin(path, &["replay", "whole", &format!("--rate={rate}")]);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains("full"), "{said}");
    }
    let whole: PathBuf = path.join("whole");
    assert!(scene::load(&whole.join("scene.yaml")).is_err(), "the scene is in the bag alone");
}

//! Pictures of a running twin as a viewer gets them: over CycloneDDS, and the same in the bag.
#![cfg(feature = "mcap")]

use std::fs;

use serde_json::{Value, json};

use crate::program::{Program, Rig, alone_with_scene, path};
use crate::python;

const COMMANDS: u64 = 4;

const SCENE: &str = "
name: live
pack: {generate: {grains: 300, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass,
                  confining_stress: 5.0e6}}
";

#[test]
fn a_viewer_gets_the_pictures_that_are_recorded_and_the_frames_they_stand_in() {
    alone_with_scene(
        a_viewer_gets_the_pictures_that_are_recorded_and_the_frames_they_stand_in,
        SCENE,
        |python, folder| {
            let program = Program::start(folder, "run", &["--record", "bag"]);
            let mut rig = Rig::start(python, &["report", "grains", "markers"]);
            // As slow as the network carries these pictures.
            let count = 1 + COMMANDS as usize;
            rig.send(&path("look", COMMANDS, 1e-8), 1.0);
            for topic in ["report", "grains", "markers"] {
                assert_eq!(rig.wait(topic, count), count, "{topic}: {}", program.log());
            }
            let live = json!({"grains": rig.told("grains"), "markers": rig.told("markers")});
            let (ended, summary) = program.terminate();
            assert!(ended.success(), "{summary}");
            assert_eq!(summary["node"]["pictures"], 2 * (1 + COMMANDS), "{summary}");
            assert_eq!(summary["node"]["pictures_skipped"], 0, "{summary}");

            let file = folder.join("live.json");
            fs::write(&file, live.to_string()).unwrap();
            let about = json!({"name": "live", "scale": 1000.0, "color": "pressure"});
            let bag = folder.join("bag");
            let said = python::run("picture.py", &[&bag, &file], &about.to_string()).unwrap();
            let seen: Value = serde_json::from_str(&said).unwrap();
            assert_eq!(seen["live"], 2 * (1 + COMMANDS));
        },
    );
}

/// A burst is faster than pictures go out: commands are answered all the same, the newest picture
/// is the last that comes, and those left out are counted.
#[test]
fn pictures_that_the_network_cannot_carry_are_left_out_and_counted_but_not_the_newest() {
    const BURST: u64 = 400;
    alone_with_scene(
        pictures_that_the_network_cannot_carry_are_left_out_and_counted_but_not_the_newest,
        SCENE,
        |python, folder| {
            let program = Program::start(folder, "run", &[]);
            let mut rig = Rig::start(python, &["report", "grains", "markers"]);
            rig.send(&path("burst", BURST, 1e-11), 0.0);
            assert_eq!(rig.wait("report", 1 + BURST as usize), 1 + BURST as usize);
            let last = rig.told("report").pop().unwrap()["header"]["stamp"].clone();
            let mut newest = Value::Null;
            let mut come = 0;
            while newest != last {
                let before = come;
                come = rig.wait("grains", before + 1);
                assert!(come > before, "the newest picture comes");
                for cloud in rig.told("grains") {
                    newest = cloud["header"]["stamp"].clone();
                }
            }
            let (ended, summary) = program.terminate();
            assert!(ended.success(), "{summary}");
            let count = |what: &str| summary["node"][what].as_u64().unwrap();
            assert!(count("pictures_skipped") > 0, "{summary}");
            assert!(count("pictures") + count("pictures_skipped") >= BURST, "{summary}");
        },
    );
}

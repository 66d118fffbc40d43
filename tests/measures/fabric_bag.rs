//! Statistics of force networks in recordings: computed anew by another program, replayed to the
//! bit, in the summary, and not there when nobody wants them.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use graintwin::record::reader::Bag;
use serde_json::Value;

use crate::python;

const TOPIC: &str = "/graintwin/fabric";

/// A shear with friction, and a compression without.
fn scene(friction: &str, more: &str) -> String {
    format!(
        "name: network\n\
         pack: {{generate: {{grains: 250, radius: {{uniform: [0.07e-3, 0.13e-3]}}, material: glass, \
         confining_stress: 5.0e6}}}}\n\
         contact: {{friction: {friction}}}\n\
         load_path: [{{polyaxial: {{strain: [-1.0e-3, 0.0, 3.0e-3], increments: 6}}}}]\n{more}"
    )
}

fn graintwin(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    let ended =
        command.args(arguments).current_dir(folder).env_remove("RUST_LOG").output().unwrap();
    assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    String::from_utf8(ended.stdout).unwrap()
}

/// Runs a scene in `folder`: its recording and its summary.
fn run(folder: &Path, scene: &str) -> (PathBuf, Value) {
    fs::write(folder.join("scene.yaml"), scene).unwrap();
    let summary = graintwin(folder, &["run", "scene.yaml", "--record", "bag", "--json"]);
    (folder.join("bag"), serde_json::from_str(&summary).unwrap())
}

fn messages(bag: &Path) -> usize {
    let bag = Bag::open(bag).unwrap();
    bag.messages().filter(|one| one.as_ref().unwrap().channel.topic == TOPIC).count()
}

#[test]
fn another_program_finds_the_same_in_the_recorded_networks() {
    for (friction, coefficient) in [("none", "0"), ("{coefficient: 0.3}", "0.3")] {
        let folder = tempfile::tempdir().unwrap();
        let (bag, summary) = run(folder.path(), &scene(friction, ""));
        assert_eq!(messages(&bag), 7);
        let said = python::run("fabric.py", &[&bag, Path::new(coefficient)], "");
        let Some(said) = said else { return };
        let said: Value = serde_json::from_str(&said).unwrap();
        assert_eq!(said["increments"], 7);
        // The summary tells those of the end.
        assert_eq!(summary["fabric"]["contacts"], said["contacts"]);
    }
}

#[test]
fn a_replay_makes_the_same_bits_and_copes_with_recordings_without_them() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, _) =
        run(folder.path(), &scene("{coefficient: 0.3}", "outputs: {chain_share: 0.25}\n"));
    assert_eq!(messages(&bag), 7);
    graintwin(folder.path(), &["replay", "bag", "--verify", "--threads", "2"]);
    let other = tempfile::tempdir().unwrap();
    let (bag, _) = run(other.path(), &scene("none", "record: {exclude: [fabric]}\n"));
    assert_eq!(messages(&bag), 0);
    graintwin(other.path(), &["replay", "bag", "--verify"]);
}

#[test]
fn never_is_never_in_the_recording_and_in_the_summary() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, summary) = run(folder.path(), &scene("none", "outputs: {fabric: never}\n"));
    assert_eq!((messages(&bag), &summary["fabric"]), (0, &Value::Null));
    assert!(summary["coordination"]["all"].is_array());
}

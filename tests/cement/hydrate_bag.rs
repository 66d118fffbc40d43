//! A run in which hydrate dissociates is recorded, replayed to the bit and resumed after a cut.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const SCENE: &str = "name: part
pack:
  generate: {grains: 80, radius: {uniform: [0.07e-3, 0.13e-3]}, material: quartz, seed: 3,
             confining_stress: 10.0e6}
  hydrate: {saturation: 0.22}
load_path:
  - dissociate: {saturation_loss: 0.006, increments: 3}
  - dissociate: {pore_pressure: 4.0e5, increments: 2}
  - dissociate: {saturation_loss: 0.001}
  - uniaxial: {strain: 2.0e-4, increments: 2}
outputs: {moduli: tangent}
";

fn graintwin(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_graintwin")).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes)).concat()
}

/// The end of a summary as JSON.
fn end(output: &Output) -> serde_json::Value {
    let mut summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let mut end = summary["end"].take();
    end["state"]["solve_seconds"].take();
    end
}

#[test]
fn what_dissociates_is_recorded_and_replayed_and_goes_on_after_a_cut() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (scene, bag, cut) = (path("part.yaml"), path("bag"), path("cut"));
    fs::write(&scene, SCENE).unwrap();
    let run = graintwin(&["run", &scene, "--record", &bag, "--json"]);
    // One command is refused: what is lost does not come back.
    assert_eq!(run.status.code(), Some(3), "{}", said(&run));
    assert!(said(&run).contains("saturation_loss would be 1e-3"), "{}", said(&run));
    let hydrate = &end(&run)["hydrate"];
    assert_eq!(hydrate["pore_pressure"], 4e5);
    let verified = graintwin(&["replay", &bag, "--verify"]);
    assert!(verified.status.success(), "{}", said(&verified));
    // A recording that lost its last third goes on to the same end.
    fs::create_dir(&cut).unwrap();
    for entry in fs::read_dir(&bag).unwrap() {
        let from = entry.unwrap().path();
        let bytes = fs::read(&from).unwrap();
        let is_bag = from.extension().is_some_and(|end| end == "mcap");
        let kept = if is_bag { &bytes[..bytes.len() * 2 / 3] } else { &bytes[..] };
        fs::write(Path::new(&cut).join(from.file_name().unwrap()), kept).unwrap();
    }
    let resumed = graintwin(&["run", "--resume", &cut, "--json"]);
    assert_eq!(resumed.status.code(), Some(3), "{}", said(&resumed));
    assert_eq!(end(&resumed), end(&run));
    let verified = graintwin(&["replay", &cut, "--verify"]);
    assert!(verified.status.success(), "{}", said(&verified));
    // The commands of a bag are commands of another run.
    let again = graintwin(&["run", &scene, "--commands", &bag, "--json"]);
    assert_eq!(end(&again)["walls"], end(&run)["walls"], "{}", said(&again));
    let drawn = graintwin(&["plot", &bag, "--out", &path("drawn")]);
    assert!(drawn.status.success(), "{}", said(&drawn));
}

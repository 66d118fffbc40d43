//! Events in recordings: in full and with snapshots, where they are wanted, and made again by a
//! replay.

use std::fs;
use std::path::Path;
use std::process::Command;

use graintwin::msg::cdr;
use graintwin::msg::{Described, Event, PackState, Rearrangement, Snapshot};
use graintwin::record::reader::Bag;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// A frictionless pack on a path with rearrangements.
const SCENE: &str = "
pack:
  generate: {grains: 306, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass,
             confining_stress: 10.0e6}
load_path:
  - isotropic: {strain: 9.0e-3, increments: 60}
";

/// Runs the scene with `more` into the recording `bag` of `folder`; returns the summary.
fn run(folder: &Path, more: &str) -> Value {
    fs::write(folder.join("scene.yaml"), format!("{SCENE}{more}")).unwrap();
    let said = graintwin(folder, &["run", "scene.yaml", "--record", "bag", "--json"]);
    serde_json::from_str(&said).unwrap()
}

fn graintwin(folder: &Path, arguments: &[&str]) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    let ended = command.args(arguments).current_dir(folder).output().unwrap();
    let [out, err] = [ended.stdout, ended.stderr].map(|text| String::from_utf8(text).unwrap());
    assert_eq!(ended.status.code(), Some(0), "{arguments:?}: {err}");
    out
}

/// The messages of a topic.
fn on<T: Described + DeserializeOwned>(folder: &Path, topic: &str) -> Vec<T> {
    let bag = Bag::open(&folder.join("bag")).unwrap();
    let messages = bag.messages().map(|message| message.unwrap());
    let own = messages.filter(|message| message.channel.topic == format!("/graintwin/{topic}"));
    own.map(|message| cdr::decode(&message.data).unwrap()).collect()
}

fn is_replayed(folder: &Path) {
    let verdict = graintwin(folder, &["replay", "bag", "--verify", "--json"]);
    let verdict: Value = serde_json::from_str(&verdict).unwrap();
    assert_eq!(verdict["equal"], true, "{verdict}");
}

#[test]
fn every_event_is_recorded_in_full_with_two_snapshots() {
    let folder = tempfile::tempdir().unwrap();
    let summary = run(folder.path(), "");
    let events: Vec<Event> = on(folder.path(), "events");
    let full: Vec<Rearrangement> = on(folder.path(), "rearrangements");
    let snapshots: Vec<Snapshot> = on(folder.path(), "snapshots");
    assert!(!events.is_empty(), "the path had no event");
    assert_eq!((full.len(), snapshots.len()), (events.len(), 2 * events.len()));
    let told = summary["events"].as_array().unwrap();
    assert_eq!(told.len(), events.len());
    let mut released = 0.0;
    for (((event, full), ends), told) in events.iter().zip(&full).zip(snapshots.chunks(2)).zip(told)
    {
        let place = (full.increment, full.event);
        assert_eq!(event.increment, full.increment);
        assert_eq!([0, 1], [ends[0].when, ends[1].when]);
        assert!(ends.iter().all(|end| (end.increment, end.event) == place));
        assert!(ends.iter().all(|end| end.position.len() == 3 * 306 && end.rotation.is_empty()));
        assert_eq!(event.grains, full.grains);
        for (k, grain) in full.grains.iter().enumerate() {
            let at = 3 * *grain as usize;
            let way: Vec<f64> =
                (0..3).map(|a| ends[1].position[at + a] - ends[0].position[at + a]).collect();
            assert_eq!(way, full.displacement[3 * k..3 * k + 3]);
        }
        let energy = full.energy_before - full.energy_after;
        assert_eq!(told["energy_released"].as_f64().unwrap(), energy);
        assert_eq!(told["increment"], full.increment);
        released += energy;
    }
    assert_eq!(summary["end"]["state"]["event_energy"].as_f64().unwrap(), released);
    is_replayed(folder.path());
}

#[test]
fn what_is_not_wanted_is_not_recorded_and_the_rest_is_the_same() {
    for (more, left) in [
        ("record: {exclude: [snapshots]}\n", "rearrangements"),
        ("outputs: {rearrangements: never}\n", "snapshots"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        run(folder.path(), more);
        let events: Vec<Event> = on(folder.path(), "events");
        let count = |topic| {
            let bag = Bag::open(&folder.path().join("bag")).unwrap();
            let name = format!("/graintwin/{topic}");
            bag.messages().filter(|message| message.as_ref().unwrap().channel.topic == name).count()
        };
        let counts = [("rearrangements", events.len()), ("snapshots", 2 * events.len())];
        for (topic, wanted) in counts {
            assert_eq!(count(topic), if topic == left { wanted } else { 0 }, "{more}");
        }
        let states: Vec<PackState> = on(folder.path(), "state");
        assert_eq!(states.len(), 61);
        is_replayed(folder.path());
    }
}

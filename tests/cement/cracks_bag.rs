//! Bonds and cracks in recordings: those of the twin, checked by another program, replayed to the bit,
//! and not there when nobody wants them or there is no cement.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use graintwin::msg::cdr;
use graintwin::msg::{Cracks, Described, Event, MarkerArray};
use graintwin::record::reader::Bag;
use graintwin::report::Demand;
use graintwin::twin::Twin;
use graintwin::{pack, scene};
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::python;

const CEMENT: &str = "{cement: {law: {parallel: {young: 10.0e9, shear: 4.0e9, radius_ratio: 0.5, \
                      length_ratio: 2.0}}, strength: {tension: 10.0e6, shear: 35.0e6}}}";

fn scene_text(normal: &str, more: &str) -> String {
    format!(
        "name: cracks\n\
         pack: {{generate: {{grains: 120, radius: {{uniform: [0.07e-3, 0.13e-3]}}, material: quartz, \
         confining_stress: 10.0e6}}}}\n\
         contact: {{friction: {{coefficient: 0.3}}, normal: {normal}}}\n\
         load_path: [{{triaxial: {{axial_strain: 2.0e-3, lateral_strain: -0.5e-3, increments: 8}}}}]\n\
         {more}"
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

/// The messages of a topic.
fn on<T: Described + DeserializeOwned>(bag: &Path, topic: &str) -> Vec<T> {
    let bag = Bag::open(bag).unwrap();
    let messages = bag.messages().map(|message| message.unwrap());
    let own = messages.filter(|message| message.channel.topic == format!("/graintwin/{topic}"));
    own.map(|message| cdr::decode(&message.data).unwrap()).collect()
}

fn count(bag: &Path, topic: &str) -> usize {
    let bag = Bag::open(bag).unwrap();
    let name = format!("/graintwin/{topic}");
    bag.messages().filter(|message| message.as_ref().unwrap().channel.topic == name).count()
}

#[test]
fn cracks_in_a_bag_are_those_of_the_run_and_are_made_again_by_a_replay() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, summary) = run(folder.path(), &scene_text(CEMENT, ""));
    let cracks: Vec<Cracks> = on(&bag, "cracks");
    assert_eq!((cracks.len(), count(&bag, "bonds")), (9, 9));
    let events: Vec<Event> = on(&bag, "events");
    let breaks = events.iter().filter(|event| event.kind == 1);
    let of_events: Vec<Vec<u32>> = breaks.map(|event| event.grains.clone()).collect();
    let told: Vec<Vec<u32>> = cracks
        .iter()
        .flat_map(|one| one.first.iter().zip(&one.second).map(|(a, b)| vec![*a, *b]))
        .collect();
    assert_eq!(told, of_events);
    assert!(told.len() > 5, "{}", told.len());
    let of_summary: Vec<Value> = summary["events"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|event| event["kind"] == "contact_break")
        .map(|event| event["grains"].clone())
        .collect();
    assert_eq!(serde_json::to_value(&told).unwrap(), Value::from(of_summary));
    let (last, cement) = (cracks.last().unwrap(), &summary["cement"]);
    assert_eq!(cement["intact"], last.intact);
    assert_eq!(cement["broken_by_tension"], last.broken_by_tension);
    assert_eq!(cement["broken_by_shear"], last.broken_by_shear);
    assert_eq!(cement["cracks"], told.len());
    let lost: f64 = cracks.iter().flat_map(|one| &one.energy_released).sum();
    let ledger = cement["broken_energy"].as_f64().unwrap();
    assert!((lost / ledger - 1.0).abs() < 1e-9, "{lost} {ledger}");
    // In the pictures each crack is a disc of eight triangles, each bond a line.
    let markers: Vec<MarkerArray> = on(&bag, "markers");
    let drawn = |ns: &str| {
        let array = &markers.last().unwrap().markers;
        array.iter().filter(|marker| marker.ns == ns).map(|one| one.points.len()).sum::<usize>()
    };
    assert_eq!(drawn("cracks"), 24 * told.len());
    assert_eq!(drawn("bonds") as u64, 2 * u64::from(last.intact));
    graintwin(folder.path(), &["replay", "bag", "--verify", "--threads", "2"]);
    let said = graintwin(folder.path(), &["plot", "bag"]);
    assert!(said.contains("cement.svg"), "{said}");
    let Some(said) = python::run("bonds.py", &[&bag], "") else { return };
    let said: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["increments"], 9);
    assert_eq!(said["cracks"], told.len());
    let most = said["most"].as_f64().unwrap();
    assert!(0.5 < most && most < 1.0, "{said}");
}

#[test]
fn a_recording_without_them_is_replayed_and_the_rest_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let more = "outputs: {bonds: never, cracks: never}\n";
    let (bag, summary) = run(folder.path(), &scene_text(CEMENT, more));
    assert_eq!((count(&bag, "bonds"), count(&bag, "cracks")), (0, 0));
    assert!(summary["cement"]["cracks"].as_u64().unwrap() > 5);
    graintwin(folder.path(), &["replay", "bag", "--verify"]);
}

#[test]
fn without_cement_nothing_is_recorded_drawn_or_told_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let (bag, summary) = run(folder.path(), &scene_text("hertz", ""));
    assert_eq!((count(&bag, "bonds"), count(&bag, "cracks")), (0, 0));
    assert!(summary["cement"].is_null());
    let markers: Vec<MarkerArray> = on(&bag, "markers");
    let cement = |ns: &str| ns == "bonds" || ns == "cracks";
    assert!(markers.iter().all(|array| array.markers.iter().all(|one| !cement(&one.ns))));
    assert!(!graintwin(folder.path(), &["plot", "bag"]).contains("cement.svg"));
}

#[test]
fn a_stored_pack_tells_its_bonds() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.yaml"), scene_text(CEMENT, "")).unwrap();
    let loaded = scene::load(&folder.path().join("scene.yaml")).unwrap();
    let pack = pack::build(&loaded).unwrap();
    let mut twin = Twin::new(&loaded.scene, &pack, 1).unwrap();
    twin.start(Demand::NONE);
    let bonds = twin.cracks().unwrap().intact;
    twin.save_pack(&folder.path().join("end.csv")).unwrap();
    let said = graintwin(folder.path(), &["check", "end.csv"]);
    let line = said.lines().find(|line| line.starts_with("cement")).unwrap();
    assert!(line.contains(&format!(" {bonds} bonds, beside 0 that broke by tension")), "{line}");
}

//! Hold, faults, reset and saved packs.

use std::path::Path;
use std::sync::OnceLock;

use graintwin::command::{Ask, Command, Disposition, Mode};
use graintwin::pack::{self, Pack};
use graintwin::report::{Demand, Report};
use graintwin::scene::{self, Coulomb, Fault, Friction, Limits, Scene};
use graintwin::twin::Twin;
use graintwin::wall;

use crate::packs::{Rig, absolute, bits, by_strain, made, scene};

/// A pack at 1 MPa.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(60, 1e6, 21))
}

fn small() -> [f64; wall::COUNT] {
    by_strain(&pack().bounds, [0.0, 0.0, 5e-5])
}

fn frictional() -> Scene {
    let mut scene = scene();
    scene.contact.friction = Friction::Coulomb(Coulomb { coefficient: 0.3, ..Coulomb::default() });
    scene
}

#[test]
fn on_hold_every_command_is_held_and_takes_no_place_in_the_sequence() {
    let mut rig = Rig::start(&scene(), pack()).0;
    rig.go(small());
    assert!(rig.twin.hold(true).unwrap().contains("HELD"));
    let before = bits(&rig.twin.pack());
    let held = [
        absolute(2, [0.0; 6]),
        absolute(1, small()),
        absolute(9, [f64::NAN; 6]),
        Command { session: "another".into(), ..absolute(1, [0.0; 6]) },
    ];
    for command in &held {
        let report = rig.twin.apply(command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Held, "{}", report.text);
        assert!(report.text.contains("on hold"), "{}", report.text);
        assert_eq!((report.increment, report.sequence), (1, command.sequence));
        assert!(report.measures.is_none());
    }
    assert!(bits(&rig.twin.pack()) == before);
    rig.twin.hold(false).unwrap();
    // The next increment of the first session is still the second command.
    let next = Command { mode: Mode::Increment, ..absolute(2, [0.0; 6]) };
    let report = rig.twin.apply(&next, Demand::ALL);
    assert_eq!((report.disposition, report.increment), (Disposition::Applied, 2));
}

#[test]
fn a_limit_holds_the_twin_until_the_faults_are_reset_when_the_scene_says_so() {
    let mut scene = scene();
    scene.node.limits = Limits { travel: 1e-8, ..Limits::default() };
    let beyond = [0.0, 0.0, 0.0, 0.0, 0.0, 2e-8];
    let mut free = Rig::start(&scene, pack()).0;
    assert_eq!(free.send(beyond).disposition, Disposition::Limit);
    free.go([0.0; 6]);

    scene.node.hold_after = vec![Fault::Limit];
    let mut rig = Rig::start(&scene, pack()).0;
    assert_eq!(rig.send(beyond).disposition, Disposition::Limit);
    let report = rig.send([0.0; 6]);
    assert_eq!(report.disposition, Disposition::Held);
    assert!(report.text.contains("node.limits.travel"), "{}", report.text);
    assert!(report.text.contains("reset_faults"), "{}", report.text);
    // A hold that ends does not end a fault, and resetting faults does not end a hold.
    assert!(rig.twin.hold(false).unwrap_err().contains("node.limits.travel"));
    rig.twin.hold(true).unwrap();
    assert!(rig.twin.reset_faults().contains("still on hold"));
    assert_eq!(rig.send([0.0; 6]).disposition, Disposition::Held);
    rig.twin.hold(false).unwrap();
    rig.go([0.0; 6]);
    assert_eq!(rig.twin.reset_faults(), "there is no fault");
}

#[test]
fn a_command_without_an_equilibrium_holds_the_twin_when_the_scene_says_so() {
    let mut scene = scene();
    scene.solver.max_iterations = Some(1);
    scene.node.hold_after = vec![Fault::NotConverged];
    let mut rig = Rig::start(&scene, pack()).0;
    let far = by_strain(&pack().bounds, [1e-3, 0.0, 5e-3]);
    assert_eq!(rig.send(far).disposition, Disposition::NotConverged);
    assert_eq!(rig.send([0.0; 6]).disposition, Disposition::Held);
    assert!(rig.twin.reset_faults().starts_with("forgotten: command 1 of session `test`"));
    rig.go([0.0; 6]);
}

/// What a report says, but for the wall clock.
fn said(report: &Report) -> String {
    let mut report = report.clone();
    if let Some(state) = report.measures.as_mut().and_then(|measures| measures.state.as_mut()) {
        state.solve_seconds = 0.0;
    }
    format!("{report:?}")
}

/// Bits of the grains and of what their contacts remember.
fn whole(twin: &Twin) -> (Vec<u64>, Option<pack::History>) {
    let pack = twin.pack();
    (bits(&pack), pack.history)
}

#[test]
fn after_a_reset_state_and_answers_are_those_of_a_new_twin_bit_by_bit() {
    // The second is given with friction that it was made without, and relaxes at the start; the
    // third comes with a history.
    let mut moved = Rig::start(&frictional(), pack()).0;
    moved.go(by_strain(&pack().bounds, [1e-3, -1e-3, 5e-4]));
    let remembers = moved.twin.pack();
    assert!(remembers.history.as_ref().is_some_and(|history| !history.contacts.is_empty()));
    // The fourth brings its walls to a load at the start.
    let text = "pack: {file: none.csv}\nwalls: {targets: {z_max: {stress: 2.0e6}}}";
    let loaded = scene::parse(text, Path::new("scene.yaml")).unwrap();
    for (scene, pack) in
        [(scene(), pack()), (frictional(), pack()), (frictional(), &remembers), (loaded, pack())]
    {
        let (mut rig, first) = Rig::start(&scene, pack);
        let start = whole(&rig.twin);
        let path = [small(), by_strain(&pack.bounds, [1e-4, -1e-4, 2e-4])];
        let after: Vec<_> = path.iter().map(|&target| said(&rig.send(target))).collect();
        let end = whole(&rig.twin);
        assert!(end != start);
        let effort = rig.twin.effort();

        let report = rig.twin.reset(Demand::ALL);
        assert_eq!(said(&report), said(&first));
        assert!(whole(&rig.twin) == start);
        assert!(rig.twin.effort().gradients >= effort.gradients);
        // The session is forgotten: its first command is one again.
        rig.sequence = 0;
        let again: Vec<_> = path.iter().map(|&target| said(&rig.send(target))).collect();
        assert_eq!(again, after);
        assert!(whole(&rig.twin) == end);
    }
}

#[test]
fn a_reset_ends_neither_hold_nor_fault() {
    let mut rig = Rig::start(&scene(), pack()).0;
    rig.twin.hold(true).unwrap();
    rig.twin.reset(Demand::default());
    assert_eq!(rig.send([0.0; 6]).disposition, Disposition::Held);
}

#[test]
fn a_saved_pack_is_in_equilibrium_when_it_is_loaded_and_is_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("now.csv");
    for scene in [scene(), frictional()] {
        let mut rig = Rig::start(&scene, pack()).0;
        let last = rig.go(by_strain(&pack().bounds, [1e-4, -1e-4, 2e-4]));
        assert!(rig.twin.save_pack(&file).unwrap().contains("increment 1"));
        let text = format!("pack: {{file: {}, material: glass}}", file.display());
        let mut loaded = scene::parse(&text, Path::new("scene.yaml")).unwrap();
        loaded.contact = scene.contact;
        let loaded = scene::Loaded { scene: loaded, file: "scene.yaml".into() };
        let saved = pack::build(&loaded).unwrap();
        assert!(bits(&saved) == bits(&rig.twin.pack()));
        let (_, report) = Rig::start(&loaded.scene, &saved);
        assert_eq!((report.disposition, report.substeps), (Disposition::Applied, 0));
        assert_eq!(report.text, "");
        let found = report.measures.unwrap().walls.normal_force;
        assert_eq!(found, last.walls.normal_force);

        let refusal = rig.twin.save_pack(&file).unwrap_err();
        assert!(refusal.contains("now.csv exists: name a new file"), "{refusal}");
        std::fs::remove_file(&file).unwrap();
        let refusal = rig.twin.save_pack(&file).unwrap_err();
        assert!(refusal.contains("now.json exists"), "{refusal}");
        std::fs::remove_file(folder.path().join("now.json")).unwrap();
    }
    let rig = Rig::start(&scene(), pack()).0;
    let refusal = rig.twin.save_pack(&folder.path().join("none/now.csv")).unwrap_err();
    assert!(refusal.contains("now.csv"), "{refusal}");
    assert!(rig.twin.save_pack(&folder.path().join("now.txt")).is_err());
}

#[test]
fn a_message_that_makes_no_command_is_invalid_or_held_and_takes_no_place_in_the_sequence() {
    let mut rig = Rig::start(&scene(), pack()).0;
    rig.go(small());
    let instead = Command { ask: Ask::Displacement([f64::NAN; 6]), ..absolute(2, small()) };
    let report = rig.twin.refuse(&instead, "joint `a` is missing".into());
    assert_eq!((report.disposition, report.increment), (Disposition::Invalid, 1));
    assert_eq!((report.sequence, report.text.as_str()), (2, "joint `a` is missing"));
    rig.twin.hold(true).unwrap();
    let report = rig.twin.refuse(&instead, "joint `a` is missing".into());
    assert_eq!(report.disposition, Disposition::Held);
    rig.twin.hold(false).unwrap();
    let next = Command { mode: Mode::Increment, ..absolute(2, [0.0; 6]) };
    assert_eq!(rig.twin.apply(&next, Demand::ALL).disposition, Disposition::Applied);
}

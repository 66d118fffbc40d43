//! Commands by which hydrate dissociates: what is refused, what goes back, what goes on.

use std::path::Path;

use graintwin::command::{Ask, Command, Disposition, Mode};
use graintwin::pack::{self, Pack};
use graintwin::path;
use graintwin::report::Demand;
use graintwin::scene::{self, Scene};
use graintwin::twin::Twin;
use graintwin::wall;
use proptest::prelude::*;

use crate::hydrates::{HYDRATE, dissociation, filled, hydrate};
use crate::packs::{Rig, absolute, bits, by_strain, close, made, scene_to, state};

fn sediment() -> Pack {
    filled(80, 10e6, 0.22, &HYDRATE)
}

/// Bits of everything that a twin goes on from: its state, and the grains as they are.
fn all_bits(twin: &Twin) -> (String, Vec<u64>) {
    (twin.digest(), bits(&twin.pack()))
}

#[test]
fn what_makes_no_sense_is_refused_with_the_field_and_what_is_allowed() {
    let (mut rig, report) = Rig::start(&scene_to(1e-8), &sediment());
    let saturation = hydrate(&report.measures.unwrap()).saturation;
    rig.dissociate(0.01, 1e5, 0.8);
    let before = all_bits(&rig.twin);
    let nan = f64::NAN;
    for (ask, named, allowed) in [
        ((nan, 0.0, 0.8), "saturation_loss is NaN", "a finite number"),
        ((0.01, nan, 0.8), "pore_pressure is NaN", "a finite number"),
        ((0.01, f64::INFINITY, 0.8), "pore_pressure is inf", "a finite number"),
        ((0.01, 0.0, nan), "biot is NaN", "a finite number"),
        ((0.01, 0.0, -0.1), "biot is -1e-1", "0 to 1 is allowed"),
        ((0.01, 0.0, 1.1), "biot is 1.1", "0 to 1 is allowed"),
        ((-0.01, 0.0, 0.8), "saturation_loss would be -1e-2", "from 1e-2, which is lost already"),
        ((0.009, 0.0, 0.8), "saturation_loss would be 9e-3", "from 1e-2, which is lost already"),
        ((saturation, 0.0, 0.8), "saturation_loss would be", "at the start is allowed"),
        ((0.01, -1.0, 0.8), "pore_pressure would be -1e0 Pa", "0 to"),
        ((0.01, 1e9, 0.8), "pore_pressure would be 1e9 Pa", "a tenth of the softest grain's"),
    ] {
        let report = rig.ask(dissociation(ask.0, ask.1, ask.2));
        assert_eq!(report.disposition, Disposition::Invalid, "{ask:?}");
        assert!(report.text.contains(named) && report.text.contains(allowed), "{}", report.text);
        assert!(report.measures.is_none());
        assert_eq!(all_bits(&rig.twin), before);
    }
    let (mut other, _) = Rig::start(&scene_to(1e-8), &made(80, 10e6, 1));
    let report = other.ask(dissociation(0.01, 0.0, 0.8));
    assert_eq!(report.disposition, Disposition::Invalid);
    assert!(report.text.contains("the pack has no hydrate"), "{}", report.text);
}

#[test]
fn increments_go_on_top_of_what_was_accepted_last() {
    let pack = sediment();
    let (mut rig, _) = Rig::start(&scene_to(1e-8), &pack);
    let (mut other, _) = Rig::start(&scene_to(1e-8), &pack);
    for k in 1..=3 {
        let command = Command {
            mode: Mode::Increment,
            ask: dissociation(0.002, 1e4, 0.5),
            ..absolute(k, [0.0; wall::COUNT])
        };
        let report = rig.twin.apply(&command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let k = k as f64;
        let measures = other.dissociate(0.002 * k, 1e4 * k, 0.5);
        for (got, want) in
            report.measures.unwrap().walls.normal_force.iter().zip(measures.walls.normal_force)
        {
            close("force", *got, want, 1e-6);
        }
    }
    // What stands at displacements goes on from where the expansion left it.
    let at = state_of_walls(&mut rig);
    let command = Command {
        mode: Mode::Increment,
        ask: Ask::Displacement([1e-9; wall::COUNT]),
        ..absolute(5, [0.0; wall::COUNT])
    };
    let moved = rig.twin.apply(&command, Demand::ALL).measures.unwrap().walls.displacement;
    for w in 0..wall::COUNT {
        assert_eq!(moved[w], at[w] + 1e-9);
    }
}

fn state_of_walls(rig: &mut Rig) -> [f64; wall::COUNT] {
    let command = Command {
        mode: Mode::Increment,
        ask: Ask::Displacement([0.0; wall::COUNT]),
        ..absolute(4, [0.0; wall::COUNT])
    };
    rig.twin.apply(&command, Demand::ALL).measures.unwrap().walls.displacement
}

#[test]
fn a_reset_brings_back_the_grains_and_the_same_course() {
    let pack = sediment();
    let (mut rig, report) = Rig::start(&scene_to(1e-8), &pack);
    let start = (all_bits(&rig.twin), report.measures.unwrap().walls);
    let course = |rig: &mut Rig| {
        rig.sequence = 0;
        rig.dissociate(0.02, 0.0, 0.8);
        rig.dissociate(0.02, 2e5, 0.8);
        all_bits(&rig.twin)
    };
    let first = course(&mut rig);
    let again = rig.twin.reset(Demand::ALL);
    assert_eq!((all_bits(&rig.twin), again.measures.unwrap().walls), start);
    assert_eq!(course(&mut rig), first);
}

#[test]
fn a_relaxation_that_fails_leaves_state_and_radii_as_they_were() {
    let pack = sediment();
    let (mut rig, _) = Rig::start(&scene_to(1e-8), &pack);
    rig.dissociate(0.005, 1e5, 0.8);
    let before = all_bits(&rig.twin);
    // Nothing is balanced so well.
    let settings = graintwin::twin::Settings { tolerance: 1e-30, ..settings() };
    rig.twin.set(&settings);
    for ask in [dissociation(0.03, 1e5, 0.8), dissociation(0.005, 5e5, 0.8)] {
        let report = rig.ask(ask);
        assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
        assert_eq!(all_bits(&rig.twin), before);
    }
    // It goes on as if nothing had been asked.
    rig.twin.set(&self::settings());
    let (mut other, _) = Rig::start(&scene_to(1e-8), &pack);
    other.dissociate(0.005, 1e5, 0.8);
    rig.dissociate(0.01, 1e5, 0.8);
    other.dissociate(0.01, 1e5, 0.8);
    assert_eq!(all_bits(&rig.twin), all_bits(&other.twin));
}

fn settings() -> graintwin::twin::Settings {
    graintwin::twin::Settings::of(&scene_to(1e-8))
}

#[test]
fn a_limit_of_force_is_found_at_the_equilibrium_and_nothing_is_done_in_part() {
    let pack = sediment();
    let mut scene = scene_to(1e-8);
    scene.node.limits.strain = 1e-4;
    scene.node.limits.clamp = true;
    let (mut rig, _) = Rig::start(&scene, &pack);
    let before = all_bits(&rig.twin);
    let report = rig.ask(dissociation(0.0, 20e6, 0.8));
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    assert!(report.text.contains("take 1.6e7 Pa away from the grains"), "{}", report.text);
    let report = rig.ask(dissociation(0.0, 3e6, 0.8));
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    assert!(report.text.contains("node.limits.strain"), "{}", report.text);
    assert_eq!(all_bits(&rig.twin), before);
    rig.dissociate(0.0, 1e4, 0.8);
}

#[test]
fn the_bits_do_not_depend_on_the_threads() {
    let pack = filled(400, 10e6, 0.22, &HYDRATE);
    let course = |threads| {
        let (mut rig, _) = Rig::start_on(&scene_to(1e-8), &pack, threads);
        rig.dissociate(0.01, 0.0, 0.8);
        rig.dissociate(0.01, 5e5, 0.8);
        all_bits(&rig.twin)
    };
    let one = course(1);
    assert_eq!(course(2), one);
    assert_eq!(course(5), one);
}

#[test]
fn a_stored_pack_keeps_its_hydrate_and_carries_the_same_forces() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("part.csv");
    let (mut rig, _) = Rig::start(&scene_to(1e-8), &sediment());
    let measures = rig.dissociate(0.04, 1e5, 0.8);
    let now = hydrate(&measures);
    rig.twin.save_pack(&file).unwrap();
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.starts_with("x,y,z,radius,young,poisson,density,friction,hydrate\n"), "{text}");
    let loaded = scene::Loaded {
        scene: scene::parse("pack: {file: part.csv}", Path::new("s.yaml")).unwrap(),
        file: folder.path().join("s.yaml"),
    };
    let pack = pack::build(&loaded).unwrap();
    assert_eq!(bits(&pack), bits(&rig.twin.pack()));
    let (mut again, report) = Rig::start(&scene_to(1e-8), &pack);
    let measures_again = report.measures.unwrap();
    for w in 0..wall::COUNT {
        let [got, want] = [&measures_again, &measures].map(|one| one.walls.normal_force[w]);
        close("force", got, want, 1e-8);
    }
    // Its own start: what is left counts anew, without a pore pressure.
    let start = hydrate(&measures_again);
    close("saturation", start.saturation, now.present_saturation, 1e-9);
    assert_eq!((start.pore_pressure, start.total_stress), (0.0, start.effective_stress));
    again.dissociate(0.01, 0.0, 0.8);
}

#[test]
fn a_scene_fills_a_pack_that_is_read_and_a_file_that_is_filled_wants_no_more() {
    let folder = tempfile::tempdir().unwrap();
    let sand = folder.path().join("sand.csv");
    pack::save(&made(80, 10e6, 1), &sand).unwrap();
    let load = |text: &str| {
        let scene = scene::parse(text, Path::new("s.yaml")).unwrap();
        pack::build(&scene::Loaded { scene, file: folder.path().join("s.yaml") })
    };
    let pack = load("pack: {file: sand.csv, hydrate: {saturation: 0.1}}").unwrap();
    let (mut rig, _) = Rig::start(&scene_to(1e-8), &pack);
    let found = hydrate(&rig.dissociate(0.0, 0.0, 0.8)).saturation;
    assert!((found - 0.1).abs() < 0.01, "{found}");
    let filled = folder.path().join("filled.csv");
    pack::save(&pack, &filled).unwrap();
    assert_eq!(bits(&load("pack: {file: filled.csv}").unwrap()), bits(&pack));
    let error = load("pack: {file: filled.csv, hydrate: {saturation: 0.1}}").unwrap_err();
    assert!(error.to_string().contains("column `hydrate`"), "{error}");
    std::fs::write(&filled, "x,y,z,radius,hydrate\n0,0,0,1e-3,2\n").unwrap();
    let error = pack::read(&filled).unwrap_err().to_string();
    assert!(error.contains("filled.csv:2: column `hydrate`: `2` is neither 0 nor 1"), "{error}");
}

fn of_path(steps: &str) -> Scene {
    let text = format!("pack: {{file: none.csv}}\nload_path:\n{steps}");
    scene::parse(&text, Path::new("s.yaml")).unwrap()
}

#[test]
fn a_step_goes_in_equal_parts_to_totals_and_the_next_one_begins_where_the_walls_are() {
    let pack = sediment();
    let scene = of_path(
        "  - dissociate: {saturation_loss: 0.01, increments: 2}\n  \
         - dissociate: {pore_pressure: 2.0e5, biot: 0.5, increments: 2}\n  \
         - uniaxial: {axis: z, strain: 1.0e-4, increments: 1}\n",
    );
    let mut path = path::Path::new(&scene, Path::new(""), &pack.bounds).unwrap();
    assert_eq!((path.length(), path.depends_on_the_twin()), (5, true));
    let mut here = path.whereabouts();
    let mut twin = Twin::new(&scene, &pack, 1).unwrap();
    let mut asked = Vec::new();
    let mut report = twin.start(Demand::ALL);
    let mut last = report.measures.clone().unwrap().walls;
    let mut before = last;
    loop {
        let served = graintwin::sink::Served { command: None, report: report.clone() };
        graintwin::sink::Sink::served(&mut here, &std::sync::Arc::new(served));
        let Some(command) = path.next() else { break };
        let command = command.unwrap();
        asked.push(command.ask);
        report = twin.apply(&command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        before = last;
        last = report.measures.clone().unwrap().walls;
    }
    let wanted = [(0.005, 0.0, 0.8), (0.01, 0.0, 0.8), (0.01, 1e5, 0.5), (0.01, 2e5, 0.5)];
    for (ask, (loss, pressure, biot)) in asked.iter().zip(wanted) {
        assert_eq!(*ask, dissociation(loss, pressure, biot));
    }
    // The strain is of the box as the pore pressure left it.
    let mut bounds = pack.bounds;
    bounds = bounds.displaced(&before.displacement);
    let strained = by_strain(&bounds, [0.0, 0.0, 1e-4]);
    for (w, strained) in strained.into_iter().enumerate() {
        let want = before.displacement[w] + strained;
        assert!((last.displacement[w] - want).abs() < 1e-18, "{w}");
    }
    assert!(before.displacement.iter().all(|&at| at < 0.0));
}

#[test]
fn steps_and_packs_that_make_no_sense_are_named() {
    let problem = |text: &str| scene::parse(text, Path::new("s.yaml")).unwrap_err().to_string();
    let step = |keys: &str| {
        problem(&format!("pack: {{file: a.csv}}\nload_path:\n  - dissociate: {{{keys}}}\n"))
    };
    for (keys, said) in [
        ("increments: 2", "needs saturation_loss or pore_pressure"),
        ("saturation_loss: 1.0", "load_path[0].dissociate.saturation_loss"),
        ("saturation_loss: -0.1", "0 <= saturation_loss < 1"),
        ("pore_pressure: -1.0", "pore_pressure >= 0 Pa"),
        ("pore_pressure: .nan", "is not a finite number"),
        ("pore_pressure: 1.0, biot: 1.5", "0 <= biot <= 1"),
        ("pore_pressure: 1.0, increments: 0", "increments"),
        ("saturation: 0.1", "saturation"),
    ] {
        let found = step(keys);
        assert!(found.contains(said), "{keys}: {found}");
    }
    for (keys, said) in [
        ("saturation: 0.0", "0 < saturation < 1"),
        ("saturation: 1.0", "pack.hydrate.saturation"),
        ("saturation: 0.2, material: ice", "no material is named `ice`"),
    ] {
        let found = problem(&format!("pack: {{file: a.csv, hydrate: {{{keys}}}}}"));
        assert!(found.contains(said), "{keys}: {found}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn whatever_is_legal_is_applied_or_refused_with_everything_kept(
        asked in prop::collection::vec((0.0..0.06f64, 0.0..3e6f64, 0.0..1.0f64), 1..4),
    ) {
        let (mut rig, _) = Rig::start(&scene_to(1e-8), &sediment());
        for (loss, pressure, biot) in asked {
            let before = all_bits(&rig.twin);
            let report = rig.ask(dissociation(loss, pressure, biot));
            match report.disposition {
                Disposition::Applied => {
                    let measures = report.measures.unwrap();
                    let now = hydrate(&measures);
                    prop_assert!(now.saturation > 0.0 && now.pore_pressure == pressure);
                    prop_assert!(measures.walls.normal_force.iter().all(|force| *force >= 0.0));
                    prop_assert!(state(&measures).residual <= 1e-8);
                }
                _ => {
                    prop_assert!(!report.text.is_empty());
                    prop_assert_eq!(all_bits(&rig.twin), before);
                }
            }
        }
    }
}

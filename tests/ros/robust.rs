//! What rigs and subscribers do wrong, and how the program takes it.

use std::path::Path;

use graintwin::command::Disposition;
use serde_json::{Value, json};

use crate::program::{ONE_GRAIN, Program, Rig, Sent, alone_with_scene, answers, path, ways};

/// A pack that is slower than a rig can be.
const SMALL: &str = "
pack: {generate: {grains: 60, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass,
                  confining_stress: 1.0e6}}
";

const APPLIED: u64 = Disposition::Applied as u64;

/// The start and a burst of 10 000 commands, sent as fast as a rig can.
const BURST: u64 = 10_000;

/// Has a burst served; returns the messages of `~/wall_forces` and the summary.
fn burst(python: &Path, folder: &Path, step: f64) -> (Vec<Value>, Value) {
    let program = Program::start(folder, "run", &[]);
    let mut rig = Rig::start(python, &["report", "wall_forces"]);
    rig.send(&path("burst", BURST, step), 0.0);
    assert_eq!(rig.wait("report", 1 + BURST as usize), 1 + BURST as usize);
    let reports = rig.told("report");
    let expected: Vec<(u64, u64)> = (1..=BURST).map(|sequence| (sequence, APPLIED)).collect();
    assert!(answers(&reports) == expected, "one report for each command, in order");
    let forces = rig.told("wall_forces");
    assert_eq!(*ways(&forces).last().unwrap(), BURST as f64 * step);
    let (ended, summary) = program.terminate();
    assert!(ended.success(), "{summary}");
    assert_eq!(summary["commands"], json!({"APPLIED": BURST}));
    (forces, summary)
}

#[test]
fn each_of_10_000_commands_at_once_is_an_increment_with_one_report_in_order() {
    alone_with_scene(
        each_of_10_000_commands_at_once_is_an_increment_with_one_report_in_order,
        ONE_GRAIN,
        |python, folder| {
            let (forces, summary) = burst(python, folder, 1e-12);
            assert_eq!(forces.len() as u64, 1 + BURST);
            assert_eq!(summary["increments"], BURST);
        },
    );
}

#[test]
fn of_10_000_commands_at_once_a_slow_twin_that_merges_makes_fewer_increments_and_as_many_reports() {
    alone_with_scene(
        of_10_000_commands_at_once_a_slow_twin_that_merges_makes_fewer_increments_and_as_many_reports,
        &format!("{SMALL}node: {{late: merge}}\n"),
        |python, folder| {
            let (forces, summary) = burst(python, folder, 1e-12);
            let increments = summary["increments"].as_u64().unwrap();
            assert!(increments < BURST / 2, "{increments}");
            assert_eq!(forces.len() as u64, 1 + increments);
        },
    );
}

/// How long a rig sends 1000 commands a second \[s\], unless the variable says otherwise: ten
/// seconds are ten thousand commands, and a rig goes on for hours.
const STEADY: u64 = 10;
const STEADY_VARIABLE: &str = "GRAINTWIN_TEST_STEADY_SECONDS";

/// Commands after which everything that keeps the last ones is full: DDS keeps 20 000 that came.
const FILLED: usize = 24_000;

/// Characters of the session. A command or a report that is not freed takes that much memory.
const SESSION: usize = 2000;

#[test]
fn a_thousand_commands_a_second_are_all_served_in_memory_that_does_not_grow() {
    alone_with_scene(
        a_thousand_commands_a_second_are_all_served_in_memory_that_does_not_grow,
        ONE_GRAIN,
        |python, folder| {
            let seconds = std::env::var(STEADY_VARIABLE)
                .map_or(STEADY, |seconds| seconds.parse().expect("whole seconds"));
            let program = Program::start(folder, "run", &[]);
            let mut rig = Rig::start(python, &["report"]);
            let session = "s".repeat(SESSION);
            let commands = path(&session, FILLED as u64 + 1000 * seconds, 1e-13);
            let (filling, steady) = commands.split_at(FILLED);
            let mut answered = 1;
            for some in filling.chunks(1000) {
                rig.send(some, 0.0);
                answered += some.len();
                assert_eq!(rig.wait("report", answered), answered);
            }
            let memory: Vec<u64> = steady
                .chunks(1000)
                .map(|second| {
                    rig.send(second, 1e-3);
                    program.memory("VmRSS")
                })
                .collect();
            println!("VmRSS, KiB: {memory:?}");
            let all = 1 + commands.len();
            assert_eq!(rig.wait("report", all), all);
            let told = rig.told("report");
            assert!(answers(&told).iter().map(|answer| answer.0).eq(1..all as u64), "in order");

            let after_a_third = memory[memory.len() / 3];
            let since = (memory.len() - 1 - memory.len() / 3) * 1000;
            let leak = (since * SESSION / 1024) as u64;
            let grown = memory[memory.len() - 1].saturating_sub(after_a_third);
            assert!(grown < leak / 2, "{grown} KiB more, {leak} KiB were one message a command");
            let (ended, summary) = program.terminate();
            assert!(ended.success(), "{summary}");
        },
    );
}

/// Commands that a stopped subscriber leaves room for: it may owe the acknowledgement of 8192
/// messages of a topic.
const WITHIN_WINDOW: usize = 2000;

/// More than that.
const BEYOND_WINDOW: usize = 10_000;

/// What the messages that wait for a stopped subscriber may take \[KiB\].
const WAITING: u64 = 64 * 1024;

#[test]
fn a_subscriber_that_stops_holds_nobody_up_for_good_and_hears_all_when_it_soon_goes_on() {
    alone_with_scene(
        a_subscriber_that_stops_holds_nobody_up_for_good_and_hears_all_when_it_soon_goes_on,
        ONE_GRAIN,
        |python, folder| {
            let program = Program::start(folder, "run", &[]);
            let mut rig = Rig::start(python, &["report"]);
            let mut subscriber = Rig::start(python, &["report", "wall_forces"]);
            let commands = path("rig", (WITHIN_WINDOW + BEYOND_WINDOW + 100) as u64, 1e-13);
            let (few, rest) = commands.split_at(WITHIN_WINDOW);
            let (many, last) = rest.split_at(BEYOND_WINDOW);
            let mut answered = 1;
            let mut serve = |rig: &mut Rig, some: &[Sent<'_>]| {
                for some in some.chunks(1000) {
                    rig.send(some, 0.0);
                    answered += some.len();
                    assert_eq!(rig.wait("report", answered), answered);
                }
            };

            subscriber.stop();
            serve(&mut rig, few);
            subscriber.go_on();
            assert_eq!(subscriber.wait("report", few.len()), few.len());
            // With the start, which waited for somebody to listen.
            let forces = 1 + few.len();
            assert_eq!(subscriber.wait("wall_forces", forces), forces);

            // Beyond the window the others wait until the lease of the stopped one has ended.
            let before = program.memory("VmRSS");
            subscriber.stop();
            serve(&mut rig, many);
            let grown = program.memory("VmRSS").saturating_sub(before);
            println!("{grown} KiB");
            assert!(grown < WAITING, "{grown} KiB");
            subscriber.kill();
            serve(&mut rig, last);
            let (ended, summary) = program.terminate();
            assert!(ended.success(), "{summary}");
            assert_eq!(summary["increments"], commands.len());
        },
    );
}

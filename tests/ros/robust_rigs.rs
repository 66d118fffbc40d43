//! Rigs that die, come back, or are two, and messages that are no commands.

use std::path::Path;
use std::process::Command;

use graintwin::command::Disposition;
use serde_json::json;

use crate::program::{ONE_GRAIN, Program, Rig, alone_with_scene, answers, path, ram, ways};

const ABSOLUTE: u8 = 0;
const INCREMENT: u8 = 1;
const APPLIED: u64 = Disposition::Applied as u64;
const DUPLICATE: u64 = Disposition::Duplicate as u64;
const GAP: u64 = Disposition::Gap as u64;
const OUT_OF_ORDER: u64 = Disposition::OutOfOrder as u64;

/// A step of the upper wall \[m\] whose sums round nowhere.
const STEP: f64 = 1.0 / (1_u64 << 40) as f64;

#[test]
fn a_rig_that_was_killed_comes_back_and_goes_on_from_where_the_walls_were_held() {
    alone_with_scene(
        a_rig_that_was_killed_comes_back_and_goes_on_from_where_the_walls_were_held,
        ONE_GRAIN,
        |python, folder| {
            let program = Program::start(folder, "run", &[]);
            let mut witness = Rig::start(python, &["report", "wall_forces"]);
            let mut first = Rig::start(python, &[]);
            first.begin(&path("first", 100_000, STEP), 1e-3);
            witness.wait("report", 200);
            first.kill();

            // A new session asks for nothing, and so hears where the walls are.
            let mut second = Rig::start(python, &["report", "wall_forces"]);
            let before = witness.told("wall_forces");
            let held_at = *ways(&before).last().unwrap();
            assert!(held_at >= 199.0 * STEP, "{held_at}");
            second.send(&[("second", 1, INCREMENT, ram(0.0))], 0.0);
            second.wait("report", 1);
            let reached = second.told("wall_forces");
            assert_eq!(ways(&reached), [held_at]);
            let force = |forces: &serde_json::Value| forces["normal_force"].clone();
            assert_eq!(force(&reached[0]), force(before.last().unwrap()));
            second.send(&[("second", 2, ABSOLUTE, ram(held_at + STEP))], 0.0);
            second.wait("report", 2);
            second.kill();

            // The old session, with commands of it lost: increments are refused until an absolute
            // command says where the walls shall be.
            let mut again = Rig::start(python, &["report", "wall_forces"]);
            again.send(
                &[
                    ("second", 6, INCREMENT, ram(STEP)),
                    ("second", 7, ABSOLUTE, ram(held_at + 2.0 * STEP)),
                    ("second", 8, INCREMENT, ram(STEP)),
                ],
                0.0,
            );
            again.wait("report", 3);
            let told = again.told("report");
            assert_eq!(answers(&told), [(6, GAP), (7, APPLIED), (8, APPLIED)]);
            assert!(
                told[0]["text"].as_str().unwrap().starts_with("3 commands missing"),
                "{told:?}"
            );
            assert!(
                told[1]["text"].as_str().unwrap().starts_with("4 commands missing"),
                "{told:?}"
            );
            assert_eq!(
                ways(&again.told("wall_forces")),
                [held_at + 2.0 * STEP, held_at + 3.0 * STEP]
            );

            // From the first death on the walls did nothing but what was asked.
            witness.wait("report", before.len() + 5);
            assert_eq!(
                ways(&witness.told("wall_forces")),
                [0.0, 1.0, 2.0, 3.0].map(|steps| held_at + steps * STEP)
            );
            let (ended, summary) = program.terminate();
            assert_eq!(ended.code(), Some(3), "a command was refused: {summary}");
        },
    );
}

#[test]
fn of_two_rigs_each_command_has_its_report_and_an_increment_goes_on_from_the_others_target() {
    alone_with_scene(
        of_two_rigs_each_command_has_its_report_and_an_increment_goes_on_from_the_others_target,
        ONE_GRAIN,
        |python, folder| {
            let program = Program::start(folder, "run", &[]);
            let mut a = Rig::start(python, &["report"]);
            let mut b = Rig::start(python, &["report", "wall_forces"]);
            // One after the other, what becomes of it, and where the upper wall is then.
            let steps = [
                (true, 1, ABSOLUTE, 1.0, APPLIED, 1.0),
                (false, 1, ABSOLUTE, 3.0, APPLIED, 3.0),
                // On the last accepted target, whoever gave it.
                (true, 2, INCREMENT, 1.0, APPLIED, 4.0),
                (true, 2, INCREMENT, 1.0, DUPLICATE, 4.0),
                (true, 1, ABSOLUTE, 1.0, OUT_OF_ORDER, 4.0),
                (true, 4, INCREMENT, 1.0, GAP, 4.0),
                // Each has a sequence of its own.
                (false, 1, ABSOLUTE, 3.0, DUPLICATE, 4.0),
                (false, 9, INCREMENT, 1.0, GAP, 4.0),
                (false, 2, INCREMENT, 1.0, APPLIED, 5.0),
                (true, 3, INCREMENT, -2.0, APPLIED, 3.0),
                (true, 9, ABSOLUTE, 2.0, APPLIED, 2.0),
                (false, 10, ABSOLUTE, 0.0, APPLIED, 0.0),
            ];
            // The start went to the rig that was there first.
            let mut reports = 0;
            for (is_a, sequence, mode, way, disposition, after) in steps {
                let (rig, session) = if is_a { (&mut a, "a") } else { (&mut b, "b") };
                rig.send(&[(session, sequence, mode, ram(way * STEP))], 0.0);
                reports += 1;
                assert_eq!(b.wait("report", reports), reports);
                let told = b.told("report");
                let report = told.last().unwrap();
                assert_eq!(
                    (report["session"].as_str(), answers(&told)),
                    (Some(session), vec![(sequence, disposition)]),
                    "{report}"
                );
                let moved = ways(&b.told("wall_forces"));
                match disposition == APPLIED {
                    true => assert_eq!(moved.last(), Some(&(after * STEP)), "{report}"),
                    false => assert!(moved.is_empty(), "{report}"),
                }
            }

            // Both at once, as fast as they can.
            let count = 2000;
            a.begin(&path("c", count, STEP), 0.0);
            b.begin(&path("d", count, -STEP), 0.0);
            a.sent();
            b.sent();
            reports += 2 * count as usize;
            assert_eq!(a.wait("report", 1 + reports), 1 + reports);
            b.wait("report", reports);
            let (of_a, of_b) = (a.told("report"), b.told("report"));
            let fast = &of_a[of_a.len() - 2 * count as usize..];
            for session in ["c", "d"] {
                let own: Vec<_> =
                    fast.iter().filter(|report| report["session"] == session).cloned().collect();
                let all: Vec<_> = (1..=count).map(|sequence| (sequence, APPLIED)).collect();
                assert!(answers(&own) == all, "{session}");
            }
            assert!(of_b == fast, "both hear the same");
            // Each increment is where its own command wanted it.
            let asked = fast.iter().map(|report| {
                let way = report["sequence"].as_f64().unwrap() * STEP;
                if report["session"] == "c" { way } else { -way }
            });
            assert!(ways(&b.told("wall_forces")).into_iter().eq(asked));
            let (_, summary) = program.terminate();
            assert_eq!(summary["node"]["commands"], json!(reports));
        },
    );
}

/// Has `tests/peer/wrong.py` publish messages that are none.
fn publish_wrong(python: &Path, kind: &str, count: u32) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/wrong.py");
    let count = count.to_string();
    let status = Command::new(python).arg("-B").arg(script).args([kind, &count]).status().unwrap();
    assert!(status.success(), "{kind}");
}

#[test]
fn messages_of_another_type_or_cut_short_are_told_and_leave_the_commands_alone() {
    alone_with_scene(
        messages_of_another_type_or_cut_short_are_told_and_leave_the_commands_alone,
        ONE_GRAIN,
        |python, folder| {
            let mut program = Program::start(folder, "run", &[]);
            let mut rig = Rig::start(python, &["report", "wall_forces"]);
            let mut sequence = 0;
            let mut go_on = |rig: &mut Rig| {
                sequence += 1;
                rig.send(&[("rig", sequence, INCREMENT, ram(STEP))], 0.0);
                let all = 1 + sequence as usize;
                assert_eq!(rig.wait("report", all), all);
            };
            go_on(&mut rig);
            for kind in ["short", "empty", "lying", "string"] {
                publish_wrong(python, kind, 20);
                assert!(program.runs(), "{kind}: {}", program.log());
                go_on(&mut rig);
            }
            let log = program.log();
            assert_eq!(answers(&rig.told("report")), [1, 2, 3, 4, 5].map(|k| (k, APPLIED)));
            assert_eq!(ways(&rig.told("wall_forces")).last(), Some(&(5.0 * STEP)));
            assert_eq!(log.matches("its bytes are no BoundaryCommand").count(), 60, "{log}");
            let told = "a peer has type std_msgs/msg/String for /graintwin/boundary_command";
            assert_eq!(log.matches(told).count(), 1, "{log}");
            let (ended, summary) = program.terminate();
            assert_eq!(summary["node"]["unreadable"], 60);
            assert_eq!(ended.code(), Some(3));
        },
    );
}

//! What a node was asked over the network, its recording gives again: on the spot and live.
#![cfg(feature = "mcap")]

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::{Value, json};

use crate::program::{ONE_GRAIN, Program, Rig, Sent, alone_with_scene, answers, path, ram};
use crate::script::perform;

const STEP: f64 = 1e-8;

fn graintwin(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    command.args(arguments).current_dir(folder).env_remove("RUST_LOG");
    command
}

/// Records what a rig does that makes every mistake and asks for everything; returns the reports
/// that it heard.
fn recorded(python: &Path, folder: &Path) -> Vec<Value> {
    let program = Program::start(folder, "recorded", &["--record", "bag"]);
    let mut rig = Rig::start(python, &["report"]);
    let mut heard = 1;
    let mut send = |rig: &mut Rig, commands: &[Sent<'_>]| {
        rig.send(commands, 0.0);
        heard += commands.len();
        assert_eq!(rig.wait("report", heard), heard);
    };
    send(&mut rig, &path("a", 5, STEP));
    // Once more, a gap, back, in no known mode, as an increment, too far.
    send(
        &mut rig,
        &[
            ("a", 5, 0, ram(5.0 * STEP)),
            ("a", 8, 0, ram(8.0 * STEP)),
            ("a", 7, 0, ram(7.0 * STEP)),
            ("a", 9, 7, ram(9.0 * STEP)),
            ("b", 1, 1, ram(STEP)),
            ("b", 2, 0, ram(1.0)),
        ],
    );
    let ask = |rig: &mut Rig, service: &str, fields: Value| {
        assert_eq!(rig.call(service, &fields)["success"], true, "{service}");
    };
    ask(&mut rig, "hold", json!({"data": true}));
    send(&mut rig, &[("b", 3, 0, ram(0.0))]);
    ask(&mut rig, "hold", json!({"data": false}));
    ask(&mut rig, "save_pack", json!({"path": "saved.csv"}));
    send(&mut rig, &[("b", 4, 0, ram(9.0 * STEP))]);
    ask(&mut rig, "reset", json!({}));
    ask(&mut rig, "reset_faults", json!({}));
    // The increment 0 of the reset has a report, too.
    heard += 1;
    rig.send(&path("a", 3, 2.0 * STEP), 0.0);
    assert_eq!(rig.wait("report", heard + 3), heard + 3);
    let reports = rig.told("report");
    assert!(program.terminate().0.code().is_some_and(|code| code == 3), "commands were refused");
    reports
}

#[test]
fn a_rig_that_asks_for_everything_is_answered_again_from_the_recording() {
    let scene = format!("{ONE_GRAIN}node: {{stale_after: 30.0, service_mapping: cyclone}}\n");
    alone_with_scene(
        a_rig_that_asks_for_everything_is_answered_again_from_the_recording,
        &scene,
        |python, folder| {
            let reports = recorded(python, folder);
            let said =
                graintwin(folder, &["replay", "bag", "--verify", "--json"]).output().unwrap();
            let error = String::from_utf8_lossy(&said.stderr);
            assert!(said.status.success(), "{error}");
            let verdict: Value = serde_json::from_slice(&said.stdout).unwrap();
            assert_eq!(verdict["compared"]["answers"], reports.len());

            // The pause before the first command is long enough for the peer to be found again.
            let mut live = graintwin(folder, &["replay", "bag", "--ros", "--rate", "1"]);
            let mut live = live.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
            let received = perform(
                python,
                &json!({
                    "listen": {"/graintwin/report": "Report", "/graintwin/wall_forces": "WallForces"},
                    "steps": [{"wait": "/graintwin/report", "count": reports.len()}],
                }),
            );
            assert!(live.wait().unwrap().success());
            let again = received["/graintwin/report"].as_array().unwrap();
            assert_eq!(answers(again), answers(&reports));
            for (again, report) in again.iter().zip(&reports) {
                assert_eq!(again, report);
            }
            let moved = received["/graintwin/wall_forces"].as_array().unwrap();
            let applied =
                answers(&reports).into_iter().filter(|(_, disposition)| *disposition == 0);
            // And the increment 0 of the start and of the reset.
            assert_eq!(moved.len(), 2 + applied.count());
        },
    );
}

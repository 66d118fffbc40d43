//! Joint states and trajectories of a rig that knows nothing of this package, over DDS.

use std::fs;
use std::path::Path;
use std::process;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::{Duration, Instant};

use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command};
use graintwin::node::{Node, Setup};
use graintwin::scene::{self, Outputs};
use graintwin::wall::WallTarget::{Displacement, Keep};
use serde_json::json;

use crate::network::{Loopback, alone};
use crate::python;

/// Joint states in one burst; fewer than the topic keeps.
const BURST: u64 = 200;

fn node(stop: &Arc<AtomicBool>) -> Node {
    let text = "pack: {file: none.csv}\nnode:\n  joint_states: {joints: {top: {wall: z_max, sign: \
                -1, zero: first}}}\n  joint_trajectory: {joints: {side: {wall: x_min}}}\n";
    let scene = scene::parse(text, Path::new("scene.yaml")).unwrap();
    Node::start(&scene.node, Setup::default(), &Outputs::default(), stop).unwrap()
}

/// What has come when the peer has gone, without waiting for any.
fn played(
    python: &Path,
    node: &mut Node,
    messages: &serde_json::Value,
    count: usize,
) -> Vec<Intake> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("messages.json");
    fs::write(&file, messages.to_string()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/joints.py");
    let status = process::Command::new(python).arg("-B").arg(script).arg(file).status().unwrap();
    assert!(status.success());
    let mut intakes = Vec::new();
    let start = Instant::now();
    // What was acknowledged can still be on its way from the middleware.
    while intakes.len() < count && start.elapsed() < Duration::from_secs(60) {
        match node.commands().next_waiting() {
            Some(intake) => intakes.push(intake),
            None => thread::sleep(Duration::from_millis(5)),
        }
    }
    intakes.extend(std::iter::from_fn(|| node.commands().next_waiting()));
    intakes
}

#[test]
fn joint_states_and_trajectories_of_a_cyclone_peer_become_commands_without_a_loss() {
    // Made outside, where there may be a network to get it from.
    let Some(python) = python::python() else { return };
    alone(
        joint_states_and_trajectories_of_a_cyclone_peer_become_commands_without_a_loss,
        Loopback::Multicast,
        || {
            let mut node = node(&Arc::default());
            let mut states: Vec<_> = (0..BURST)
                .map(|k| {
                    let position = format!("{:?}", 0.25 - 1e-7 * k as f64);
                    json!({"stamp": [k, 5], "name": ["other", "top"], "position": ["nan", position]})
                })
                .collect();
            states.push(json!({"stamp": [1, 0], "name": ["other"], "position": ["0"]}));
            let points = json!([[0, 500_000_000, ["1e-7"]], [2, 0, ["-2e-7"]]]);
            let trajectories = [
                json!({"stamp": [9, 0], "name": ["side"], "points": points}),
                json!({"stamp": [9, 0], "name": ["side"], "points": []}),
            ];
            let messages = json!({"states": states, "trajectories": trajectories});
            let count = BURST as usize + 4;
            let intakes = played(&python, &mut node, &messages, count);
            let summary = node.stop();
            println!("{summary:?}");
            assert_eq!(
                (intakes.len(), summary.commands, summary.unreadable),
                (count, count as u64, 0)
            );

            let (mut followed, mut went, mut wrong) = (0, Vec::new(), Vec::new());
            for intake in &intakes {
                match intake {
                    Intake::Command(command) if command.session == "joint_states" => {
                        let Command { stamp, sequence, ask: Ask::Targets(targets), .. } = command
                        else {
                            panic!("{command:?}");
                        };
                        assert_eq!(
                            (stamp.sec as u64, stamp.nanosec, *sequence),
                            (followed, 5, followed + 1)
                        );
                        let position = 0.25 - 1e-7 * followed as f64;
                        let expected = Displacement(-(position - 0.25));
                        assert_eq!(targets, &[Keep, Keep, Keep, Keep, Keep, expected]);
                        assert!(command.age.is_some_and(|age| age > 1e9));
                        followed += 1;
                    }
                    Intake::Command(command) => {
                        let Ask::Targets([target, ..]) = command.ask else { panic!("{command:?}") };
                        let Command { session, sequence, stamp, .. } = command;
                        went.push((session.as_str(), *sequence, stamp.sec, target));
                    }
                    Intake::Malformed(command, text) => {
                        wrong.push((command.session.as_str(), command.sequence, text.as_str()));
                    }
                    Intake::Request(asked) => panic!("{asked:?}"),
                }
            }
            assert_eq!(followed, BURST);
            let session = "joint_trajectory/1";
            let expected =
                [(session, 1, 9, Displacement(1e-7)), (session, 2, 11, Displacement(-2e-7))];
            assert_eq!(went, expected);
            assert_eq!(wrong.len(), 2);
            assert_eq!((wrong[0].0, wrong[0].1), ("joint_states", BURST + 1));
            assert!(wrong[0].2.contains("`top`"), "{wrong:?}");
            assert_eq!((wrong[1].0, wrong[1].1), ("joint_trajectory/2", 1));
        },
    );
}

//! What a node hears and says beside its answers, in its recording.
#![cfg(feature = "mcap")]

use std::fs;
use std::path::Path;
use std::process;
use std::thread;
use std::time::{Duration, Instant};

use graintwin::msg::rcl::Log;
use graintwin::msg::{DiagnosticArray, JointState, JointTrajectory, WallTargets, cdr};
use graintwin::record::reader::{Bag, Message};
use serde_json::json;

use crate::program::{ONE_GRAIN, Program, alone_with_scene};

const JOINTS: &str = "node:\n  joint_states: {joints: {top: {wall: z_max, sign: -1, zero: first}}}\n  \
                      joint_trajectory: {joints: {side: {wall: x_min}}}\n";

const STATES: usize = 40;

fn on<'a>(messages: &'a [Message], topic: &'a str) -> impl Iterator<Item = &'a Message> {
    messages.iter().filter(move |message| message.channel.topic == topic)
}

/// Waits until the recording in `folder` has `count` messages on `topic`.
fn wait_for(folder: &Path, topic: &str, count: usize) {
    let since = Instant::now();
    loop {
        let bag = Bag::open(folder).unwrap();
        let messages: Vec<_> = bag.messages().map_while(Result::ok).collect();
        let found = on(&messages, topic).count();
        if found >= count {
            return;
        }
        assert!(since.elapsed() < Duration::from_secs(60), "{found} of {count} on {topic}");
        thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn joints_are_recorded_as_they_came_and_the_log_and_the_diagnostics_too() {
    alone_with_scene(
        joints_are_recorded_as_they_came_and_the_log_and_the_diagnostics_too,
        &format!("{ONE_GRAIN}{JOINTS}"),
        |python, folder| {
            let program = Program::start(folder, "twin", &["--record", "run"]);
            let mut states: Vec<_> = (0..STATES)
                .map(|k| {
                    let position = format!("{:?}", 0.25 - 1e-9 * k as f64);
                    json!({"stamp": [k, 5], "name": ["top"], "position": [position]})
                })
                .collect();
            // No joint that moves a wall: refused, and told in the log.
            states.push(json!({"stamp": [99, 0], "name": ["other"], "position": ["0"]}));
            let points = json!([[1, 0, ["1e-9"]], [2, 0, ["2e-9"]]]);
            let trajectories = [json!({"stamp": [99, 0], "name": ["side"], "points": points})];
            let messages = json!({"states": states, "trajectories": trajectories});
            fs::write(folder.join("messages.json"), messages.to_string()).unwrap();
            let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/joints.py");
            let played = process::Command::new(python)
                .arg("-B")
                .arg(script)
                .arg(folder.join("messages.json"))
                .status()
                .unwrap();
            assert!(played.success());
            wait_for(&folder.join("run"), "/graintwin/report", STATES + 4);
            wait_for(&folder.join("run"), "/rosout", 1);
            let (ended, summary) = program.terminate();
            println!("{summary}");
            assert_eq!(ended.code(), Some(3), "a message was refused");

            let bag = Bag::open(&folder.join("run")).unwrap();
            let messages: Vec<_> = bag.messages().map(Result::unwrap).collect();
            let joints: Vec<JointState> = on(&messages, "/graintwin/joint_states")
                .map(|message| cdr::decode(&message.data).unwrap())
                .collect();
            assert_eq!(joints.len(), STATES + 1);
            for (k, joint) in joints[..STATES].iter().enumerate() {
                assert_eq!(joint.header.stamp.sec as usize, k);
                assert_eq!(joint.position, [0.25 - 1e-9 * k as f64]);
                assert_eq!(joint.velocity, [0.5], "what the twin does not use is there too");
            }
            let trajectory = on(&messages, "/graintwin/joint_trajectory").next().unwrap();
            let trajectory: JointTrajectory = cdr::decode(&trajectory.data).unwrap();
            assert_eq!(trajectory.points.len(), 2);
            // The commands that were made of them are there as well.
            for message in on(&messages, "/graintwin/wall_targets") {
                cdr::decode::<WallTargets>(&message.data).unwrap();
            }
            assert!(on(&messages, "/graintwin/wall_targets").count() >= STATES);
            let log: Vec<String> = on(&messages, "/rosout")
                .map(|message| cdr::decode::<Log>(&message.data).unwrap().msg)
                .collect();
            assert!(log.iter().any(|said| said.contains("INVALID")), "{log:#?}");
            let diagnostics = on(&messages, "/diagnostics").next().unwrap();
            let diagnostics: DiagnosticArray = cdr::decode(&diagnostics.data).unwrap();
            assert!(diagnostics.status.iter().any(|status| status.name == "graintwin: recorder"));
        },
    );
}

//! Commands from bags that another recorder wrote: the Python package rosbags.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::time::{Duration, Instant};

use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::msg::convert::CommandMessage;
use graintwin::msg::{PackState, WallForces, cdr};
use graintwin::record::reader::{Bag, ReadError, Source};
use graintwin::scene;
use graintwin::wall::WallTarget::{self, Displacement, Keep};
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::python;

fn command(sequence: u64) -> Command {
    Command {
        stamp: Stamp { sec: 5, nanosec: 7 },
        session: "rig".into(),
        sequence,
        mode: Mode::Absolute,
        ask: Ask::Displacement([0.1, 0.2, 0.3, 0.4, 0.5, sequence as f64 / 3.0]),
        age: None,
    }
}

fn text() -> String {
    let path = "msgs/graintwin_msgs/msg/BoundaryCommand.msg";
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap()
}

fn sent(topic: &str, command: &Command) -> Value {
    let CommandMessage::Boundary(message) = CommandMessage::from(command) else {
        panic!("only boundary commands are sent here");
    };
    json!({"topic": topic, "command": message})
}

/// Lets the peer write a bag and reads its commands; `None` without a peer.
fn read(definition: &str, messages: Vec<Value>) -> Option<Vec<Result<Command, ReadError>>> {
    let parent = tempfile::tempdir().unwrap();
    let (folder, text) = (parent.path().join("rig"), parent.path().join("BoundaryCommand.msg"));
    fs::write(&text, definition).unwrap();
    python::run("write_bag.py", &[&folder, &text], &Value::from(messages).to_string())?;
    Some(Bag::open(&folder).unwrap().commands().collect())
}

#[test]
fn commands_are_taken_from_any_topic_of_their_type() {
    let commands = [command(1), command(2), command(3)];
    let messages = commands.iter().map(|command| sent("/lab/press", command)).collect();
    // Comments are no part of a definition.
    let definition: String = text()
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| line.to_owned() + "\n")
        .collect();
    let Some(found) = read(&definition, messages) else { return };
    let found: Vec<_> = found.into_iter().map(Result::unwrap).collect();
    assert_eq!(found, commands);
}

#[test]
fn commands_on_two_topics_are_refused() {
    let messages = vec![sent("/rig/a", &command(1)), sent("/rig/b", &command(1))];
    let Some(found) = read(&text(), messages) else { return };
    let refusal = found.last().unwrap().as_ref().unwrap_err();
    let ReadError::TwoCommandTopics { topics, .. } = refusal else { panic!("{refusal}") };
    assert_eq!(topics, &["/rig/a", "/rig/b"]);
}

#[test]
fn commands_of_another_definition_are_refused() {
    let definition = text() + "\nfloat64 speed\n";
    let Some(found) = read(&definition, vec![sent("/rig/a", &command(1))]) else { return };
    let refusal = found.last().unwrap().as_ref().unwrap_err();
    assert!(matches!(refusal, ReadError::OtherDefinition { .. }), "{refusal}");
}

/// It is for the gate to refuse it and to report that.
#[test]
fn a_command_of_unknown_mode_is_handed_on() {
    let mut message = sent("/rig/a", &command(1));
    message["command"]["mode"] = 9.into();
    let Some(found) = read(&text(), vec![message]) else { return };
    assert_eq!(found[0].as_ref().unwrap().mode, Mode::Unknown(9));
}

/// What the scene says of the rig's joints.
const JOINTS: &str = "
  joint_states: {joints: {ram: {wall: z_max, sign: -1, zero: 0.5}}}
  joint_trajectory: {joints: {side: {wall: x_min}}}";

fn node(joints: &str) -> scene::Node {
    let text = format!("pack: {{file: none.csv}}\nnode:\n  late: every{joints}\n");
    scene::parse(&text, Path::new("scene.yaml")).unwrap().node
}

fn states(topic: &str, time: u64, ram: f64) -> Value {
    let states = json!({"names": ["motor", "ram"], "positions": [9.0, ram]});
    json!({"topic": topic, "time": time, "states": states})
}

/// Lets the peer write the bag of a rig; `None` without a peer.
fn rig(storage: &Value, messages: Vec<Value>) -> Option<(TempDir, PathBuf)> {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("rig");
    let mut asked = storage.clone();
    asked["messages"] = messages.into();
    python::run("write_rig.py", &[&folder], &asked.to_string())?;
    Some((parent, folder))
}

/// The intakes of a bag with their times, or why there are none.
fn intakes(
    folder: &Path,
    joints: &str,
    topic: Option<&str>,
) -> Result<Vec<(u64, Intake)>, ReadError> {
    let node = node(joints);
    Bag::open(folder)?.intakes(&Source::new(&node, topic))?.collect()
}

/// Time, sequence and what it asks of the upper wall and of the one at low x.
fn asked(intakes: &[(u64, Intake)]) -> Vec<(u64, u64, WallTarget, WallTarget)> {
    let asked = intakes.iter().map(|(time, intake)| {
        let Intake::Command(Command { sequence, ask: Ask::Targets(targets), .. }) = intake else {
            panic!("{intake:?}");
        };
        (*time, *sequence, targets[5], targets[0])
    });
    asked.collect()
}

#[test]
fn joints_become_commands_in_the_order_in_which_they_were_recorded() {
    for (compression, big) in [("NONE", true), ("STORAGE", false)] {
        let mut messages: Vec<_> = [(3, 0.25), (1, 0.5), (2, 0.375)]
            .map(|(time, ram)| states("/rig/joints", time, ram))
            .into();
        messages[1]["big"] = big.into();
        messages.push(json!({"topic": "/rig/talk", "time": 2, "text": "pressing"}));
        let Some((_parent, folder)) = rig(&json!({"compression": compression}), messages) else {
            return;
        };
        let found = intakes(&folder, JOINTS, None).unwrap();
        let expected = [(1, 1, 0.0), (2, 2, 0.125), (3, 3, 0.25)];
        assert_eq!(
            asked(&found),
            expected.map(|(time, n, way)| (time, n, Displacement(way), Keep))
        );
        let Intake::Command(command) = &found[2].1 else { panic!() };
        assert_eq!(command.stamp, Stamp { sec: 0, nanosec: 3 });
        assert_eq!((command.session.as_str(), command.age), ("joint_states", None));
    }
}

#[test]
fn a_trajectory_becomes_a_command_a_point() {
    let points = json!({"names": ["side"], "points": [[1, [1e-6]], [2, [2e-6]]]});
    let message = json!({"topic": "/plan", "time": 7, "trajectory": points});
    let Some((_parent, folder)) = rig(&json!({}), vec![message]) else { return };
    let found = intakes(&folder, JOINTS, None).unwrap();
    let expected = [(7, 1, Keep, Displacement(1e-6)), (7, 2, Keep, Displacement(2e-6))];
    assert_eq!(asked(&found), expected);
}

#[test]
fn a_mangled_message_is_handed_on_as_such_and_the_next_ones_too() {
    let raw = |time: u64, raw: &str| json!({"topic": "/joints", "time": time, "raw": raw});
    let other = json!({"names": ["motor"], "positions": [9.0]});
    let messages = vec![
        states("/joints", 1, 0.25),
        raw(2, "00010000ffffffff"),
        raw(3, ""),
        json!({"topic": "/joints", "time": 4, "states": other}),
        states("/joints", 5, 0.25),
    ];
    let Some((_parent, folder)) = rig(&json!({}), messages) else { return };
    let found = intakes(&folder, JOINTS, None).unwrap();
    assert_eq!(found.len(), 5);
    for (at, expected) in [(1, "cannot be read"), (2, "cannot be read"), (3, "joint `ram`")] {
        let Intake::Malformed(command, text) = &found[at].1 else { panic!("{found:?}") };
        assert!(text.contains(expected), "{text}");
        assert_eq!(command.sequence, at as u64 + 1);
        let Ask::Targets(targets) = command.ask else { panic!("{command:?}") };
        assert!(matches!(targets[5], Displacement(way) if way.is_nan()));
    }
    let Intake::Command(last) = &found[4].1 else { panic!("{found:?}") };
    assert_eq!(last.sequence, 5);
}

#[test]
fn of_several_topics_with_joints_one_is_to_be_named() {
    let messages = vec![states("/left", 1, 0.25), states("/right", 2, 0.5)];
    let Some((_parent, folder)) = rig(&json!({}), messages) else { return };
    let refusal = intakes(&folder, JOINTS, None).unwrap_err();
    assert!(
        refusal.to_string().contains("2 topics, /left, /right: one is to be named"),
        "{refusal}"
    );
    let found = intakes(&folder, JOINTS, Some("/right")).unwrap();
    assert_eq!(asked(&found), [(2, 1, Displacement(0.0), Keep)]);

    let refusal = intakes(&folder, JOINTS, Some("/middle")).unwrap_err().to_string();
    assert!(
        refusal
            .contains("no topic /middle; its topics: /left (sensor_msgs/msg/JointState), /right")
    );
    for topic in [None, Some("/left")] {
        let refusal = intakes(&folder, "", topic).unwrap_err().to_string();
        assert!(refusal.contains("node.joint_states is needed"), "{refusal}");
    }
}

#[test]
fn a_topic_that_moves_nothing_is_refused_with_what_would() {
    let talk = json!({"topic": "/rig/talk", "time": 2, "text": "pressing"});
    let Some((_parent, folder)) = rig(&json!({}), vec![talk]) else { return };
    let refusal = intakes(&folder, JOINTS, Some("/rig/talk")).unwrap_err().to_string();
    assert!(refusal.contains("is std_msgs/msg/String; allowed: graintwin_msgs/"), "{refusal}");
    let refusal = intakes(&folder, JOINTS, None).unwrap_err().to_string();
    assert!(refusal.contains("its topics: /rig/talk (std_msgs/msg/String)"), "{refusal}");
}

/// As when a twin that follows the rig has recorded both.
#[test]
fn commands_proper_come_before_joints_unless_these_are_named() {
    let Some((parent, folder)) = rig(&json!({}), vec![states("/joints", 1, 0.25)]) else { return };
    let text_file = parent.path().join("BoundaryCommand.msg");
    fs::write(&text_file, text()).unwrap();
    let commands = parent.path().join("commands");
    let sent = Value::from(vec![sent("/rig/a", &command(1))]).to_string();
    python::run("write_bag.py", &[&commands, &text_file], &sent).unwrap();
    fs::rename(commands.join("commands.mcap"), folder.join("rig_2.mcap")).unwrap();

    let found = intakes(&folder, JOINTS, None).unwrap();
    let [(1_000, Intake::Command(found))] = &found[..] else { panic!("{found:?}") };
    assert_eq!(*found, command(1));
    let found = intakes(&folder, JOINTS, Some("/joints")).unwrap();
    assert_eq!(asked(&found), [(1, 1, Displacement(0.25), Keep)]);
}

#[test]
fn other_storage_is_refused_with_the_way_to_convert_it() {
    let stored = [
        (json!({"storage": "sqlite3"}), "is a bag in SQLite"),
        (json!({"compression": "FILE"}), "is packed file by file"),
        (json!({"compression": "MESSAGE"}), "is packed message by message"),
    ];
    for (storage, expected) in stored {
        let Some((_parent, folder)) = rig(&storage, vec![states("/joints", 1, 0.25)]) else {
            return;
        };
        let refusal = Bag::open(&folder).unwrap_err().to_string();
        assert!(refusal.contains(expected), "{refusal}");
        assert!(refusal.contains("`ros2 bag convert -i BAG -o mcap.yaml`"), "{refusal}");
    }
}

/// Forces, displacements and state of every increment of a recording, without their stamps and
/// without the time they took.
fn answers(folder: &Path) -> Vec<String> {
    let mut answers = Vec::new();
    for message in Bag::open(folder).unwrap().messages() {
        let message = message.unwrap();
        match message.channel.topic.as_str() {
            "/graintwin/wall_forces" => {
                let mut forces: WallForces = cdr::decode(&message.data).unwrap();
                forces.header = Default::default();
                answers.push(serde_json::to_string(&forces).unwrap());
            }
            "/graintwin/state" => {
                let mut state: PackState = cdr::decode(&message.data).unwrap();
                (state.header, state.solve_seconds) = Default::default();
                answers.push(serde_json::to_string(&state).unwrap());
            }
            _ => {}
        }
    }
    answers
}

/// Two parts of a split bag, the second of them in the other byte order and unpacked, against the
/// same way of the wall in a table.
#[test]
fn a_run_of_a_rigs_recording_equals_that_of_the_same_path_to_the_bit() {
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::write(
        at("scene.yaml"),
        "pack: {generate: {grains: 60, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass, \
         confining_stress: 1.0e6}}\nnode:\n  \
         joint_states: {joints: {ram: {wall: z_max, gear: 1.0e-3}}}\n",
    )
    .unwrap();
    // Positions in mm, of which none is exact in m: both sides multiply.
    let ways: Vec<f64> = (1..=6).map(|step| 1.7e-5 * f64::from(step)).collect();
    let mut table = String::from("stamp,z_max\n");
    for (step, way) in ways.iter().enumerate() {
        table += &format!("{},{:?}\n", step + 1, 1.0e-3 * way);
    }
    fs::write(at("path.csv"), table).unwrap();
    let mut messages: Vec<_> = ways
        .iter()
        .enumerate()
        .map(|(step, way)| states("/press/joint_states", 1_000_000_000 * (step as u64 + 1), *way))
        .collect();
    messages[3..].iter_mut().for_each(|message| message["big"] = true.into());
    let second = messages.split_off(3);
    let Some((_first, folder)) = rig(&json!({"compression": "STORAGE"}), messages) else { return };
    let (_second, rest) = rig(&json!({}), second).unwrap();
    fs::rename(folder.join("rig.mcap"), folder.join("rig_0.mcap")).unwrap();
    fs::rename(rest.join("rig.mcap"), folder.join("rig_1.mcap")).unwrap();

    for (commands, out) in [(&folder, "of_rig"), (&at("path.csv"), "of_table")] {
        let ended = process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .args(["-q", "run"])
            .arg(at("scene.yaml"))
            .arg("--commands")
            .arg(commands)
            .arg("--record")
            .arg(at(out))
            .output()
            .unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    }
    let found = answers(&at("of_rig"));
    assert_eq!(found.len(), 2 * 7);
    assert_eq!(found, answers(&at("of_table")));

    // The six commands are a second apart: at ten times the pace they take half a second.
    let program = |arguments: &[&str]| {
        let ended = process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .current_dir(parent.path())
            .args(arguments)
            .output()
            .unwrap();
        assert!(ended.status.success(), "{}", String::from_utf8_lossy(&ended.stderr));
    };
    let bag = folder.to_str().unwrap();
    let start = Instant::now();
    program(&[
        "replay",
        bag,
        "--scene",
        "scene.yaml",
        "--topic",
        "/press/joint_states",
        "--rate",
        "10",
        "--record",
        "replayed",
    ]);
    assert!(start.elapsed() >= Duration::from_millis(500));
    assert_eq!(answers(&at("replayed")), found);
    // Without a name the only topic with joints is meant, and then nothing of the rig is needed.
    program(&["replay", bag, "--scene", "scene.yaml", "--record", "nameless"]);
    assert_eq!(answers(&at("nameless")), found);
    program(&["replay", "replayed", "--verify"]);
}

#[test]
fn a_topic_of_a_file_that_is_no_bag_is_refused() {
    let parent = tempfile::tempdir().unwrap();
    let at = |name: &str| parent.path().join(name);
    fs::write(at("scene.yaml"), "pack: {file: none.csv}\n").unwrap();
    fs::write(at("path.csv"), "stamp,z_max\n1,0\n").unwrap();
    let ended = process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .arg("run")
        .arg(at("scene.yaml"))
        .arg("--commands")
        .arg(at("path.csv"))
        .args(["--topic", "/joints"])
        .output()
        .unwrap();
    assert_eq!(ended.status.code(), Some(2));
    let stderr = String::from_utf8(ended.stderr).unwrap();
    assert!(stderr.contains("--topic names a topic of a bag"), "{stderr}");
}

//! Commands from bags that another recorder wrote: the Python package rosbags.
#![cfg(feature = "mcap")]
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/python.rs"]
mod python;

use std::fs;
use std::path::Path;

use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::msg::convert::CommandMessage;
use graintwin::record::reader::{Bag, ReadError};
use serde_json::{Value, json};

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

//! The CycloneDDS peer of `tests/peer`: a rig that knows the twin from DDS only.

use std::fs;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::Arc;

use graintwin::command::{Command, Stamp};
use graintwin::msg::{self, convert};
use graintwin::report::Measures;
use graintwin::sink::Served;
use graintwin::wall;
use serde_json::Value;

use crate::network::{Loopback, alone};
use crate::python;

/// Runs `body` alone with a Python that speaks CycloneDDS. The Python is made outside, where there
/// may be a network to get it from.
pub(crate) fn alone_with_peer<T: Fn()>(test: T, body: impl FnOnce(&Path)) {
    if let Some(python) = python::python() {
        alone(test, Loopback::Multicast, || body(&python));
    }
}

/// Starts the peer with `commands`, of which it keeps at most `in_flight` without a report. It
/// writes what it receives to a file in `folder`, see [`received`].
pub(crate) fn start(
    python: &Path,
    folder: &Path,
    commands: &[Command],
    in_flight: Option<usize>,
) -> process::Child {
    let sent = folder.join("sent.json");
    fs::write(&sent, commands_json(commands)).unwrap();
    script(python, "play.py")
        .args([sent, received(folder)])
        .args(in_flight.map(|count| format!("--in-flight={count}")))
        .spawn()
        .unwrap()
}

/// The file with a list of messages for every topic.
pub(crate) fn received(folder: &Path) -> PathBuf {
    folder.join("received.json")
}

/// Has everything that the peer received compared with everything that was served, except the
/// fields called `ignored`.
///
/// The numbers go from one program to the other in files that Python reads: `serde_json` rounds
/// when it reads.
pub(crate) fn compare(python: &Path, folder: &Path, served: &[Arc<Served>], ignored: &[&str]) {
    let expected = folder.join("expected.json");
    fs::write(&expected, expected_json(served)).unwrap();
    let status = script(python, "compare.py")
        .args([expected, received(folder)])
        .args(ignored.iter().map(|field| format!("--ignore={field}")))
        .status()
        .unwrap();
    assert!(status.success(), "the peer did not receive what was served");
}

fn script(python: &Path, name: &str) -> process::Command {
    let mut command = process::Command::new(python);
    command.arg("-B").arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer").join(name));
    command
}

/// The commands for the peer; floats as text, since JSON has no NaN.
fn commands_json(commands: &[Command]) -> String {
    let all: Vec<Value> = commands
        .iter()
        .map(|command| {
            let Stamp { sec, nanosec } = command.stamp;
            serde_json::json!({
                "header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": "pack"},
                "session": command.session,
                "sequence": command.sequence,
                "mode": u8::from(command.mode),
                "displacement": command.ask.numbers().map(|value| format!("{value:?}")),
            })
        })
        .collect();
    serde_json::to_string(&all).unwrap()
}

/// Every message that should have come out, topic by topic.
fn expected_json(served: &[Arc<Served>]) -> String {
    let measures: Vec<&Measures> =
        served.iter().filter_map(|one| one.report.measures.as_ref()).collect();
    let mut topics = serde_json::Map::new();
    let mut topic = |name: &str, messages: Value| {
        topics.insert(name.to_owned(), messages);
    };
    fn json<M: serde::Serialize>(messages: impl Iterator<Item = M>) -> Value {
        serde_json::to_value(messages.collect::<Vec<M>>()).unwrap()
    }
    let all = || measures.iter().copied();
    topic("report", json(served.iter().map(|one| msg::Report::from(&one.report))));
    topic("wall_forces", json(all().map(convert::wall_forces)));
    for (wall, name) in wall::NAMES.iter().enumerate() {
        let wrenches = all().map(|measures| convert::wall_wrench(measures, wall));
        topic(&format!("wall/{name}/wrench"), json(wrenches));
    }
    topic("wall_states", json(all().map(convert::wall_states)));
    topic("state", json(all().filter_map(convert::pack_state)));
    topic("moduli", json(all().filter_map(convert::moduli)));
    topic("tangent", json(all().filter_map(convert::tangent)));
    topic("contact_network", json(all().filter_map(convert::whole_network)));
    topic("grain_motion", json(all().filter_map(convert::whole_motion)));
    topic("fabric", json(all().filter_map(convert::fabric)));
    topic("hydrate", json(all().filter_map(convert::hydrate)));
    topic("shear_state", json(all().filter_map(convert::shear)));
    topic("plane_state", json(all().filter_map(convert::plane_state)));
    topic("bonds", json(all().filter_map(convert::whole_bonds)));
    topic("cracks", json(all().filter_map(convert::whole_cracks)));
    topic("events", json(all().flat_map(convert::events)));
    topic("rearrangements", json(all().flat_map(msg::rearrangement::whole)));
    serde_json::to_string(&topics).unwrap()
}

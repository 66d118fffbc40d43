//! The live server as a viewer of another make sees it, written after the protocol's specification.
#![cfg(all(feature = "foxglove", feature = "ros", feature = "mcap"))]
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may panic, and its capture keeps what it prints until then"
)]

#[path = "common/network.rs"]
mod network;
#[path = "common/program.rs"]
mod program;
#[path = "common/python.rs"]
mod python;
#[path = "common/viewer.rs"]
mod viewer;

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use graintwin::msg::topics;
use graintwin::pack::{Grain, Pack};
use graintwin::report::Demand;
use graintwin::scene;
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::view::foxglove::{ServeError, Server};
use graintwin::view::picture::Painter;
use graintwin::wall::Bounds;
use program::{ONE_GRAIN, Program, Rig, alone_with_scene, path};
use serde_json::{Value, json};
use viewer::Viewer;

const COMMANDS: u64 = 5;

const STEP: f64 = 1e-8;

const SCENE: &str = "
name: live
pack: {generate: {grains: 200, radius: {uniform: [0.07e-3, 0.13e-3]}, material: glass,
                  confining_stress: 5.0e6}}
";

/// Where the program listens by default.
const DEFAULT: &str = "127.0.0.1:8765";

const STATE: &str = "/graintwin/state";

const TOPICS: [&str; 8] = [
    "/tf_static",
    STATE,
    "/graintwin/wall_forces",
    "/graintwin/moduli",
    "/graintwin/fabric",
    "/graintwin/grains",
    "/graintwin/markers",
    "/graintwin/report",
];

/// What a viewer has seen of a run of [`COMMANDS`], whenever it came before the first of them.
fn check(seen: &Value) {
    assert_eq!(seen["name"], "graintwin");
    assert_eq!(seen["capabilities"], json!([]), "viewers can look only");
    let all: Vec<u64> = (0..=COMMANDS).collect();
    for topic in ["/graintwin/state", "/graintwin/wall_forces", "/graintwin/moduli"] {
        assert_eq!(seen["increments"][topic], json!(all), "{topic}");
    }
    assert_eq!(seen["counts"]["/tf_static"], 1);
    let frames: Vec<(String, String)> = serde_json::from_value(seen["frames"].clone()).unwrap();
    for child in ["pack", "pack_view"] {
        assert!(frames.contains(&("world".into(), child.into())), "{frames:?}");
    }
    assert_eq!(seen["closed"], true, "the server says when it goes");
}

#[test]
fn a_viewer_sees_the_messages_that_are_recorded_bit_by_bit_and_a_late_one_the_last_of_them() {
    alone_with_scene(
        a_viewer_sees_the_messages_that_are_recorded_bit_by_bit_and_a_late_one_the_last_of_them,
        SCENE,
        |python, folder| {
            let program = Program::start(folder, "run", &["--record", "bag", "--foxglove"]);
            let mut viewer = Viewer::start(python, DEFAULT, COMMANDS, &TOPICS);
            assert_eq!(viewer.line(), "waits");
            assert_eq!(viewer.line(), "looks", "{}", program.log());
            let mut rig = Rig::start(python, &["report"]);
            rig.send(&path("look", COMMANDS, STEP), 0.0);
            assert_eq!(viewer.line(), "seen", "{}", program.log());
            viewer.tell(folder.join("bag").to_str().unwrap());
            assert_eq!(viewer.line(), "done", "{}", program.log());
            let (ended, summary) = program.terminate();
            assert!(ended.success(), "{summary}");
            viewer.tell("");
            let seen = viewer.end();
            check(&seen);
            assert_eq!(seen["late"], true);
            assert!(seen["strain"][2].as_f64().unwrap() > 0.0, "{seen}");
            // As many as the encoder kept up with; the first may have come before the viewer.
            let pictures = seen["counts"]["/graintwin/markers"].as_u64().unwrap();
            assert!((1..=COMMANDS + 1).contains(&pictures), "{seen}");
        },
    );
}

#[test]
fn a_replay_is_shown_at_the_pace_of_the_recording() {
    alone_with_scene(
        a_replay_is_shown_at_the_pace_of_the_recording,
        ONE_GRAIN,
        |python, folder| {
            let program = Program::start(folder, "run", &["--record", "bag"]);
            let mut rig = Rig::start(python, &["report"]);
            // In the replay, the viewer comes in this pause.
            thread::sleep(Duration::from_secs(2));
            rig.send(&path("look", COMMANDS, STEP), 0.0);
            assert_eq!(rig.wait("report", 1 + COMMANDS as usize), 1 + COMMANDS as usize);
            assert!(program.terminate().0.success());

            let mut viewer = Viewer::start(python, DEFAULT, COMMANDS, &TOPICS);
            assert_eq!(viewer.line(), "waits");
            let mut replay = graintwin(folder, &["replay", "bag", "--foxglove"]);
            let mut replay = replay.stdout(Stdio::null()).spawn().unwrap();
            assert_eq!(viewer.line(), "looks");
            assert_eq!(viewer.line(), "seen");
            viewer.tell("");
            check(&viewer.end());
            assert!(replay.wait().unwrap().success());
        },
    );
}

#[test]
fn a_port_in_use_and_what_is_no_address_end_the_program_with_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.yaml"), SCENE).unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = taken.local_addr().unwrap().to_string();
    for (given, sentence) in [
        (address.as_str(), format!("cannot serve Foxglove at {address}: the port is in use")),
        ("nowhere", "allowed: IP:PORT".into()),
    ] {
        let said = graintwin(folder.path(), &["run", "scene.yaml", "--foxglove", given]).output();
        let said = said.unwrap();
        assert_eq!(said.status.code(), Some(2), "{given}");
        let error = String::from_utf8(said.stderr).unwrap();
        assert!(error.contains(&sentence), "{error}");
    }
    assert!(matches!(Server::start(taken.local_addr().unwrap()), Err(ServeError::InUse(_))));
}

#[test]
fn networks_and_grains_are_asked_for_while_somebody_looks_at_markers() {
    let Some(python) = python::python() else { return };
    let mut server = Server::start("127.0.0.1:0".parse().unwrap()).unwrap();
    let scene = scene::parse(ONE_GRAIN, Path::new("scene.yaml")).unwrap();
    let bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };
    let sink = server.sink(Painter::new(&scene, &bounds, 1)).unwrap();
    let small = Demand { state: true, moduli: true, tangent: true, ..Demand::default() };
    assert_eq!(sink.demand(), small);
    let address = server.address().to_string();
    let viewer = Viewer::start(&python, &address, 1, &["/graintwin/markers", "/graintwin/report"]);
    let becomes = |demand: Demand| {
        let until = Instant::now() + Duration::from_secs(60);
        while sink.demand() != demand {
            assert!(Instant::now() < until, "{:?}", sink.demand());
            thread::sleep(Duration::from_millis(5));
        }
    };
    becomes(Demand { contact_network: true, grains: true, bonds: true, ..small });
    drop(viewer);
    becomes(small);
    assert_eq!(server.stop().clients, 1);
}

#[test]
fn a_viewer_that_reads_nothing_holds_up_neither_the_twin_nor_the_end() {
    let scene = scene::parse(ONE_GRAIN, Path::new("scene.yaml")).unwrap();
    let bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };
    let (young, poisson, density, friction) = (70e9, 0.2, 2.5e3, 0.0);
    let grain = Grain {
        position: [0.0; 3],
        radius: 1.00001e-3,
        young,
        poisson,
        density,
        friction,
        hydrate: false,
    };
    let pack = Pack { bounds, grains: vec![grain], history: None };
    let report = Twin::new(&scene, &pack, 1).unwrap().start(Demand::ALL);
    let served = Arc::new(Served { command: None, report });

    let mut server = Server::start("127.0.0.1:0".parse().unwrap()).unwrap();
    let mut sink = server.sink(Painter::new(&scene, &bounds, 1)).unwrap();
    let stalled = subscribe_and_stall(&server.address().to_string());
    let until = Instant::now() + Duration::from_secs(60);
    while sink.demand() != Demand::ALL {
        assert!(Instant::now() < until, "{:?}", sink.demand());
        thread::sleep(Duration::from_millis(5));
    }
    // Far more than the sockets between them hold.
    for _ in 0..10_000 {
        sink.served(&served);
    }
    assert_eq!(server.stop().clients, 1);
    drop(stalled);
}

/// Subscribes to everything by hand, and reads no more.
fn subscribe_and_stall(address: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).unwrap();
    let hello = format!(
        "GET / HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\
         Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n"
    );
    stream.write_all(hello.as_bytes()).unwrap();
    let topics = 3 + topics::measures().count();
    let mut said = Vec::new();
    let mut buffer = [0; 4096];
    let ids: Vec<u64> = loop {
        let count = stream.read(&mut buffer).unwrap();
        assert!(count > 0, "{}", String::from_utf8_lossy(&said));
        said.extend_from_slice(&buffer[..count]);
        let text = String::from_utf8_lossy(&said);
        let channels = text.split("{\"id\":").skip(1);
        let ids: Vec<_> = channels
            .filter_map(|channel| channel.split_once(",\"topic\":")?.0.parse().ok())
            .collect();
        if ids.len() == topics {
            break ids;
        }
    };
    let wanted: Vec<Value> =
        ids.iter().enumerate().map(|(k, id)| json!({"id": k, "channelId": id})).collect();
    let text = json!({"op": "subscribe", "subscriptions": wanted}).to_string();
    // A text frame, masked with zeros.
    let mut frame = vec![0x81, 0x80 | 126];
    frame.extend(u16::try_from(text.len()).unwrap().to_be_bytes());
    frame.extend([0; 4]);
    frame.extend(text.as_bytes());
    stream.write_all(&frame).unwrap();
    stream
}

fn graintwin(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    command.current_dir(folder).args(arguments).args(["--threads", "1"]);
    command
}

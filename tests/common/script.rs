//! A CycloneDDS peer that does what a test tells it: `tests/peer/act.py`.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use std::fs;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

use crate::network::{Loopback, alone};
use crate::python;

/// Runs `body` alone with a Python that speaks CycloneDDS.
pub(crate) fn alone_with_peer<T: Fn()>(test: T, body: impl FnOnce(&Path)) {
    if let Some(python) = python::python() {
        alone(test, Loopback::Multicast, || body(&python));
    }
}

/// Has `script` performed; returns what the peer received, a list for every topic.
pub(crate) fn perform(python: &Path, script: &Value) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let (told, received) = (folder.path().join("script.json"), folder.path().join("received.json"));
    fs::write(&told, script.to_string()).unwrap();
    let peer = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/act.py");
    let status = Command::new(python).arg("-B").args([&peer, &told, &received]).status().unwrap();
    assert!(status.success(), "the peer could not do what it was told");
    serde_json::from_slice(&fs::read(received).unwrap()).unwrap()
}

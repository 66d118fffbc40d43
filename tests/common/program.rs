//! The program as a node, and rigs that tell a test what they hear of it.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};

use serde_json::{Value, json};

use crate::network::{Loopback, alone};
use crate::python;

/// A grain between six walls that it touches: the fastest twin with forces.
pub(crate) const ONE_GRAIN: &str = "
pack: {file: grain.csv, box: {min: [-1.0e-3, -1.0e-3, -1.0e-3], max: [1.0e-3, 1.0e-3, 1.0e-3]}}
";

/// Runs `body` alone with a Python that speaks `CycloneDDS` and a folder with `scene.yaml`.
pub(crate) fn alone_with_scene<T: Fn()>(test: T, scene: &str, body: impl FnOnce(&Path, &Path)) {
    let Some(python) = python::python() else { return };
    alone(test, Loopback::Multicast, || {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("scene.yaml"), scene).unwrap();
        fs::write(
            folder.path().join("grain.csv"),
            "x,y,z,radius,young,poisson,density,friction\n0,0,0,1.00001e-3,70e9,0.2,2500,0\n",
        )
        .unwrap();
        body(&python, folder.path());
    });
}

/// Displacements with the upper wall at `way` \[m\].
pub(crate) fn ram(way: f64) -> [f64; 6] {
    [0.0, 0.0, 0.0, 0.0, 0.0, way]
}

/// Absolute commands of `session` that take the upper wall `step` \[m\] further each.
pub(crate) fn path(session: &str, count: u64, step: f64) -> Vec<Sent<'_>> {
    (1..=count).map(|sequence| (session, sequence, 0, ram(sequence as f64 * step))).collect()
}

/// Where the upper wall was in each message of `~/wall_forces`.
pub(crate) fn ways(forces: &[Value]) -> Vec<f64> {
    forces.iter().map(|forces| forces["displacement"][5].as_f64().unwrap()).collect()
}

/// Sequence and disposition of each report but that of the start.
pub(crate) fn answers(reports: &[Value]) -> Vec<(u64, u64)> {
    let number = |report: &Value, key: &str| report[key].as_u64().unwrap();
    reports
        .iter()
        .filter(|report| number(report, "sequence") > 0)
        .map(|report| (number(report, "sequence"), number(report, "disposition")))
        .collect()
}

/// The program serving `scene.yaml` of a folder, killed when a test gives up.
pub(crate) struct Program {
    child: Child,
    log: std::path::PathBuf,
    summary: std::path::PathBuf,
}

impl Program {
    /// Starts it in `folder`, its log and its summary in files there, which are called `name`.
    pub(crate) fn start(folder: &Path, name: &str, arguments: &[&str]) -> Self {
        let (log, summary) =
            (folder.join(format!("{name}.log")), folder.join(format!("{name}.json")));
        let child = Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .current_dir(folder)
            .args(["run", "scene.yaml", "--ros", "--json", "--threads", "1"])
            .args(arguments)
            .stdout(File::create(&summary).unwrap())
            .stderr(File::create(&log).unwrap())
            .spawn()
            .unwrap();
        Self { child, log, summary }
    }

    /// Its memory by name, as VmRSS \[KiB\].
    pub(crate) fn memory(&self, name: &str) -> u64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(':'));
        line.unwrap().trim().trim_end_matches(" kB").parse().unwrap()
    }

    /// What it has said on stderr.
    pub(crate) fn log(&self) -> String {
        fs::read_to_string(&self.log).unwrap()
    }

    /// Whether it still runs.
    pub(crate) fn runs(&mut self) -> bool {
        self.child.try_wait().unwrap().is_none()
    }

    /// SIGKILL.
    pub(crate) fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// SIGTERM; returns how it ended and its summary.
    pub(crate) fn terminate(mut self) -> (ExitStatus, Value) {
        signal(&self.child, "TERM");
        let ended = self.child.wait().unwrap();
        let summary = fs::read(&self.summary).unwrap();
        (ended, serde_json::from_slice(&summary).unwrap())
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

fn signal(child: &Child, name: &str) {
    let pid = child.id().to_string();
    assert!(Command::new("kill").args([&format!("-{name}"), &pid]).status().unwrap().success());
}

/// One command of a rig: session, sequence, mode (0 absolute, 1 increment), displacement \[m\].
pub(crate) type Sent<'a> = (&'a str, u64, u8, [f64; 6]);

/// `tests/peer/rig.py`, killed when a test gives up.
pub(crate) struct Rig {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Rig {
    /// A rig that has found the node and listens to `topics`.
    pub(crate) fn start(python: &Path, topics: &[&str]) -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/peer/rig.py");
        let mut child = Command::new(python)
            .arg("-B")
            .arg(script)
            .args(topics)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let to = child.stdin.take().unwrap();
        let from = BufReader::new(child.stdout.take().unwrap());
        let mut rig = Self { child, to, from };
        assert_eq!(rig.heard(), json!({}), "it finds the node");
        rig
    }

    fn tell(&mut self, what: &Value) {
        writeln!(self.to, "{what}").unwrap();
        self.to.flush().unwrap();
    }

    fn heard(&mut self) -> Value {
        let mut line = String::new();
        self.from.read_line(&mut line).unwrap();
        serde_json::from_str(&line).expect("the rig goes on")
    }

    fn ask(&mut self, what: &Value) -> Value {
        self.tell(what);
        self.heard()
    }

    /// Publishes `commands`, one in `period` seconds or as fast as it can.
    pub(crate) fn send(&mut self, commands: &[Sent<'_>], period: f64) {
        self.begin(commands, period);
        self.sent();
    }

    /// Begins to publish `commands`; [`Rig::sent`] waits until that is done.
    pub(crate) fn begin(&mut self, commands: &[Sent<'_>], period: f64) {
        self.tell(&json!({"send": commands, "period": period}));
    }

    /// Waits until everything that was begun is sent.
    pub(crate) fn sent(&mut self) {
        self.heard();
    }

    /// Waits until `count` messages in all have come on `topic`, a minute at most; returns how many.
    pub(crate) fn wait(&mut self, topic: &str, count: usize) -> usize {
        let come = self.ask(&json!({"wait": topic, "count": count}));
        come["come"].as_u64().unwrap() as usize
    }

    /// What came on `topic` since the last time.
    pub(crate) fn told(&mut self, topic: &str) -> Vec<Value> {
        match self.ask(&json!({"told": topic}))["messages"].take() {
            Value::Array(messages) => messages,
            other => panic!("{other}"),
        }
    }

    /// The answer of a service.
    pub(crate) fn call(&mut self, service: &str, fields: &Value) -> Value {
        self.ask(&json!({"call": service, "fields": fields}))["answer"].take()
    }

    /// SIGSTOP: it reads nothing and says nothing from now on.
    pub(crate) fn stop(&self) {
        signal(&self.child, "STOP");
    }

    /// SIGCONT.
    pub(crate) fn go_on(&self) {
        signal(&self.child, "CONT");
    }

    /// SIGKILL.
    pub(crate) fn kill(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

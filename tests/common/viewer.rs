//! A viewer of the Foxglove WebSocket protocol in a process of its own: `tests/python/live.py`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

use serde_json::Value;

/// The process, killed when a test gives up.
pub(crate) struct Viewer {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
}

impl Viewer {
    /// Looks at `topics` of whoever listens at `address`, until command `last` is served.
    pub(crate) fn start(python: &Path, address: &str, last: u64, topics: &[&str]) -> Self {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/live.py");
        let mut child = Command::new(python)
            .arg("-B")
            .arg(script)
            .args([address, &last.to_string()])
            .args(topics)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the interpreter runs");
        let to = child.stdin.take().expect("a pipe");
        let from = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { child, to, from }
    }

    /// The next line that it prints; empty when it has ended.
    pub(crate) fn line(&mut self) -> String {
        let mut line = String::new();
        self.from.read_line(&mut line).expect("a pipe");
        line.trim_end().into()
    }

    /// Sends it a line.
    pub(crate) fn tell(&mut self, line: &str) {
        writeln!(self.to, "{line}").expect("the viewer listens");
        self.to.flush().expect("the viewer listens");
    }

    /// What it has seen.
    pub(crate) fn end(mut self) -> Value {
        let line = self.line();
        assert!(self.child.wait().expect("it ran").success(), "the viewer found something wrong");
        serde_json::from_str(&line).expect("JSON")
    }
}

impl Drop for Viewer {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

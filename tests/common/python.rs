//! A Python with the peers that the tests talk to, set up once under the target folder.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The peers; exact versions, so that a new release cannot break an old test.
const PACKAGES: [&str; 10] = [
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "rosbags==0.11.9",
    "websockets==17.4",
    "cyclonedds==11.0.1",
    "catkin_pkg==1.1.1",
    "colcon-ros==0.5.0",
    "colcon-package-information==0.4.1",
    "colcon-recursive-crawl==0.2.3",
    "colcon-cargo==0.2.0",
];

/// Set to 1 to go without the tests that need Python.
const SKIP: &str = "GRAINTWIN_SKIP_PYTHON";

/// The interpreter of the tests' own environment; `None` when the tests are to go without.
///
/// # Panics
/// When there is no Python 3 or the packages cannot be installed.
#[allow(clippy::print_stdout, reason = "what is left out must be seen")]
pub(crate) fn python() -> Option<PathBuf> {
    if std::env::var_os(SKIP).is_some_and(|value| value == "1") {
        println!("skipped: {SKIP}=1");
        return None;
    }
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("a folder in target");
    let home = target.join("python");
    fs::create_dir_all(&home).expect("the target folder can be written");
    // Test binaries run at the same time.
    let lock = File::create(home.join("lock")).expect("the target folder can be written");
    lock.lock().expect("a file can be locked");
    // The environment has a folder of its own: making it anew empties that.
    let environment = home.join("environment");
    let interpreter = environment.join("bin").join("python");
    let done = home.join("installed");
    let wanted = PACKAGES.join("\n");
    if fs::read_to_string(&done).is_ok_and(|installed| installed == wanted) {
        return Some(interpreter);
    }
    // Package sources below are none of a ROS 2 workspace's.
    fs::write(home.join("COLCON_IGNORE"), "").expect("the target folder can be written");
    must(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment));
    must(Command::new(&interpreter).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES));
    fs::write(&done, wanted).expect("the target folder can be written");
    Some(interpreter)
}

/// Runs `tests/python/SCRIPT` with `input` and returns what it printed; `None` when the tests are
/// to go without Python.
///
/// # Panics
/// When the script fails: with what it said.
#[allow(dead_code, reason = "some tests want the interpreter only")]
pub(crate) fn run(script: &str, arguments: &[&Path], input: &str) -> Option<String> {
    let interpreter = python()?;
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python").join(script);
    let mut child = Command::new(interpreter)
        .arg("-B")
        .arg(&script)
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the interpreter runs");
    let mut to = child.stdin.take().expect("a pipe");
    // The scripts read all before they write.
    to.write_all(input.as_bytes()).expect("the script reads its input");
    drop(to);
    let output = child.wait_with_output().expect("the interpreter runs");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{} says:\n{said}", script.display());
    Some(String::from_utf8(output.stdout).expect("UTF-8"))
}

fn must(command: &mut Command) {
    let status = command.status();
    assert!(
        status.as_ref().is_ok_and(std::process::ExitStatus::success),
        "{command:?}: {status:?}\nThe tests talk to Python packages ({}): they need \
         python3 with venv, and a package index. {SKIP}=1 leaves those tests out.",
        PACKAGES.join(", ")
    );
}

//! Recordings that cannot be written, seen at the boundary of the program's process.
#![cfg(unix)]

use std::fs::{self, File};
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use graintwin::record::reader::Bag;
use graintwin::record::recover::{Account, recover};
use serde_json::Value;

use crate::bead::{arguments, parts, run_and_record, write_bead};

/// How long a test waits for the program before it gives up.
const PATIENCE: Duration = Duration::from_secs(100);

/// A run that takes seconds: long enough to do something to it.
const LONG: u64 = 30_000;

/// How a run ended: exit code, summary, stderr.
struct Ended {
    code: i32,
    summary: Value,
    said: String,
}

impl Ended {
    fn increments(&self) -> u64 {
        self.summary["increments"].as_u64().unwrap()
    }
}

fn start(mut command: Command, folder: &Path) -> Child {
    command
        .stdin(Stdio::null())
        .stdout(File::create(folder.join("summary.json")).unwrap())
        .stderr(File::create(folder.join("said")).unwrap())
        .spawn()
        .unwrap()
}

fn end(mut child: Child, folder: &Path) -> Ended {
    let since = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if since.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("the program does not end");
        }
        sleep(Duration::from_millis(5));
    }
    let summary = fs::read(folder.join("summary.json")).unwrap();
    Ended {
        code: child.wait().unwrap().code().unwrap(),
        summary: serde_json::from_slice(&summary).unwrap(),
        said: fs::read_to_string(folder.join("said")).unwrap(),
    }
}

fn wait_for(mut condition: impl FnMut() -> bool) {
    let since = Instant::now();
    while !condition() {
        assert!(since.elapsed() < PATIENCE, "nothing happened for {PATIENCE:?}");
        sleep(Duration::from_millis(2));
    }
}

/// Runs with files of at most 2 MiB, which stands for a disk that is full: the same calls fail.
fn run_on_a_full_disk(on_failure: &str) -> (tempfile::TempDir, Ended) {
    let folder = tempfile::tempdir().unwrap();
    let record = format!("{{chunk: 1 MiB, compression: none, on_failure: {on_failure}}}");
    write_bead(folder.path(), &record, LONG);
    let mut command = Command::new("sh");
    command
        .current_dir(folder.path())
        .env_remove("RUST_LOG")
        .args(["-c", "trap '' XFSZ; ulimit -f 4096; exec \"$@\"", "sh"])
        .arg(env!("CARGO_BIN_EXE_graintwin"))
        .args(arguments());
    let ended = end(start(command, folder.path()), folder.path());
    (folder, ended)
}

#[test]
fn on_a_full_disk_the_run_goes_on_without_recording_and_ends_with_3() {
    let (folder, ended) = run_on_a_full_disk("continue");
    assert_eq!((ended.code, ended.increments()), (3, LONG), "{}", ended.said);
    assert!(ended.said.contains("File too large"), "{}", ended.said);
    assert!(ended.said.contains("the run goes on without recording"), "{}", ended.said);
    assert!(ended.summary["lost"][0].as_str().unwrap().contains("run_0.mcap failed"));
    what_was_written_is_readable(folder.path());
}

#[test]
fn on_a_full_disk_the_run_ends_with_3_when_the_scene_says_so() {
    let (folder, ended) = run_on_a_full_disk("stop");
    assert_eq!(ended.code, 3, "{}", ended.said);
    assert!(ended.increments() < LONG, "{}", ended.increments());
    assert!(ended.said.contains("the run ends after this increment"), "{}", ended.said);
    assert_eq!(ended.summary["end"]["increment"], ended.increments(), "there is a summary");
    what_was_written_is_readable(folder.path());
}

/// And `recover` makes it whole.
fn what_was_written_is_readable(folder: &Path) {
    let run = folder.join("run");
    let account = Account::of(&Bag::open(&run).unwrap()).unwrap();
    assert!(account.own && account.is_damaged());
    assert!(account.answers.last.as_ref().unwrap().2 > 100);
    let whole = folder.join("whole");
    let recovered = recover(&run, &whole).unwrap();
    assert_eq!(recovered.kept, account.kept);
    assert!(Account::of(&Bag::open(&whole).unwrap()).unwrap().is_whole());
}

#[test]
fn a_folder_that_vanishes_is_said_at_once_and_the_run_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    write_bead(folder.path(), "{chunk: 1 MiB, compression: none}", LONG);
    let child = start(run_and_record(folder.path()), folder.path());
    let run = folder.path().join("run");
    let written =
        || parts(&run).iter().any(|file| fs::metadata(file).is_ok_and(|f| f.len() > 1 << 20));
    wait_for(written);
    fs::remove_dir_all(&run).unwrap();
    let said = || fs::read_to_string(folder.path().join("said")).unwrap();
    wait_for(|| said().contains("the run goes on without recording"));
    let ended = end(child, folder.path());
    assert_eq!((ended.code, ended.increments()), (3, LONG), "{}", ended.said);
    assert!(ended.said.contains("run_0.mcap failed: it is no longer there"), "{}", ended.said);
}

/// Runs until there is a file, then does `spoil`, which must keep the program from making a further
/// one.
fn run_that_cannot_split(
    on_failure: &str,
    command: fn(&Path) -> Command,
    spoil: fn(&Path),
) -> Ended {
    let folder = tempfile::tempdir().unwrap();
    let record = format!(
        "{{chunk: 1 MiB, compression: none, split: {{size: 2 MiB}}, on_failure: {on_failure}}}"
    );
    write_bead(folder.path(), &record, LONG);
    let child = start(command(folder.path()), folder.path());
    let run = folder.path().join("run");
    wait_for(|| !parts(&run).is_empty());
    spoil(&run);
    let ended = end(child, folder.path());
    let bag = Bag::open(&run).unwrap();
    let account = Account::of(&bag).unwrap();
    assert!(account.answers.last.as_ref().unwrap().2 > 100);
    fs::set_permissions(&run, fs::Permissions::from_mode(0o755)).unwrap();
    let whole = recover(&run, &folder.path().join("whole")).unwrap();
    assert_eq!(whole.kept, account.kept);
    ended
}

#[test]
fn a_folder_that_takes_no_further_file_ends_the_recording_between_two_answers() {
    /// The program as somebody to whom permissions matter: root is given none but its own.
    fn command(folder: &Path) -> Command {
        let mut command = Command::new("sh");
        let shell = "if [ \"$(id -u)\" = 0 ]; then \
                     exec setpriv --bounding-set -dac_override \"$@\"; else exec \"$@\"; fi";
        command
            .current_dir(folder)
            .env_remove("RUST_LOG")
            .args(["-c", shell, "sh"])
            .arg(env!("CARGO_BIN_EXE_graintwin"))
            .args(arguments());
        command
    }
    let ended = run_that_cannot_split("continue", command, |run| {
        fs::set_permissions(run, fs::Permissions::from_mode(0o555)).unwrap();
    });
    assert_eq!((ended.code, ended.increments()), (3, LONG), "{}", ended.said);
    assert!(ended.said.contains("mcap failed: Permission denied"), "{}", ended.said);
}

#[test]
fn a_file_in_the_way_of_the_next_one_ends_the_run_when_the_scene_says_so() {
    let ended = run_that_cannot_split("stop", run_and_record, |run| {
        // Whichever comes next.
        for number in 1..60 {
            File::create_new(run.join(format!("run_{number}.mcap"))).ok();
        }
    });
    assert_eq!(ended.code, 3, "{}", ended.said);
    assert!(ended.increments() < LONG);
    assert!(ended.said.contains("mcap failed: File exists"), "{}", ended.said);
    assert!(ended.said.contains("the run ends after this increment"), "{}", ended.said);
}

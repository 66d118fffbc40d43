//! Recording programs that are killed at random moments: nothing that was whole is lost.
#![cfg(unix)]
#![allow(clippy::print_stdout, reason = "what was killed must be seen when the test fails")]

use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use graintwin::record::reader::Bag;
use graintwin::record::recover::{Account, in_place, recover};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::bead::{parts, run_and_record, write_bead};
use crate::python;

const KILLS: usize = 56;

/// Every so many kills, the readers of others are asked too: starting them takes long.
const PEERS: usize = 14;

/// Every so many kills, the recording is gone on with to its end.
const RESUMES: usize = 4;

/// Commands of a run that nobody kills.
const COMMANDS: u64 = 10_000;

/// Small chunks; every other recording is split.
const RECORD: [&str; 2] = [
    "{chunk: 1 MiB, compression: none}",
    "{chunk: 1 MiB, compression: none, split: {size: 1 MiB}}",
];

/// When a program is killed.
#[derive(Clone, Copy, Debug)]
enum Moment {
    /// So long after its start.
    After(Duration),
    /// So long after it began its file with this number.
    AfterFile(usize, Duration),
}

/// Starts a recording in `folder` and kills it.
fn kill(folder: &Path, moment: Moment) {
    let mut child = run_and_record(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let run = folder.join("run");
    let pause = match moment {
        Moment::After(pause) => pause,
        Moment::AfterFile(number, pause) => {
            let since = Instant::now();
            let file = run.join(format!("run_{number}.mcap"));
            while !file.exists() && since.elapsed() < Duration::from_secs(60) {
                sleep(Duration::from_micros(100));
            }
            pause
        }
    };
    sleep(pause);
    child.kill().unwrap();
    assert!(!child.wait().unwrap().success(), "it was over before it was killed: {moment:?}");
}

/// What `graintwin check` says, and its exit code.
fn check(bag: &Path) -> (i32, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_graintwin")).arg("check").arg(bag).output().unwrap();
    (output.status.code().unwrap(), String::from_utf8(output.stdout).unwrap())
}

fn account(bag: &Path) -> Account {
    Account::of(&Bag::open(bag).unwrap()).unwrap()
}

/// The last increment whose answer is whole; none when there is no answer.
fn increment(account: &Account) -> Option<u64> {
    account.answers.last.as_ref().map(|(_, _, increment)| *increment)
}

/// Runs the program in `folder`; it must end well.
fn graintwin(folder: &Path, arguments: &[&str]) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    let output = command.args(arguments).current_dir(folder).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {said}");
}

/// The digest of the state at the end of a recording that ended in order.
fn state(bag: &Path) -> String {
    let end = Bag::open(bag).unwrap().survey().unwrap().metadata;
    end["graintwin_end"]["state"].clone()
}

/// Who looks at what a kill left.
#[derive(Clone, Copy, Debug, Default)]
struct Looks {
    /// The readers of others.
    peers: bool,
    /// Whoever goes on with it.
    resumes: bool,
}

/// Kills a recording and looks at what is left; says whether a file was cut off in the middle of the
/// recording. A run that is gone on with must end in the state `undisturbed`.
fn kill_and_recover(folder: &Path, moment: Moment, looks: Looks, undisturbed: &str) -> bool {
    kill(folder, moment);
    let run = folder.join("run");
    if parts(&run).is_empty() {
        // It was killed before it recorded anything.
        return false;
    }
    let left = account(&run);
    let (code, said) = check(&run);
    if !left.own {
        // Not even the file's beginning was on disk.
        assert_eq!((code, left.kept), (3, 0), "{said}");
        return false;
    }
    assert_eq!(code, if left.is_whole() { 0 } else { 3 }, "{said}");
    if let Some(last) = increment(&left) {
        assert!(said.contains(&format!("complete up to {last}\n")), "{said}");
    }
    let whole = folder.join("whole");
    let recovered = recover(&run, &whole).unwrap();
    assert_eq!((recovered.kept, recovered.dropped), (left.kept, left.dropped));
    let again = account(&whole);
    assert!(again.is_whole() && again.own);
    assert_eq!((again.answers.starts, again.answers.unanswered), (left.answers.starts, 0));
    assert_eq!(again.answers.dispositions, left.answers.dispositions);
    assert_eq!(increment(&again), increment(&left));
    // Each increment has exactly one command: none is missing in between.
    let served: u64 = again.answers.dispositions.values().sum();
    assert_eq!(served, increment(&again).unwrap_or(0));
    in_place(&run).unwrap();
    let in_place = account(&run);
    assert!(in_place.is_whole() && in_place.answers == again.answers);
    if again.answers.starts > 0 {
        graintwin(folder, &["replay", "whole", "--verify"]);
    }
    if looks.peers && served > 0 {
        taken_by_peers(&whole);
    }
    if looks.resumes && served > 0 {
        let again = ["run", "scene.yaml", "--commands", "path.csv", "--resume", "run"];
        graintwin(folder, &again);
        assert_eq!(increment(&account(&run)), Some(COMMANDS));
        assert_eq!(state(&run), undisturbed);
    }
    left.is_damaged() && served > 0
}

fn taken_by_peers(whole: &Path) {
    if let Some(said) = python::run("split.py", &[whole], "") {
        let said: serde_json::Value = serde_json::from_str(&said).unwrap();
        assert_eq!(said["messages"].as_array().unwrap().len() as u64, account(whole).kept);
    }
}

#[test]
fn a_recording_killed_at_any_moment_is_whole_up_to_its_last_complete_increment() {
    let mut random = Pcg64Mcg::seed_from_u64(20_261_122);
    let whole = tempfile::tempdir().unwrap();
    write_bead(whole.path(), RECORD[0], COMMANDS);
    assert!(run_and_record(whole.path()).stdout(Stdio::null()).status().unwrap().success());
    let undisturbed = state(&whole.path().join("run"));
    let mut damaged = 0;
    for number in 0..KILLS {
        let split = number % 2;
        let mut pause = |most| Duration::from_micros(random.random_range(0..most));
        let moment = match number % 8 {
            0 => Moment::After(pause(30_000)),
            // At a split.
            3 => Moment::AfterFile(1, pause(3_000)),
            7 => Moment::AfterFile(2, pause(3_000)),
            _ => Moment::AfterFile(0, pause(180_000)),
        };
        println!("kill {number}: {moment:?}, split {split}");
        let folder = tempfile::tempdir().unwrap();
        write_bead(folder.path(), RECORD[split], COMMANDS);
        let looks =
            Looks { peers: number % PEERS == PEERS - 1, resumes: number % RESUMES == RESUMES - 1 };
        damaged += usize::from(kill_and_recover(folder.path(), moment, looks, &undisturbed));
    }
    // The test means something only where most programs were killed while they wrote.
    assert!(damaged > KILLS / 2, "{damaged} of {KILLS}");
}

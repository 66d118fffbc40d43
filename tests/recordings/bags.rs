//! The recordings in `bags/`: replayed to the bit, small, and as their README says.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Most bytes of all together.
const MOST: u64 = 2_000_000;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The recordings that README lists, with the commands that made them.
fn listed() -> Vec<(PathBuf, String)> {
    let text = fs::read_to_string(root().join("bags/README.md")).unwrap();
    let rows = text.lines().filter(|line| line.starts_with("| `"));
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        (root().join("bags").join(cells[1]), cells[2].to_owned())
    };
    rows.map(row).collect()
}

fn graintwin(arguments: &[&str]) -> (bool, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_graintwin"));
    let output = command.args(arguments).current_dir(root()).env_remove("RUST_LOG").output();
    let output = output.unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (output.status.success(), text(output.stdout), text(output.stderr))
}

#[test]
fn two_recordings_are_kept_and_they_are_small() {
    let listed = listed();
    assert_eq!(listed.len(), 2);
    let files = listed.iter().flat_map(|(bag, _)| fs::read_dir(bag).unwrap());
    let sizes = files.map(|file| file.unwrap().metadata().unwrap().len());
    let bytes: u64 = sizes.sum();
    assert!(bytes < MOST, "{bytes} bytes");
}

#[test]
fn each_is_replayed_to_the_bit_on_one_and_on_three_threads() {
    for (bag, _) in listed() {
        for threads in ["1", "3"] {
            let bag = bag.to_str().unwrap();
            let (done, verdict, said) =
                graintwin(&["replay", bag, "--verify", "--json", "--threads", threads]);
            assert!(done, "{bag}: {said}");
            let verdict: Value = serde_json::from_str(&verdict).unwrap();
            assert_eq!((&verdict["equal"], &verdict["whole"]), (&true.into(), &true.into()));
            assert!(verdict["compared"]["state"].is_string(), "{verdict}");
        }
    }
}

/// The scene in the recording is the one that the command names.
#[test]
fn each_was_made_by_the_command_in_the_list() {
    for (bag, command) in listed() {
        let words: Vec<&str> = command.split_whitespace().collect();
        let [program, "run", scene, "--record", folder] = words[..] else { panic!("{command}") };
        assert_eq!(program, "graintwin");
        assert_eq!(root().join(folder), bag);
        let (_, of_scene, _) = graintwin(&["run", scene, "--print-config"]);
        let (_, of_bag, said) = graintwin(&["replay", folder, "--print-config"]);
        assert_eq!(of_scene, of_bag, "{said}");
    }
}

#[test]
fn each_is_drawn() {
    for (bag, _) in listed() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().to_str().unwrap();
        let (done, files, said) = graintwin(&["plot", bag.to_str().unwrap(), "--out", out]);
        assert!(done, "{said}");
        assert!(files.lines().count() > 8, "{files}");
    }
}

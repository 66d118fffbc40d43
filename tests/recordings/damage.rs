//! Recordings that were cut off, spoilt, or could not be written.
#![allow(clippy::print_stdout, reason = "a child process speaks to its test")]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use graintwin::command;
use graintwin::msg::topics;
use graintwin::record::reader::{Bag, ReadError, Survey};
use graintwin::record::{RecordError, Recorder};
use graintwin::scene::{Compression, Record};
use graintwin::sink::{Served, Sink};

use crate::answers::{answers, provenance};

const COMPRESSIONS: [Compression; 3] = [Compression::Zstd, Compression::Lz4, Compression::None];

/// How long a test waits for another thread or process before it gives up.
const PATIENCE: Duration = Duration::from_secs(60);

fn create(folder: &Path, settings: &Record) -> Result<Recorder, RecordError> {
    Recorder::create(folder, settings, &provenance())
}

fn record(folder: &Path, settings: &Record, answers: &[Arc<Served>]) -> PathBuf {
    let mut recorder = create(folder, settings).unwrap();
    answers.iter().for_each(|answer| recorder.served(answer));
    recorder.finish().unwrap();
    mcap_file(folder)
}

fn mcap_file(folder: &Path) -> PathBuf {
    let mut files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.find(|file| file.extension().is_some_and(|extension| extension == "mcap")).unwrap()
}

fn survey(path: &Path) -> Survey {
    Bag::open(path).unwrap().survey().unwrap()
}

fn commands(path: &Path) -> Vec<Result<command::Command, ReadError>> {
    Bag::open(path).unwrap().commands().collect()
}

fn sent(answers: &[Arc<Served>]) -> Vec<command::Command> {
    answers.iter().filter_map(|answer| answer.command.clone()).collect()
}

/// Several chunks, so that most cuts leave whole ones before them.
fn small_chunks(compression: Compression) -> Record {
    Record { chunk: 16 << 10, compression, ..Record::default() }
}

#[test]
fn a_whole_bag_says_what_is_in_it_and_gives_its_commands_back() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let answers = answers(10, 30);
    let file = record(&folder, &Record::default(), &answers);
    for path in [&folder, &file] {
        let survey = survey(path);
        assert!(survey.damage.is_none(), "{:?}", survey.damage);
        assert_eq!(survey.topics.len(), topics::all().count());
        assert_eq!(survey.topics["/graintwin/boundary_command"].messages, 10);
        assert_eq!(survey.topics["/graintwin/report"].messages, 11);
        // 2 of the 10 commands were refused.
        let networks = &survey.topics["/graintwin/contact_network"];
        assert_eq!(networks.messages, 9);
        assert_eq!(networks.kind, "graintwin_msgs/msg/ContactNetwork");
        assert_eq!(networks.encoding, "cdr");
        let (first, last) = survey.times.unwrap();
        assert!(first < last);
        let names: Vec<_> = survey.attachments.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["scene.yaml", "pack.csv", "pack.json", "pack.history.json"]);
        assert_eq!(survey.metadata["graintwin"]["threads"], "2");
        let found: Vec<_> = commands(path).into_iter().map(Result::unwrap).collect();
        assert_eq!(found, sent(&answers));
        let bag = Bag::open(path).unwrap();
        assert_eq!(bag.attachment("pack.csv").unwrap(), Some(provenance().pack_csv));
        assert_eq!(bag.attachment("elsewhere.csv").unwrap(), None);
    }
}

/// Every cut: what is read is a beginning of what was written, never less for a longer file, and
/// only the whole file is called whole.
#[test]
fn a_bag_cut_off_anywhere_gives_what_was_before_the_cut() {
    for compression in COMPRESSIONS {
        let parent = tempfile::tempdir().unwrap();
        let answers = answers(20, 60);
        let file = record(&parent.path().join("run"), &small_chunks(compression), &answers);
        let bytes = fs::read(&file).unwrap();
        let whole = survey(&file).messages();
        let sent = sent(&answers);
        let cut = parent.path().join("cut.mcap");
        let mut before = 0;
        for length in (0..bytes.len()).step_by(997).chain(bytes.len() - 60..bytes.len()) {
            fs::write(&cut, &bytes[..length]).unwrap();
            let survey = survey(&cut);
            assert!(survey.damage.is_some(), "{length} of {} bytes", bytes.len());
            let messages = survey.messages();
            assert!((before..=whole).contains(&messages), "{length}: {before} {messages}");
            before = messages;
            let found = commands(&cut);
            let (last, found) = found.split_last().unwrap();
            assert!(matches!(last, Err(ReadError::Damaged { .. })), "{length}: {last:?}");
            for (found, sent) in found.iter().zip(&sent) {
                assert_eq!(found.as_ref().unwrap(), sent);
            }
        }
        assert_eq!(before, whole, "the index alone was cut off");
    }
}

/// Sums stand over every byte of the file.
#[test]
fn a_bag_with_a_spoilt_byte_is_never_called_whole() {
    for compression in COMPRESSIONS {
        let parent = tempfile::tempdir().unwrap();
        let file = record(&parent.path().join("run"), &small_chunks(compression), &answers(4, 9));
        let bytes = fs::read(&file).unwrap();
        let spoilt = parent.path().join("spoilt.mcap");
        for at in (0..bytes.len()).step_by(bytes.len() / 600) {
            for flip in [0x01, 0xff] {
                let mut changed = bytes.clone();
                changed[at] ^= flip;
                fs::write(&spoilt, &changed).unwrap();
                assert!(survey(&spoilt).damage.is_some(), "byte {at} of {}", bytes.len());
            }
        }
    }
}

/// Lengths and counts of all sizes all over the file, in its chunks without a sum that would give
/// them away: no panic, no end of memory, an end.
#[test]
fn hostile_lengths_do_no_harm() {
    const VALUES: [u64; 7] = [0, 1, 0xff, 0xffff, 0x7fff_ffff, 0xffff_ffff, u64::MAX];
    for compression in COMPRESSIONS {
        let parent = tempfile::tempdir().unwrap();
        let settings = Record { compression, ..Record::default() };
        let file = record(&parent.path().join("run"), &settings, &answers(1, 2));
        let mut bytes = fs::read(&file).unwrap();
        let chunk = first_chunk(&bytes);
        bytes[chunk + CHUNK_SUM..][..4].fill(0);
        let hostile = parent.path().join("hostile.mcap");
        let mut values = VALUES.iter().cycle();
        for at in (8..bytes.len() - 8).step_by(23) {
            let mut changed = bytes.clone();
            changed[at..at + 8].copy_from_slice(&values.next().unwrap().to_le_bytes());
            fs::write(&hostile, &changed).unwrap();
            survey(&hostile);
            commands(&hostile);
        }
    }
}

/// Where a chunk record has the sum over its contents, behind two times and a size; 0 is none.
const CHUNK_SUM: usize = 9 + 24;

/// Where a chunk record that is not compressed has the size of its contents.
const CHUNK_SIZE: usize = CHUNK_SUM + 8;

/// Start of the first chunk record of a file.
fn first_chunk(bytes: &[u8]) -> usize {
    const CHUNK: u8 = 6;
    let mut at = 8;
    while bytes[at] != CHUNK {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap());
        at += 9 + usize::try_from(length).unwrap();
    }
    at
}

#[test]
fn a_chunk_that_holds_more_than_it_says_is_damage() {
    let parent = tempfile::tempdir().unwrap();
    let settings = Record { compression: Compression::None, ..Record::default() };
    let file = record(&parent.path().join("run"), &settings, &answers(1, 2));
    let mut bytes = fs::read(&file).unwrap();
    let chunk = first_chunk(&bytes);
    bytes[chunk + CHUNK_SUM..][..4].fill(0);
    bytes[chunk + CHUNK_SIZE] -= 1;
    fs::write(&file, &bytes).unwrap();
    match survey(&file).damage {
        Some(ReadError::Damaged { damage, .. }) => assert_eq!(damage.offset, chunk as u64),
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_attachment_without_room_for_its_sum_is_damage() {
    const ATTACHMENT: u8 = 9;
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("short.mcap");
    let mut bytes = b"\x89MCAP0\r\n".to_vec();
    bytes.push(ATTACHMENT);
    // Two times, two empty names, no data.
    let body = [0; 8 + 8 + 4 + 4 + 8];
    bytes.extend_from_slice(&(body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(&body);
    fs::write(&file, &bytes).unwrap();
    let damage = survey(&file).damage.unwrap().to_string();
    assert!(damage.contains("damaged at byte 8: an attachment"), "{damage}");
}

#[test]
fn what_is_no_bag_is_refused_with_a_sentence() {
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("text.mcap");
    fs::write(&file, "name: a scene, not a bag\n").unwrap();
    let damage = survey(&file).damage.unwrap().to_string();
    assert!(damage.contains("not the mark that MCAP files begin and end with"), "{damage}");

    let empty = tempfile::tempdir().unwrap();
    let refusal = Bag::open(empty.path()).unwrap_err().to_string();
    assert!(refusal.contains("holds no .mcap file"), "{refusal}");

    let missing = parent.path().join("missing");
    let refusal = Bag::open(&missing).unwrap_err();
    assert!(matches!(refusal, ReadError::Io { .. }), "{refusal}");
}

#[test]
fn a_bag_without_commands_says_what_it_holds_instead() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &Record::default(), &answers(0, 1));
    // The topic is there, but nothing was ever sent on it.
    let refusal = commands(&folder).pop().unwrap().unwrap_err().to_string();
    assert!(refusal.contains("/graintwin/report (graintwin_msgs/msg/Report)"), "{refusal}");
}

#[test]
fn a_folder_that_holds_something_is_left_alone() {
    let parent = tempfile::tempdir().unwrap();
    fs::write(parent.path().join("thesis.txt"), "years of work").unwrap();
    let refusal = create(parent.path(), &Record::default()).unwrap_err();
    assert_eq!(refusal, RecordError::NotEmpty(parent.path().to_owned()));
    assert_eq!(fs::read_dir(parent.path()).unwrap().count(), 1);
}

#[test]
fn an_empty_folder_is_taken() {
    let parent = tempfile::tempdir().unwrap();
    record(parent.path(), &Record::default(), &answers(1, 1));
    assert!(parent.path().join("metadata.yaml").exists());
}

#[test]
fn targets_that_cannot_be_written_are_refused_at_once() {
    let parent = tempfile::tempdir().unwrap();
    let file = parent.path().join("file");
    fs::write(&file, "").unwrap();
    assert_eq!(
        create(&file, &Record::default()).unwrap_err(),
        RecordError::NotAFolder(file.clone())
    );
    for folder in [file.join("below"), PathBuf::from("/proc/graintwin")] {
        let refusal = create(&folder, &Record::default()).unwrap_err();
        assert!(matches!(refusal, RecordError::Create { .. }), "{refusal}");
    }
}

#[test]
fn a_folder_that_vanishes_is_told_during_the_run() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let mut recorder = create(&folder, &Record::default()).unwrap();
    let answers = answers(3, 5);
    recorder.served(&answers[0]);
    fs::remove_dir_all(&folder).unwrap();
    recorder.served(&answers[1]);
    let failure = wait_for(|| recorder.failure());
    assert!(failure.to_string().contains("no longer there"), "{failure}");
    recorder.served(&answers[2]);
    match recorder.finish() {
        Err(RecordError::Write { lost, .. }) => assert_eq!(lost, 3),
        other => panic!("{other:?}"),
    }
}

fn wait_for<T>(mut condition: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(value) = condition() {
            return value;
        }
        assert!(start.elapsed() < PATIENCE, "nothing happened for {PATIENCE:?}");
        thread::sleep(Duration::from_millis(5));
    }
}

/// Runs one of the ignored tests below in a process of its own, by way of a shell line in which
/// `"$@"` stands for it.
fn in_own_process(shell: &str, test: &str, folder: &Path) -> std::process::Child {
    let (_, module) = module_path!().split_once("::").unwrap();
    Command::new("sh")
        .args(["-c", shell, "sh"])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", &format!("{module}::{test}"), "--ignored", "--nocapture"])
        .env("GRAINTWIN_TEST_FOLDER", folder)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

/// The folder that the calling test gave; none when all ignored tests are run.
fn own_folder() -> Option<PathBuf> {
    std::env::var_os("GRAINTWIN_TEST_FOLDER").map(PathBuf::from)
}

#[test]
fn a_killed_process_leaves_every_answer_that_was_flushed() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let mut child = in_own_process("exec \"$@\"", "child_records_and_waits", &folder);
    let mut said = BufReader::new(child.stdout.take().unwrap()).lines();
    said.find(|line| line.as_ref().unwrap().contains("answers served")).unwrap().unwrap();
    // Nothing ends the recording: only the recorder's own clock brings it to the disk.
    wait_for(|| (survey(&folder).topics.get("/graintwin/report")?.messages == 8).then_some(()));
    child.kill().unwrap();
    child.wait().unwrap();
    let survey = survey(&folder);
    let damage = survey.damage.as_ref().unwrap().to_string();
    assert!(damage.contains("the file ends without the record that closes it"), "{damage}");
    assert!(damage.contains(&format!("; {} messages before", survey.messages())), "{damage}");
    assert_eq!(survey.topics["/graintwin/boundary_command"].messages, 7);
    assert_eq!(survey.attachments.len(), 4);
}

#[test]
#[ignore = "run by a_killed_process_leaves_every_answer_that_was_flushed"]
fn child_records_and_waits() {
    let Some(folder) = own_folder() else { return };
    let mut recorder = create(&folder, &Record::default()).unwrap();
    answers(7, 2000).iter().for_each(|answer| recorder.served(answer));
    println!("answers served");
    thread::sleep(PATIENCE);
}

/// The limit on the size of files stands for a disk that is full: the same calls fail.
#[test]
fn a_full_disk_is_told_during_the_run_and_what_was_written_stays_readable() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let shell = "trap '' XFSZ; ulimit -f 2048; \"$@\"";
    let mut child = in_own_process(shell, "child_records_until_it_fails", &folder);
    let said: Vec<String> =
        BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap).collect();
    assert!(child.wait().unwrap().success(), "{said:#?}");
    let line = said.iter().find_map(|line| line.strip_prefix("served and lost: ")).unwrap();
    let (served, lost) = line.split_once(' ').unwrap();
    let (served, lost): (u64, u64) = (served.parse().unwrap(), lost.parse().unwrap());
    let survey = survey(&folder);
    assert!(survey.damage.is_some());
    let whole = survey.topics["/graintwin/contact_network"].messages;
    assert!(whole > 0 && lost > 0, "{line}");
    // A chunk that was cut off may hold some more.
    assert!(whole >= served - lost, "{whole} of {line}");
}

#[test]
#[ignore = "run by a_full_disk_is_told_during_the_run_and_what_was_written_stays_readable"]
fn child_records_until_it_fails() {
    let Some(folder) = own_folder() else { return };
    let mut recorder = create(&folder, &small_chunks(Compression::None)).unwrap();
    let answer = &answers(0, 2000)[0];
    let mut served = 0;
    while recorder.failure().is_none() {
        recorder.served(answer);
        served += 1;
    }
    let demand = recorder.demand();
    assert!(!demand.state && !demand.moduli && !demand.contact_network);
    for _ in 0..100 {
        recorder.served(answer);
        served += 1;
    }
    let failure = recorder.failure().unwrap();
    match (recorder.finish(), failure) {
        (
            Err(RecordError::Write { path, reason, lost }),
            RecordError::Write { reason: told_before, .. },
        ) => {
            assert_eq!(path, mcap_file(&folder));
            assert_eq!(reason, told_before);
            println!("\nserved and lost: {served} {lost}");
        }
        other => panic!("{other:?}"),
    }
}

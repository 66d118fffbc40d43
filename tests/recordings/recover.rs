//! Recordings that were cut off, made whole again, and gone on with.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use graintwin::command::Stamp;
use graintwin::command::circumstance::{Circumstance, Happened};
use graintwin::command::request::Request;
use graintwin::msg::{DiagnosticArray, Header};
use graintwin::record::reader::{Bag, Survey};
use graintwin::record::recover::{Account, RecoverError, in_place, recover};
use graintwin::record::{RecordError, Recorder};
use graintwin::report::Report;
use graintwin::scene::{Compression, Record, Split};
use graintwin::sink::{Beside, Recording, Served, Sink};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::answers::{answers, provenance};
use crate::python;

/// What stays of a message: topic, times, sequence, bytes.
type Found = (String, u64, u64, u32, Vec<u8>);

fn messages(bag: &Path) -> Vec<Found> {
    let bag = Bag::open(bag).unwrap();
    bag.messages()
        .map_while(Result::ok)
        .map(|message| {
            let topic = message.channel.topic.clone();
            (topic, message.log_time, message.publish_time, message.sequence, message.data)
        })
        .collect()
}

fn survey(bag: &Path) -> Survey {
    Bag::open(bag).unwrap().survey().unwrap()
}

fn account(bag: &Path) -> Account {
    Account::of(&Bag::open(bag).unwrap()).unwrap()
}

/// Small chunks in small files.
fn settings() -> Record {
    let split = Split { size: Some(60_000), duration: None };
    Record { chunk: 1 << 14, compression: Compression::Zstd, split, ..Record::default() }
}

fn record(folder: &Path, settings: &Record, answers: &[Arc<Served>]) {
    let mut recorder = Recorder::create(folder, settings, &provenance()).unwrap();
    for answer in answers {
        recorder.served(answer);
    }
    recorder.finish().unwrap();
}

/// The files of a bag, in order.
fn files(folder: &Path) -> Vec<PathBuf> {
    account(folder).files.into_iter().map(|file| file.path).collect()
}

/// As a crash leaves it: no description, the last file cut off after `bytes`.
fn cut(folder: &Path, bytes: u64) {
    fs::remove_file(folder.join("metadata.yaml")).unwrap();
    let last = files(folder).pop().unwrap();
    fs::File::options().write(true).open(last).unwrap().set_len(bytes).unwrap();
}

fn copied(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
    }
}

/// Every file of a folder with its bytes.
fn bytes(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut all: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .map(|path| (path.clone(), fs::read(path).unwrap()))
        .collect();
    all.sort();
    all
}

/// Whether `found` is `all` up to the end of some answer.
fn ends_with_an_answer(found: &[Found], all: &[Found]) -> bool {
    found == &all[..found.len()]
        && found.last().is_none_or(|(topic, ..)| topic == "/graintwin/report")
}

#[test]
fn a_recording_cut_off_anywhere_is_whole_up_to_its_last_whole_answer() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let all = messages(&folder);
    let last = files(&folder).pop().unwrap();
    assert!(files(&folder).len() > 2, "the recording is split");
    let length = fs::metadata(&last).unwrap().len();
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let mut cuts: Vec<u64> = (0..60).map(|_| random.random_range(0..length)).collect();
    cuts.extend([0, 1, 8, length - 1, length - 8, length - 9]);
    let mut most = 0;
    for bytes_left in cuts {
        let cut_off = parent.path().join("cut");
        copied(&folder, &cut_off);
        cut(&cut_off, bytes_left);
        let readable = messages(&cut_off);
        let recovered = parent.path().join("recovered");
        let done = recover(&cut_off, &recovered).unwrap();
        let found = messages(&recovered);
        assert!(ends_with_an_answer(&found, &all), "cut at {bytes_left}");
        assert_eq!(
            (done.kept, done.dropped as usize),
            (found.len() as u64, readable.len() - found.len())
        );
        // What was there of the next answer is all that is missing.
        let rest = &all[found.len()..];
        let next = rest.iter().position(|(topic, ..)| topic == "/graintwin/report");
        assert!(next.is_none_or(|next| done.dropped as usize <= next), "cut at {bytes_left}");
        let survey = survey(&recovered);
        assert!(survey.damage.is_none());
        assert_eq!(survey.attachments.len(), 4);
        assert!(account(&recovered).is_whole());

        // The same in its own folder, once and once more.
        in_place(&cut_off).unwrap();
        assert_eq!(messages(&cut_off), found, "cut at {bytes_left}");
        let once = bytes(&cut_off);
        in_place(&cut_off).unwrap();
        assert!(bytes(&cut_off) == once, "a second time changes nothing");
        most = most.max(found.len());
        fs::remove_dir_all(&cut_off).unwrap();
        fs::remove_dir_all(&recovered).unwrap();
    }
    assert!(most > all.len() / 2);
}

#[test]
fn a_recovered_file_says_so_and_independent_readers_take_it() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let last = files(&folder).pop().unwrap();
    cut(&folder, fs::metadata(&last).unwrap().len() * 3 / 5);
    let size = fs::metadata(&last).unwrap().len();
    let recovered = parent.path().join("recovered");
    let done = recover(&folder, &recovered).unwrap();
    assert_eq!((done.rewritten, done.left_out), (1, 0));
    let survey = survey(&recovered);
    let about = &survey.metadata["graintwin_recovered"];
    assert_eq!(about["source"], last.file_name().unwrap().to_str().unwrap());
    assert_eq!(about["bytes"], size.to_string());
    assert_eq!(about["dropped"], done.dropped.to_string());
    assert!(about["damage"].contains("the file ends in the middle of a record"), "{about:?}");
    assert_eq!(survey.metadata["graintwin"]["threads"], "2");
    let Some(said) = python::run("split.py", &[&recovered], "") else { return };
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["messages"].as_array().unwrap().len() as u64, done.kept);
}

#[test]
fn a_whole_bag_is_copied_byte_by_byte() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let copy = parent.path().join("copy");
    let done = recover(&folder, &copy).unwrap();
    assert_eq!((done.rewritten, done.dropped, done.left_out), (0, 0, 0));
    let names = |all: Vec<(PathBuf, Vec<u8>)>| -> Vec<_> {
        all.into_iter().map(|(path, bytes)| (path.file_name().unwrap().to_owned(), bytes)).collect()
    };
    assert!(names(bytes(&folder)) == names(bytes(&copy)));
    let before = bytes(&folder);
    in_place(&folder).unwrap();
    assert!(bytes(&folder) == before, "what is whole stays as it is");
}

#[test]
fn the_description_of_whole_files_is_made_again_as_it_was() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let before = bytes(&folder);
    fs::remove_file(folder.join("metadata.yaml")).unwrap();
    in_place(&folder).unwrap();
    assert!(bytes(&folder) == before);
}

/// A chunk that never grows full, so that all answers are in the file in one piece.
fn one_chunk() -> Record {
    Record { chunk: 1 << 24, compression: Compression::None, ..Record::default() }
}

/// Ends the file behind the last message before the `count`-th last report.
fn cut_before_report(folder: &Path, count: usize) {
    let file = files(folder).pop().unwrap();
    let all = fs::read(&file).unwrap();
    let (_, _, _, _, data) = messages(folder)
        .into_iter()
        .filter(|(topic, ..)| topic == "/graintwin/report")
        .nth_back(count)
        .unwrap();
    // The chunk is not packed: the report's bytes stand in it as they are, behind 31 of the record.
    let place = all.windows(data.len()).position(|window| window == data).unwrap();
    cut(folder, place as u64 - 31);
}

#[test]
fn what_came_beside_is_kept_and_a_command_without_report_dropped() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let answers = answers(2, 3);
    let mut recorder = Recorder::create(&folder, &one_chunk(), &provenance()).unwrap();
    let handle = recorder.handle();
    let status = DiagnosticArray { header: Header::default(), status: Vec::new() };
    recorder.served(&answers[0]);
    recorder.served(&answers[1]);
    handle.beside(Beside::Diagnostics(status.clone()));
    let held = Circumstance::Asked(Request::Hold(true), Ok(String::new()));
    recorder.happened(&Happened { increment: 1, stamp: Stamp::default(), what: held });
    recorder.happened(&Happened {
        increment: 1,
        stamp: Stamp::default(),
        what: Circumstance::Age(3.0),
    });
    recorder.served(&answers[2]);
    recorder.finish().unwrap();
    cut_before_report(&folder, 0);

    let account = account(&folder);
    assert_eq!(account.answers.unanswered, 1);
    assert_eq!((account.answers.starts, account.answers.dispositions[&0]), (1, 1));
    let recovered = parent.path().join("recovered");
    let done = recover(&folder, &recovered).unwrap();
    let found = messages(&recovered);
    let topics: Vec<_> = found.iter().rev().map(|(topic, ..)| topic.as_str()).take(3).collect();
    // That the twin was held bears on what follows; the age was the lost command's.
    assert_eq!(topics, ["/graintwin/circumstance", "/diagnostics", "/graintwin/report"]);
    assert_eq!(done.kept, found.len() as u64);
}

#[test]
fn commands_that_were_merged_with_a_lost_one_are_dropped() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let answers = answers(3, 3);
    let merged = |served: &Served| {
        let Served { command, report } = served;
        let report = Report { measures: None, increment: 3, ..report.clone() };
        Arc::new(Served { command: command.clone(), report })
    };
    let mut recorder = Recorder::create(&folder, &one_chunk(), &provenance()).unwrap();
    recorder.served(&answers[0]);
    recorder.served(&merged(&answers[1]));
    recorder.served(&merged(&answers[2]));
    recorder.served(&answers[3]);
    recorder.finish().unwrap();
    assert!(account(&folder).is_whole());
    cut_before_report(&folder, 0);

    let account = account(&folder);
    assert_eq!(account.answers.unanswered, 3);
    assert_eq!(account.answers.last.as_ref().unwrap().2, 0);
    let recovered = parent.path().join("recovered");
    recover(&folder, &recovered).unwrap();
    let found = messages(&recovered);
    assert_eq!(found.iter().filter(|(topic, ..)| topic == "/graintwin/report").count(), 1);
}

#[test]
fn a_damage_in_the_middle_ends_an_own_recording_there_and_leaves_its_folder_alone() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let all = messages(&folder);
    let paths = files(&folder);
    let mut spoilt = fs::read(&paths[1]).unwrap();
    let middle = spoilt.len() / 2;
    spoilt[middle] ^= 0x10;
    fs::write(&paths[1], spoilt).unwrap();
    let before = bytes(&folder);
    assert!(matches!(in_place(&folder).unwrap_err(), RecoverError::Middle { .. }));
    assert!(bytes(&folder) == before);
    let recovered = parent.path().join("recovered");
    let done = recover(&folder, &recovered).unwrap();
    assert_eq!(done.left_out, paths.len() - 2);
    assert!(ends_with_an_answer(&messages(&recovered), &all));
}

#[test]
fn a_recording_goes_on_in_a_new_file() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let answers = answers(16, 300);
    record(&folder, &settings(), &answers[..9]);
    cut(&folder, 10_000);
    in_place(&folder).unwrap();
    let before = messages(&folder);
    let count = files(&folder).len();
    let whole = before.iter().filter(|(topic, ..)| topic == "/graintwin/report").count();

    let mut recorder = Recorder::resume(&folder, &settings(), &provenance()).unwrap();
    for answer in &answers[whole..] {
        recorder.served(answer);
    }
    let recorded = recorder.finish().unwrap();
    let all = messages(&folder);
    assert_eq!(recorded.messages, all.len() as u64);
    assert!(recorded.files > count);
    assert_eq!(all[..before.len()], before);
    assert!(all.is_sorted_by(|one, other| one.1 < other.1), "log_time rises");
    assert_eq!(all[before.len()].0, "/tf_static", "the frames are repeated");
    let reports = all.iter().filter(|(topic, ..)| topic == "/graintwin/report").count();
    assert_eq!(reports, answers.len());
    assert!(account(&folder).is_whole());
    let Some(said) = python::run("split.py", &[&folder], "") else { return };
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(said["files"].as_array().unwrap().len(), recorded.files);
}

#[test]
fn a_recording_that_goes_on_with_nothing_stays_as_it_was() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    let before = bytes(&folder);
    Recorder::resume(&folder, &settings(), &provenance()).unwrap().finish().unwrap();
    assert!(bytes(&folder) == before);
}

#[test]
fn what_is_no_whole_recording_cannot_go_on() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    record(&folder, &settings(), &answers(16, 300));
    cut(&folder, 10_000);
    let refusal = Recorder::resume(&folder, &settings(), &provenance()).unwrap_err();
    assert!(matches!(&refusal, RecordError::Resume { reason, .. } if reason == "it is not whole"));
    fs::remove_dir_all(&folder).unwrap();
    let refusal = Recorder::resume(&folder, &settings(), &provenance()).unwrap_err().to_string();
    assert!(refusal.contains("cannot go on with the recording in"), "{refusal}");
}

#[test]
fn a_bag_of_another_program_keeps_every_message_that_can_be_read() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("rig");
    let text =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("msgs/graintwin_msgs/msg/BoundaryCommand.msg");
    let commands: Vec<_> = (1..200)
        .map(|sequence| {
            serde_json::json!({"topic": "/rig/command", "command": {
                "header": {"stamp": {"sec": sequence, "nanosec": 5}},
                "session": "rig", "sequence": sequence, "mode": 0,
                "displacement": [0.0, 0.0, 0.0, 0.0, 0.0, 1e-7],
            }})
        })
        .collect();
    let input = serde_json::Value::from(commands).to_string();
    if python::run("write_bag.py", &[&folder, &text], &input).is_none() {
        return;
    }
    let (all, file) = (messages(&folder), files(&folder).pop().unwrap());
    let length = fs::metadata(&file).unwrap().len();
    let about = |bag: &Path| {
        let first = Bag::open(bag).unwrap().messages().next().unwrap().unwrap();
        (first.channel.about.clone(), first.channel.definition.clone())
    };
    let told = about(&folder);
    fs::File::options().write(true).open(&file).unwrap().set_len(length * 2 / 3).unwrap();
    let readable = messages(&folder);
    let recovered = parent.path().join("recovered");
    let done = recover(&folder, &recovered).unwrap();
    let found = messages(&recovered);
    assert!(!found.is_empty() && found == readable && found == all[..found.len()]);
    assert_eq!((done.kept, done.dropped), (found.len() as u64, 0));
    assert_eq!(about(&recovered), told);
    assert!(matches!(in_place(&folder).unwrap_err(), RecoverError::Foreign(_)));
    let said = python::run("count.py", &[&recovered], "").unwrap();
    assert_eq!(said.trim(), found.len().to_string());
}

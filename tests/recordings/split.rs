//! Recordings of several files, and of some topics only.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::sleep;
use std::time::Duration;

use graintwin::command::Stamp;
use graintwin::command::circumstance::{Circumstance, Happened};
use graintwin::command::request::Request;
use graintwin::record::reader::Bag;
use graintwin::record::{Recorded, Recorder};
use graintwin::report::Demand;
use graintwin::scene::{self, Compression, Record, Split, Topics};
use graintwin::sink::{Served, Sink};
use serde_json::{Value, json};

use crate::answers::{answers, provenance};
use crate::python;

fn record(folder: &Path, settings: &Record, answers: &[Arc<Served>]) -> Recorded {
    let mut recorder = Recorder::create(folder, settings, &provenance()).unwrap();
    for answer in answers {
        recorder.served(answer);
    }
    recorder.finish().unwrap()
}

/// Topic and bytes of every message.
fn messages(bag: &Path) -> Vec<(String, Vec<u8>)> {
    let bag = Bag::open(bag).unwrap();
    let messages = bag.messages().map(Result::unwrap);
    messages.map(|message| (message.channel.topic.clone(), message.data)).collect()
}

fn files(folder: &Path, count: usize) -> Vec<PathBuf> {
    let name = folder.file_name().unwrap().to_str().unwrap();
    (0..count).map(|number| folder.join(format!("{name}_{number}.mcap"))).collect()
}

/// What two independent readers find in `folder`, if there are any.
fn peers_find(folder: &Path) -> Option<Value> {
    Some(serde_json::from_str(&python::run("split.py", &[folder], "")?).unwrap())
}

/// Without compression, so that sizes can be told.
fn split(size: Option<u64>, duration: Option<f64>) -> Record {
    let compression = Compression::None;
    Record { chunk: 1 << 16, compression, split: Split { size, duration }, ..Record::default() }
}

#[test]
fn a_recording_that_is_split_by_size_holds_every_message_once() {
    const SIZE: u64 = 1 << 18;
    let parent = tempfile::tempdir().unwrap();
    let answers = answers(60, 400);
    let whole = parent.path().join("whole");
    record(&whole, &split(None, None), &answers);
    let one = record(&parent.path().join("one"), &split(None, None), &answers[..1]);
    let folder = parent.path().join("parts");
    let recorded = record(&folder, &split(Some(SIZE), None), &answers);
    let parts = files(&folder, recorded.files);
    // 60 answers of 75 kB each, 4 to a file.
    assert!((10..=20).contains(&parts.len()), "{}", parts.len());
    let sizes: Vec<u64> = parts.iter().map(|path| fs::metadata(path).unwrap().len()).collect();
    assert_eq!(sizes.iter().sum::<u64>(), recorded.bytes);
    // One answer, and the types and the index at the end: what a recording of one answer has.
    assert!(sizes.iter().all(|size| *size < SIZE + one.bytes), "{sizes:?}, {}", one.bytes);
    assert!(sizes[..parts.len() - 1].iter().all(|size| *size > SIZE / 2), "{sizes:?}");

    let mut again = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        let mut found = messages(part);
        assert_eq!(found.last().unwrap().0, "/graintwin/report", "a file ends with a whole answer");
        if number > 0 {
            let repeated = found.remove(0);
            assert_eq!(repeated, again_frames(&again), "the frames come first");
        }
        again.extend(found);
    }
    assert!(again == messages(&whole), "not the same messages");

    let Some(said) = peers_find(&folder) else { return };
    let said_files = said["files"].as_array().unwrap();
    assert_eq!(said_files.len(), parts.len());
    let program = &said_files[0]["metadata"]["graintwin"];
    assert_eq!(program["threads"], "2");
    for (number, file) in said_files.iter().enumerate() {
        assert_eq!(&file["metadata"]["graintwin"], program);
        let attached = file["attachments"].as_array().unwrap().len();
        assert_eq!(attached, if number == 0 { 4 } else { 0 });
    }
    let times: Vec<u64> = said["messages"]
        .as_array()
        .unwrap()
        .iter()
        .map(|message| message[1].as_u64().unwrap())
        .collect();
    assert!(times.is_sorted_by(|one, other| one < other), "log_time rises over the files");
}

/// The frames in what was found first.
fn again_frames(found: &[(String, Vec<u8>)]) -> (String, Vec<u8>) {
    found.iter().find(|(topic, _)| topic == "/tf_static").unwrap().clone()
}

#[test]
fn a_recording_is_split_by_duration_and_an_end_makes_no_empty_file() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let settings = split(None, Some(0.2));
    let mut recorder = Recorder::create(&folder, &settings, &provenance()).unwrap();
    let answers = answers(11, 5);
    for answer in &answers {
        recorder.served(answer);
        sleep(Duration::from_millis(60));
    }
    let recorded = recorder.finish().unwrap();
    // 11 pauses are at least 660 ms, so more than two files; four answers or fewer fit into one.
    assert!((3..=12).contains(&recorded.files), "{}", recorded.files);
    for part in files(&folder, recorded.files) {
        let survey = Bag::open(&part).unwrap().survey().unwrap();
        let (first, last) = survey.times.unwrap();
        // The recorder's clock is read when the answer comes, the messages of it follow by 1 ns.
        assert!(last - first < 200_000_100, "{}", last - first);
    }
    let reports = messages(&folder).iter().filter(|(topic, _)| topic.ends_with("/report")).count();
    assert_eq!(reports, answers.len());
}

#[test]
fn only_the_topics_that_the_scene_names_are_recorded_and_what_a_replay_needs() {
    let parent = tempfile::tempdir().unwrap();
    let named = Topics::Named(vec!["wall/*".into(), "~/state".into()]);
    let settings = Record { topics: named, exclude: vec!["wall/z_*".into()], ..Record::default() };
    let folder = parent.path().join("run");
    let mut recorder = Recorder::create(&folder, &settings, &provenance()).unwrap();
    let demand = recorder.demand();
    assert!(demand.state && !demand.moduli && !demand.contact_network, "{demand:?}");
    for answer in &answers(3, 5) {
        recorder.served(answer);
    }
    let what = Circumstance::Asked(Request::Hold(true), Ok(String::new()));
    recorder.happened(&Happened { increment: 3, stamp: Stamp::default(), what });
    recorder.finish().unwrap();
    let survey = Bag::open(&folder).unwrap().survey().unwrap();
    let found: Vec<_> =
        survey.topics.iter().map(|(topic, found)| (topic.as_str(), found.messages)).collect();
    assert_eq!(
        found,
        [
            ("/graintwin/boundary_command", 3),
            ("/graintwin/circumstance", 1),
            ("/graintwin/report", 4),
            ("/graintwin/state", 4),
            ("/graintwin/wall/x_max/wrench", 4),
            ("/graintwin/wall/x_min/wrench", 4),
            ("/graintwin/wall/y_max/wrench", 4),
            ("/graintwin/wall/y_min/wrench", 4),
            ("/graintwin/wall_targets", 0),
        ]
    );
    assert!(peers_find(&folder).is_none_or(|said| said["files"][0]["messages"] == json!(28)));
}

#[test]
fn all_topics_are_demanded_by_default() {
    let parent = tempfile::tempdir().unwrap();
    let recorder = Recorder::create(parent.path(), &Record::default(), &provenance()).unwrap();
    assert_eq!(recorder.demand(), Demand::ALL);
}

#[test]
fn a_level_makes_the_recording_smaller() {
    let parent = tempfile::tempdir().unwrap();
    let answers = answers(8, 300);
    let size = |level| {
        let settings = Record { level: Some(level), ..Record::default() };
        record(&parent.path().join(format!("level{level}")), &settings, &answers).bytes
    };
    assert!(size(19) < size(1));
}

fn problems(record: &str) -> String {
    let text = format!("pack: {{file: a.csv}}\nrecord: {record}\n");
    scene::parse(&text, Path::new("s.yaml")).unwrap_err().to_string()
}

#[test]
fn settings_that_mean_nothing_are_refused_with_a_sentence() {
    for (record, said) in [
        ("{compression: lz4, level: 3}", "record.level: only `compression: zstd` has levels"),
        ("{level: 23}", "record.level: 23 is outside 1 to 22"),
        ("{split: {size: 10 KiB}}", "record.split.size: 10240 bytes is outside 1 MiB to 1024 GiB"),
        ("{split: {duration: 0.5}}", "record.split.duration: 0.5 is outside duration >= 1 s"),
        ("{split: {length: 3}}", "unknown field `length`"),
        (
            "{topics: [stat]}",
            "record.topics[0]: no topic is named `stat`; known: boundary_command,",
        ),
        ("{topics: state}", "`state` is not `all`"),
        ("{exclude: [state, 'x/*']}", "record.exclude[1]: no topic is named `x/*`; known:"),
        ("{exclude: [~/report]}", "record.exclude[0]: `~/report` is always recorded: a replay"),
        ("{on_failure: panic}", "on_failure"),
    ] {
        let found = problems(record);
        assert!(found.contains(said), "{record}: {found}");
    }
}

#[test]
fn the_settings_come_back_from_the_echo() {
    let text = "pack: {file: a.csv}\nrecord: {level: 9, split: {size: 1 GiB, duration: 600.0}, \
                topics: [state, wall/*], exclude: [wall/z_*], on_failure: stop}\n";
    let scene = scene::parse(text, Path::new("s.yaml")).unwrap();
    assert_eq!(scene.record.split, Split { size: Some(1 << 30), duration: Some(600.0) });
    let again = scene::parse(&scene.to_yaml().unwrap(), Path::new("s.yaml")).unwrap();
    assert_eq!(again, scene);
}

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

use std::path::Path;
use std::sync::Mutex;

use super::*;
use graintwin::command::request::Answer;
use graintwin::command::{Ask, Mode};
use graintwin::pack::{Grain, Pack};
use graintwin::scene;
use graintwin::wall::Bounds;

/// A source in which everything has come already.
struct Came(VecDeque<Intake>);

impl Source for Came {
    fn next(&mut self) -> Option<Intake> {
        self.0.pop_front()
    }

    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize) {
        let count = self.0.len().min(most.saturating_sub(waiting.len()));
        waiting.extend(self.0.drain(..count));
    }
}

/// A sink that keeps everything.
struct Kept<'a>(&'a Mutex<Vec<Arc<Served>>>);

impl Sink for Kept<'_> {
    fn demand(&self) -> Demand {
        Demand::default()
    }

    fn served(&mut self, served: &Arc<Served>) {
        self.0.lock().unwrap().push(Arc::clone(served));
    }
}

fn twin() -> Twin {
    let scene = scene::parse("pack: {file: none.csv}", Path::new("scene.yaml")).unwrap();
    let (young, poisson, density) = (70e9, 0.2, 2.5e3);
    let grain = Grain {
        position: [0.0; 3],
        radius: 1e-3,
        young,
        poisson,
        density,
        friction: 0.0,
        hydrate: false,
    };
    let bounds = Bounds { min: [-0.999e-3; 3], max: [0.999e-3; 3] };
    Twin::new(&scene, &Pack { bounds, grains: vec![grain], history: None }, 1).unwrap()
}

/// Sends z_max inwards.
fn command(sequence: u64, displacement: f64) -> Command {
    Command {
        stamp: Stamp { sec: sequence as i32, nanosec: 0 },
        session: "test".into(),
        sequence,
        mode: Mode::Absolute,
        ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, 0.0, displacement]),
        age: None,
    }
}

/// Asks, and notes the answer.
fn ask(request: Request, answers: &Arc<Mutex<Vec<Answer>>>) -> Intake {
    let answers = Arc::clone(answers);
    Intake::Request(Asked::new(request, move |answer| answers.lock().unwrap().push(answer)))
}

/// Sequence (0 without a command), increment and disposition of everything served.
fn served(
    late: Late,
    came: impl IntoIterator<Item = Intake>,
    stop: bool,
) -> Vec<(u64, u64, Disposition)> {
    let kept = Mutex::default();
    let mut sinks: Vec<Box<dyn Sink>> = vec![Box::new(Kept(&kept))];
    let how = (Outputs::default(), late);
    let mut source = Came(came.into_iter().collect());
    let mut twin = twin();
    start(&mut twin, how.0, &mut sinks).unwrap();
    serve(&mut twin, how, &mut source, &mut sinks, &AtomicBool::new(stop));
    drop(sinks);
    let kept = kept.into_inner().unwrap();
    let told = |one: &Arc<Served>| {
        let command = one.command.as_ref();
        assert_eq!(command.map_or(0, |command| command.sequence), one.report.sequence);
        (one.report.sequence, one.report.increment, one.report.disposition)
    };
    kept.iter().map(told).collect()
}

const APPLIED: Disposition = Disposition::Applied;

#[test]
fn late_commands_are_merged_between_requests_and_each_has_its_report() {
    let answers = Arc::default();
    let came = || {
        let ramp = |range: std::ops::Range<u64>| {
            range.map(|k| Intake::Command(command(k, 1e-7 * k as f64)))
        };
        ramp(1..4)
            .chain([ask(Request::Hold(false), &answers)])
            .chain(ramp(4..6))
            .chain([Intake::Command(command(6, 4.5e-7)), Intake::Command(command(7, 4e-7))])
            .chain([Intake::Malformed(command(8, f64::NAN), "wrong".into())])
    };
    let merged = served(Late::Merge, came(), false);
    let increments = [0, 1, 1, 1, 2, 2, 3, 3];
    let expected: Vec<_> =
        (0..).zip(increments).map(|(sequence, increment)| (sequence, increment, APPLIED)).collect();
    assert_eq!(merged[..8], expected);
    assert_eq!(merged[8..], [(8, 3, Disposition::Invalid)]);
    let every = served(Late::Every, came(), false);
    assert!(every[..8].iter().enumerate().all(|(k, one)| *one == (k as u64, k as u64, APPLIED)));
    assert_eq!(answers.lock().unwrap().len(), 2);
}

#[test]
fn more_commands_than_are_looked_at_at_once_all_have_their_reports() {
    let count = 3 * MOST_WAITING as u64;
    let came = (1..=count).map(|k| Intake::Command(command(k, 1e-10 * k as f64)));
    let reports = served(Late::Merge, came, false);
    let sequences: Vec<u64> = reports.iter().map(|one| one.0).collect();
    assert_eq!(sequences, (0..=count).collect::<Vec<_>>());
    assert_eq!(reports.last(), Some(&(count, 3, APPLIED)));
}

#[test]
fn a_command_beyond_a_limit_is_left_out_of_a_merge() {
    let far = 2e-3;
    let came = [command(1, 1e-7), command(2, 2e-7), command(3, far), command(4, 3e-7)];
    let reports = served(Late::Merge, came.map(Intake::Command), false);
    let expected = [(0, 0, APPLIED), (1, 1, APPLIED), (2, 1, APPLIED), (3, 1, Disposition::Limit)];
    assert_eq!(reports[..4], expected);
    assert_eq!(reports[4], (4, 2, APPLIED));
}

#[test]
fn requests_are_answered_in_order_and_a_reset_is_published_like_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pack.csv");
    let answers = Arc::default();
    let came = [
        Intake::Command(command(1, 1e-7)),
        ask(Request::SavePack(file.clone()), &answers),
        ask(Request::SavePack(file.clone()), &answers),
        ask(Request::Hold(true), &answers),
        Intake::Command(command(2, 2e-7)),
        ask(Request::Hold(false), &answers),
        ask(Request::Reset, &answers),
        ask(Request::ResetFaults, &answers),
        Intake::Command(command(1, 3e-7)),
    ];
    let reports = served(Late::Every, came, false);
    let expected = [
        (0, 0, APPLIED),
        (1, 1, APPLIED),
        (2, 1, Disposition::Held),
        (0, 0, APPLIED),
        (1, 1, APPLIED),
    ];
    assert_eq!(reports, expected);
    assert!(file.exists());
    let answers = answers.lock().unwrap();
    let done: Vec<bool> = answers.iter().map(Result::is_ok).collect();
    assert_eq!(done, [true, false, true, true, true, true], "{answers:?}");
}

#[test]
fn a_request_behind_the_stop_is_refused() {
    let answers = Arc::default();
    let came = [ask(Request::Reset, &answers)];
    assert_eq!(served(Late::Every, came, true), [(0, 0, APPLIED)]);
    assert!(answers.lock().unwrap()[0].is_err());
}

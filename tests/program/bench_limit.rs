//! The time limit of `bench`, on a clock that the test moves.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::time::Duration;

use graintwin::bench::{Ended, Job, Reference, Row, TOLERANCES, Timing, measure};
use graintwin::command::Command;
use graintwin::path;
use graintwin::scene::{Method, Scene};
use graintwin::view::work_precision;

use crate::packs::{made, scene};

/// A clock that is a second later whenever it is read.
struct Ticking(Cell<u64>);

impl Ticking {
    fn read(&self) -> Duration {
        self.0.set(self.0.get() + 1);
        Duration::from_secs(self.0.get())
    }
}

/// The rows of a path of five increments, at most `limit` \[s\] each on such a clock, broken off
/// after `most` rows.
fn rows(limit: u64, rounds: u32, most: usize) -> Vec<Row> {
    let pack = made(60, 10e6, 1);
    let text = "pack: {file: p.csv}\nload_path: [{uniaxial: {strain: 5.0e-5, increments: 5}}]";
    let path = graintwin::scene::parse(text, "s.yaml".as_ref()).unwrap().load_path;
    let commands: Vec<Command> = path::commands(&path, "".as_ref(), &pack.bounds).unwrap();
    let scene: Scene = scene();
    let job = Job { scene: &scene, pack: &pack, commands: &commands, threads: 1 };
    let reference = Reference::of(&job).unwrap();
    let ticking = Ticking(Cell::new(0));
    let clock = || ticking.read();
    let timing = Timing { rounds, limit: Duration::from_secs(limit), clock: &clock };
    let mut seen = 0;
    measure(&job, &reference, &timing, &mut |_| {
        seen += 1;
        if seen == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
    .unwrap()
}

#[test]
fn a_row_ends_at_the_limit_and_tighter_tolerances_are_not_tried() {
    // An increment reads the clock three times: before it, and around the twin's answer.
    let rows = rows(8, 3, usize::MAX);
    let newton: Vec<_> = rows.iter().filter(|row| row.method == Method::Newton).collect();
    assert_eq!(newton[0].ended, Ended::Limit);
    assert_eq!((newton[0].tolerance, newton[0].increments), (TOLERANCES[0], 3));
    assert_eq!(newton[0].cpu_seconds_median, 1.0);
    assert!(newton[0].text.contains("after 3 of 5"), "{}", newton[0].text);
    assert!(newton.len() > 1);
    for row in &newton[1..] {
        assert_eq!((row.ended, row.increments), (Ended::Skipped, 0));
        assert!(row.cpu_seconds_median.is_nan() && row.force_error.worst.is_nan());
        assert!(row.text.contains("1e-2"), "{}", row.text);
    }
    let notes = &work_precision(&rows, "", "").charts[0].notes;
    let cut = rows.iter().filter(|row| row.ended == Ended::Limit).count();
    assert!(notes.len() == cut && notes[0].starts_with("newton at 1e-2: "), "{notes:?}");
}

#[test]
fn a_round_that_the_limit_cuts_short_does_not_count() {
    for row in rows(22, 3, usize::MAX) {
        assert_eq!((row.ended, row.increments, row.rounds), (Ended::Complete, 5, 1));
    }
    for row in rows(100, 3, usize::MAX) {
        assert_eq!((row.ended, row.rounds), (Ended::Complete, 3));
    }
}

#[test]
fn whoever_watches_may_break_off() {
    assert_eq!(rows(100, 1, 2).len(), 2);
}

use super::intake::{Arrivals, SILENCE};
use super::link::Traffic;
use super::*;
use crate::command::Disposition;
use crate::node::health::Vitals;
use crate::sink::RecordingState;

fn value<'a>(status: &'a Status, key: &str) -> &'a str {
    &status.values.iter().find(|pair| pair.key == key).unwrap().value
}

fn refused(reason: Disposition, count: u64) -> Vitals {
    let mut vitals = Vitals::default();
    vitals.refused[reason as usize] = count;
    vitals
}

#[test]
fn the_levels_are_those_of_diagnostic_msgs() {
    let levels = [Level::Ok, Level::Warn, Level::Error, Level::Stale].map(|level| level as u8);
    assert_eq!(levels, [0, 1, 2, 3]);
}

#[test]
fn one_command_without_equilibrium_is_a_warning_and_three_in_a_row_are_an_error() {
    let level = |failing| solver::status(&Vitals { failing, ..Vitals::default() }).level;
    let levels = [0, 1, 2, 3, 9].map(level);
    assert_eq!(levels, [Level::Ok, Level::Warn, Level::Warn, Level::Error, Level::Error]);
}

#[test]
fn refusals_warn_for_a_while_and_stay_counted() {
    let mut past = intake::Past::default();
    let status = past.status(&refused(Disposition::Limit, 2), &Arrivals::default());
    assert_eq!((status.level, value(&status, "refused: beyond a limit")), (Level::Warn, "2"));
    assert_eq!(value(&status, "refused: too old"), "0");
    for _ in 0..10 {
        past.status(&refused(Disposition::Limit, 2), &Arrivals::default());
    }
    let status = past.status(&refused(Disposition::Limit, 2), &Arrivals::default());
    assert_eq!((status.level, value(&status, "refused: beyond a limit")), (Level::Ok, "2"));
}

#[test]
fn every_reason_of_a_refusal_is_told() {
    let served = [Disposition::Applied, Disposition::Clamped, Disposition::Duplicate];
    for number in 0..crate::node::health::DISPOSITIONS {
        let mut vitals = Vitals::default();
        vitals.refused[number] = 1;
        let status = intake::Past::default().status(&vitals, &Arrivals::default());
        let told = status
            .values
            .iter()
            .filter(|pair| pair.key.starts_with("refused"))
            .any(|pair| pair.value == "1");
        assert_eq!(told, !served.iter().any(|one| *one as usize == number), "{number}");
    }
}

#[test]
fn a_rig_that_was_there_and_is_silent_is_stale_and_one_that_never_came_is_not() {
    let status = |silence, on_hold| {
        let vitals = Vitals { silence, on_hold, ..Vitals::default() };
        intake::Past::default().status(&vitals, &Arrivals::default()).level
    };
    let long = Some(SILENCE + Duration::from_secs(1));
    assert_eq!(status(None, false), Level::Ok);
    assert_eq!(status(Some(Duration::from_secs(1)), false), Level::Ok);
    assert_eq!(status(long, false), Level::Stale);
    assert_eq!(status(long, true), Level::Warn);
}

#[test]
fn a_recorder_warns_of_a_full_disk_before_it_fails() {
    let full = RecordingState { free: Some(5 << 20), ..RecordingState::default() };
    let status = recorder::status(Some(full.clone()));
    assert_eq!((status.level, &*status.message), (Level::Warn, "the disk has 5 MiB left"));
    let failed = RecordingState { failure: Some("no room".into()), ..full };
    let status = recorder::status(Some(failed));
    assert_eq!((status.level, &*status.message), (Level::Error, "no room"));
    let off = recorder::status(None);
    assert_eq!((off.level, &*off.message), (Level::Ok, "off"));
}

#[test]
fn a_link_warns_of_what_it_leaves_out_and_errs_when_it_loses() {
    let level = |traffic: &Traffic| link::Past::default().status(traffic).level;
    let ok = Traffic { waiting: 3, listeners: vec![("report", 2)], ..Traffic::default() };
    assert_eq!(level(&ok), Level::Ok);
    assert_eq!(level(&Traffic { skipped: 1, ..ok.clone() }), Level::Warn);
    assert_eq!(level(&Traffic { waiting: 5000, ..ok.clone() }), Level::Warn);
    assert_eq!(level(&Traffic { skipped: 1, lost: 1, ..ok }), Level::Error);
}

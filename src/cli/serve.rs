//! The loop of `run`: commands in, answers to every sink.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use anyhow::anyhow;

use graintwin::command::circumstance::{Circumstance, Happened};
use graintwin::command::merge::mergeable;
use graintwin::command::request::{Asked, Intake, Request};
use graintwin::command::{Command, Disposition, Stamp};
use graintwin::report::{Demand, Report};
use graintwin::scene::{Late, ModuliKind, Outputs, When};
use graintwin::sink::{Served, Sink};
use graintwin::twin::{Merged, Twin};

use super::Failure;
use super::source::Source;

/// Most commands that are looked at to be merged.
const MOST_WAITING: usize = 1024;

/// Relaxes the pack: increment 0.
pub(super) fn start(
    twin: &mut Twin,
    outputs: Outputs,
    sinks: &mut [Box<dyn Sink + '_>],
) -> Result<(), Failure> {
    let first = timed(|| twin.start(demand(outputs, sinks)));
    let failed = first.disposition == Disposition::NotConverged;
    let why = failed.then(|| first.text.clone());
    hand_over(None, first, sinks);
    match why {
        None => Ok(()),
        Some(why) => Err(Failure::Other(anyhow!("no equilibrium to start from: {why}"))),
    }
}

/// Serves what comes from `source` until it ends or `stop` is set. `late` says what happens to
/// commands that wait, until the source changes it.
pub(super) fn serve(
    twin: &mut Twin,
    (outputs, mut late): (Outputs, Late),
    source: &mut dyn Source,
    sinks: &mut [Box<dyn Sink + '_>],
    stop: &AtomicBool,
) {
    let mut waiting = VecDeque::new();
    while let Some(intake) = waiting.pop_front().or_else(|| source.next()) {
        if stop.load(Ordering::SeqCst) {
            waiting.push_front(intake);
            break;
        }
        if let Some((settings, now_late)) = source.changed() {
            twin.set(&settings);
            late = now_late;
            tell(twin, Circumstance::Settings(settings), sinks);
        }
        match intake {
            Intake::Command(command) if late == Late::Merge => {
                waiting.push_front(Intake::Command(command));
                source.overtake(&mut waiting, MOST_WAITING);
                merged(twin, outputs, &mut waiting, sinks);
            }
            Intake::Command(command) => {
                serve_one(twin, outputs, command, sinks);
            }
            Intake::Malformed(command, text) => {
                let report = twin.refuse(&command, text.clone());
                tell(twin, Circumstance::Malformed(text), sinks);
                hand_over(Some(command), report, sinks);
            }
            Intake::Request(asked) => answer(twin, outputs, asked, sinks),
        }
    }
    for intake in waiting {
        if let Intake::Request(asked) = intake {
            asked.answer(Err("the twin is stopping".into()));
        }
    }
}

fn serve_one(
    twin: &mut Twin,
    outputs: Outputs,
    command: Command,
    sinks: &mut [Box<dyn Sink + '_>],
) {
    let report = timed(|| twin.apply(&command, demand(outputs, sinks)));
    if let (Disposition::Stale, Some(age)) = (report.disposition, command.age) {
        tell(twin, Circumstance::Age(age), sinks);
    }
    hand_over(Some(command), report, sinks);
}

/// Serves the first of `waiting`, which is a command, with those behind it that can be merged.
fn merged(
    twin: &mut Twin,
    outputs: Outputs,
    waiting: &mut VecDeque<Intake>,
    sinks: &mut [Box<dyn Sink + '_>],
) {
    let count = mergeable(twin.setpoint(), &*waiting).max(1);
    let commands: Vec<Command> = waiting
        .drain(..count)
        .filter_map(|intake| match intake {
            Intake::Command(command) => Some(command),
            Intake::Malformed(..) | Intake::Request(_) => None,
        })
        .collect();
    let start = Instant::now();
    let mut commands = VecDeque::from(commands);
    match twin.apply_merged(commands.make_contiguous(), demand(outputs, sinks)) {
        Merged::Together(mut reports) => {
            if let Some(report) = reports.last_mut() {
                took(report, start);
            }
            let together = commands.drain(..reports.len()).collect::<Vec<_>>();
            for (command, report) in together.into_iter().zip(reports) {
                hand_over(Some(command), report, sinks);
            }
        }
        Merged::Apart(count) => {
            for command in commands.drain(..count) {
                serve_one(twin, outputs, command, sinks);
            }
        }
    }
    for command in commands.into_iter().rev() {
        waiting.push_front(Intake::Command(command));
    }
}

/// Does what was asked, and answers.
fn answer(twin: &mut Twin, outputs: Outputs, asked: Asked, sinks: &mut [Box<dyn Sink + '_>]) {
    let mut first = None;
    let answer = match &asked.request {
        Request::Reset => {
            let report = timed(|| twin.reset(ordered(outputs, Demand::ALL)));
            let answer = match report.disposition {
                Disposition::NotConverged => Err(report.text.clone()),
                _ => Ok("increment 0 again; no command is remembered".into()),
            };
            first = Some(report);
            answer
        }
        Request::SavePack(file) => twin.save_pack(file),
        Request::Hold(held) => twin.hold(*held),
        Request::ResetFaults => Ok(twin.reset_faults()),
    };
    tell(twin, Circumstance::Asked(asked.request.clone(), answer.clone()), sinks);
    // Every sink gets increment 0 whole, as at the start.
    if let Some(report) = first {
        hand_over(None, report, sinks);
    }
    asked.answer(answer);
}

/// What the scene orders and what the sinks want of the next increment.
pub(super) fn demand(outputs: Outputs, sinks: &[Box<dyn Sink + '_>]) -> Demand {
    let wanted = sinks.iter().map(|sink| sink.demand()).fold(Demand::default(), Demand::or);
    ordered(outputs, wanted)
}

/// What of `wanted` the scene allows, and what it orders.
pub(super) fn ordered(outputs: Outputs, wanted: Demand) -> Demand {
    Demand {
        state: wanted.state,
        moduli: wanted.moduli && outputs.moduli != ModuliKind::None,
        tangent: wanted.tangent && outputs.moduli.takes_tangent(),
        contact_network: when(outputs.contact_network, wanted.contact_network),
        grains: when(outputs.markers, wanted.grains),
        grain_motion: when(outputs.grain_motion, wanted.grain_motion),
        fabric: when(outputs.fabric, wanted.fabric),
        hydrate: wanted.hydrate,
        shear: wanted.shear,
        plane: wanted.plane,
        rearrangements: when(outputs.rearrangements, wanted.rearrangements),
        snapshots: when(outputs.snapshots, wanted.snapshots),
        bonds: when(outputs.bonds, wanted.bonds),
        cracks: when(outputs.cracks, wanted.cracks),
    }
}

/// Whether something is computed that is `wanted` or not.
fn when(ordered: When, wanted: bool) -> bool {
    match ordered {
        When::Always => true,
        When::OnDemand => wanted,
        When::Never => false,
    }
}

/// The twin has no clock: the time an answer took is filled in here.
fn timed(answer: impl FnOnce() -> Report) -> Report {
    let start = Instant::now();
    let mut report = answer();
    took(&mut report, start);
    report
}

pub(super) fn took(report: &mut Report, start: Instant) {
    if let Some(state) = report.measures.as_mut().and_then(|measures| measures.state.as_mut()) {
        state.solve_seconds = start.elapsed().as_secs_f64();
    }
}

/// Tells every sink of what else bears on the answers.
fn tell(twin: &Twin, what: Circumstance, sinks: &mut [Box<dyn Sink + '_>]) {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let nanoseconds = i64::try_from(since.as_nanos()).unwrap_or(i64::MAX);
    let stamp = Stamp::default().later(nanoseconds).unwrap_or_default();
    let happened = Happened { increment: twin.increment(), stamp, what };
    for sink in sinks {
        sink.happened(&happened);
    }
}

fn hand_over(command: Option<Command>, report: Report, sinks: &mut [Box<dyn Sink + '_>]) {
    give(Served { command, report }, sinks);
}

/// Hands an answer to every sink.
pub(super) fn give(served: Served, sinks: &mut [Box<dyn Sink + '_>]) {
    let served = Arc::new(served);
    for sink in sinks {
        sink.served(&served);
    }
}

#[cfg(all(test, feature = "mcap"))]
mod replayed;
#[cfg(test)]
mod tests;

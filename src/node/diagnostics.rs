//! How the program fares, once a second on `/diagnostics`: the solver, the intake of commands,
//! the recorder, the link to the others.

mod intake;
mod link;
mod recent;
mod recorder;
mod solver;

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::time::{MissedTickBehavior, interval};

use super::clock::Clock;
use super::counters::Counters;
use super::discrepancy::{Recorder, record};
use super::endpoints::Endpoints;
use crate::command::request::Intake;
use crate::msg::{DiagnosticArray, DiagnosticStatus, Header, KeyValue};
use crate::sink::Beside;

const PERIOD: Duration = Duration::from_secs(1);

/// The levels of a status.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Level {
    Ok = 0,
    Warn = 1,
    Error = 2,
    Stale = 3,
}

/// A status in the making.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Status {
    level: Level,
    part: &'static str,
    message: String,
    values: Vec<KeyValue>,
}

impl Status {
    fn new(part: &'static str, message: impl Into<String>) -> Self {
        Self { level: Level::Ok, part, message: message.into(), values: Vec::new() }
    }

    /// Says this instead of what it said.
    fn say(&mut self, level: Level, message: impl Into<String>) {
        self.level = level;
        self.message = message.into();
    }

    fn value(&mut self, key: impl Into<String>, value: &dyn fmt::Display) {
        self.values.push(KeyValue { key: key.into(), value: value.to_string() });
    }

    fn message(self, hardware_id: &str) -> DiagnosticStatus {
        DiagnosticStatus {
            level: self.level as u8,
            name: format!("graintwin: {}", self.part),
            message: self.message,
            hardware_id: hardware_id.into(),
            values: self.values,
        }
    }
}

/// What the diagnostics look at.
pub(super) struct Watched {
    pub endpoints: Arc<Endpoints>,
    pub counters: Arc<Counters>,
    pub commands: mpsc::WeakSender<Intake>,
    pub recorder: Recorder,
    pub clock: Clock,
    pub hardware_id: String,
}

impl Watched {
    /// Publishes for ever.
    pub(super) async fn run(self) {
        let mut intake = intake::Past::default();
        let mut link = link::Past::default();
        let mut ticks = interval(PERIOD);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            ticks.tick().await;
            let vitals = self.counters.health.vitals();
            let all = [
                solver::status(&vitals),
                intake.status(&vitals, &self.arrivals()),
                recorder::status(self.recorder.get().map(|recorder| recorder.state())),
                link.status(&self.traffic()),
            ];
            let status = all.into_iter().map(|one| one.message(&self.hardware_id)).collect();
            let header = Header { stamp: self.clock.now().into(), frame_id: String::new() };
            let message = DiagnosticArray { header, status };
            record(&self.recorder, || Beside::Diagnostics(message.clone()));
            // What is lost is said in the log, and the next one says it again.
            self.endpoints.diagnostics.publish(message).await;
        }
    }

    fn arrivals(&self) -> intake::Arrivals {
        let waiting = |queue: mpsc::Sender<_>| queue.max_capacity() - queue.capacity();
        intake::Arrivals {
            received: count(&self.counters.commands),
            unreadable: count(&self.counters.unreadable),
            waiting: self.commands.upgrade().map_or(0, waiting),
        }
    }

    fn traffic(&self) -> link::Traffic {
        let counters = &self.counters;
        link::Traffic {
            listeners: self.endpoints.listeners(),
            published: count(&counters.published),
            lost: count(&counters.lost),
            // Two counts that are not read at the same time.
            waiting: count(&counters.queued).saturating_sub(count(&counters.done)),
            frames: count(&counters.frames_sent),
            skipped: count(&counters.frames_skipped),
            pictures: count(&counters.pictures_sent),
            pictures_skipped: count(&counters.pictures_skipped),
        }
    }
}

fn count(counter: &AtomicU64) -> u64 {
    counter.load(Ordering::Relaxed)
}

#[cfg(test)]
mod tests;

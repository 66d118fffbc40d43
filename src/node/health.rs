//! How the solver and the intake fare: numbers that their threads leave for the diagnostics,
//! without a lock.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use crate::command::Disposition;
use crate::command::request::Request;
use crate::sink::Served;

/// Kinds of [`Disposition`].
pub(super) const DISPOSITIONS: usize = Disposition::Held as usize + 1;

/// Stands for a time that never was.
const NEVER: u64 = u64::MAX;

/// Written by the solver's thread and the receiving tasks, read by the diagnostics.
#[derive(Debug)]
pub(super) struct Health {
    start: Instant,
    /// When the newest command arrived, in nanoseconds since the start.
    newest: AtomicU64,
    accepted: AtomicU64,
    repeated: AtomicU64,
    refused: [AtomicU64; DISPOSITIONS],
    increment: AtomicU64,
    /// Commands in a row that found no equilibrium.
    failing: AtomicU64,
    iterations: AtomicU64,
    residual: AtomicU64,
    solve_seconds: AtomicU64,
    hold_asked: AtomicBool,
    last_held: AtomicBool,
    /// Samples of load cells that were of no use.
    unused: AtomicU64,
}

/// What [`Health`] held at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Vitals {
    /// Since the newest command arrived; `None` when none ever did.
    pub silence: Option<Duration>,
    /// Commands served.
    pub accepted: u64,
    /// Commands that had been served before.
    pub repeated: u64,
    /// Commands refused, by [`Disposition`].
    pub refused: [u64; DISPOSITIONS],
    /// The last increment.
    pub increment: u64,
    /// Commands in a row that found no equilibrium.
    pub failing: u64,
    /// Iterations of the last increment.
    pub iterations: u64,
    /// Its relative residual.
    pub residual: f64,
    /// Wall-clock time that it took \[s\].
    pub solve_seconds: f64,
    /// Whether commands are refused as held.
    pub on_hold: bool,
    /// Samples of load cells that were of no use.
    pub unused: u64,
}

impl Default for Health {
    fn default() -> Self {
        Self {
            start: Instant::now(),
            newest: NEVER.into(),
            accepted: 0.into(),
            repeated: 0.into(),
            refused: Default::default(),
            increment: 0.into(),
            failing: 0.into(),
            iterations: 0.into(),
            residual: 0.into(),
            solve_seconds: 0.into(),
            hold_asked: false.into(),
            last_held: false.into(),
            unused: 0.into(),
        }
    }
}

impl Health {
    /// A command has arrived.
    pub(super) fn arrived(&self) {
        let since = u64::try_from(self.start.elapsed().as_nanos()).unwrap_or(NEVER - 1);
        self.newest.store(since, Ordering::Relaxed);
    }

    /// A sample of a load cell was of no use.
    pub(super) fn unused(&self) {
        self.unused.fetch_add(1, Ordering::Relaxed);
    }

    /// A command was served or refused.
    pub(super) fn served(&self, served: &Served) {
        let report = &served.report;
        self.increment.store(report.increment, Ordering::Relaxed);
        let state = report.measures.as_ref().and_then(|measures| measures.state.as_ref());
        if let Some(state) = state {
            self.iterations.store(state.iterations.into(), Ordering::Relaxed);
            self.residual.store(state.residual.to_bits(), Ordering::Relaxed);
            self.solve_seconds.store(state.solve_seconds.to_bits(), Ordering::Relaxed);
        }
        if served.command.is_none() {
            return;
        }
        let disposition = report.disposition;
        self.last_held.store(disposition == Disposition::Held, Ordering::Relaxed);
        let moved = report.measures.is_some()
            || matches!(disposition, Disposition::Applied | Disposition::Clamped);
        if moved {
            self.failing.store(0, Ordering::Relaxed);
            self.accepted.fetch_add(1, Ordering::Relaxed);
        } else if disposition == Disposition::Duplicate {
            self.repeated.fetch_add(1, Ordering::Relaxed);
        } else {
            self.refused[disposition as usize].fetch_add(1, Ordering::Relaxed);
            if disposition == Disposition::NotConverged {
                self.failing.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    /// A request was done.
    pub(super) fn done(&self, request: &Request) {
        match request {
            Request::Hold(on) => {
                self.hold_asked.store(*on, Ordering::Relaxed);
                self.last_held.fetch_and(*on, Ordering::Relaxed);
            }
            // A fault that holds is kept.
            Request::Reset => self.failing.store(0, Ordering::Relaxed),
            Request::ResetFaults => {
                self.last_held.store(false, Ordering::Relaxed);
                self.failing.store(0, Ordering::Relaxed);
            }
            Request::SavePack(_) => {}
        }
    }

    /// Everything, as it is now.
    pub(super) fn vitals(&self) -> Vitals {
        let count = |number: &AtomicU64| number.load(Ordering::Relaxed);
        let newest = Some(count(&self.newest)).filter(|newest| *newest != NEVER);
        let silence = |newest| self.start.elapsed().saturating_sub(Duration::from_nanos(newest));
        Vitals {
            silence: newest.map(silence),
            accepted: count(&self.accepted),
            repeated: count(&self.repeated),
            refused: std::array::from_fn(|number| count(&self.refused[number])),
            increment: count(&self.increment),
            failing: count(&self.failing),
            iterations: count(&self.iterations),
            residual: f64::from_bits(count(&self.residual)),
            solve_seconds: f64::from_bits(count(&self.solve_seconds)),
            on_hold: self.hold_asked.load(Ordering::Relaxed)
                || self.last_held.load(Ordering::Relaxed),
            unused: count(&self.unused),
        }
    }
}

#[cfg(test)]
mod tests;

//! Answers on their way from the twin, and those who want them.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use ::foxglove::SinkId;

use super::outlets::Outlet;
use crate::report::{Measures, Report};
use crate::sink::Served;

/// Answers that wait with their contact network or grains: a network of 10^6 contacts is 73 MB.
const MOST_WHOLE: usize = 4;

/// Answers that wait at all. They are emptied at the speed of encoding, which waits for no client;
/// so the twin waits here only if it should be faster than that.
const MOST: usize = 4096;

/// An answer that waits.
#[derive(Clone)]
pub(super) struct Waiting {
    pub(super) served: Arc<Served>,
    /// When it came \[ns since 1970\].
    pub(super) time: u64,
}

/// What is to be done next.
pub(super) struct Work {
    /// Who subscribed since the last answer.
    pub(super) newcomers: Vec<(Outlet, SinkId)>,
    /// The next answer, and who gets it.
    pub(super) answer: Option<(Waiting, Vec<(Outlet, SinkId)>)>,
}

/// Between the twin, the clients, and the thread that encodes.
#[derive(Default)]
pub(super) struct Queue {
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    answers: VecDeque<Waiting>,
    newcomers: BTreeSet<(Outlet, SinkId)>,
    listeners: BTreeSet<(Outlet, SinkId)>,
    skipped: u64,
    ended: bool,
}

impl Queue {
    /// Takes an answer of the twin.
    pub(super) fn put(&self, served: Arc<Served>) {
        let mut state = self.lock();
        while state.answers.len() >= MOST && !state.ended {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        if state.ended {
            return;
        }
        state.answers.push_back(Waiting { served, time: now() });
        state.lighten();
        drop(state);
        self.changed.notify_all();
    }

    pub(super) fn came(&self, who: (Outlet, SinkId)) {
        self.lock().newcomers.insert(who);
        self.changed.notify_all();
    }

    pub(super) fn left(&self, who: (Outlet, SinkId)) {
        let mut state = self.lock();
        state.newcomers.remove(&who);
        state.listeners.remove(&who);
    }

    /// Takes no more; what waits is still handed out.
    pub(super) fn end(&self) {
        self.lock().ended = true;
        self.changed.notify_all();
    }

    pub(super) fn skipped(&self) -> u64 {
        self.lock().skipped
    }

    /// Waits for something to do; `None` at the end.
    pub(super) fn take(&self) -> Option<Work> {
        let mut state = self.lock();
        while state.answers.is_empty() && state.newcomers.is_empty() {
            if state.ended {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let newcomers = std::mem::take(&mut state.newcomers);
        state.listeners.extend(&newcomers);
        let newcomers = newcomers.into_iter().collect();
        let next = state.answers.pop_front();
        let answer = next.map(|next| (next, state.listeners.iter().copied().collect()));
        drop(state);
        self.changed.notify_all();
        Some(Work { newcomers, answer })
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Takes network and grains from the oldest answers when too many wait with them.
    fn lighten(&mut self) {
        let whole = self.answers.iter().filter(|waiting| is_whole(&waiting.served)).count();
        let too_many = whole.saturating_sub(MOST_WHOLE);
        for waiting in
            self.answers.iter_mut().filter(|waiting| is_whole(&waiting.served)).take(too_many)
        {
            waiting.served = Arc::new(light(&waiting.served));
            self.skipped += 1;
        }
    }
}

fn is_whole(served: &Served) -> bool {
    let measures = served.report.measures.as_ref();
    measures.is_some_and(|measures| measures.network.is_some() || measures.grains.is_some())
}

/// The same answer without network and grains.
fn light(served: &Served) -> Served {
    let Report { stamp, sequence, increment, disposition, substeps, .. } = served.report;
    let (session, text) = (served.report.session.clone(), served.report.text.clone());
    let measures = served.report.measures.as_ref().map(|measures| {
        let Measures { stamp, increment, walls, wall_force_error, state, moduli, .. } = *measures;
        let events = measures.events.clone();
        let (network, grains) = (None, None);
        Measures {
            stamp,
            increment,
            events,
            walls,
            wall_force_error,
            state,
            moduli,
            network,
            grains,
        }
    });
    let report =
        Report { stamp, session, sequence, increment, disposition, substeps, text, measures };
    Served { command: served.command.clone(), report }
}

/// Nanoseconds since 1970; 0 when the clock says that it is earlier.
fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

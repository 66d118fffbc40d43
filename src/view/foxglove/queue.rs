//! Answers on their way from the twin, and those who want them.

use std::collections::{BTreeSet, VecDeque};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

use ::foxglove::SinkId;

use super::outlets::Outlet;
use crate::report::{Measures, Report};
use crate::sink::Served;

/// Answers that wait with their contact network, grains or motion: a network of 10^6 contacts is 73 MB.
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
pub(super) struct Queue {
    /// The outlets that need networks, grains or their motion.
    pictures: Vec<Outlet>,
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
    pub(super) fn new(pictures: Vec<Outlet>) -> Self {
        Self { pictures, state: Mutex::default(), changed: Condvar::new() }
    }

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
        let lightened = state.lighten();
        let mut looking = state.listeners.iter().chain(&state.newcomers);
        if looking.any(|(outlet, _)| self.pictures.contains(outlet)) {
            state.skipped += lightened;
        }
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
    /// Takes network, grains and their motion from the oldest answers when too many wait with them; returns from
    /// how many.
    fn lighten(&mut self) -> u64 {
        let whole = self.answers.iter().filter(|waiting| is_whole(&waiting.served)).count();
        let too_many = whole.saturating_sub(MOST_WHOLE);
        for waiting in
            self.answers.iter_mut().filter(|waiting| is_whole(&waiting.served)).take(too_many)
        {
            waiting.served = Arc::new(light(&waiting.served));
        }
        too_many as u64
    }
}

fn is_whole(served: &Served) -> bool {
    let measures = served.report.measures.as_ref();
    measures.is_some_and(|measures| {
        measures.network.is_some()
            || measures.bonds.is_some()
            || measures.grains.is_some()
            || measures.motion.is_some()
    })
}

/// The same answer without network, bonds, grains and their motion.
fn light(served: &Served) -> Served {
    let Report { stamp, sequence, increment, disposition, substeps, .. } = served.report;
    let (session, text) = (served.report.session.clone(), served.report.text.clone());
    let measures = served.report.measures.as_ref().map(|measures| {
        let Measures { stamp, increment, walls, wall_force_error, state, moduli, tangent, .. } =
            *measures;
        // Events are rare: what is told of them is kept.
        let events = measures.events.clone();
        let fabric = measures.fabric.clone();
        let hydrate = measures.hydrate;
        let shear = measures.shear;
        let plane = measures.plane.clone();
        let rearrangements = measures.rearrangements.clone();
        let snapshots = measures.snapshots.clone();
        let cracks = measures.cracks.clone();
        let (network, bonds, grains, motion) = (None, None, None, None);
        Measures {
            stamp,
            increment,
            events,
            rearrangements,
            snapshots,
            walls,
            wall_force_error,
            state,
            moduli,
            tangent,
            network,
            grains,
            surfaces: Vec::new(),
            motion,
            fabric,
            hydrate,
            shear,
            plane,
            bonds,
            cracks,
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

#[cfg(test)]
mod tests {
    use std::num::NonZeroU64;

    use super::*;
    use crate::command::{Ask, Command, Mode, Stamp};
    use crate::pack::{Grain, Pack};
    use crate::report::Demand;
    use crate::twin::Twin;
    use crate::wall::Bounds;

    /// Answers to `count` commands of a grain between walls, everything measured.
    fn answers(count: u64) -> Vec<Arc<Served>> {
        let scene = crate::scene::parse("pack: {file: none.csv}", "s.yaml".as_ref()).unwrap();
        let (young, poisson, density, friction) = (70e9, 0.2, 2.5e3, 0.0);
        let grain = Grain {
            position: [0.0; 3],
            radius: 1e-3,
            young,
            poisson,
            density,
            friction,
            hydrate: false,
        };
        let bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };
        let pack = Pack { bounds, grains: vec![grain], history: None };
        let mut twin = Twin::new(&scene, &pack, 1).unwrap();
        twin.start(Demand::ALL);
        let command = |sequence: u64| Command {
            stamp: Stamp::default(),
            session: "a".into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, 0.0, 1e-8 * sequence as f64]),
            age: None,
        };
        let mut serve = |command: Command| {
            let report = twin.apply(&command, Demand::ALL);
            Arc::new(Served { command: Some(command), report })
        };
        (1..=count).map(|sequence| serve(command(sequence))).collect()
    }

    fn drain(queue: &Queue) -> Vec<Arc<Served>> {
        std::iter::from_fn(|| queue.take())
            .filter_map(|work| work.answer)
            .map(|(waiting, _)| waiting.served)
            .collect()
    }

    #[test]
    fn when_it_is_behind_the_oldest_pictures_are_left_out_and_no_answer() {
        let outlets = super::super::Outlets::new(::foxglove::Context::new()).unwrap();
        let queue = Queue::new(outlets.pictures());
        let looks = outlets.pictures()[0];
        queue.came((looks, SinkId::new(NonZeroU64::MIN)));
        let more = 3;
        for served in answers(MOST_WHOLE as u64 + more) {
            queue.put(served);
        }
        queue.end();
        assert_eq!(queue.skipped(), more);
        let out = drain(&queue);
        for (k, served) in out.iter().enumerate() {
            let k = k as u64 + 1;
            assert_eq!(served.command.as_ref().unwrap().sequence, k);
            assert_eq!(served.report.sequence, k);
            let measures = served.report.measures.as_ref().unwrap();
            assert_eq!(measures.increment, k);
            assert!(measures.state.is_some() && measures.moduli.is_some());
            assert_eq!(measures.network.is_some() && measures.grains.is_some(), k > more);
        }
        assert_eq!(out.len() as u64, MOST_WHOLE as u64 + more);
    }

    #[test]
    fn nobody_misses_pictures_that_nobody_looks_at() {
        let outlets = super::super::Outlets::new(::foxglove::Context::new()).unwrap();
        let queue = Queue::new(outlets.pictures());
        answers(MOST_WHOLE as u64 + 1).into_iter().for_each(|served| queue.put(served));
        assert_eq!(queue.skipped(), 0);
    }

    #[test]
    fn who_has_left_gets_nothing() {
        let outlets = super::super::Outlets::new(::foxglove::Context::new()).unwrap();
        let queue = Queue::new(Vec::new());
        let who = |id| (outlets.pictures()[0], SinkId::new(NonZeroU64::new(id).unwrap()));
        (1..=3).for_each(|id| queue.came(who(id)));
        queue.left(who(1));
        assert_eq!(queue.take().unwrap().newcomers, [who(2), who(3)]);
        queue.left(who(2));
        queue.put(answers(1).remove(0));
        let Work { newcomers, answer } = queue.take().unwrap();
        assert_eq!((newcomers, answer.unwrap().1), (vec![], vec![who(3)]));
    }
}

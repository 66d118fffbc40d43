//! The real rig beside the twin: what its load cells measure, and how the twin compares.

use std::pin::pin;
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use futures::StreamExt;
use ros2_client::Subscription;
use tokio::sync::mpsc;
use tokio::task::block_in_place;
use tokio::time::sleep;

use super::counters::Counters;
use super::outbox::{Item, Outgoing};
use crate::measure::discrepancy::{Cells, Discrepancy, Pairing};
use crate::msg::{WrenchStamped, convert};
use crate::sink::{Beside, Recording, Served};

/// How often increments that wait for a silent load cell are looked at.
const LOOK: Duration = Duration::from_millis(50);

/// A recording that may be there.
pub(super) type Recorder = Arc<OnceLock<Arc<dyn Recording>>>;

/// Records what a task of the node has to tell, if there is a recording. The disk may keep this task
/// waiting, and no other.
pub(super) fn record(recorder: &Recorder, beside: impl FnOnce() -> Beside) {
    if let Some(recording) = recorder.get() {
        block_in_place(|| recording.beside(beside()));
    }
}

/// Pairs increments with measurements and hands the result on, in order.
pub(super) struct Comparison {
    pairing: Mutex<Pairing>,
    start: Instant,
    outbox: mpsc::UnboundedSender<Item>,
    recorder: Recorder,
    counters: Arc<Counters>,
}

impl Comparison {
    pub(super) fn new(
        cells: Cells,
        outbox: mpsc::UnboundedSender<Item>,
        recorder: Recorder,
        counters: Arc<Counters>,
    ) -> Self {
        let pairing = Mutex::new(Pairing::new(cells));
        Self { pairing, start: Instant::now(), outbox, recorder, counters }
    }

    /// Takes an answer of the twin.
    pub(super) fn served(&self, served: &Served) {
        let Some(measures) = &served.report.measures else { return };
        let (stamp, twin) = (measures.stamp, measures.walls.normal_force);
        let mut pairing = self.pairing();
        if served.command.is_some() {
            pairing.served(stamp, measures.increment, twin, self.start.elapsed());
            self.hand_on_ready(&mut pairing);
        } else {
            // Nothing that was before belongs to what comes after.
            self.hand_on_all(&mut pairing);
            let first = Discrepancy::unmeasured(stamp, measures.increment, twin);
            self.hand_on(&first, Item::Initial);
        }
    }

    /// Takes what the load cell of `wall` measured.
    fn measured(&self, wall: usize, sample: WrenchStamped) {
        let force = sample.wrench.force;
        let stamp = sample.header.stamp.into();
        let mut pairing = self.pairing();
        if !pairing.measured(wall, stamp, [force.x, force.y, force.z]) {
            self.counters.health.unused();
        }
        if let Some(recorder) = self.recorder.get() {
            recorder.beside(Beside::Measured(wall, sample));
        }
        self.hand_on_ready(&mut pairing);
    }

    /// Hands on what waits, whether or not its measurements have come.
    pub(super) fn flush(&self) {
        self.hand_on_all(&mut self.pairing());
    }

    fn pairing(&self) -> MutexGuard<'_, Pairing> {
        self.pairing.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn hand_on_ready(&self, pairing: &mut Pairing) {
        while let Some(found) = pairing.ready(self.start.elapsed()) {
            self.hand_on(&found, Item::Answer);
        }
    }

    fn hand_on_all(&self, pairing: &mut Pairing) {
        while let Some(found) = pairing.take_oldest() {
            self.hand_on(&found, Item::Answer);
        }
    }

    fn hand_on(&self, found: &Discrepancy, as_item: fn(Vec<Outgoing>) -> Item) {
        let message = convert::discrepancy(found);
        if let Some(recorder) = self.recorder.get() {
            recorder.beside(Beside::Discrepancy(message.clone()));
        }
        self.counters.queued.fetch_add(1, Ordering::Relaxed);
        // Fails only when the node has stopped; its summary then counts the message as lost.
        self.outbox.send(as_item(vec![Outgoing::Discrepancy(message)])).ok();
    }
}

/// Takes every sample of the load cell of `wall`.
pub(super) async fn receive(
    wall: usize,
    subscription: Subscription<WrenchStamped>,
    comparison: Arc<Comparison>,
) {
    let mut samples = pin!(subscription.async_stream());
    while let Some(sample) = samples.next().await {
        match sample {
            // The recorder may keep us waiting.
            Ok((sample, _)) => block_in_place(|| comparison.measured(wall, sample)),
            Err(error) => {
                comparison.counters.unreadable.fetch_add(1, Ordering::Relaxed);
                tracing::error!("a measurement is lost, its bytes are no WrenchStamped: {error}");
            }
        }
    }
}

/// Lets go what waited long enough.
pub(super) async fn look(comparison: Arc<Comparison>) {
    loop {
        sleep(LOOK).await;
        block_in_place(|| comparison.hand_on_ready(&mut comparison.pairing()));
    }
}

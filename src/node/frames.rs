//! Contact networks on their way to their topic: in chunks, no faster than the network takes them,
//! and left out when too many wait.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio::time::{Instant, sleep_until};

use super::counters::Counters;
use super::endpoints::Endpoints;
use crate::msg::convert::{self, LIVE_CHUNK};
use crate::report::ContactNetwork;
use crate::sink::Served;

/// Bytes that go out in a second. More outruns the receive buffer of a stock Linux, and the repair
/// of lost samples is twenty times slower than this.
const BYTES_PER_SECOND: f64 = 20e6;

/// Shortest wait worth taking, since the timer does not know a shorter one.
const TICK: Duration = Duration::from_millis(1);

/// Bytes of one contact in a message: two indices, eight floats, a state.
const CONTACT: usize = 2 * 4 + 8 * 8 + 1;

/// Bytes of a message around its contacts, at most: header, lengths, padding, datagram.
const ENVELOPE: usize = 256;

/// KiB of contact networks that may wait: a bit over three seconds of the network.
const ROOM: usize = 64 * 1024;

/// One contact network that waits to be sent. Dropping it makes room for another.
pub(super) struct Frame {
    served: Arc<Served>,
    _room: OwnedSemaphorePermit,
}

/// Decides which contact networks may wait.
pub(super) struct Frames {
    room: Arc<Semaphore>,
    counters: Arc<Counters>,
}

impl Frames {
    pub(super) fn new(counters: Arc<Counters>) -> Self {
        Self { room: Arc::new(Semaphore::new(ROOM)), counters }
    }

    /// The contact network of `served` as a frame, when there is one and room for it.
    pub(super) fn take(&self, served: &Arc<Served>) -> Option<Frame> {
        let network = served.report.measures.as_ref()?.network.as_ref()?;
        let Ok(room) = Arc::clone(&self.room).try_acquire_many_owned(kibibytes(network)) else {
            self.counters.frames_skipped.fetch_add(1, Ordering::Relaxed);
            return None;
        };
        self.counters.frames_queued.fetch_add(1, Ordering::Relaxed);
        Some(Frame { served: Arc::clone(served), _room: room })
    }
}

/// Size of a network on the wire, at most the whole room: a single frame must always fit.
fn kibibytes(network: &ContactNetwork) -> u32 {
    (bytes(network.first.len()) / 1024 + 1).min(ROOM) as u32
}

fn bytes(contacts: usize) -> usize {
    contacts * CONTACT + ENVELOPE
}

/// Publishes `frames` one after the other, chunk by chunk, each chunk at least its own time on the
/// wire after the one before it. Lost time is not caught up: a burst is what loses samples.
pub(super) async fn send(
    mut frames: mpsc::UnboundedReceiver<Frame>,
    endpoints: Arc<Endpoints>,
    counters: Arc<Counters>,
) {
    let mut free = Instant::now();
    while let Some(frame) = frames.recv().await {
        let Some(measures) = &frame.served.report.measures else { continue };
        let mut whole = true;
        for chunk in convert::network_chunks(measures, LIVE_CHUNK) {
            if free.saturating_duration_since(Instant::now()) >= TICK {
                sleep_until(free).await;
            }
            let seconds = bytes(chunk.first.len()) as f64 / BYTES_PER_SECOND;
            whole &= endpoints.contact_network.publish(chunk).await;
            free = free.max(Instant::now()) + Duration::from_secs_f64(seconds);
        }
        let counter = if whole { &counters.frames_sent } else { &counters.lost };
        counter.fetch_add(1, Ordering::Relaxed);
        counters.frames_done.fetch_add(1, Ordering::Relaxed);
    }
}

//! Contact networks, bonds and motions of the grains on their way to their topics: in chunks, no faster
//! than the network takes them, and left out when too many wait.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio::time::{Instant, sleep_until};

use super::counters::Counters;
use super::endpoints::Endpoints;
use crate::msg::convert::{self, LIVE_BONDS, LIVE_CHUNK, LIVE_GRAINS};
use crate::report::Measures;
use crate::sink::Served;

/// Bytes that go out in a second. More outruns the receive buffer of a stock Linux, and the repair
/// of lost samples is twenty times slower than this.
const BYTES_PER_SECOND: f64 = 20e6;

/// Shortest wait worth taking, since the timer does not know a shorter one.
const TICK: Duration = Duration::from_millis(1);

/// Bytes of one contact in a message: two indices, eight floats, a state.
const CONTACT: usize = 2 * 4 + 8 * 8 + 1;

/// Bytes of one grain in a message: four vectors, three floats, a flag.
const GRAIN: usize = (4 * 3 + 3) * 8 + 1;

/// Bytes of one bond in a message: two indices, a condition, fourteen floats.
const BOND: usize = 2 * 4 + 1 + 14 * 8;

/// Bytes of a message around its contacts, bonds or grains, at most: header, lengths, numbers of the whole,
/// padding, datagram.
const ENVELOPE: usize = 512;

/// KiB that may wait: a bit over three seconds of the network.
const ROOM: usize = 64 * 1024;

/// What goes out in chunks.
#[derive(Clone, Copy)]
enum Large {
    Network,
    Motion,
    Bonds,
}

impl Large {
    /// Its size on the wire, when it was measured.
    fn bytes(self, measures: &Measures) -> Option<usize> {
        match self {
            Self::Network => Some(contacts(measures.network.as_ref()?.first.len())),
            Self::Motion => Some(grains(measures.motion.as_ref()?.carries.len())),
            Self::Bonds => Some(bonds(measures.bonds.as_ref()?.first.len())),
        }
    }
}

fn contacts(count: usize) -> usize {
    count * CONTACT + ENVELOPE
}

fn bonds(count: usize) -> usize {
    count * BOND + ENVELOPE
}

fn grains(count: usize) -> usize {
    count * GRAIN + ENVELOPE
}

/// What waits to be sent, whole. Dropping it makes room for another.
pub(super) struct Frame {
    large: Large,
    served: Arc<Served>,
    _room: OwnedSemaphorePermit,
}

impl Frame {
    /// Whether somebody subscribed to its topic.
    pub(super) fn has_listener(&self, endpoints: &Endpoints) -> bool {
        match self.large {
            Large::Network => endpoints.contact_network.has_listener(endpoints),
            Large::Motion => endpoints.grain_motion.has_listener(endpoints),
            Large::Bonds => endpoints.bonds.has_listener(endpoints),
        }
    }
}

/// Decides what may wait.
pub(super) struct Frames {
    room: Arc<Semaphore>,
    counters: Arc<Counters>,
}

impl Frames {
    pub(super) fn new(counters: Arc<Counters>) -> Self {
        Self { room: Arc::new(Semaphore::new(ROOM)), counters }
    }

    /// What of `served` goes out in chunks as frames, as far as there is room.
    pub(super) fn take(&self, served: &Arc<Served>) -> impl Iterator<Item = Frame> {
        let all = [Large::Network, Large::Motion, Large::Bonds];
        all.into_iter().filter_map(|large| self.frame(large, served))
    }

    fn frame(&self, large: Large, served: &Arc<Served>) -> Option<Frame> {
        let bytes = large.bytes(served.report.measures.as_ref()?)?;
        let Ok(room) = Arc::clone(&self.room).try_acquire_many_owned(kibibytes(bytes)) else {
            self.counters.frames_skipped.fetch_add(1, Ordering::Relaxed);
            return None;
        };
        self.counters.frames_queued.fetch_add(1, Ordering::Relaxed);
        Some(Frame { large, served: Arc::clone(served), _room: room })
    }
}

/// At most the whole room: a single frame must always fit.
fn kibibytes(bytes: usize) -> u32 {
    (bytes / 1024 + 1).min(ROOM) as u32
}

/// Publishes `frames` one after the other, chunk by chunk.
pub(super) async fn send(
    mut frames: mpsc::UnboundedReceiver<Frame>,
    endpoints: Arc<Endpoints>,
    counters: Arc<Counters>,
) {
    let mut pace = Pace { free: Instant::now() };
    while let Some(frame) = frames.recv().await {
        let Some(measures) = &frame.served.report.measures else { continue };
        let mut whole = true;
        match frame.large {
            Large::Network => {
                for chunk in convert::network_chunks(measures, LIVE_CHUNK) {
                    pace.wait().await;
                    let bytes = contacts(chunk.first.len());
                    whole &= endpoints.contact_network.publish(chunk).await;
                    pace.sent(bytes);
                }
            }
            Large::Motion => {
                for chunk in convert::motion_chunks(measures, LIVE_GRAINS) {
                    pace.wait().await;
                    let bytes = grains(chunk.carries.len());
                    whole &= endpoints.grain_motion.publish(chunk).await;
                    pace.sent(bytes);
                }
            }
            Large::Bonds => {
                for chunk in convert::bond_chunks(measures, LIVE_BONDS) {
                    pace.wait().await;
                    let bytes = bonds(chunk.first.len());
                    whole &= endpoints.bonds.publish(chunk).await;
                    pace.sent(bytes);
                }
            }
        }
        let counter = if whole { &counters.frames_sent } else { &counters.lost };
        counter.fetch_add(1, Ordering::Relaxed);
        counters.frames_done.fetch_add(1, Ordering::Relaxed);
    }
}

/// Keeps each chunk at least its own time on the wire after the one before it. Lost time is not
/// caught up: a burst is what loses samples.
struct Pace {
    /// When the wire is free.
    free: Instant,
}

impl Pace {
    async fn wait(&self) {
        if self.free.saturating_duration_since(Instant::now()) >= TICK {
            sleep_until(self.free).await;
        }
    }

    fn sent(&mut self, bytes: usize) {
        let seconds = bytes as f64 / BYTES_PER_SECOND;
        self.free = self.free.max(Instant::now()) + Duration::from_secs_f64(seconds);
    }
}

//! Pictures on their way to their topics: drawn here, no faster than the network takes them, and
//! of those that wait only the newest.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;
use tokio::time::sleep;

use super::counters::Counters;
use super::endpoints::Endpoints;
use crate::msg::picture::MarkerArray;
use crate::sink::Served;
use crate::view::picture::Painter;

/// Bytes that go out in a second. A picture is one sample, larger than the receive buffer of a
/// stock Linux holds, and what it cannot hold is repaired at about this speed.
const BYTES_PER_SECOND: f64 = 1e6;

/// Which picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Picture {
    /// The point cloud of the grains.
    Grains,
    /// The markers.
    Markers,
}

/// What waits to be drawn: of each picture the newest increment.
pub(super) struct Easel {
    waiting: Mutex<[Option<Arc<Served>>; 2]>,
    came: Notify,
    counters: Arc<Counters>,
}

impl Easel {
    pub(super) fn new(counters: Arc<Counters>) -> Self {
        Self { waiting: Mutex::default(), came: Notify::new(), counters }
    }

    /// Has a picture of `served` drawn, in place of one that still waits.
    pub(super) fn put(&self, picture: Picture, served: Arc<Served>) {
        self.counters.pictures_queued.fetch_add(1, Ordering::Relaxed);
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting[picture as usize].replace(served).is_some() {
            self.counters.pictures_skipped.fetch_add(1, Ordering::Relaxed);
            self.counters.pictures_done.fetch_add(1, Ordering::Relaxed);
        }
        drop(waiting);
        self.came.notify_one();
    }

    fn take(&self) -> [Option<Arc<Served>>; 2] {
        std::mem::take(&mut *self.waiting.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Draws what comes to the `easel`, and publishes it.
pub(super) async fn send(easel: Arc<Easel>, painter: Painter, endpoints: Arc<Endpoints>) {
    let counters = &easel.counters;
    loop {
        let [grains, markers] = easel.take();
        if grains.is_none() && markers.is_none() {
            easel.came.notified().await;
            continue;
        }
        if let Some(cloud) = grains.as_deref().and_then(|served| painter.cloud(measures(served)?)) {
            let bytes = cloud.data.len();
            let sent = endpoints.grains.publish(cloud).await;
            done(counters, sent);
            rest(bytes).await;
        }
        if let Some(array) =
            markers.as_deref().and_then(|served| painter.markers(measures(served)?))
        {
            let bytes = bytes(&array);
            let sent = endpoints.markers.publish(array).await;
            done(counters, sent);
            rest(bytes).await;
        }
    }
}

fn measures(served: &Served) -> Option<&crate::report::Measures> {
    served.report.measures.as_ref()
}

fn done(counters: &Counters, sent: bool) {
    let counter = if sent { &counters.pictures_sent } else { &counters.lost };
    counter.fetch_add(1, Ordering::Relaxed);
    counters.pictures_done.fetch_add(1, Ordering::Relaxed);
}

/// Waits until `bytes` have gone out.
async fn rest(bytes: usize) {
    sleep(Duration::from_secs_f64(bytes as f64 / BYTES_PER_SECOND)).await;
}

/// Size of markers on the wire, but for what is the same in each.
fn bytes(array: &MarkerArray) -> usize {
    const MARKER: usize = 300;
    let of = |points: usize, colors: usize| MARKER + 24 * points + 16 * colors;
    array.markers.iter().map(|marker| of(marker.points.len(), marker.colors.len())).sum()
}

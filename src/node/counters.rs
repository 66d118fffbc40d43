//! What went through the node.

use std::sync::atomic::{AtomicU64, Ordering};

use super::health::Health;

/// Counts kept while the node runs. What is `queued` and not `done` is on its way; contact networks
/// and motions of the grains are counted as frames, and clouds and markers as pictures, apart from the other messages.
#[derive(Debug, Default)]
pub(super) struct Counters {
    pub commands: AtomicU64,
    pub unreadable: AtomicU64,
    pub queued: AtomicU64,
    pub done: AtomicU64,
    pub published: AtomicU64,
    pub lost: AtomicU64,
    pub frames_queued: AtomicU64,
    pub frames_done: AtomicU64,
    pub frames_sent: AtomicU64,
    pub frames_skipped: AtomicU64,
    pub pictures_queued: AtomicU64,
    pub pictures_done: AtomicU64,
    pub pictures_sent: AtomicU64,
    pub pictures_skipped: AtomicU64,
    /// Requests to the services, and those of them that have their response.
    pub asked: AtomicU64,
    pub answered: AtomicU64,
    pub health: Health,
}

/// What went through the node, said when it has stopped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Summary {
    /// Commands received.
    pub commands: u64,
    /// Samples on the topics of commands and load cells that are none.
    pub unreadable: u64,
    /// Messages published, contact networks, motions of the grains and pictures not counted.
    pub published: u64,
    /// Messages that could not be published, or not before the end.
    pub lost: u64,
    /// Contact networks and motions of the grains published in full.
    pub frames: u64,
    /// Those that somebody wanted and that were left out, since the network was slower than the
    /// twin.
    pub frames_skipped: u64,
    /// Messages on `grains` and `markers` that were published.
    pub pictures: u64,
    /// Those that somebody wanted and that a newer one took the place of, since the network was
    /// slower than the twin.
    pub pictures_skipped: u64,
}

impl Summary {
    /// Whether a command or a message is lost. A skipped frame or picture is no loss:
    /// those topics promise what the network can carry, the recording promises all of them.
    #[must_use]
    pub fn data_lost(&self) -> bool {
        self.unreadable + self.lost > 0
    }
}

impl Counters {
    /// The summary after the end, when what is still queued can go nowhere.
    pub(super) fn summary(&self) -> Summary {
        let count = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        let unsent = count(&self.queued) - count(&self.done);
        let frames_unsent = count(&self.frames_queued) - count(&self.frames_done);
        let pictures_unsent = count(&self.pictures_queued) - count(&self.pictures_done);
        Summary {
            commands: count(&self.commands),
            unreadable: count(&self.unreadable),
            published: count(&self.published),
            lost: count(&self.lost) + unsent,
            frames: count(&self.frames_sent),
            frames_skipped: count(&self.frames_skipped) + frames_unsent,
            pictures: count(&self.pictures_sent),
            pictures_skipped: count(&self.pictures_skipped) + pictures_unsent,
        }
    }
}

//! The recorder as the node sees it.

use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Weak};

use super::worker::{self, Item, Status};
use crate::sink::{Beside, Recording, RecordingState};

/// A recording for other threads than the twin's.
#[derive(Clone, Debug)]
pub struct RecorderHandle {
    queue: Weak<SyncSender<Item>>,
    status: Arc<Status>,
}

impl RecorderHandle {
    pub(super) fn new(queue: Weak<SyncSender<Item>>, status: Arc<Status>) -> Self {
        Self { queue, status }
    }
}

impl Recording for RecorderHandle {
    /// Waits when the queue is full. What comes after the end is counted as lost.
    fn beside(&self, beside: Beside) {
        let item = Item::Beside(Box::new(beside), worker::now());
        let queue = self.queue.upgrade().filter(|_| !self.status.failed());
        if queue.is_none_or(|queue| queue.send(item).is_err()) {
            self.status.lose(1);
        }
    }

    fn state(&self) -> RecordingState {
        self.status.state()
    }
}

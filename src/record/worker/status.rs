//! How a recording fares, known to its own thread and to others.

use std::fmt;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::record::RecordError;
use crate::sink::RecordingState;

/// Who hears of a failure.
pub(in crate::record) type Tell = Box<dyn FnOnce(&RecordError) + Send>;

/// How a recording fares.
#[derive(Debug)]
pub(in crate::record) struct Status {
    /// The file that is being written.
    path: Mutex<PathBuf>,
    failed: AtomicBool,
    reason: Mutex<Option<String>>,
    listener: Listener,
    lost: AtomicU64,
    messages: AtomicU64,
    bytes: AtomicU64,
    /// Bytes left on the file system; the largest number when nobody knows.
    free: AtomicU64,
}

impl Status {
    pub(in crate::record) fn new(path: PathBuf) -> Self {
        Self {
            path: Mutex::new(path),
            failed: false.into(),
            reason: Mutex::new(None),
            listener: Listener(Mutex::new(None)),
            lost: 0.into(),
            messages: 0.into(),
            bytes: 0.into(),
            free: u64::MAX.into(),
        }
    }

    /// How the recording fares.
    pub(in crate::record) fn state(&self) -> RecordingState {
        let free = self.free.load(Ordering::Relaxed);
        RecordingState {
            messages: self.messages.load(Ordering::Relaxed),
            bytes: self.bytes.load(Ordering::Relaxed),
            lost: self.lost.load(Ordering::Relaxed),
            free: (free != u64::MAX).then_some(free),
            failure: self.failure().map(|failure| failure.to_string()),
        }
    }

    pub(super) fn writes(&self, path: PathBuf) {
        *locked(&self.path) = path;
    }

    pub(super) fn holds_messages(&self, messages: u64) {
        self.messages.store(messages, Ordering::Relaxed);
    }

    pub(super) fn holds_bytes(&self, bytes: u64, free: Option<u64>) {
        self.bytes.store(bytes, Ordering::Relaxed);
        self.free.store(free.unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// Who hears of a failure, once; at once when it has happened.
    pub(in crate::record) fn tell(&self, listener: Tell) {
        *locked(&self.listener.0) = Some(listener);
        if let Some(failure) = self.failure() {
            self.listener.hear(&failure);
        }
    }

    /// Whether the recording has failed.
    pub(in crate::record) fn failed(&self) -> bool {
        self.failed.load(Ordering::Acquire)
    }

    /// Counts answers that are not in the recording.
    pub(in crate::record) fn lose(&self, answers: u64) {
        self.lost.fetch_add(answers, Ordering::Relaxed);
    }

    /// Ends the recording; the first reason stands.
    pub(in crate::record) fn fail(&self, reason: String, lost: u64) -> RecordError {
        self.lose(lost);
        let reason = locked(&self.reason).get_or_insert(reason).clone();
        self.failed.store(true, Ordering::Release);
        let failure = self.error(reason);
        self.listener.hear(&failure);
        failure
    }

    /// What went wrong.
    pub(in crate::record) fn failure(&self) -> Option<RecordError> {
        let reason = locked(&self.reason).clone();
        reason.map(|reason| self.error(reason))
    }

    fn error(&self, reason: String) -> RecordError {
        let lost = self.lost.load(Ordering::Relaxed);
        let path = locked(&self.path).clone();
        RecordError::Write { path, reason, lost }
    }
}

struct Listener(Mutex<Option<Tell>>);

impl Listener {
    fn hear(&self, failure: &RecordError) {
        let listener = locked(&self.0).take();
        if let Some(listener) = listener {
            listener(failure);
        }
    }
}

impl fmt::Debug for Listener {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("Listener")
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

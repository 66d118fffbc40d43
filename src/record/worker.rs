//! The recorder's thread.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::bag::BagWriter;
use super::{FLUSH_AFTER, RecordError, Recorded, Target, metadata};
use crate::sink::Served;

/// One answer of the twin, on its way to the file.
#[derive(Debug)]
pub(super) struct Answer {
    pub(super) served: Arc<Served>,
    /// When, in nanoseconds since 1970.
    pub(super) time: u64,
}

/// Nanoseconds since 1970; 0 when the clock says that it is earlier.
pub(super) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// How the recording fares, known to both threads.
#[derive(Debug)]
pub(super) struct Status {
    path: PathBuf,
    failed: AtomicBool,
    reason: Mutex<Option<String>>,
    lost: AtomicU64,
}

impl Status {
    pub(super) fn new(path: PathBuf) -> Self {
        Self { path, failed: false.into(), reason: Mutex::new(None), lost: 0.into() }
    }

    /// Whether the recording has failed.
    pub(super) fn failed(&self) -> bool {
        self.failed.load(Ordering::Acquire)
    }

    /// Counts answers that are not in the recording.
    pub(super) fn lose(&self, answers: u64) {
        self.lost.fetch_add(answers, Ordering::Relaxed);
    }

    /// Ends the recording; the first reason stands.
    pub(super) fn fail(&self, reason: String, lost: u64) -> RecordError {
        self.lose(lost);
        let reason = self
            .reason
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get_or_insert(reason)
            .clone();
        self.failed.store(true, Ordering::Release);
        self.error(reason)
    }

    /// What went wrong.
    pub(super) fn failure(&self) -> Option<RecordError> {
        let reason = self.reason.lock().unwrap_or_else(PoisonError::into_inner).clone();
        reason.map(|reason| self.error(reason))
    }

    fn error(&self, reason: String) -> RecordError {
        let lost = self.lost.load(Ordering::Relaxed);
        RecordError::Write { path: self.path.clone(), reason, lost }
    }
}

type Bag = BagWriter<BufWriter<File>>;

/// What the thread owns besides the bag.
pub(super) struct Worker {
    answers: Receiver<Answer>,
    status: Arc<Status>,
    target: Target,
    /// Since when there are answers in the open chunk.
    waiting: Option<Instant>,
    /// Answers that are not on disk for sure.
    pending: u64,
    /// Answers that are.
    safe: u64,
}

impl Worker {
    pub(super) fn new(answers: Receiver<Answer>, status: Arc<Status>, target: Target) -> Self {
        Self { answers, status, target, waiting: None, pending: 0, safe: 0 }
    }

    /// Writes until nobody sends any more, then ends the recording.
    pub(super) fn run(mut self, bag: Bag) -> Result<Recorded, RecordError> {
        self.record(bag).map_err(|reason| {
            let failure = self.status.fail(reason, self.pending);
            // The twin must not wait for a recorder that writes no more.
            let unwritten = self.answers.iter().count();
            self.status.lose(unwritten as u64);
            self.status.failure().unwrap_or(failure)
        })
    }

    fn record(&mut self, mut bag: Bag) -> Result<Recorded, String> {
        loop {
            let answer = match self.waiting {
                None => self.answers.recv().map_err(RecvTimeoutError::from),
                Some(since) => {
                    self.answers.recv_timeout(FLUSH_AFTER.saturating_sub(since.elapsed()))
                }
            };
            match answer {
                Ok(answer) => self.write(&mut bag, &answer)?,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            if self.waiting.is_some_and(|since| since.elapsed() >= FLUSH_AFTER) {
                bag.flush().map_err(text)?;
                self.flushed()?;
            }
        }
        self.finish(bag)
    }

    fn write(&mut self, bag: &mut Bag, answer: &Answer) -> Result<(), String> {
        self.pending += 1;
        if bag.answer(&answer.served, answer.time).map_err(text)? {
            self.waiting.get_or_insert_with(Instant::now);
            Ok(())
        } else {
            self.flushed()
        }
    }

    /// Everything is on disk; or was, if the file is gone.
    fn flushed(&mut self) -> Result<(), String> {
        self.safe += self.pending;
        self.pending = 0;
        self.waiting = None;
        if self.target.file().exists() {
            return Ok(());
        }
        self.pending = self.safe;
        Err("it is no longer there".into())
    }

    fn finish(&mut self, bag: Bag) -> Result<Recorded, String> {
        let (to, contents) = bag.finish(&self.target.file_name).map_err(text)?;
        let file = to.into_inner().map_err(|error| text(error.into_error()))?;
        // Some file systems tell only now that there was no room.
        file.sync_all().map_err(text)?;
        let bytes = file.metadata().map_err(text)?.len();
        self.flushed()?;
        let description = self.target.folder.join("metadata.yaml");
        fs::write(&description, metadata::file(&contents, &self.target.file_name))
            .map_err(|error| format!("{}: {error}", description.display()))?;
        let folder = self.target.folder.clone();
        Ok(Recorded { folder, messages: contents.messages(), bytes })
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

//! The recorder's thread.

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::bag::BagWriter;
use super::{Closing, FLUSH_AFTER, RecordError, Recorded, Target, metadata};
use crate::command::circumstance::Happened;
use crate::sink::{Beside, RecordingState, Served};

/// What is on its way to the file, and when it happened, in nanoseconds since 1970.
#[derive(Debug)]
pub(super) enum Item {
    /// One answer of the twin.
    Answer(Arc<Served>, u64),
    /// What else bears on the answers.
    Happened(Box<Happened>, u64),
    /// How the run ended.
    Closing(Closing),
    /// What came or went beside.
    Beside(Box<Beside>, u64),
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
    messages: AtomicU64,
    bytes: AtomicU64,
    /// Bytes left on the file system; the largest number when nobody knows.
    free: AtomicU64,
}

impl Status {
    pub(super) fn new(path: PathBuf) -> Self {
        Self {
            path,
            failed: false.into(),
            reason: Mutex::new(None),
            lost: 0.into(),
            messages: 0.into(),
            bytes: 0.into(),
            free: u64::MAX.into(),
        }
    }

    /// How the recording fares.
    pub(super) fn state(&self) -> RecordingState {
        let free = self.free.load(Ordering::Relaxed);
        RecordingState {
            messages: self.messages.load(Ordering::Relaxed),
            bytes: self.bytes.load(Ordering::Relaxed),
            lost: self.lost.load(Ordering::Relaxed),
            free: (free != u64::MAX).then_some(free),
            failure: self.failure().map(|failure| failure.to_string()),
        }
    }

    fn look_at_disk(&self, bytes: u64) {
        self.bytes.store(bytes, Ordering::Relaxed);
        let folder = self.path.parent().unwrap_or(Path::new("."));
        self.free.store(free_bytes(folder).unwrap_or(u64::MAX), Ordering::Relaxed);
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
    items: Receiver<Item>,
    status: Arc<Status>,
    target: Target,
    /// Since when there is something in the open chunk.
    waiting: Option<Instant>,
    /// Items that are not on disk for sure.
    pending: u64,
    /// Items that are.
    safe: u64,
}

impl Worker {
    pub(super) fn new(items: Receiver<Item>, status: Arc<Status>, target: Target) -> Self {
        Self { items, status, target, waiting: None, pending: 0, safe: 0 }
    }

    /// Writes until nobody sends any more, then ends the recording.
    pub(super) fn run(mut self, bag: Bag) -> Result<Recorded, RecordError> {
        self.record(bag).map_err(|reason| {
            let failure = self.status.fail(reason, self.pending);
            // The twin must not wait for a recorder that writes no more.
            let unwritten = self.items.iter().count();
            self.status.lose(unwritten as u64);
            self.status.failure().unwrap_or(failure)
        })
    }

    fn record(&mut self, mut bag: Bag) -> Result<Recorded, String> {
        loop {
            let item = match self.waiting {
                None => self.items.recv().map_err(RecvTimeoutError::from),
                Some(since) => self.items.recv_timeout(FLUSH_AFTER.saturating_sub(since.elapsed())),
            };
            match item {
                Ok(item) => self.write(&mut bag, &item)?,
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

    fn write(&mut self, bag: &mut Bag, item: &Item) -> Result<(), String> {
        self.pending += u64::from(!matches!(item, Item::Closing(_)));
        let open = match item {
            Item::Answer(served, time) => bag.answer(served, *time),
            Item::Happened(happened, time) => bag.happened(happened, *time),
            Item::Closing(closing) => {
                bag.close_with(closing);
                return Ok(());
            }
            Item::Beside(beside, time) => bag.beside(beside, *time),
        };
        self.status.messages.store(bag.messages(), Ordering::Relaxed);
        if open.map_err(text)? {
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
        if let Ok(file) = fs::metadata(self.target.file()) {
            self.status.look_at_disk(file.len());
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

/// What the file system of `folder` has left for programs like this one.
#[cfg(unix)]
fn free_bytes(folder: &Path) -> Option<u64> {
    let found = nix::sys::statvfs::statvfs(folder).ok()?;
    // The width of these numbers differs from system to system.
    #[allow(clippy::unnecessary_cast, clippy::useless_conversion, reason = "it does not on Linux")]
    let (blocks, size) = (u64::from(found.blocks_available()), found.fragment_size() as u64);
    Some(blocks.saturating_mul(size))
}

#[cfg(not(unix))]
fn free_bytes(_: &Path) -> Option<u64> {
    None
}

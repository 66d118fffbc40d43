//! Recordings: a rosbag2 folder with one MCAP file, written on a thread of its own.
//!
//! A recording holds every command with its report and every measure, each under the topic of
//! [`topics`](crate::msg::topics), and as attachments what made it: `scene.yaml`, `pack.csv` and
//! `pack.json`, with version, features, kernels and threads in a metadata record. ROS 2 plays it.
//!
//! **Nothing is lost quietly.** Answers go to the recorder's thread through a bounded queue; when
//! the disk is slower than the twin, the twin waits. When writing fails, the run goes on without
//! the recorder: [`Recorder::failure`] tells it at once, [`Recorder::finish`] at the end.
//!
//! **A killed run leaves a recording.** A chunk of the file is closed, and written in one go,
//! when it holds `record.chunk` bytes and no later than [`FLUSH_AFTER`] after its first answer.
//! So a lone command is on disk that soon, and only commands that follow upon each other faster
//! share a chunk. They do to keep the index small; compression hardly gains, the low bits of a
//! contact network being new at every increment.
//!
//! **Times.** `log_time` is the wall clock when the twin had served, and at least a nanosecond
//! more for each message: it rises strictly even when the clock is set back, and players that
//! shuffle equal times find none. Playback follows the twin's pace. `publish_time` is the stamp
//! in the header, that is, of the command served: `ros2 bag play --message-order sent`, which
//! ROS 2 has since Kilted, follows the rig's pace.

mod bag;
mod beside;
mod metadata;
pub mod reader;
mod worker;

use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::command::circumstance::Happened;
use crate::report::Demand;
use crate::scene;
use crate::sink::{Served, Sink};

use bag::BagWriter;
pub use beside::RecorderHandle;
use worker::{Item, Status, Worker};

/// How long an answer may wait in an open chunk before it is handed to the system.
pub const FLUSH_AFTER: Duration = Duration::from_millis(200);

/// Answers between the twin and the recorder's thread. A few smooth the writing of a chunk; more
/// would only hold memory, a network of 10^6 contacts being 73 MB.
const QUEUE: usize = 8;

/// Name of the attachment with the pack's history.
pub const HISTORY: &str = "pack.history.json";

/// Name of the metadata record with the program that recorded.
pub const PROGRAM: &str = "graintwin";

/// Name of the metadata record with what the run came to; a run that was killed leaves none.
pub const END: &str = "graintwin_end";

/// What made a recording, so that it can be made again.
#[derive(Clone, Debug)]
pub struct Provenance {
    /// The effective scene with all defaults, as YAML.
    pub scene: String,
    /// The pack at the start, in the form of the pack CSV.
    pub pack_csv: Vec<u8>,
    /// The pack's box, in the form of the JSON beside that CSV.
    pub pack_json: Vec<u8>,
    /// The pack's history when it has one, in the form of the file that this JSON names [`HISTORY`].
    pub pack_history: Option<Vec<u8>>,
    /// Threads of the twin.
    pub threads: usize,
    /// Seed of the pack.
    pub seed: u64,
}

/// What a run came to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Closing {
    /// The last increment.
    pub increment: u64,
    /// The state by then, as [`Twin::digest`](crate::twin::Twin::digest) tells it.
    pub digest: String,
}

/// What was recorded.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Recorded {
    /// The folder.
    pub folder: PathBuf,
    /// Messages in it.
    pub messages: u64,
    /// Size of its MCAP file.
    pub bytes: u64,
}

/// Why nothing, or not everything, was recorded.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RecordError {
    /// The target exists and is no folder.
    #[error("cannot record into {}: it is a file; name a new or an empty folder", .0.display())]
    NotAFolder(PathBuf),
    /// The target holds something.
    #[error(
        "cannot record into {}: it holds files already; name a new or an empty folder",
        .0.display()
    )]
    NotEmpty(PathBuf),
    /// The recording could not be begun.
    #[error("cannot record into {}: {reason}", .path.display())]
    Create {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// Writing failed during the run or at its end.
    #[error("recording {} failed: {reason}; answers lost: {lost}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
        /// Answers of the twin, and measurements, that are not in the recording.
        lost: u64,
    },
}

/// Writes a rosbag2 folder from what the twin says.
#[derive(Debug)]
pub struct Recorder {
    /// The only one that lasts: when it goes, the thread ends.
    queue: Option<Arc<SyncSender<Item>>>,
    thread: Option<JoinHandle<Result<Recorded, RecordError>>>,
    status: Arc<Status>,
}

impl Recorder {
    /// Begins a recording in `folder`, which is made when it is not there.
    ///
    /// # Errors
    /// When `folder` is a file, holds something, or cannot be written.
    pub fn create(
        folder: &Path,
        settings: &scene::Record,
        provenance: &Provenance,
    ) -> Result<Self, RecordError> {
        claim(folder)?;
        let target = Target::new(folder);
        let failed = |reason: String| RecordError::Create { path: target.file(), reason };
        let file = File::create_new(target.file()).map_err(|error| failed(error.to_string()))?;
        let bag = BagWriter::new(BufWriter::new(file), settings, provenance, worker::now())
            .map_err(|error| failed(error.to_string()))?;
        let status = Arc::new(Status::new(target.file()));
        let (queue, items) = sync_channel(QUEUE);
        let worker = Worker::new(items, Arc::clone(&status), target.clone());
        let thread = thread::Builder::new()
            .name("recorder".into())
            .spawn(move || worker.run(bag))
            .map_err(|error| failed(error.to_string()))?;
        Ok(Self { queue: Some(Arc::new(queue)), thread: Some(thread), status })
    }

    /// What went wrong, as soon as it did.
    #[must_use]
    pub fn failure(&self) -> Option<RecordError> {
        self.status.failure()
    }

    /// The recording for other threads than the twin's. It does not keep the recording open.
    #[must_use]
    pub fn handle(&self) -> RecorderHandle {
        let queue = self.queue.as_ref().map(Arc::downgrade).unwrap_or_default();
        RecorderHandle::new(queue, Arc::clone(&self.status))
    }

    /// Ends the recording: writes what is queued, the index and `metadata.yaml`.
    ///
    /// # Errors
    /// When anything of the recording could not be written, now or earlier.
    pub fn finish(mut self) -> Result<Recorded, RecordError> {
        self.end()
    }

    /// How the run ended, to be written at the end of the recording.
    pub fn close_with(&mut self, closing: Closing) {
        self.enqueue(Item::Closing(closing));
    }

    /// Queues `item`, waiting when the queue is full, or counts it as lost.
    fn enqueue(&self, item: Item) {
        if self.status.failed() {
            self.status.lose(1);
            return;
        }
        if self.queue.as_ref().is_none_or(|queue| queue.send(item).is_err()) {
            self.status.fail("its thread panicked".into(), 1);
        }
    }

    fn end(&mut self) -> Result<Recorded, RecordError> {
        drop(self.queue.take());
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(recorded)) => recorded,
            Some(Err(_)) | None => Err(self.status.fail("its thread panicked".into(), 0)),
        }
    }
}

impl Sink for Recorder {
    /// Everything, until the recording has failed.
    fn demand(&self) -> Demand {
        if self.status.failed() { Demand::default() } else { Demand::ALL }
    }

    /// Queues the answer; waits when the queue is full.
    fn served(&mut self, served: &Arc<Served>) {
        self.enqueue(Item::Answer(Arc::clone(served), worker::now()));
    }

    /// As an answer.
    fn happened(&mut self, happened: &Happened) {
        self.enqueue(Item::Happened(Box::new(happened.clone()), worker::now()));
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        if self.thread.is_none() {
            return;
        }
        if let Err(error) = self.end() {
            tracing::error!("{error}");
        }
    }
}

/// Where a recording goes.
#[derive(Clone, Debug)]
struct Target {
    folder: PathBuf,
    file_name: String,
}

impl Target {
    /// `folder` with the file in it that rosbag2 would make: `NAME/NAME_0.mcap`.
    fn new(folder: &Path) -> Self {
        let name = folder.canonicalize().ok().and_then(|folder| {
            folder.file_name().and_then(|name| name.to_str()).map(str::to_owned)
        });
        let name = name.as_deref().unwrap_or("recording");
        Self { folder: folder.to_owned(), file_name: format!("{name}_0.mcap") }
    }

    fn file(&self) -> PathBuf {
        self.folder.join(&self.file_name)
    }
}

/// Makes `folder` unless it is there and empty: what [`Recorder::create`] does first.
///
/// # Errors
/// When `folder` is a file, holds something, or cannot be made.
pub fn claim(folder: &Path) -> Result<(), RecordError> {
    let failed = |error: io::Error| RecordError::Create {
        path: folder.to_owned(),
        reason: error.to_string(),
    };
    if folder.exists() && !folder.is_dir() {
        return Err(RecordError::NotAFolder(folder.to_owned()));
    }
    fs::create_dir_all(folder).map_err(failed)?;
    if fs::read_dir(folder).map_err(failed)?.next().is_some() {
        return Err(RecordError::NotEmpty(folder.to_owned()));
    }
    Ok(())
}

//! Recordings: a rosbag2 folder with MCAP files, written on a thread of its own.
//!
//! A recording holds every command with its report and every measure, each under the topic of
//! [`topics`], and what came and went beside them; as attachments what made it:
//! `scene.yaml`, `pack.csv` and `pack.json`, with version, features, kernels and threads in a
//! metadata record. ROS 2 plays it. [`scene::Record`] chooses topics.
//!
//! **Files.** With `record.split` the recording goes on in a new file, between two answers, when
//! the one at hand has reached its size or duration. Each can be looked at alone: it has the types,
//! the topics, the program's metadata record and, with its first message, the frames of the walls.
//! The attachments are in the first. A split loses nothing, and `log_time` rises across it.
//!
//! **Nothing is lost quietly.** Answers go to the recorder's thread through a bounded queue; when
//! the disk is slower than the twin, the twin waits. When writing fails, whoever was named to
//! [`Recorder::tell_failure`] hears of it at once, and the recorder takes no more;
//! [`Recorder::finish`] says it at the end.
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
pub mod recover;
pub mod replay;
mod role;
mod target;
mod worker;

use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use crate::command::circumstance::Happened;
use crate::msg::topics;
use crate::report::Demand;
use crate::scene;
use crate::sink::{Served, Sink};
use crate::view::picture::Painter;

use bag::{BagError, BagWriter, Making};
pub use beside::RecorderHandle;
use recover::Resumed;
use target::Target;
pub use target::claim;
use worker::{Beginning, Item, Status, Worker};

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

/// Name of the metadata record in files that were recovered.
pub const RECOVERED: &str = "graintwin_recovered";

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
    /// Who draws the pictures; without one none are recorded.
    pub painter: Option<Painter>,
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
    /// How many MCAP files it has.
    pub files: usize,
    /// Messages in them.
    pub messages: u64,
    /// Their size.
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
    /// A recording cannot go on.
    #[error("cannot go on with the recording in {}: {reason}", .path.display())]
    Resume {
        /// The folder.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Writing failed during the run or at its end.
    #[error(
        "recording {} failed: {reason}; answers and messages beside them that are lost: {lost}",
        .path.display()
    )]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
        /// Answers of the twin, and messages beside them, that are not in the recording.
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
    /// What is recorded.
    wanted: Demand,
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
        let making = Making::new(settings, provenance);
        Self::start(target, making, Beginning::default(), |to, making| {
            BagWriter::first(to, making, provenance, worker::now())
        })
    }

    /// Goes on with the recording in `folder`, whose files must be whole
    /// ([`recover::in_place`]), in a new file. The attachments stay those of the first.
    ///
    /// # Errors
    /// When `folder` holds no such recording, or cannot be written.
    pub fn resume(
        folder: &Path,
        settings: &scene::Record,
        provenance: &Provenance,
    ) -> Result<Self, RecordError> {
        let Resumed { target, beginning, past } = recover::resumed(folder)?;
        let making = Making::new(settings, provenance);
        Self::start(target, making, beginning, |to, making| BagWriter::next(to, making, past))
    }

    /// Begins the file that `beginning` names with what `begin` writes, and the thread.
    fn start(
        target: Target,
        making: Making,
        beginning: Beginning,
        begin: impl FnOnce(BufWriter<File>, &Making) -> Result<BagWriter<BufWriter<File>>, BagError>,
    ) -> Result<Self, RecordError> {
        let path = target.file(beginning.number);
        let failed = |reason: String| RecordError::Create { path: path.clone(), reason };
        let file = File::create_new(&path).map_err(|error| failed(error.to_string()))?;
        let bag =
            begin(BufWriter::new(file), &making).map_err(|error| failed(error.to_string()))?;
        let wanted = demand(making.settings());
        let status = Arc::new(Status::new(path.clone()));
        let (queue, items) = sync_channel(QUEUE);
        let worker = Worker::new(items, Arc::clone(&status), target, making, beginning);
        let thread = thread::Builder::new()
            .name("recorder".into())
            .spawn(move || worker.run(bag))
            .map_err(|error| failed(error.to_string()))?;
        Ok(Self { queue: Some(Arc::new(queue)), thread: Some(thread), status, wanted })
    }

    /// Names who hears, once and at once, that writing has failed; on the recorder's thread. Until
    /// then nobody does before the end.
    pub fn tell_failure(&self, listener: impl FnOnce(&RecordError) + Send + 'static) {
        self.status.tell(Box::new(listener));
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
    /// What is recorded, until the recording has failed.
    fn demand(&self) -> Demand {
        if self.status.failed() { Demand::default() } else { self.wanted }
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

/// What must be measured for the topics that are recorded.
fn demand(settings: &scene::Record) -> Demand {
    let mut demand = Demand::ALL;
    // Markers show the state, the contacts and the cement.
    let marked = settings.takes(&topics::MARKERS);
    demand.state = marked || settings.takes(&topics::STATE);
    demand.moduli = settings.takes(&topics::MODULI);
    demand.tangent = settings.takes(&topics::TANGENT);
    demand.contact_network = marked || settings.takes(&topics::CONTACT_NETWORK);
    demand.grains = marked || settings.takes(&topics::GRAINS);
    demand.grain_motion = settings.takes(&topics::GRAIN_MOTION);
    demand.fabric = settings.takes(&topics::FABRIC);
    demand.hydrate = settings.takes(&topics::HYDRATE);
    demand.plane = settings.takes(&topics::PLANE_STATE);
    demand.rearrangements = settings.takes(&topics::REARRANGEMENTS);
    demand.snapshots = settings.takes(&topics::SNAPSHOTS);
    demand.bonds = marked || settings.takes(&topics::BONDS);
    demand.cracks = settings.takes(&topics::CRACKS);
    demand
}

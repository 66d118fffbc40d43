//! The recorder's thread.

mod disk;
mod status;

use std::fs::{self, File};
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::bag::{BagWriter, Making, Past};
use super::target::Target;
use super::{Closing, FLUSH_AFTER, RecordError, Recorded, metadata};
use crate::command::circumstance::Happened;
use crate::sink::{Beside, Served};

pub(super) use status::Status;

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

impl Item {
    fn time(&self) -> Option<u64> {
        match self {
            Self::Answer(_, time) | Self::Happened(_, time) | Self::Beside(_, time) => Some(*time),
            Self::Closing(_) => None,
        }
    }
}

/// Nanoseconds since 1970; 0 when the clock says that it is earlier.
pub(super) fn now() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

type Bag = BagWriter<BufWriter<File>>;

/// What the thread owns besides the file at hand.
pub(super) struct Worker {
    items: Receiver<Item>,
    status: Arc<Status>,
    target: Target,
    making: Making,
    /// The files that are finished.
    finished: Vec<metadata::File>,
    /// Their size.
    finished_bytes: u64,
    /// Number of the file at hand.
    number: u64,
    /// Its size on disk when that was looked at last.
    bytes: u64,
    /// Since when there is something in the open chunk.
    waiting: Option<Instant>,
    /// Items that are not on disk for sure.
    pending: u64,
    /// Items that are, in the file at hand and in those before.
    safe: u64,
    safe_before: u64,
    watch: disk::Watch,
    begun: Instant,
}

/// Where a worker begins: which files there are already, and how large they are.
#[derive(Debug, Default)]
pub(super) struct Beginning {
    pub(super) finished: Vec<metadata::File>,
    pub(super) finished_bytes: u64,
    pub(super) number: u64,
}

impl Worker {
    pub(super) fn new(
        items: Receiver<Item>,
        status: Arc<Status>,
        target: Target,
        making: Making,
        beginning: Beginning,
    ) -> Self {
        let Beginning { finished, finished_bytes, number } = beginning;
        Self {
            items,
            status,
            target,
            making,
            finished,
            finished_bytes,
            number,
            bytes: 0,
            waiting: None,
            pending: 0,
            safe: 0,
            safe_before: 0,
            watch: disk::Watch::default(),
            begun: Instant::now(),
        }
    }

    /// Writes until nobody sends any more, then ends the recording.
    pub(super) fn run(mut self, bag: Bag) -> Result<Recorded, RecordError> {
        self.record(bag).map_err(|reason| {
            let failure = self.status.fail(reason, self.lost());
            // The twin must not wait for a recorder that writes no more.
            let unwritten = self.items.iter().count();
            self.status.lose(unwritten as u64);
            self.status.failure().unwrap_or(failure)
        })
    }

    /// What of all that came is on no disk, by what is still there.
    fn lost(&self) -> u64 {
        let gone = |path: &Path, items: u64| if path.exists() { 0 } else { items };
        self.pending
            + gone(&self.target.file(self.number), self.safe)
            + gone(&self.target.folder, self.safe_before)
    }

    fn record(&mut self, mut bag: Bag) -> Result<Recorded, String> {
        self.look()?;
        loop {
            let item = match self.waiting {
                None => self.items.recv().map_err(RecvTimeoutError::from),
                Some(since) => self.items.recv_timeout(FLUSH_AFTER.saturating_sub(since.elapsed())),
            };
            match item {
                Ok(item) => {
                    let counts = u64::from(item.time().is_some());
                    if item.time().is_some_and(|time| self.is_full(&bag, time)) {
                        bag = self.next_file(bag).inspect_err(|_| self.pending += counts)?;
                    }
                    self.pending += counts;
                    self.write(&mut bag, &item)?;
                }
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
        let open = match item {
            Item::Answer(served, time) => bag.answer(served, *time),
            Item::Happened(happened, time) => bag.happened(happened, *time),
            Item::Closing(closing) => {
                bag.close_with(closing);
                return Ok(());
            }
            Item::Beside(beside, time) => bag.beside(beside, *time),
        };
        self.tell_messages(bag);
        if open.map_err(text)? {
            self.waiting.get_or_insert_with(Instant::now);
            Ok(())
        } else {
            self.flushed()
        }
    }

    fn tell_messages(&self, bag: &Bag) {
        let before: u64 = self.finished.iter().map(|file| file.contents.messages()).sum();
        self.status.holds_messages(before + bag.contents().messages());
    }

    /// Everything is on disk; or was, if the file is gone.
    fn flushed(&mut self) -> Result<(), String> {
        self.safe += std::mem::take(&mut self.pending);
        self.waiting = None;
        self.look()
    }

    /// Looks at the file and at its disk.
    fn look(&mut self) -> Result<(), String> {
        let Ok(file) = fs::metadata(self.target.file(self.number)) else {
            return Err("it is no longer there".into());
        };
        self.bytes = file.len();
        let written = self.finished_bytes + self.bytes;
        let free = disk::free_bytes(&self.target.folder);
        self.status.holds_bytes(written, free);
        let warning = free.and_then(|free| self.watch.look(self.begun.elapsed(), written, free));
        if let Some(warning) = warning {
            tracing::warn!("{warning}");
        }
        Ok(())
    }

    /// Whether what happened at `time` belongs into the next file.
    fn is_full(&self, bag: &Bag, time: u64) -> bool {
        let split = self.making.settings().split;
        let contents = bag.contents();
        let reached = |size: u64| self.bytes + bag.open() >= size;
        let lasted = |limit: f64| time.saturating_sub(contents.start()) as f64 * 1e-9 >= limit;
        // Messages on topics that are not recorded fill no file.
        contents.times.is_some()
            && (split.size.is_some_and(reached) || split.duration.is_some_and(lasted))
    }

    /// Finishes the file at hand and begins the next.
    fn next_file(&mut self, bag: Bag) -> Result<Bag, String> {
        let past = self.close(bag)?;
        self.safe_before += std::mem::take(&mut self.safe);
        self.finished_bytes += std::mem::take(&mut self.bytes);
        self.number += 1;
        let path = self.target.file(self.number);
        self.status.writes(path.clone());
        let file = File::create_new(&path).map_err(text)?;
        BagWriter::next(BufWriter::new(file), &self.making, past).map_err(text)
    }

    /// Finishes the file at hand.
    fn close(&mut self, bag: Bag) -> Result<Past, String> {
        let name = self.target.file_name(self.number);
        let (to, contents, past) = bag.finish(&name).map_err(text)?;
        let file = to.into_inner().map_err(|error| text(error.into_error()))?;
        // Some file systems tell only now that there was no room.
        file.sync_all().map_err(text)?;
        self.flushed()?;
        self.finished.push(metadata::File { name, contents });
        Ok(past)
    }

    fn finish(&mut self, bag: Bag) -> Result<Recorded, String> {
        self.close(bag)?;
        let last = self.finished.last().map_or(0, |file| file.contents.messages());
        if self.number > 0 && last == 0 {
            // It was begun and nothing came: a file without a message stops players.
            fs::remove_file(self.target.file(self.number)).map_err(text)?;
            self.finished.pop();
            self.bytes = 0;
        }
        let description = self.target.description();
        fs::write(&description, metadata::file(&self.finished))
            .map_err(|error| format!("{}: {error}", description.display()))?;
        Ok(Recorded {
            folder: self.target.folder.clone(),
            files: self.finished.len(),
            messages: self.finished.iter().map(|file| file.contents.messages()).sum(),
            bytes: self.finished_bytes + self.bytes,
        })
    }
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

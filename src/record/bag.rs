//! What the twin says as messages in the files of a bag.

mod part;

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::{Attachment, McapError};

use super::{Closing, END, HISTORY, PROGRAM, Provenance, metadata};
use crate::command::circumstance::Happened;
use crate::msg::Circumstance;
use crate::msg::answer::{self, Outgoing};
use crate::msg::cdr::CdrError;
use crate::msg::topics::{self, Topic};
use crate::relax::lanes;
use crate::scene;
use crate::sink::{Beside, Served};
use crate::view::picture::Painter;

pub(super) use part::{Channel, Contents, Part, Schema, When};

/// Why a bag could not be written on.
#[derive(Debug, thiserror::Error)]
pub(super) enum BagError {
    /// The system said no.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// The format said no.
    #[error("{0}")]
    Mcap(McapError),
    /// A message is no CDR.
    #[error(transparent)]
    Cdr(#[from] CdrError),
}

impl From<McapError> for BagError {
    fn from(error: McapError) -> Self {
        match error {
            // The sentence of this variant hides its cause.
            McapError::Io(error) => Self::Io(error),
            other => Self::Mcap(other),
        }
    }
}

/// What every file of a recording is made with.
#[derive(Clone, Debug)]
pub(super) struct Making {
    settings: scene::Record,
    program: BTreeMap<String, String>,
    painter: Option<Painter>,
}

impl Making {
    pub(super) fn new(settings: &scene::Record, provenance: &Provenance) -> Self {
        let painter = provenance.painter.clone();
        Self { settings: settings.clone(), program: program(provenance), painter }
    }

    pub(super) fn settings(&self) -> &scene::Record {
        &self.settings
    }
}

/// What one file of a recording hands on to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct Past {
    /// `log_time` of the last message.
    pub(super) last: Option<u64>,
    /// The frames of the walls, as bytes and with their time: a file that is looked at alone
    /// needs them.
    pub(super) frames: Option<(Vec<u8>, u64)>,
}

/// Writes answers into one file.
pub(super) struct BagWriter<W: Write> {
    part: Part<W>,
    /// The topics that are recorded, in the order of the part's channels.
    topics: Vec<&'static Topic>,
    past: Past,
    /// Whether the frames of the file before are still to be repeated.
    frames_due: bool,
    buffer: Vec<u8>,
    closing: Option<Closing>,
    painter: Option<Painter>,
}

impl<W: Write> BagWriter<W> {
    /// Begins the first file of a recording at `time`, with its attachments.
    pub(super) fn first(
        to: W,
        making: &Making,
        provenance: &Provenance,
        time: u64,
    ) -> Result<Self, BagError> {
        let mut part = Part::new(to, &making.settings)?;
        let mut files: Vec<(&str, &str, &[u8])> = vec![
            ("scene.yaml", "application/yaml", provenance.scene.as_bytes()),
            ("pack.csv", "text/csv", &provenance.pack_csv),
            ("pack.json", "application/json", &provenance.pack_json),
        ];
        files.extend(
            provenance.pack_history.iter().map(|json| (HISTORY, "application/json", &**json)),
        );
        for (name, media_type, data) in files {
            part.attach(&Attachment {
                log_time: time,
                create_time: time,
                name: name.into(),
                media_type: media_type.into(),
                data: data.into(),
            })?;
        }
        Self::begin(part, making, Past::default())
    }

    /// Begins the file that follows upon `past`.
    pub(super) fn next(to: W, making: &Making, past: Past) -> Result<Self, BagError> {
        Self::begin(Part::new(to, &making.settings)?, making, past)
    }

    fn begin(mut part: Part<W>, making: &Making, past: Past) -> Result<Self, BagError> {
        part.metadata(PROGRAM, making.program.clone())?;
        part.flush()?;
        let topics: Vec<_> = topics::all().filter(|topic| making.settings.takes(topic)).collect();
        for topic in &topics {
            describe(&mut part, topic);
        }
        let frames_due = past.frames.is_some();
        let painter = making.painter.clone();
        Ok(Self { part, topics, past, frames_due, buffer: Vec::new(), closing: None, painter })
    }

    /// Writes one answer, served at `time`; says whether it is still in an open chunk.
    pub(super) fn answer(&mut self, served: &Served, time: u64) -> Result<bool, BagError> {
        // Taken out while `self` is written to.
        let painter = self.painter.take();
        let draws = painter.as_ref().filter(|one| one.records(served.report.increment));
        let topics = self.topics.clone();
        let wants = |topic: &Topic| topics.contains(&topic);
        let written = answer::each(served, draws, &wants, &mut |topic, message| {
            self.write(topic, message, time)
        });
        self.painter = painter;
        written?;
        self.part.close_full_chunk()
    }

    /// Writes what else bears on the answers, at `time`; says whether it is still in an open chunk.
    pub(super) fn happened(&mut self, happened: &Happened, time: u64) -> Result<bool, BagError> {
        self.write(&topics::CIRCUMSTANCE, &Circumstance::from(happened), time)?;
        self.part.close_full_chunk()
    }

    /// Writes what came or went beside the answers, at `time`; says whether it is still in an open
    /// chunk.
    pub(super) fn beside(&mut self, beside: &Beside, time: u64) -> Result<bool, BagError> {
        let (topic, message) = answer::beside(beside);
        self.write(topic, message, time)?;
        self.part.close_full_chunk()
    }

    /// How the run ended, to be written at the end.
    pub(super) fn close_with(&mut self, closing: &Closing) {
        self.closing = Some(closing.clone());
    }

    /// What it holds so far.
    pub(super) fn contents(&self) -> &Contents {
        self.part.contents()
    }

    /// What the open chunk and its index will take at most.
    pub(super) fn open(&self) -> u64 {
        self.part.open()
    }

    /// Writes a message, unless its topic is not recorded.
    fn write(
        &mut self,
        topic: &'static Topic,
        message: &dyn Outgoing,
        time: u64,
    ) -> Result<(), BagError> {
        let Some(channel) = self.place(topic) else { return Ok(()) };
        let publish_time = message.stamp().nanoseconds().max(0).unsigned_abs();
        let mut buffer = std::mem::take(&mut self.buffer);
        message.encode(&mut buffer)?;
        if *topic == topics::TF_STATIC {
            self.past.frames = Some((buffer.clone(), publish_time));
            self.frames_due = false;
        }
        self.repeat_frames(time)?;
        self.put(channel, publish_time, time, &buffer)?;
        self.buffer = buffer;
        Ok(())
    }

    fn repeat_frames(&mut self, time: u64) -> Result<(), BagError> {
        if std::mem::take(&mut self.frames_due)
            && let Some((bytes, publish_time)) = self.past.frames.clone()
            && let Some(channel) = self.place(&topics::TF_STATIC)
        {
            self.put(channel, publish_time, time, &bytes)?;
        }
        Ok(())
    }

    fn put(
        &mut self,
        channel: usize,
        publish_time: u64,
        time: u64,
        bytes: &[u8],
    ) -> Result<(), BagError> {
        let log_time = match self.past.last {
            Some(last) => time.max(last + 1),
            None => time,
        };
        // The sequence as rosbag2 has it; a command's is in the message.
        self.part.write(channel, When { sequence: 0, log_time, publish_time }, bytes)?;
        self.past.last = Some(log_time);
        Ok(())
    }

    fn place(&self, topic: &'static Topic) -> Option<usize> {
        self.topics.iter().position(|known| std::ptr::eq(*known, topic))
    }

    /// Closes the open chunk, if there is one, and hands everything to the system.
    pub(super) fn flush(&mut self) -> Result<(), BagError> {
        self.part.flush()
    }

    /// Writes the index, and gives back what was written to and what goes to the next file.
    pub(super) fn finish(mut self, file_name: &str) -> Result<(W, Contents, Past), BagError> {
        if let Some(Closing { increment, digest }) = &self.closing {
            let metadata = BTreeMap::from([
                ("increment".into(), increment.to_string()),
                ("state".into(), digest.clone()),
            ]);
            self.part.metadata(END, metadata)?;
        }
        let (to, contents) = self.part.finish(file_name)?;
        Ok((to, contents, self.past))
    }
}

fn describe<W: Write>(part: &mut Part<W>, topic: &Topic) {
    let channel = Channel {
        topic: topic.recorded_name(),
        kind: topic.kind.full_name(),
        encoding: "cdr".into(),
        about: BTreeMap::from([
            (metadata::QOS.into(), metadata::offered_qos(topic)),
            (metadata::HASH.into(), topic.kind.hash.into()),
        ]),
        messages: 0,
    };
    let (name, definition) = (topic.kind.full_name(), topic.kind.definition());
    let schema = Schema { name: &name, encoding: "ros2msg", data: definition.as_bytes() };
    part.channel(channel, Some(&schema));
}

/// What the recording program was.
fn program(provenance: &Provenance) -> BTreeMap<String, String> {
    let features: Vec<&str> = [("mcap", cfg!(feature = "mcap")), ("ros", cfg!(feature = "ros"))]
        .into_iter()
        .filter_map(|(name, on)| on.then_some(name))
        .collect();
    BTreeMap::from([
        ("version".into(), env!("CARGO_PKG_VERSION").into()),
        ("features".into(), features.join(" ")),
        ("kernels".into(), lanes::kernels().into()),
        ("threads".into(), provenance.threads.to_string()),
        ("seed".into(), provenance.seed.to_string()),
    ])
}

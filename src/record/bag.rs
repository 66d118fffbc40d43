//! One MCAP file as rosbag2 lays it out.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};

use super::{Closing, END, HISTORY, PROGRAM, Provenance, metadata};
use crate::command::circumstance::Happened;
use crate::msg::Circumstance;
use crate::msg::answer::{self, Outgoing};
use crate::msg::cdr::CdrError;
use crate::msg::topics::{self, Topic};
use crate::relax::lanes;
use crate::scene::{self, Compression};
use crate::sink::{Beside, Served};

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

/// A topic in the file.
#[derive(Debug)]
pub(super) struct Channel {
    pub(super) topic: &'static Topic,
    pub(super) messages: u64,
    id: u16,
}

/// What a bag holds; times in nanoseconds since 1970.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// Every topic; none before the first message.
    pub(super) channels: Vec<Channel>,
    /// `log_time` of the first message.
    pub(super) first: Option<u64>,
    /// `log_time` of the last message.
    pub(super) last: Option<u64>,
}

impl Contents {
    /// Messages on all topics.
    pub(super) fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// Nanoseconds between the first and the last message.
    pub(super) fn duration(&self) -> u64 {
        self.last.unwrap_or(0) - self.first.unwrap_or(0)
    }
}

/// Writes answers into one MCAP file.
///
/// The chunks are this type's own business, not the MCAP writer's: that one closes a chunk
/// before the message that no longer fits, and so one without a message when the first message
/// is larger than a chunk, a file that rosbag2 then refuses to play. Here a chunk is closed after
/// an answer, and thus always holds one and is never smaller than its largest message.
pub(super) struct BagWriter<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    contents: Contents,
    chunk: u64,
    open: u64,
    buffer: Vec<u8>,
    closing: Option<Closing>,
}

impl<W: Write> BagWriter<W> {
    /// Begins a bag at `time` with its attachments.
    pub(super) fn new(
        to: W,
        settings: &scene::Record,
        provenance: &Provenance,
        time: u64,
    ) -> Result<Self, BagError> {
        let compression = match settings.compression {
            Compression::Zstd => Some(mcap::Compression::Zstd),
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            Compression::None => None,
        };
        let mut mcap = WriteOptions::new()
            .profile("ros2")
            .library(concat!("graintwin ", env!("CARGO_PKG_VERSION")))
            .compression(compression)
            // The processors are the solver's.
            .compression_threads(0)
            .chunk_size(None)
            // Chunks are made in memory and written in one go: a file that stops halfway stops
            // at the end of a chunk but for the one that was just being written.
            .disable_seeking(true)
            .create(NoSeek::new(to))?;
        let mut files: Vec<(&str, &str, &[u8])> = vec![
            ("scene.yaml", "application/yaml", provenance.scene.as_bytes()),
            ("pack.csv", "text/csv", &provenance.pack_csv),
            ("pack.json", "application/json", &provenance.pack_json),
        ];
        files.extend(
            provenance.pack_history.iter().map(|json| (HISTORY, "application/json", &**json)),
        );
        for (name, media_type, data) in files {
            mcap.attach(&Attachment {
                log_time: time,
                create_time: time,
                name: name.into(),
                media_type: media_type.into(),
                data: data.into(),
            })?;
        }
        let metadata = program(provenance);
        mcap.write_metadata(&Metadata { name: PROGRAM.into(), metadata })?;
        mcap.flush()?;
        let contents = Contents::default();
        Ok(Self {
            mcap,
            contents,
            chunk: settings.chunk,
            open: 0,
            buffer: Vec::new(),
            closing: None,
        })
    }

    /// Writes one answer, served at `time`; says whether it is still in an open chunk.
    pub(super) fn answer(&mut self, served: &Served, time: u64) -> Result<bool, BagError> {
        answer::each(served, &|_| true, &mut |topic, message| self.write(topic, message, time))?;
        self.close_full_chunk()
    }

    /// Writes what else bears on the answers, at `time`; says whether it is still in an open chunk.
    pub(super) fn happened(&mut self, happened: &Happened, time: u64) -> Result<bool, BagError> {
        self.write(&topics::CIRCUMSTANCE, &Circumstance::from(happened), time)?;
        self.close_full_chunk()
    }

    /// Writes what came or went beside the answers, at `time`; says whether it is still in an open
    /// chunk.
    pub(super) fn beside(&mut self, beside: &Beside, time: u64) -> Result<bool, BagError> {
        match beside {
            Beside::Measured(wall, wrench) => {
                self.write(&topics::MEASURED_WRENCH[*wall], wrench, time)?;
            }
            Beside::Discrepancy(message) => self.write(&topics::DISCREPANCY, message, time)?,
        }
        self.close_full_chunk()
    }

    /// How the run ended, to be written at the end.
    pub(super) fn close_with(&mut self, closing: &Closing) {
        self.closing = Some(closing.clone());
    }

    /// Messages so far.
    pub(super) fn messages(&self) -> u64 {
        self.contents.messages()
    }

    fn write(
        &mut self,
        topic: &'static Topic,
        message: &dyn Outgoing,
        time: u64,
    ) -> Result<(), BagError> {
        message.encode(&mut self.buffer)?;
        let log_time = match self.contents.last {
            Some(last) => time.max(last + 1),
            None => time,
        };
        if self.contents.channels.is_empty() {
            self.register()?;
        }
        let channel = self
            .contents
            .channels
            .iter_mut()
            .find(|channel| std::ptr::eq(channel.topic, topic))
            .expect("every topic is registered");
        let header = MessageHeader {
            channel_id: channel.id,
            // As rosbag2 does; a command's sequence is in the message.
            sequence: 0,
            log_time,
            publish_time: message.stamp().nanoseconds().max(0).unsigned_abs(),
        };
        self.mcap.write_to_known_channel(&header, &self.buffer)?;
        channel.messages += 1;
        self.contents.first.get_or_insert(log_time);
        self.contents.last = Some(log_time);
        self.open += self.buffer.len() as u64;
        Ok(())
    }

    /// Closes the open chunk when it is full; says whether it is still open. What a file that was
    /// cut off still holds is thus whole answers.
    fn close_full_chunk(&mut self) -> Result<bool, BagError> {
        if self.open >= self.chunk {
            self.flush()?;
        }
        Ok(self.open > 0)
    }

    /// Registers every topic, in the chunk of the first message.
    fn register(&mut self) -> Result<(), BagError> {
        for topic in topics::all() {
            let schema = self.mcap.add_schema(
                &topic.kind.full_name(),
                "ros2msg",
                topic.kind.definition().as_bytes(),
            )?;
            let about = BTreeMap::from([
                ("offered_qos_profiles".into(), metadata::offered_qos(topic)),
                ("topic_type_hash".into(), topic.kind.hash.into()),
            ]);
            let id = self.mcap.add_channel(schema, &topic.recorded_name(), "cdr", &about)?;
            self.contents.channels.push(Channel { topic, messages: 0, id });
        }
        Ok(())
    }

    /// Closes the open chunk, if there is one, and hands everything to the system.
    pub(super) fn flush(&mut self) -> Result<(), BagError> {
        self.mcap.flush()?;
        self.open = 0;
        Ok(())
    }

    /// Writes rosbag2's own record and the index, and gives back what was written to.
    pub(super) fn finish(mut self, file_name: &str) -> Result<(W, Contents), BagError> {
        let text = metadata::body(&self.contents, file_name);
        let metadata = BTreeMap::from([("serialized_metadata".into(), text)]);
        self.mcap.write_metadata(&Metadata { name: "rosbag2".into(), metadata })?;
        if let Some(Closing { increment, digest }) = &self.closing {
            let metadata = BTreeMap::from([
                ("increment".into(), increment.to_string()),
                ("state".into(), digest.clone()),
            ]);
            self.mcap.write_metadata(&Metadata { name: END.into(), metadata })?;
        }
        self.mcap.finish()?;
        Ok((self.mcap.into_inner().into_inner(), self.contents))
    }
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

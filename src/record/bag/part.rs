//! One MCAP file as rosbag2 lays it out, whatever is in it.

use std::collections::BTreeMap;
use std::io::Write;

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, WriteOptions};

use super::BagError;
use crate::record::metadata;
use crate::scene::{self, Compression};

/// A topic in a file.
#[derive(Clone, Debug, Default)]
pub(in crate::record) struct Channel {
    /// Its name.
    pub(in crate::record) topic: String,
    /// Name of its type.
    pub(in crate::record) kind: String,
    /// Encoding of its messages.
    pub(in crate::record) encoding: String,
    /// What else is said of it: `offered_qos_profiles` and `topic_type_hash` as rosbag2 has them.
    pub(in crate::record) about: BTreeMap<String, String>,
    /// How many messages it has.
    pub(in crate::record) messages: u64,
}

/// The definition of a type.
#[derive(Clone, Debug)]
pub(in crate::record) struct Schema<'a> {
    pub(in crate::record) name: &'a str,
    pub(in crate::record) encoding: &'a str,
    pub(in crate::record) data: &'a [u8],
}

/// What a file holds; times in nanoseconds since 1970.
#[derive(Clone, Debug, Default)]
pub(in crate::record) struct Contents {
    /// Its topics, once there is a message.
    pub(in crate::record) channels: Vec<Channel>,
    /// The earliest and the latest `log_time`.
    pub(in crate::record) times: Option<(u64, u64)>,
}

impl Contents {
    /// Messages on all topics.
    pub(in crate::record) fn messages(&self) -> u64 {
        self.channels.iter().map(|channel| channel.messages).sum()
    }

    /// `log_time` of the first message; 0 without any.
    pub(in crate::record) fn start(&self) -> u64 {
        self.times.map_or(0, |(first, _)| first)
    }

    /// Nanoseconds between the first and the last message.
    pub(in crate::record) fn duration(&self) -> u64 {
        self.times.map_or(0, |(first, last)| last - first)
    }

    /// Extends the times by `time`.
    pub(in crate::record) fn reaches(&mut self, time: u64) {
        let (first, last) = self.times.unwrap_or((time, time));
        self.times = Some((first.min(time), last.max(time)));
    }
}

/// Times and sequence of a message.
#[derive(Clone, Copy, Debug)]
pub(in crate::record) struct When {
    pub(in crate::record) sequence: u32,
    pub(in crate::record) log_time: u64,
    pub(in crate::record) publish_time: u64,
}

/// Writes one file.
///
/// The chunks are this type's own business, not the MCAP writer's: that one closes a chunk
/// before the message that no longer fits, and so one without a message when the first message
/// is larger than a chunk, a file that rosbag2 then refuses to play. Here a chunk is closed when
/// whoever writes says so, and a topic is registered together with a message.
pub(in crate::record) struct Part<W: Write> {
    mcap: mcap::Writer<NoSeek<W>>,
    contents: Contents,
    /// Of each channel: the number of its schema, and its own once it is registered.
    numbers: Vec<(u16, Option<u16>)>,
    schemas: Vec<(String, String, Vec<u8>)>,
    /// Whether a channel is not registered yet.
    news: bool,
    chunk: u64,
    open: u64,
    index: u64,
}

/// What a record adds to the bytes of a message.
const HEADER: u64 = 31;

/// What the index behind a chunk takes for a message.
const INDEX: u64 = 16;

/// Level of zstd when nothing is said of it.
const FASTEST: u32 = 1;

impl<W: Write> Part<W> {
    pub(in crate::record) fn new(to: W, settings: &scene::Record) -> Result<Self, BagError> {
        let compression = match settings.compression {
            Compression::Zstd => Some(mcap::Compression::Zstd),
            Compression::Lz4 => Some(mcap::Compression::Lz4),
            Compression::None => None,
        };
        let level = match settings.compression {
            Compression::Zstd => settings.level.unwrap_or(FASTEST),
            // The library's own.
            Compression::Lz4 | Compression::None => 0,
        };
        let mcap = WriteOptions::new()
            .profile("ros2")
            .library(concat!("graintwin ", env!("CARGO_PKG_VERSION")))
            .compression(compression)
            .compression_level(level)
            // The processors are the solver's.
            .compression_threads(0)
            .chunk_size(None)
            // Chunks are made in memory and written in one go: a file that stops halfway stops
            // at the end of a chunk but for the one that was just being written.
            .disable_seeking(true)
            .create(NoSeek::new(to))?;
        Ok(Self {
            mcap,
            contents: Contents::default(),
            numbers: Vec::new(),
            schemas: Vec::new(),
            news: false,
            chunk: settings.chunk,
            open: 0,
            index: 0,
        })
    }

    /// Puts a file in. Closes the open chunk.
    pub(in crate::record) fn attach(&mut self, file: &Attachment<'_>) -> Result<(), BagError> {
        self.mcap.attach(file)?;
        self.closed();
        Ok(())
    }

    /// Puts texts in. Closes the open chunk.
    pub(in crate::record) fn metadata(
        &mut self,
        name: &str,
        metadata: BTreeMap<String, String>,
    ) -> Result<(), BagError> {
        self.mcap.write_metadata(&Metadata { name: name.into(), metadata })?;
        self.closed();
        Ok(())
    }

    /// A topic whose messages will come; it is in the file from the next message on. Returns what
    /// to call it in [`Part::write`].
    pub(in crate::record) fn channel(
        &mut self,
        channel: Channel,
        schema: Option<&Schema<'_>>,
    ) -> usize {
        // Number 0 is a channel without schema.
        let number = schema.map_or(0, |schema| {
            let Schema { name, encoding, data } = *schema;
            let same = |known: &(String, String, Vec<u8>)| {
                known.0 == name && known.1 == encoding && known.2 == data
            };
            let place = self.schemas.iter().position(same).unwrap_or_else(|| {
                self.schemas.push((name.into(), encoding.into(), data.into()));
                self.schemas.len() - 1
            });
            place + 1
        });
        self.contents.channels.push(channel);
        self.news = true;
        self.numbers.push((u16::try_from(number).unwrap_or(u16::MAX), None));
        self.numbers.len() - 1
    }

    /// Registers in the file what it does not know yet.
    fn register(&mut self) -> Result<(), BagError> {
        for (channel, (schema, number)) in self.contents.channels.iter().zip(&mut self.numbers) {
            if number.is_some() {
                continue;
            }
            let schema = match schema.checked_sub(1) {
                None => 0,
                Some(place) => {
                    let (name, encoding, data) = &self.schemas[usize::from(place)];
                    self.mcap.add_schema(name, encoding, data)?
                }
            };
            let Channel { topic, encoding, about, .. } = channel;
            *number = Some(self.mcap.add_channel(schema, topic, encoding, about)?);
        }
        Ok(())
    }

    /// Writes a message on a channel of this part.
    pub(in crate::record) fn write(
        &mut self,
        channel: usize,
        when: When,
        data: &[u8],
    ) -> Result<(), BagError> {
        if std::mem::take(&mut self.news) {
            self.register()?;
        }
        let channel_id = self.numbers[channel].1.unwrap_or_default();
        let When { sequence, log_time, publish_time } = when;
        let header = MessageHeader { channel_id, sequence, log_time, publish_time };
        self.mcap.write_to_known_channel(&header, data)?;
        self.contents.channels[channel].messages += 1;
        self.contents.reaches(log_time);
        self.open += HEADER + data.len() as u64;
        self.index += INDEX;
        Ok(())
    }

    /// What the open chunk and its index will take at most.
    pub(in crate::record) fn open(&self) -> u64 {
        self.open + self.index
    }

    /// What it holds so far.
    pub(in crate::record) fn contents(&self) -> &Contents {
        &self.contents
    }

    /// Closes the open chunk when it is full; says whether one is still open.
    pub(in crate::record) fn close_full_chunk(&mut self) -> Result<bool, BagError> {
        if self.open >= self.chunk {
            self.flush()?;
        }
        Ok(self.open > 0)
    }

    /// Closes the open chunk, if there is one, and hands everything to the system.
    pub(in crate::record) fn flush(&mut self) -> Result<(), BagError> {
        self.mcap.flush()?;
        self.closed();
        Ok(())
    }

    fn closed(&mut self) {
        self.open = 0;
        self.index = 0;
    }

    /// Writes rosbag2's own record and the index, and gives back what was written to.
    pub(in crate::record) fn finish(mut self, file_name: &str) -> Result<(W, Contents), BagError> {
        if self.contents.times.is_none() {
            // They are in no chunk.
            self.contents.channels.clear();
        }
        let file = metadata::File { name: file_name.into(), contents: self.contents };
        let text = metadata::body(std::slice::from_ref(&file));
        let texts = BTreeMap::from([(metadata::KEY.into(), text)]);
        self.mcap.write_metadata(&Metadata { name: metadata::RECORD.into(), metadata: texts })?;
        self.mcap.finish()?;
        Ok((self.mcap.into_inner().into_inner(), file.contents))
    }
}

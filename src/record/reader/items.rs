//! What a bag is made of, piece by piece.

use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::fields::Record;
use super::records::{Records, Stop};
use super::{Channel, Message, ReadError};

/// A piece of a bag.
pub(in crate::record) enum Item {
    /// A topic that messages may follow on.
    Channel(Arc<Channel>),
    /// A message.
    Message(Message),
    /// A file that was put in.
    Attachment {
        /// Its name.
        name: String,
        /// Its MIME type.
        media_type: String,
        /// Its bytes.
        data: Vec<u8>,
    },
    /// Named texts.
    Metadata {
        /// Name of the record.
        name: String,
        /// The texts.
        values: BTreeMap<String, String>,
    },
}

/// The pieces of a bag's files, one file after the other; ends after the first error.
pub(in crate::record) struct Items<'a> {
    files: std::slice::Iter<'a, PathBuf>,
    current: Option<Part<'a>>,
    messages: u64,
}

impl<'a> Items<'a> {
    pub(super) fn new(files: &'a [PathBuf]) -> Self {
        Self { files: files.iter(), current: None, messages: 0 }
    }

    /// Gives nothing more.
    pub(in crate::record) fn end(&mut self) {
        self.files = [].iter();
        self.current = None;
    }

    fn fail(&mut self, path: &Path, stop: Stop) -> ReadError {
        self.files = [].iter();
        let path = path.to_owned();
        match stop {
            Stop::Io(error) => ReadError::Io { path, error },
            Stop::Damage(damage) => ReadError::Damaged { path, damage, messages: self.messages },
        }
    }
}

impl Iterator for Items<'_> {
    type Item = Result<Item, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut part = match self.current.take() {
                Some(part) => part,
                None => {
                    let path = self.files.next()?;
                    match Part::open(path) {
                        Ok(part) => part,
                        Err(stop) => return Some(Err(self.fail(path, stop))),
                    }
                }
            };
            match part.next() {
                Some(Ok(item)) => {
                    self.messages += u64::from(matches!(item, Item::Message(_)));
                    self.current = Some(part);
                    return Some(Ok(item));
                }
                Some(Err(stop)) => return Some(Err(self.fail(part.path, stop))),
                None => {}
            }
        }
    }
}

/// One file of a bag.
struct Part<'a> {
    path: &'a Path,
    records: Records,
    schemas: HashMap<u16, Schema>,
    channels: HashMap<u16, Arc<Channel>>,
}

#[derive(Default)]
struct Schema {
    name: String,
    text: String,
}

impl<'a> Part<'a> {
    fn open(path: &'a Path) -> Result<Self, Stop> {
        let records = Records::open(path).map_err(Stop::Io)?;
        Ok(Self { path, records, schemas: HashMap::new(), channels: HashMap::new() })
    }

    /// The item a record stands for; none when it is only for the reader.
    fn item(&mut self, record: Record) -> Result<Option<Item>, Stop> {
        Ok(match record {
            Record::Schema { id, name, text } => {
                self.schemas.insert(id, Schema { name, text });
                None
            }
            Record::Channel { id, schema, topic, encoding } => {
                let schema = self.schemas.get(&schema);
                let channel = Arc::new(Channel {
                    topic,
                    kind: schema.map_or_else(String::new, |schema| schema.name.clone()),
                    encoding,
                    definition: schema.map_or_else(String::new, |schema| schema.text.clone()),
                });
                // The summary at the end says all channels again.
                let known = self.channels.insert(id, Arc::clone(&channel));
                known.is_none().then_some(Item::Channel(channel))
            }
            Record::Message { channel, log_time, publish_time, data } => {
                let Some(known) = self.channels.get(&channel) else {
                    let reason = format!("a message on channel {channel}, which is not described");
                    return Err(self.records.damage(reason));
                };
                let channel = Arc::clone(known);
                Some(Item::Message(Message { channel, log_time, publish_time, data }))
            }
            Record::Attachment { name, media_type, data } => {
                Some(Item::Attachment { name, media_type, data })
            }
            Record::Metadata { name, values } => Some(Item::Metadata { name, values }),
            Record::Other => None,
        })
    }
}

impl Iterator for Part<'_> {
    type Item = Result<Item, Stop>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            match self.records.next()?.and_then(|record| self.item(record)) {
                Ok(Some(item)) => return Some(Ok(item)),
                Ok(None) => {}
                Err(stop) => return Some(Err(stop)),
            }
        }
    }
}

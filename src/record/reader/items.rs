//! What a bag is made of, piece by piece.

use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

use super::fields::Record;
use super::part::Part;
use super::records::{Records, Stop};
use super::{Channel, Message, ReadError, Schema};

/// A piece of a bag.
pub(in crate::record) enum Item {
    /// A topic that messages may follow on.
    Channel(Arc<Channel>),
    /// A message.
    Message(Message),
    /// A file that was put in.
    Attachment {
        /// When it was recorded and made \[ns since 1970\].
        times: (u64, u64),
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
pub(in crate::record) struct Items {
    parts: std::vec::IntoIter<Part>,
    current: Option<Pieces>,
    messages: u64,
}

impl Items {
    pub(super) fn new(parts: Vec<Part>) -> Self {
        Self { parts: parts.into_iter(), current: None, messages: 0 }
    }

    /// Gives nothing more.
    pub(in crate::record) fn end(&mut self) {
        self.parts = Vec::new().into_iter();
        self.current = None;
    }

    fn fail(&mut self, path: PathBuf, stop: Stop) -> ReadError {
        self.parts = Vec::new().into_iter();
        match stop {
            Stop::Io(error) => ReadError::Io { path, error },
            Stop::Damage(damage) => ReadError::Damaged { path, damage, messages: self.messages },
        }
    }
}

impl Iterator for Items {
    type Item = Result<Item, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let mut pieces = match self.current.take() {
                Some(pieces) => pieces,
                None => {
                    let part = self.parts.next()?;
                    match Records::open(&part) {
                        Ok(records) => Pieces::new(part.path, records),
                        Err(error) => return Some(Err(self.fail(part.path, error.into()))),
                    }
                }
            };
            match pieces.next() {
                Some(Ok(item)) => {
                    self.messages += u64::from(matches!(item, Item::Message(_)));
                    self.current = Some(pieces);
                    return Some(Ok(item));
                }
                Some(Err(stop)) => return Some(Err(self.fail(pieces.path, stop))),
                None => {}
            }
        }
    }
}

/// Most that the descriptions of a file's topics and types may take \[bytes\].
const DESCRIPTIONS: usize = 16 << 20;

/// What a description takes beside its text, and each word that it says \[bytes\].
const DESCRIPTION: usize = 512;
const WORD: usize = 64;

/// The pieces of one file.
struct Pieces {
    path: PathBuf,
    records: Records,
    schemas: HashMap<u16, Arc<Schema>>,
    channels: HashMap<u16, Known>,
    /// Taken by them \[bytes\].
    described: usize,
}

/// What a file says of a topic.
struct Described {
    topic: String,
    encoding: String,
    about: BTreeMap<String, String>,
}

/// A channel with the number of its schema.
struct Known {
    schema: u16,
    channel: Arc<Channel>,
}

impl Pieces {
    fn new(path: PathBuf, records: Records) -> Self {
        let (schemas, channels) = Default::default();
        Self { path, records, schemas, channels, described: 0 }
    }

    /// The item a record stands for; none when it is only for the reader.
    fn item(&mut self, record: Record) -> Result<Option<Item>, Stop> {
        Ok(match record {
            Record::Schema { id, name, encoding, data } => {
                // One may be binary; then it is none of ours, and its text does not matter.
                let text = String::from_utf8_lossy(&data).into();
                self.schema(id, Schema { name, encoding, text, data })?;
                None
            }
            Record::Channel { id, schema, topic, encoding, about } => {
                let described = Described { topic, encoding, about };
                self.channel(id, schema, described)?.map(Item::Channel)
            }
            Record::Message { channel, sequence, log_time, publish_time, data } => {
                let Some(known) = self.channels.get(&channel) else {
                    let reason = format!("a message on channel {channel}, which is not described");
                    return Err(self.records.damage(reason));
                };
                let channel = Arc::clone(&known.channel);
                Some(Item::Message(Message { channel, sequence, log_time, publish_time, data }))
            }
            Record::Attachment { log_time, create_time, name, media_type, data } => {
                let times = (log_time, create_time);
                Some(Item::Attachment { times, name, media_type, data })
            }
            Record::Metadata { name, values } => Some(Item::Metadata { name, values }),
            Record::Other => None,
        })
    }

    /// Notes a type. The summary at the end says all of them again.
    fn schema(&mut self, id: u16, schema: Schema) -> Result<(), Stop> {
        let reason = match self.schemas.get(&id) {
            _ if id == 0 => "type 0 is described: it stands for none".into(),
            Some(known) if **known == schema => return Ok(()),
            Some(_) => format!("type {id} is described a second time, and otherwise"),
            None => {
                self.describe(schema.name.len() + schema.text.len() + schema.data.len())?;
                self.schemas.insert(id, Arc::new(schema));
                return Ok(());
            }
        };
        Err(self.records.damage(reason))
    }

    /// Notes a topic, and tells it when it is new.
    fn channel(
        &mut self,
        id: u16,
        schema: u16,
        described: Described,
    ) -> Result<Option<Arc<Channel>>, Stop> {
        let Described { topic, encoding, about } = described;
        if let Some(known) = self.channels.get(&id) {
            let old = &*known.channel;
            let same = (known.schema, &old.topic, &old.encoding, &old.about)
                == (schema, &topic, &encoding, &about);
            let reason = format!("channel {id} is described a second time, and otherwise");
            return if same { Ok(None) } else { Err(self.records.damage(reason)) };
        }
        let kind = self.schemas.get(&schema).map(Arc::clone);
        if kind.is_none() && schema != 0 {
            let reason = format!("channel {id} has type {schema}, which is not described");
            return Err(self.records.damage(reason));
        }
        let told: usize = about.iter().map(|(name, text)| name.len() + text.len() + WORD).sum();
        self.describe(topic.len() + encoding.len() + told)?;
        let channel = Arc::new(Channel {
            topic,
            kind: kind.as_ref().map_or_else(String::new, |kind| kind.name.clone()),
            encoding,
            definition: kind.as_ref().map_or_else(|| "".into(), |kind| Arc::clone(&kind.text)),
            about,
            schema: kind,
        });
        self.channels.insert(id, Known { schema, channel: Arc::clone(&channel) });
        Ok(Some(channel))
    }

    /// Counts a description of `bytes`.
    fn describe(&mut self, bytes: usize) -> Result<(), Stop> {
        self.described = self.described.saturating_add(bytes).saturating_add(DESCRIPTION);
        if self.described <= DESCRIPTIONS {
            return Ok(());
        }
        let reason = format!("topics and types are described in more than {DESCRIPTIONS} bytes");
        Err(self.records.damage(reason))
    }
}

impl Iterator for Pieces {
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

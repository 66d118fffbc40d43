//! What is in a bag.

use std::collections::BTreeMap;

use super::items::Item;
use super::{Bag, ReadError};

/// What is in a bag.
#[derive(Debug, Default)]
pub struct Survey {
    /// Its topics by name.
    pub topics: BTreeMap<String, TopicSummary>,
    /// The earliest and the latest time of recording \[ns since 1970\].
    pub times: Option<(u64, u64)>,
    /// Its attachments in the order of the bag.
    pub attachments: Vec<AttachmentSummary>,
    /// Its metadata records by name.
    pub metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Where it stops making sense; all the rest is what was read before that.
    pub damage: Option<ReadError>,
}

/// A topic in a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TopicSummary {
    /// Name of its type.
    pub kind: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// How many there are.
    pub messages: u64,
}

/// An attachment in a bag.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AttachmentSummary {
    /// Its name.
    pub name: String,
    /// Its MIME type.
    pub media_type: String,
    /// Its size.
    pub bytes: u64,
}

impl Survey {
    /// Reads all of `bag`.
    pub(super) fn of(bag: &Bag) -> Result<Self, ReadError> {
        let mut survey = Self::default();
        for item in bag.items() {
            match item {
                Ok(item) => survey.add(item),
                Err(error @ ReadError::Damaged { .. }) => survey.damage = Some(error),
                Err(error) => return Err(error),
            }
        }
        Ok(survey)
    }

    /// Messages on all topics.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.topics.values().map(|topic| topic.messages).sum()
    }

    fn add(&mut self, item: Item) {
        match item {
            Item::Channel(channel) => {
                self.topics.entry(channel.topic.clone()).or_insert_with(|| TopicSummary {
                    kind: channel.kind.clone(),
                    encoding: channel.encoding.clone(),
                    messages: 0,
                });
            }
            Item::Message(message) => {
                let time = message.log_time;
                let (first, last) = self.times.unwrap_or((time, time));
                self.times = Some((first.min(time), last.max(time)));
                if let Some(topic) = self.topics.get_mut(&message.channel.topic) {
                    topic.messages += 1;
                }
            }
            Item::Attachment { name, media_type, data, .. } => {
                let bytes = data.len() as u64;
                self.attachments.push(AttachmentSummary { name, media_type, bytes });
            }
            Item::Metadata { name, values } => {
                self.metadata.insert(name, values);
            }
        }
    }
}

//! The records of an MCAP file that are of interest, taken apart without trust in their lengths.

use std::collections::BTreeMap;

use mcap::records::op;

/// A record, as far as a reader of recordings cares.
#[derive(Debug)]
pub(super) enum Record {
    Schema {
        id: u16,
        name: String,
        text: String,
    },
    Channel {
        id: u16,
        schema: u16,
        topic: String,
        encoding: String,
    },
    Message {
        channel: u16,
        log_time: u64,
        publish_time: u64,
        data: Vec<u8>,
    },
    Attachment {
        name: String,
        media_type: String,
        data: Vec<u8>,
    },
    Metadata {
        name: String,
        values: BTreeMap<String, String>,
    },
    /// Index, statistics and what else a reader from the front does without.
    Other,
}

impl Record {
    /// Takes a record apart; the error says what is wrong with it.
    pub(super) fn parse(opcode: u8, body: &[u8]) -> Result<Self, String> {
        let mut fields = Fields(body);
        let record = match opcode {
            op::SCHEMA => fields.schema(),
            op::CHANNEL => fields.channel(),
            op::MESSAGE => fields.message(),
            op::ATTACHMENT => return fields.attachment(body),
            op::METADATA => fields.metadata(),
            _ => Some(Self::Other),
        };
        record.ok_or_else(|| format!("a record of kind {opcode} with impossible lengths or text"))
    }
}

/// Whether a chunk that is not packed holds more than its header says. The MCAP reader counts the
/// bytes of such a chunk below zero.
pub(super) fn chunk_overflows(body: &[u8]) -> bool {
    let mut fields = Fields(body);
    let declared = (|| {
        fields.bytes(28)?;
        fields.text()?.is_empty().then_some(fields.u64()?)
    })();
    declared.is_some_and(|declared| fields.0.len() as u64 > declared)
}

struct Fields<'a>(&'a [u8]);

impl<'a> Fields<'a> {
    fn schema(&mut self) -> Option<Record> {
        let id = self.u16()?;
        let name = self.text()?.to_owned();
        let _encoding = self.text()?;
        // A schema may be binary; then it is none of ours, and its text does not matter.
        let length = self.u32()? as usize;
        let text = String::from_utf8_lossy(self.bytes(length)?).into_owned();
        Some(Record::Schema { id, name, text })
    }

    fn channel(&mut self) -> Option<Record> {
        let (id, schema) = (self.u16()?, self.u16()?);
        let topic = self.text()?.to_owned();
        let encoding = self.text()?.to_owned();
        Some(Record::Channel { id, schema, topic, encoding })
    }

    fn message(&mut self) -> Option<Record> {
        let channel = self.u16()?;
        let _sequence = self.u32()?;
        let (log_time, publish_time) = (self.u64()?, self.u64()?);
        Some(Record::Message { channel, log_time, publish_time, data: self.0.to_vec() })
    }

    fn metadata(&mut self) -> Option<Record> {
        let name = self.text()?.to_owned();
        let length = self.u32()? as usize;
        let mut pairs = Fields(self.bytes(length)?);
        let mut values = BTreeMap::new();
        while !pairs.0.is_empty() {
            values.insert(pairs.text()?.to_owned(), pairs.text()?.to_owned());
        }
        Some(Record::Metadata { name, values })
    }

    /// The crate's own parser checks the sum over an attachment, but only once the lengths are
    /// known to be possible.
    fn attachment(&mut self, body: &[u8]) -> Result<Record, String> {
        let possible = (|| {
            self.bytes(16)?;
            self.text()?;
            self.text()?;
            let length = usize::try_from(self.u64()?).ok()?;
            self.bytes(length)?;
            (self.0.len() == 4).then_some(())
        })();
        if possible.is_none() {
            return Err("an attachment with impossible lengths or text".into());
        }
        match mcap::parse_record(op::ATTACHMENT, body) {
            Ok(mcap::records::Record::Attachment { header, data, .. }) => Ok(Record::Attachment {
                name: header.name,
                media_type: header.media_type,
                data: data.into_owned(),
            }),
            Ok(_) => Err("an attachment that is none".into()),
            Err(error) => Err(error.to_string()),
        }
    }

    fn bytes(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (taken, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*taken)
    }

    fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()? as usize;
        std::str::from_utf8(self.bytes(length)?).ok()
    }
}

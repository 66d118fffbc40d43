//! The records of an MCAP file that are of interest, taken apart without trust in their lengths.

use std::collections::BTreeMap;

use mcap::records::op;

/// A record, as far as a reader of recordings cares.
#[derive(Debug)]
pub(super) enum Record {
    Schema {
        id: u16,
        name: String,
        encoding: String,
        data: Vec<u8>,
    },
    Channel {
        id: u16,
        schema: u16,
        topic: String,
        encoding: String,
        about: BTreeMap<String, String>,
    },
    Message {
        channel: u16,
        sequence: u32,
        log_time: u64,
        publish_time: u64,
        data: Vec<u8>,
    },
    Attachment {
        log_time: u64,
        create_time: u64,
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
            op::METADATA => fields.metadata(),
            _ => Some(Self::Other),
        };
        record.ok_or_else(|| format!("a record of kind {opcode} with impossible lengths or text"))
    }

    /// Takes a record out of a chunk apart. Only three kinds may be in one, and those that other
    /// programs may add.
    pub(super) fn in_chunk(opcode: u8, body: &[u8]) -> Result<Self, String> {
        match opcode {
            op::SCHEMA | op::CHANNEL | op::MESSAGE => Self::parse(opcode, body),
            0..=op::DATA_END => Err(format!("a record of kind {opcode} in a chunk")),
            _ => Ok(Self::Other),
        }
    }

    /// Takes an attachment apart, whose bytes stay where they are.
    pub(super) fn attachment(mut body: Vec<u8>) -> Result<Self, String> {
        let mut fields = Fields(&body);
        let Some((head, length, sum)) = fields.attachment() else {
            return Err("an attachment with impossible lengths or text".into());
        };
        let AttachmentHead { log_time, create_time, name, media_type } = head;
        let end = body.len() - 4;
        if sum != 0 && crc32fast::hash(&body[..end]) != sum {
            return Err(format!("the sum over attachment `{name}` is not its own"));
        }
        body.truncate(end);
        body.drain(..end - length);
        Ok(Self::Attachment { log_time, create_time, name, media_type, data: body })
    }
}

/// What stands before the data of an attachment.
struct AttachmentHead {
    log_time: u64,
    create_time: u64,
    name: String,
    media_type: String,
}

/// Longest name of a topic, a type or an encoding \[bytes\]; ROS 2 allows fewer than 256.
const LONGEST_NAME: usize = 512;

/// What is left of a record.
pub(super) struct Fields<'a>(pub(super) &'a [u8]);

impl<'a> Fields<'a> {
    fn schema(&mut self) -> Option<Record> {
        let id = self.u16()?;
        let name = self.name()?.to_owned();
        let encoding = self.name()?.to_owned();
        let length = self.u32()? as usize;
        let data = self.bytes(length)?.to_vec();
        Some(Record::Schema { id, name, encoding, data })
    }

    fn channel(&mut self) -> Option<Record> {
        let (id, schema) = (self.u16()?, self.u16()?);
        let topic = self.name()?.to_owned();
        let encoding = self.name()?.to_owned();
        let about = self.texts()?;
        Some(Record::Channel { id, schema, topic, encoding, about })
    }

    fn message(&mut self) -> Option<Record> {
        let channel = self.u16()?;
        let sequence = self.u32()?;
        let (log_time, publish_time) = (self.u64()?, self.u64()?);
        let data = self.0.to_vec();
        Some(Record::Message { channel, sequence, log_time, publish_time, data })
    }

    fn metadata(&mut self) -> Option<Record> {
        let name = self.name()?.to_owned();
        let values = self.texts()?;
        Some(Record::Metadata { name, values })
    }

    /// Texts by name.
    fn texts(&mut self) -> Option<BTreeMap<String, String>> {
        let length = self.u32()? as usize;
        let mut pairs = Fields(self.bytes(length)?);
        let mut texts = BTreeMap::new();
        while !pairs.0.is_empty() {
            texts.insert(pairs.text()?.to_owned(), pairs.text()?.to_owned());
        }
        Some(texts)
    }

    /// What is before the data, their size and the sum; nothing where the lengths do not fill the
    /// record.
    fn attachment(&mut self) -> Option<(AttachmentHead, usize, u32)> {
        let (log_time, create_time) = (self.u64()?, self.u64()?);
        let (name, media_type) = (self.name()?.to_owned(), self.name()?.to_owned());
        let head = AttachmentHead { log_time, create_time, name, media_type };
        let length = usize::try_from(self.u64()?).ok()?;
        self.bytes(length)?;
        let sum = self.u32()?;
        self.0.is_empty().then_some((head, length, sum))
    }

    /// Opcode and body of a whole record.
    pub(super) fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let [opcode] = self.array()?;
        let length = usize::try_from(self.u64()?).ok()?;
        Some((opcode, self.bytes(length)?))
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

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    fn text(&mut self) -> Option<&'a str> {
        let length = self.u32()? as usize;
        std::str::from_utf8(self.bytes(length)?).ok()
    }
    /// A text that may be shown on a terminal.
    pub(super) fn name(&mut self) -> Option<&'a str> {
        let name = self.text()?;
        (name.len() <= LONGEST_NAME && !name.contains(char::is_control)).then_some(name)
    }
}

//! The records of an MCAP file from its front to its end, chunks unpacked.

use std::io::{self, Read};

use mcap::MAGIC;
use mcap::records::op;

use super::bounded::fill;
use super::chunk::{Chunk, LARGEST, Unusable};
use super::fields::{Fields, Record};
use super::part::Part;

/// Largest description of a type, of a topic or of anything else in words \[bytes\].
const LARGEST_TEXT: usize = 16 << 20;

/// Opcode and length in front of every record.
const PREFIX: usize = 9;

/// Body of the record that ends the file.
const FOOTER: usize = 20;

/// Bytes passed over at once.
const PIECE: usize = 64 << 10;

/// Where a file stops making sense, and why.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("damaged at byte {offset}: {reason}")]
pub struct Damage {
    /// Start of the first record that cannot be read whole.
    pub offset: u64,
    /// What is wrong with it.
    pub reason: String,
}

/// What stopped the reading.
#[derive(Debug)]
pub(super) enum Stop {
    /// The system.
    Io(io::Error),
    /// The contents.
    Damage(Damage),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Reads one file.
pub(super) struct Records {
    from: Box<dyn Read + Send>,
    /// Start of the record at hand in the file.
    at: u64,
    /// Start of the record after it.
    next: u64,
    /// Over the section at hand.
    sum: crc32fast::Hasher,
    section: Section,
    /// The chunk at hand.
    chunk: Chunk,
    /// What ends the file, behind the records of the chunk.
    stop: Option<Stop>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Section {
    /// Before the first record.
    Start,
    Data,
    Summary,
    /// Behind the last record.
    End,
}

impl Records {
    pub(super) fn open(part: &Part) -> io::Result<Self> {
        Ok(Self {
            from: part.read()?,
            at: 0,
            next: 0,
            sum: crc32fast::Hasher::new(),
            section: Section::Start,
            chunk: Chunk::default(),
            stop: None,
        })
    }

    /// Damage at the record that was read last.
    pub(super) fn damage(&self, reason: impl Into<String>) -> Stop {
        Stop::Damage(Damage { offset: self.at, reason: reason.into() })
    }

    fn end(&mut self, stop: Stop) -> Stop {
        self.section = Section::End;
        self.chunk = Chunk::default();
        self.stop = None;
        stop
    }

    /// Reads a record of the file itself; `None` when it is a chunk, or the end.
    fn frame(&mut self) -> Result<Option<Record>, Stop> {
        if self.section == Section::Start {
            self.mark("the file ends within the mark that MCAP files begin with")?;
            self.section = Section::Data;
        }
        self.at = self.next;
        let mut prefix = Vec::new();
        if !fill(&mut self.from, &mut prefix, PREFIX)? {
            return Err(self.damage(match prefix.is_empty() {
                true => "the file ends without the record that closes it",
                false => IN_THE_MIDDLE,
            }));
        }
        let before = self.sum.clone();
        self.sum.update(&prefix);
        let opcode = prefix[0];
        let length = Fields(&prefix[1..]).u64().unwrap_or_default();
        self.next = self.next.saturating_add(PREFIX as u64).saturating_add(length);
        let most = match opcode {
            0 => return Err(self.damage("a record of kind 0, which there is not")),
            op::CHUNK | op::MESSAGE | op::ATTACHMENT => LARGEST,
            op::SCHEMA | op::CHANNEL | op::METADATA => LARGEST_TEXT,
            op::DATA_END => return self.data_end(length, before).map(|()| None),
            op::FOOTER => return self.footer(length).map(|()| None),
            _ => return self.pass_over(length).map(|()| Some(Record::Other)),
        };
        if self.section == Section::Summary && !matches!(opcode, op::SCHEMA | op::CHANNEL) {
            return Err(self.damage(format!("a record of kind {opcode} behind the data's end")));
        }
        let length = usize::try_from(length).ok().filter(|length| *length <= most);
        let Some(length) = length else {
            let text = format!("a record of kind {opcode} with more than {most} bytes");
            return Err(self.damage(text));
        };
        let mut body = Vec::new();
        if !fill(&mut self.from, &mut body, length)? {
            let stop = self.damage(IN_THE_MIDDLE);
            if opcode != op::CHUNK {
                return Err(stop);
            }
            self.stop = Some(stop);
            self.chunk = Chunk::unpack(body, true).unwrap_or_default();
            return Ok(None);
        }
        self.sum.update(&body);
        if opcode == op::CHUNK {
            self.chunk = Chunk::unpack(body, false).map_err(|unusable| match unusable {
                Unusable::Io(error) => Stop::Io(error),
                Unusable::Damage(reason) => self.damage(reason),
            })?;
            return Ok(None);
        }
        let record = match opcode {
            op::ATTACHMENT => Record::attachment(body),
            _ => Record::parse(opcode, &body),
        };
        record.map(Some).map_err(|reason| self.damage(reason))
    }

    /// Reads the mark at either end of a file.
    fn mark(&mut self, cut: &str) -> Result<(), Stop> {
        let mut mark = Vec::new();
        let whole = fill(&mut self.from, &mut mark, MAGIC.len())?;
        if !MAGIC.starts_with(&mark) {
            return Err(self.damage("not the mark that MCAP files begin and end with"));
        }
        if !whole {
            return Err(self.damage(cut));
        }
        self.sum.update(&mark);
        self.next += mark.len() as u64;
        Ok(())
    }

    /// Reads the record that ends the data; `sum` is that over all bytes before it.
    fn data_end(&mut self, length: u64, sum: crc32fast::Hasher) -> Result<(), Stop> {
        if self.section != Section::Data {
            return Err(self.damage("the data end twice"));
        }
        let body = self.small(length, 4)?;
        let said = Fields(&body).u32().unwrap_or_default();
        if said != 0 && sum.finalize() != said {
            return Err(self.damage("the sum over all bytes before this is not theirs"));
        }
        self.section = Section::Summary;
        self.sum = crc32fast::Hasher::new();
        Ok(())
    }

    /// Reads the record that ends the file, and what is behind it.
    fn footer(&mut self, length: u64) -> Result<(), Stop> {
        if self.section != Section::Summary {
            return Err(self.damage("the file ends before its data do"));
        }
        let body = self.small(length, FOOTER)?;
        let (summed, sum) = body.split_at(FOOTER - 4);
        self.sum.update(summed);
        let said = Fields(sum).u32().unwrap_or_default();
        if said != 0 && self.sum.clone().finalize() != said {
            return Err(self.damage("the sum over the summary is not its own"));
        }
        self.at = self.next;
        self.mark("the file ends within the mark that MCAP files end with")?;
        self.section = Section::End;
        if self.from.read(&mut [0])? != 0 {
            self.at = self.next;
            return Err(self.damage("more bytes behind the end"));
        }
        Ok(())
    }

    /// A body that has one size only.
    fn small(&mut self, length: u64, size: usize) -> Result<Vec<u8>, Stop> {
        if length != size as u64 {
            return Err(self.damage("a record at the end of a section with an impossible length"));
        }
        let mut body = Vec::new();
        match fill(&mut self.from, &mut body, size)? {
            true => Ok(body),
            false => Err(self.damage(IN_THE_MIDDLE)),
        }
    }

    fn pass_over(&mut self, mut length: u64) -> Result<(), Stop> {
        let mut piece = Vec::new();
        while length > 0 {
            piece.clear();
            let wanted = usize::try_from(length).unwrap_or(PIECE).min(PIECE);
            if !fill(&mut self.from, &mut piece, wanted)? {
                return Err(self.damage(IN_THE_MIDDLE));
            }
            self.sum.update(&piece);
            length -= wanted as u64;
        }
        Ok(())
    }
}

const IN_THE_MIDDLE: &str = "the file ends in the middle of a record";

impl Iterator for Records {
    type Item = Result<Record, Stop>;

    /// Ends after the first error.
    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(record) = self.chunk.record() {
                let record = record.map_err(|reason| self.damage(reason));
                return Some(record.map_err(|stop| self.end(stop)));
            }
            if let Some(stop) = self.stop.take() {
                return Some(Err(self.end(stop)));
            }
            if self.section == Section::End {
                return None;
            }
            match self.frame() {
                Ok(None) => {}
                Ok(Some(record)) => return Some(Ok(record)),
                Err(stop) => return Some(Err(self.end(stop))),
            }
        }
    }
}

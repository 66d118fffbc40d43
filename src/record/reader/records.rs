//! The records of an MCAP file from its front to its end, chunks unpacked.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use mcap::{MAGIC, McapError};

use super::fields::{self, Record};

/// Largest record, and largest chunk packed or unpacked, that is taken into memory \[bytes\]:
/// a network of 7 10^6 contacts.
const LARGEST: usize = 512 << 20;

/// Bytes asked of the file at once.
const PIECE: usize = 64 << 10;

/// Opcode and length in front of every record.
const PREFIX: usize = 9;

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

/// Reads one file.
pub(super) struct Records {
    file: File,
    framing: LinearReader,
    /// Start of the record at hand in the file.
    at: u64,
    /// Start of the record after it.
    next: u64,
    /// Records out of the chunk at hand.
    unpacked: VecDeque<Frame>,
    /// What ends the file, behind the unpacked records.
    stop: Option<Stop>,
    ended: bool,
}

/// Opcode and body of a record.
type Frame = (u8, Vec<u8>);

impl Records {
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_validate_data_section_crc(true)
            .with_validate_summary_section_crc(true)
            .with_check_finishes_after_end_magic(true)
            .with_record_length_limit(LARGEST);
        Ok(Self {
            file: File::open(path)?,
            framing: LinearReader::new_with_options(options),
            at: 0,
            next: MAGIC.len() as u64,
            unpacked: VecDeque::new(),
            stop: None,
            ended: false,
        })
    }

    /// Damage at the record that was read last.
    pub(super) fn damage(&self, reason: String) -> Stop {
        Stop::Damage(Damage { offset: self.at, reason })
    }

    /// The next frame of the file itself.
    fn frame(&mut self) -> Option<Result<Frame, Stop>> {
        loop {
            match self.framing.next_event()? {
                Ok(LinearReadEvent::ReadRequest(_)) => {
                    match read(&mut self.file, self.framing.insert(PIECE)) {
                        Ok(count) => self.framing.notify_read(count),
                        Err(error) => return Some(Err(Stop::Io(error))),
                    }
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    self.at = self.next;
                    self.next += (PREFIX + data.len()) as u64;
                    return Some(Ok((opcode, data.to_vec())));
                }
                Err(error) => {
                    self.at = self.next;
                    if matches!(error, McapError::UnexpectedEof) {
                        self.unpacked = self.rescue().unwrap_or_default();
                    }
                    return Some(Err(self.damage(reason(error))));
                }
            }
        }
    }

    /// What can be read of a chunk that the file's end cuts through.
    fn rescue(&mut self) -> io::Result<VecDeque<Frame>> {
        self.file.seek(SeekFrom::Start(self.at))?;
        let mut prefix = [0; PREFIX];
        self.file.read_exact(&mut prefix)?;
        if prefix[0] != op::CHUNK {
            return Ok(VecDeque::new());
        }
        let mut body = Vec::new();
        self.file.by_ref().take(LARGEST as u64).read_to_end(&mut body)?;
        Ok(unpack(prefix, &body).0)
    }

    fn chunk(&mut self, body: &[u8]) {
        let mut prefix = [op::CHUNK; PREFIX];
        prefix[1..].copy_from_slice(&(body.len() as u64).to_le_bytes());
        match unpack(prefix, body) {
            (unpacked, Ok(())) => self.unpacked = unpacked,
            (_, Err(error)) => self.stop = Some(self.damage(reason(error))),
        }
    }
}

impl Iterator for Records {
    type Item = Result<Record, Stop>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            if let Some((opcode, body)) = self.unpacked.pop_front() {
                let record = Record::parse(opcode, &body).map_err(|reason| self.damage(reason));
                self.ended = record.is_err();
                return Some(record);
            }
            if let Some(stop) = self.stop.take() {
                self.ended = true;
                return Some(Err(stop));
            }
            match self.frame() {
                Some(Ok((op::CHUNK, body))) => self.chunk(&body),
                Some(Ok(frame)) => self.unpacked.push_back(frame),
                Some(Err(stop)) => self.stop = Some(stop),
                None => self.ended = true,
            }
        }
        None
    }
}

/// The records in a chunk, whole or cut off, and whether that is all of them.
fn unpack(prefix: [u8; PREFIX], body: &[u8]) -> (VecDeque<Frame>, Result<(), McapError>) {
    let mut unpacked = VecDeque::new();
    if fields::chunk_overflows(body) {
        return (unpacked, Err(McapError::UnexpectedEoc));
    }
    let options = LinearReaderOptions::default()
        .with_skip_start_magic(true)
        .with_skip_end_magic(true)
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(LARGEST);
    let mut reader = LinearReader::new_with_options(options);
    let mut source = prefix.chain(body);
    let mut bytes = 0_usize;
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(_)) => match source.read(reader.insert(PIECE)) {
                Ok(count) => reader.notify_read(count),
                Err(error) => return (unpacked, Err(error.into())),
            },
            Ok(LinearReadEvent::Record { opcode, data }) => {
                bytes += data.len();
                if bytes > LARGEST {
                    return (unpacked, Err(McapError::ChunkTooLarge(bytes as u64)));
                }
                unpacked.push_back((opcode, data.to_vec()));
            }
            Err(error) => return (unpacked, Err(error)),
        }
    }
    (unpacked, Ok(()))
}

/// Reads what is there; no bytes at the end of the file.
fn read(file: &mut File, into: &mut [u8]) -> io::Result<usize> {
    loop {
        match file.read(into) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            other => return other,
        }
    }
}

/// The sentence about an error, with its cause where the sentence hides it.
fn reason(error: McapError) -> String {
    match error {
        McapError::Io(error) => error.to_string(),
        McapError::UnexpectedEof => "the file ends in the middle of a record".into(),
        McapError::BadMagic => "not the mark that MCAP files begin and end with".into(),
        other => other.to_string(),
    }
}

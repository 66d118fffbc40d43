//! Chunks: records that were packed together.

use std::io::{self, Read};

use super::bounded::fill;
use super::fields::{Fields, Record};

/// Largest record, and largest chunk packed or unpacked, that is taken into memory \[bytes\]:
/// a network of 7 10^6 contacts.
pub(super) const LARGEST: usize = 512 << 20;

/// What any chunk may unpack to \[bytes\].
const MODEST: usize = 64 << 20;

/// How much larger than packed a chunk that is not modest may be. Forces and positions pack to a
/// half or a quarter; what packs to a hundredth holds nothing and is made to fill memory.
const RATIO: usize = 100;

/// How a zstd frame begins. The library would also unpack those of its first years.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// The records of a chunk in one piece.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    bytes: Vec<u8>,
    /// Start of the next record.
    next: usize,
    /// Whether the last record may be cut off.
    cut: bool,
}

/// Why a chunk is of no use.
pub(super) enum Unusable {
    /// There is no memory for it.
    Io(io::Error),
    /// Its contents.
    Damage(String),
}

impl Chunk {
    /// Unpacks the body of a chunk record. Of one that is `cut` off, what can be had.
    pub(super) fn unpack(mut body: Vec<u8>, cut: bool) -> Result<Self, Unusable> {
        let mut fields = Fields(&body);
        let head = Head::read(&mut fields);
        let Some(head) = head else {
            return match cut {
                true => Ok(Self::default()),
                false => Err(Unusable::Damage("a chunk with impossible lengths or text".into())),
            };
        };
        let there = fields.0.len();
        if !cut && there < head.packed {
            let text = format!("a chunk of {there} bytes that says it has {}", head.packed);
            return Err(Unusable::Damage(text));
        }
        let packed = &fields.0[..there.min(head.packed)];
        let most = MODEST.max(packed.len().saturating_mul(RATIO)).min(LARGEST);
        if !cut && head.unpacked > most {
            return Err(Unusable::Damage(format!(
                "a chunk of {} bytes that says it unpacks to {}; at most {most} are allowed",
                packed.len(),
                head.unpacked
            )));
        }
        let most = most.min(head.unpacked);
        let bytes = match head.packing.as_str() {
            "" => {
                let start = body.len() - there;
                let length = packed.len();
                if !cut && length != head.unpacked {
                    return Err(Unusable::Damage(other_size(length, head.unpacked)));
                }
                body.truncate(start + length);
                body.drain(..start);
                body
            }
            "zstd" if packed.starts_with(&ZSTD) => {
                match zstd::stream::read::Decoder::with_buffer(packed) {
                    Ok(from) => unpack(&mut from.single_frame(), most, cut)?,
                    Err(error) => return Err(Unusable::Io(error)),
                }
            }
            "zstd" if cut => Vec::new(),
            "zstd" => return Err(Unusable::Damage("a chunk that zstd did not pack".into())),
            "lz4" => match lz4::Decoder::new(packed) {
                Ok(mut from) => unpack(&mut from, most, cut)?,
                Err(error) => return Err(Unusable::Io(error)),
            },
            other => {
                let text = format!("a chunk packed with `{other}`; allowed: zstd, lz4 or nothing");
                return Err(Unusable::Damage(text));
            }
        };
        if !cut && head.sum != 0 && crc32fast::hash(&bytes) != head.sum {
            return Err(Unusable::Damage("the sum over a chunk's contents is not theirs".into()));
        }
        Ok(Self { bytes, next: 0, cut })
    }

    /// The next record; the error says what is wrong with it.
    pub(super) fn record(&mut self) -> Option<Result<Record, String>> {
        if self.next == self.bytes.len() {
            // Nothing of it is needed while the next one is unpacked.
            *self = Self::default();
            return None;
        }
        let mut fields = Fields(&self.bytes[self.next..]);
        let record = fields.record().map(|(opcode, body)| Record::in_chunk(opcode, body));
        self.next = self.bytes.len() - fields.0.len();
        if record.is_none() {
            let cut = self.cut;
            *self = Self::default();
            return (!cut).then(|| Err("a chunk that ends in the middle of a record".into()));
        }
        record
    }
}

/// What stands in front of the packed records.
struct Head {
    unpacked: usize,
    sum: u32,
    packing: String,
    packed: usize,
}

impl Head {
    fn read(fields: &mut Fields<'_>) -> Option<Self> {
        let _times = (fields.u64()?, fields.u64()?);
        let unpacked = usize::try_from(fields.u64()?).ok()?;
        let sum = fields.u32()?;
        let packing = fields.name()?.to_owned();
        let packed = usize::try_from(fields.u64()?).ok()?;
        Some(Self { unpacked, sum, packing, packed })
    }
}

/// All of `from`, which must be `size` bytes unless it is `cut` off.
fn unpack(from: &mut dyn Read, size: usize, cut: bool) -> Result<Vec<u8>, Unusable> {
    let mut bytes = Vec::new();
    let whole = fill(from, &mut bytes, size);
    if cut {
        return Ok(bytes);
    }
    let sentence = match whole {
        Ok(true) => match from.take(1).read(&mut [0]) {
            Ok(0) => return Ok(bytes),
            Ok(_) => format!("a chunk that unpacks to more than the {size} bytes that it says"),
            Err(error) => unpackable(&error),
        },
        Ok(false) => other_size(bytes.len(), size),
        Err(error) if error.kind() == io::ErrorKind::OutOfMemory => {
            return Err(Unusable::Io(error));
        }
        Err(error) => unpackable(&error),
    };
    Err(Unusable::Damage(sentence))
}

fn unpackable(error: &io::Error) -> String {
    format!("a chunk that cannot be unpacked: {error}")
}

fn other_size(found: usize, said: usize) -> String {
    format!("a chunk that unpacks to {found} bytes and not to the {said} that it says")
}

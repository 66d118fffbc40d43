//! Messages as bytes: CDR with the four bytes in front that say so, as on the wire and in bags.

use byteorder::{BigEndian, LittleEndian};
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::schema::Described;

const LITTLE_ENDIAN: [u8; 2] = [0, 1];
const BIG_ENDIAN: [u8; 2] = [0, 0];

/// Why bytes are no message.
#[derive(Debug, thiserror::Error)]
pub enum CdrError {
    /// Not plain CDR.
    #[error("{kind}: starts with {found:02x?}, plain CDR with 00 00 or 00 01")]
    Encapsulation {
        /// Full name of the type.
        kind: String,
        /// The first bytes, at most four.
        found: Vec<u8>,
    },
    /// Plain CDR, but not of this type.
    #[error("{kind}: {error}")]
    Body {
        /// Full name of the type.
        kind: String,
        /// What does not fit.
        error: cdr_encoding::Error,
    },
}

/// Replaces `bytes` by `message`, little endian.
///
/// # Errors
/// When the type cannot be written as CDR; no type of this crate is such.
pub fn encode<T: Described + Serialize>(message: &T, bytes: &mut Vec<u8>) -> Result<(), CdrError> {
    bytes.clear();
    bytes.extend_from_slice(&LITTLE_ENDIAN);
    bytes.extend_from_slice(&[0, 0]);
    cdr_encoding::to_writer::<T, LittleEndian, _>(bytes, message).map_err(body::<T>)
}

/// The message in `bytes`, of either byte order. Bytes after its end are ignored: some writers
/// pad.
///
/// # Errors
/// When the bytes are not CDR of this type.
pub fn decode<T: Described + DeserializeOwned>(bytes: &[u8]) -> Result<T, CdrError> {
    let (order, body) = match bytes.split_first_chunk::<4>() {
        Some(([high, low, ..], body)) => ([*high, *low], body),
        None => return Err(encapsulation::<T>(bytes)),
    };
    match order {
        LITTLE_ENDIAN => cdr_encoding::from_bytes::<T, LittleEndian>(body),
        BIG_ENDIAN => cdr_encoding::from_bytes::<T, BigEndian>(body),
        _ => return Err(encapsulation::<T>(bytes)),
    }
    .map(|(message, _)| message)
    .map_err(self::body::<T>)
}

fn body<T: Described>(error: cdr_encoding::Error) -> CdrError {
    CdrError::Body { kind: T::TYPE.full_name(), error }
}

fn encapsulation<T: Described>(bytes: &[u8]) -> CdrError {
    let found = bytes.iter().take(4).copied().collect();
    CdrError::Encapsulation { kind: T::TYPE.full_name(), found }
}

//! The recorder.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// The recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Record {
    /// Size of an MCAP chunk before compression: bytes, or a number with `KiB`, `MiB`, `GiB`;
    /// 1 MiB to 1 GiB. It must be larger than the largest message.
    #[serde(with = "byte_size")]
    pub chunk: u64,
    /// Compression of the chunks.
    pub compression: Compression,
}

impl Default for Record {
    fn default() -> Self {
        Self { chunk: 4 << 20, compression: Compression::Zstd }
    }
}

impl Record {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        if !(1 << 20..=1 << 30).contains(&self.chunk) {
            problems
                .add(at.key("chunk"), format!("{} bytes is outside 1 MiB to 1 GiB", self.chunk));
        }
    }
}

/// Compression of MCAP chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// Zstandard.
    #[default]
    Zstd,
    /// LZ4.
    Lz4,
    /// None.
    None,
}

/// `4 MiB` and its kin.
mod byte_size {
    use std::fmt;

    use serde::de::{Error, Visitor};
    use serde::{Deserializer, Serializer};

    const UNITS: [(&str, u32); 3] = [("GiB", 30), ("MiB", 20), ("KiB", 10)];

    #[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
    pub(super) fn serialize<S: Serializer>(bytes: &u64, to: S) -> Result<S::Ok, S::Error> {
        for (unit, shift) in UNITS {
            if *bytes > 0 && bytes.is_multiple_of(1 << shift) {
                return to.serialize_str(&format!("{} {unit}", bytes >> shift));
            }
        }
        to.serialize_u64(*bytes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
        from.deserialize_any(Size)
    }

    struct Size;

    impl Visitor<'_> for Size {
        type Value = u64;

        fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
            to.write_str("a whole number of bytes, or one with a unit: 4 MiB")
        }

        fn visit_u64<E: Error>(self, bytes: u64) -> Result<u64, E> {
            Ok(bytes)
        }

        fn visit_str<E: Error>(self, text: &str) -> Result<u64, E> {
            let wrong = || {
                E::custom(format!(
                    "`{text}` is no size; allowed: a whole number with KiB, MiB or GiB: 4 MiB"
                ))
            };
            let (number, shift) = UNITS
                .iter()
                .find_map(|(unit, shift)| text.strip_suffix(unit).map(|number| (number, *shift)))
                .ok_or_else(wrong)?;
            let count: u64 = number.trim().parse().map_err(|_| wrong())?;
            count.checked_mul(1 << shift).ok_or_else(wrong)
        }
    }
}

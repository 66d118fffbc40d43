//! `4 MiB` and its kin.

use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserializer, Serializer};

const UNITS: [(&str, u32); 3] = [("GiB", 30), ("MiB", 20), ("KiB", 10)];

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde hands over a reference")]
pub(in crate::scene) fn serialize<S: Serializer>(bytes: &u64, to: S) -> Result<S::Ok, S::Error> {
    for (unit, shift) in UNITS {
        if *bytes > 0 && bytes.is_multiple_of(1 << shift) {
            return to.serialize_str(&format!("{} {unit}", bytes >> shift));
        }
    }
    to.serialize_u64(*bytes)
}

pub(in crate::scene) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
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

/// The same for a size that may be left out.
pub(super) mod optional {
    use super::{Deserializer, Serializer, Size};

    pub(in crate::scene) fn serialize<S: Serializer>(
        bytes: &Option<u64>,
        to: S,
    ) -> Result<S::Ok, S::Error> {
        match bytes {
            Some(bytes) => super::serialize(bytes, to),
            None => to.serialize_none(),
        }
    }

    pub(in crate::scene) fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<u64>, D::Error> {
        from.deserialize_any(Size).map(Some)
    }
}

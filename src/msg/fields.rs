//! The fields of a message by name, from its bytes and its definition alone.
//!
//! Where two messages of one type differ, people want to know in which field, for types that the
//! program has no struct for as well.

use std::collections::HashMap;
use std::fmt::Write as _;

/// Most messages within messages; no type of ROS 2 comes near.
const DEEPEST: usize = 32;

/// A field of a message with its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Where it is, as `header.stamp.sec` or `force[2].x`.
    pub path: String,
    /// What it holds: numbers in their shortest form that reads back to the same bits, a NaN with
    /// its bits.
    pub value: String,
}

/// The fields of the message in `bytes`, plain CDR with its four bytes in front, which has this
/// `definition`, in their order. Stops where bytes and definition do not agree.
#[must_use]
pub fn fields(definition: &str, bytes: &[u8]) -> Vec<Field> {
    let mut found = Vec::new();
    if let Some(mut walk) = Walk::new(definition, bytes) {
        // What has been found so far is what there is to say.
        let _ = walk.message("", &mut String::new(), 0, &mut found);
    }
    found
}

/// The first field in which two messages of the same `definition` differ: its path, and what each
/// of them holds. One that ends before has nothing there.
#[must_use]
pub fn first_difference(definition: &str, one: &[u8], other: &[u8]) -> Option<[Field; 2]> {
    let (one, other) = (fields(definition, one), fields(definition, other));
    let different = one.iter().zip(&other).find(|(one, other)| one != other);
    if let Some((one, other)) = different {
        return Some([one.clone(), other.clone()]);
    }
    let nothing = |of: &Field| Field { path: of.path.clone(), value: "nothing".into() };
    match (one.get(other.len()), other.get(one.len())) {
        (Some(more), None) => Some([more.clone(), nothing(more)]),
        (None, Some(more)) => Some([nothing(more), more.clone()]),
        _ => None,
    }
}

/// How many of a type follow each other.
#[derive(Clone, Copy)]
enum Count {
    One,
    Fixed(usize),
    Sequence,
}

/// A line of a definition.
struct Line<'a> {
    kind: &'a str,
    count: Count,
    name: &'a str,
}

/// A message that is being taken apart.
struct Walk<'a> {
    /// The lines of each type by its name without package; the root has none.
    types: HashMap<&'a str, Vec<Line<'a>>>,
    body: &'a [u8],
    at: usize,
    big_endian: bool,
}

impl<'a> Walk<'a> {
    fn new(definition: &'a str, bytes: &'a [u8]) -> Option<Self> {
        let (head, body) = bytes.split_first_chunk::<4>()?;
        let big_endian = match head[..2] {
            [0, 0] => true,
            [0, 1] => false,
            _ => return None,
        };
        let mut types: HashMap<&str, Vec<Line<'_>>> = HashMap::new();
        let mut name = "";
        for text in definition.lines() {
            let text = text.split('#').next().unwrap_or_default().trim();
            if let Some(kind) = text.strip_prefix("MSG:") {
                name = short(kind.trim());
            } else if let Some(line) = line(text) {
                types.entry(name).or_default().push(line);
            }
        }
        Some(Self { types, body, at: 0, big_endian })
    }

    /// Takes a message of type `name` at the place `path` apart.
    fn message(
        &mut self,
        name: &str,
        path: &mut String,
        depth: usize,
        found: &mut Vec<Field>,
    ) -> Option<()> {
        let lines = self.types.get(name).map_or(0, Vec::len);
        for line in 0..lines {
            let Line { kind, count, name } = &self.types[name][line];
            let (kind, count, name) = (*kind, *count, *name);
            let end = path.len();
            if end > 0 {
                path.push('.');
            }
            path.push_str(name);
            self.field(kind, count, path, depth, found)?;
            path.truncate(end);
        }
        Some(())
    }

    fn field(
        &mut self,
        kind: &'a str,
        count: Count,
        path: &mut String,
        depth: usize,
        found: &mut Vec<Field>,
    ) -> Option<()> {
        let many = match count {
            Count::One => return self.one(kind, path, depth, found),
            Count::Fixed(many) => many,
            Count::Sequence => self.unsigned(4)? as usize,
        };
        for index in 0..many {
            let (end, before) = (path.len(), self.at);
            // A string takes all text.
            let _ = write!(path, "[{index}]");
            self.one(kind, path, depth, found)?;
            path.truncate(end);
            // A type without a field takes no byte: its number alone would keep us here.
            if self.at == before {
                break;
            }
        }
        Some(())
    }

    fn one(
        &mut self,
        kind: &'a str,
        path: &mut String,
        depth: usize,
        found: &mut Vec<Field>,
    ) -> Option<()> {
        let value = match kind {
            "bool" => (self.unsigned(1)? != 0).to_string(),
            "byte" | "uint8" | "char" => self.unsigned(1)?.to_string(),
            "int8" => (self.unsigned(1)? as i8).to_string(),
            "uint16" => self.unsigned(2)?.to_string(),
            "int16" => (self.unsigned(2)? as i16).to_string(),
            "uint32" => self.unsigned(4)?.to_string(),
            "int32" => (self.unsigned(4)? as i32).to_string(),
            "uint64" => self.unsigned(8)?.to_string(),
            "int64" => (self.unsigned(8)? as i64).to_string(),
            "float32" => {
                let bits = self.unsigned(4)? as u32;
                let number = f32::from_bits(bits);
                if number.is_nan() { format!("NaN ({bits:#x})") } else { format!("{number:?}") }
            }
            "float64" => {
                let bits = self.unsigned(8)?;
                let number = f64::from_bits(bits);
                if number.is_nan() { format!("NaN ({bits:#x})") } else { format!("{number:?}") }
            }
            "string" => {
                let length = self.unsigned(4)? as usize;
                let bytes = self.take(length)?;
                let text = bytes.strip_suffix(&[0]).unwrap_or(bytes);
                format!("{:?}", String::from_utf8_lossy(text))
            }
            message if depth < DEEPEST => {
                return self.message(short(message), path, depth + 1, found);
            }
            _ => return None,
        };
        found.push(Field { path: path.clone(), value });
        Some(())
    }

    fn unsigned(&mut self, bytes: usize) -> Option<u64> {
        self.at = self.at.next_multiple_of(bytes);
        let big_endian = self.big_endian;
        let taken = self.take(bytes)?.iter();
        let add = |number: u64, byte: &u8| number << 8 | u64::from(*byte);
        Some(if big_endian { taken.fold(0, add) } else { taken.rev().fold(0, add) })
    }

    fn take(&mut self, bytes: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(bytes)?;
        let taken = self.body.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }
}

/// A field of a definition; `None` for a constant and for what is none.
fn line(text: &str) -> Option<Line<'_>> {
    let (kind, rest) = text.split_once(char::is_whitespace)?;
    // A default value may follow the name, a constant has one behind a `=`.
    let name = rest.split_whitespace().next()?;
    let constant = rest
        .split_once('=')
        .is_some_and(|(before, _)| before.trim() == name.split('=').next().unwrap_or_default());
    if constant {
        return None;
    }
    let (kind, count) = match kind.split_once('[') {
        None => (kind, Count::One),
        Some((kind, within)) => {
            let within = within.strip_suffix(']')?;
            let fixed = within.parse().map(Count::Fixed);
            (kind, fixed.unwrap_or(Count::Sequence))
        }
    };
    let kind = kind.split("<=").next().unwrap_or(kind);
    Some(Line { kind, count, name })
}

/// The name of a type without its package.
fn short(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::msg::{ContactNetwork, Described, Report, WallForces, cdr};

    fn bytes<T: Described + serde::Serialize>(message: &T) -> Vec<u8> {
        let mut bytes = Vec::new();
        cdr::encode(message, &mut bytes).expect("a message of this crate can be written");
        bytes
    }

    #[test]
    fn the_first_different_field_is_named_with_both_values() {
        let mut one = WallForces { increment: 3, ..WallForces::default() };
        let other = bytes(&one);
        one.normal_force[4] = 1.0f64.next_up();
        one.moment[5].z = -0.0;
        let definition = WallForces::TYPE.definition();
        let [found, expected] =
            first_difference(&definition, &bytes(&one), &other).expect("they differ");
        assert_eq!(
            (found.path.as_str(), found.value.as_str()),
            ("normal_force[4]", "1.0000000000000002")
        );
        assert_eq!((expected.path.as_str(), expected.value.as_str()), ("normal_force[4]", "0.0"));
        one.normal_force[4] = 0.0;
        let [found, expected] = first_difference(&definition, &bytes(&one), &other)
            .expect("they differ in the sign of zero");
        assert_eq!((found.path.as_str(), found.value.as_str()), ("moment[5].z", "-0.0"));
        assert_eq!(expected.value, "0.0");
    }

    #[test]
    fn sequences_of_different_length_differ_where_the_longer_one_goes_on() {
        let one = ContactNetwork { state: vec![1, 2], ..ContactNetwork::default() };
        let other = ContactNetwork { state: vec![1, 2, 3], ..ContactNetwork::default() };
        let definition = ContactNetwork::TYPE.definition();
        let [found, expected] =
            first_difference(&definition, &bytes(&one), &bytes(&other)).expect("they differ");
        assert_eq!((found.path.as_str(), found.value.as_str()), ("state[2]", "nothing"));
        assert_eq!(expected.value, "3");
        assert_eq!(first_difference(&definition, &bytes(&one), &bytes(&one)), None);
    }

    #[test]
    fn a_message_has_all_its_fields_and_no_constants() {
        let report = Report { text: "ü".into(), substeps: 7, ..Report::default() };
        let found = fields(&Report::TYPE.definition(), &bytes(&report));
        let paths: Vec<&str> = found.iter().map(|field| field.path.as_str()).collect();
        assert_eq!(
            paths,
            [
                "header.stamp.sec",
                "header.stamp.nanosec",
                "header.frame_id",
                "session",
                "sequence",
                "increment",
                "disposition",
                "substeps",
                "text"
            ]
        );
        assert_eq!(found[8].value, "\"ü\"");
        assert_eq!(found[7].value, "7");
    }

    #[test]
    fn hostile_definitions_and_lengths_end_at_once() {
        let long = [0, 1, 0, 0, 255, 255, 255, 255, 1];
        for definition in ["A a\nMSG: p/A\nA a", "Nothing[] a", "uint8[4294967295] a", "string a"] {
            assert!(fields(definition, &long).len() < 10, "{definition}");
        }
    }
}

//! The YAML as written, with the place of every key and value: it tells where a field stands.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::{Location, Spanned};

use super::check::{Field, Segment};

/// A value of the file.
#[derive(Debug)]
pub(super) enum Tree {
    Map(Vec<(Spanned<String>, Spanned<Tree>)>),
    List(Vec<Spanned<Tree>>),
    /// Numbers and words alike, as text.
    Scalar(String),
    Null,
}

/// What a place in the file belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Key,
    Value,
}

impl Tree {
    pub(super) fn kind(&self) -> String {
        match self {
            Self::Map(_) => "keys with values".into(),
            Self::List(_) => "a list".into(),
            Self::Scalar(text) => format!("`{text}`"),
            Self::Null => "nothing".into(),
        }
    }
}

/// Line and column of `field`, or of the nearest that is in the file.
pub(super) fn position(root: &Spanned<Tree>, field: &Field) -> Option<(u64, u64)> {
    let mut here = root;
    for (depth, segment) in field.0.iter().enumerate() {
        let next = match (segment, &here.value) {
            (Segment::Key(key), Tree::Map(entries)) => {
                entries.iter().find(|(name, _)| name.value == *key).map(|(_, value)| value)
            }
            (Segment::Index(index), Tree::List(entries)) => entries.get(*index),
            // One step of a load path may stand alone, without its list.
            (Segment::Index(0), Tree::Map(_)) => Some(here),
            _ => None,
        };
        match next {
            Some(next) => here = next,
            None if depth == 0 => return None,
            None => break,
        }
    }
    coordinates(here.referenced)
}

/// Calls `visit` for every key and value with its field and place, outer ones first.
pub(super) fn walk<'tree>(
    here: &'tree Spanned<Tree>,
    field: &Field,
    visit: &mut impl FnMut(&Field, Place, Location, &'tree Tree),
) {
    visit(field, Place::Value, here.referenced, &here.value);
    match &here.value {
        Tree::Map(entries) => {
            for (key, value) in entries {
                let field = field.key(&key.value);
                visit(&field, Place::Key, key.referenced, &value.value);
                walk(value, &field, visit);
            }
        }
        Tree::List(entries) => {
            for (index, value) in entries.iter().enumerate() {
                walk(value, &field.index(index), visit);
            }
        }
        Tree::Scalar(_) | Tree::Null => {}
    }
}

/// Line and column of a location that is known.
pub(super) fn coordinates(location: Location) -> Option<(u64, u64)> {
    (location != Location::UNKNOWN).then(|| (location.line(), location.column()))
}

impl<'de> Deserialize<'de> for Tree {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Any)
    }
}

struct Any;

impl<'de> Visitor<'de> for Any {
    type Value = Tree;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("YAML")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_i128<E>(self, value: i128) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_u128<E>(self, value: u128) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.to_string()))
    }

    fn visit_str<E>(self, value: &str) -> Result<Tree, E> {
        Ok(Tree::Scalar(value.into()))
    }

    fn visit_unit<E>(self) -> Result<Tree, E> {
        Ok(Tree::Null)
    }

    fn visit_none<E>(self) -> Result<Tree, E> {
        Ok(Tree::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Tree, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = list.next_element()? {
            entries.push(entry);
        }
        Ok(Tree::List(entries))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Tree, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Tree::Map(entries))
    }
}

//! Keys of the scene format that this version cannot serve.
//!
//! They are looked up in the file as written, so that the message can say more than that a word
//! is unknown. A row goes when its feature comes.

use serde_saphyr::Spanned;

use super::check::{Field, Problems, Segment};
use super::tree::{self, Place, Tree};

struct Row {
    /// The last keys of the field; list indices do not count.
    keys: &'static [&'static str],
    text: &'static str,
}

const TABLE: &[Row] = &[Row {
    keys: &["node", "topics"],
    text: "this version maps no topics; the names are those of the node; allowed: no such key",
}];

/// Finds what the file asks for in vain.
pub(super) fn check(root: &Spanned<Tree>, problems: &mut Problems) {
    tree::walk(root, &Field::root(), &mut |field, place, _, _| {
        if place == Place::Key
            && let Some(row) = TABLE.iter().find(|row| ends_with(field, row.keys))
        {
            problems.add(field.clone(), row.text);
        }
    });
}

fn ends_with(field: &Field, keys: &[&str]) -> bool {
    let mut names = field.0.iter().rev().filter_map(|segment| match segment {
        Segment::Key(key) => Some(key.as_str()),
        Segment::Index(_) => None,
    });
    keys.iter().rev().all(|key| names.next() == Some(key))
}

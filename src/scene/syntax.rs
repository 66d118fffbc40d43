//! What the YAML reader objects to, as a sentence about the scene.

use serde_saphyr::{Error, Location, Spanned, UserMessageFormatter};

use super::check::Field;
use super::tree::{self, Place, Tree};

/// Field, place and sentence of an error of the reader.
///
/// `root` is the file as written; `None` when the file is not YAML at all.
pub(super) fn explain(
    error: &Error,
    root: Option<&Spanned<Tree>>,
) -> (Field, Option<(u64, u64)>, String) {
    let location = error.location().unwrap_or(Location::UNKNOWN);
    let error = innermost(error);
    let found = root.and_then(|root| find(root, location, error));
    let (field, value) = match found {
        Some((field, value)) => (field, Some(value)),
        None => (Field::root(), None),
    };
    (field, tree::coordinates(location), sentence(error, value))
}

fn innermost(mut error: &Error) -> &Error {
    while let Error::AliasError { error: inner, .. } | Error::WithSnippet { error: inner, .. } =
        error
    {
        error = inner;
    }
    error
}

/// The field that the reader means by a place.
fn find<'tree>(
    root: &'tree Spanned<Tree>,
    location: Location,
    error: &Error,
) -> Option<(Field, &'tree Tree)> {
    // A mapping begins where its first key does, and only a missing key is said of the mapping.
    let rank = |place: Place, value: &Tree| match (place, value) {
        (Place::Value, Tree::Map(_)) if matches!(error, Error::SerdeMissingField { .. }) => 0,
        (Place::Key, _) => 1,
        (Place::Value, Tree::Scalar(_) | Tree::Null) => 1,
        (Place::Value, Tree::Map(_) | Tree::List(_)) => 2,
    };
    let mut best: Option<(u8, Place, Field, &Tree)> = None;
    tree::walk(root, &Field::root(), &mut |field, place, here, value| {
        let here = tree::coordinates(here);
        if here.is_some() && here == tree::coordinates(location) {
            let rank = rank(place, value);
            if best.as_ref().is_none_or(|(least, ..)| rank < *least) {
                best = Some((rank, place, field.clone(), value));
            }
        }
    });
    best.map(|(_, place, mut field, value)| {
        // In braces the reader names the place of the first key instead.
        if place == Place::Key && matches!(error, Error::SerdeMissingField { .. }) {
            field.0.pop();
        }
        (field, value)
    })
}

fn sentence(error: &Error, value: Option<&Tree>) -> String {
    let found = value.map_or_else(|| "this".into(), Tree::kind);
    match error {
        Error::InvalidScalar { ty, .. } => format!("{found} is not {}", kind(ty)),
        Error::Unexpected { expected: "mapping start", .. } => {
            format!("{found} stands here; allowed: keys with values, as in `{{key: value}}`")
        }
        Error::Unexpected { expected: "sequence start", .. } => {
            format!("{found} stands here; allowed: a list, as in `[a, b]`")
        }
        Error::NullIntoString { .. } => "nothing stands here; allowed: text".into(),
        Error::ExpectedMappingEndAfterEnumVariantValue { .. } => {
            "a second key stands here; allowed: one key, or one `- key: ...` an entry".into()
        }
        Error::MultipleDocuments { .. } => {
            "a second document begins here; allowed: one scene a file".into()
        }
        Error::Budget { .. } | Error::AliasReplayLimitExceeded { .. } => {
            "too large or too deeply nested for a scene; long histories belong into a CSV".into()
        }
        other => without_place(other),
    }
}

fn kind(name: &str) -> &str {
    match name {
        "floating point" | "f64" => "a number",
        "u8" => "a whole number from 0 to 255",
        "u16" => "a whole number from 0 to 65535",
        "u32" => "a whole number from 0 to 4294967295",
        "u64" | "usize" => "a whole number from 0 up",
        "bool" | "boolean" => "true or false",
        other => other,
    }
}

/// The reader's own words; the place is told apart from them.
fn without_place(error: &Error) -> String {
    let text = error.render_with_formatter(&UserMessageFormatter);
    match text.rfind(" at line ") {
        Some(end) => text[..end].into(),
        None => text,
    }
}

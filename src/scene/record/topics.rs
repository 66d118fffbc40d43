//! Which topics are recorded, by name or pattern.

use std::fmt;

use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::msg::Topic;
use crate::msg::topics::{BOUNDARY_COMMAND, CIRCUMSTANCE, REPORT, WALL_TARGETS, all};
use crate::scene::check::{Field, Problems};

/// Which topics are recorded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Topics {
    /// All of them; `all` in a scene.
    #[default]
    All,
    /// Those with these names, under the node's own (`state`, or `~/state`) or absolute
    /// (`/tf_static`). A `*` stands for any characters: `wall/*`.
    Named(Vec<String>),
}

impl Topics {
    pub(super) fn name(&self, topic: &Topic) -> bool {
        match self {
            Self::All => true,
            Self::Named(patterns) => any_names(patterns, topic),
        }
    }

    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        if let Self::Named(patterns) = self {
            check_known(patterns, at, problems);
        }
    }
}

/// Whether `topic` is recorded whatever the scene says: a replay needs it.
pub(super) fn is_always_recorded(topic: &Topic) -> bool {
    [&BOUNDARY_COMMAND, &WALL_TARGETS, &CIRCUMSTANCE, &REPORT].contains(&topic)
}

pub(super) fn any_names(patterns: &[String], topic: &Topic) -> bool {
    patterns.iter().any(|pattern| names(pattern, topic))
}

pub(super) fn check_excluded(patterns: &[String], at: &Field, problems: &mut Problems) {
    check_known(patterns, at, problems);
    for (index, pattern) in patterns.iter().enumerate() {
        if all().any(|topic| is_always_recorded(topic) && relative(pattern) == topic.name) {
            let text = format!("`{pattern}` is always recorded: a replay needs it");
            problems.add(at.index(index), text);
        }
    }
}

fn check_known(patterns: &[String], at: &Field, problems: &mut Problems) {
    for (index, pattern) in patterns.iter().enumerate() {
        if !all().any(|topic| names(pattern, topic)) {
            let known = all().map(|topic| topic.name).collect::<Vec<_>>().join(", ");
            problems.add(at.index(index), format!("no topic is named `{pattern}`; known: {known}"));
        }
    }
}

fn names(pattern: &str, topic: &Topic) -> bool {
    matches(relative(pattern), topic.name)
}

fn relative(pattern: &str) -> &str {
    pattern.strip_prefix("~/").unwrap_or(pattern)
}

/// Whether `name` is `pattern` with something, or nothing, for each `*`.
fn matches(pattern: &str, name: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(name) = name.strip_prefix(start) else { return false };
    let mut left = name;
    let mut pieces = rest.split('*').peekable();
    while let Some(piece) = pieces.next() {
        if pieces.peek().is_none() {
            return left.ends_with(piece);
        }
        // The first place leaves the most for what follows.
        match left.find(piece) {
            Some(place) => left = &left[place + piece.len()..],
            None => return false,
        }
    }
    true
}

impl Serialize for Topics {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All => to.serialize_str("all"),
            Self::Named(patterns) => patterns.serialize(to),
        }
    }
}

impl<'de> Deserialize<'de> for Topics {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(AllOrNames)
    }
}

struct AllOrNames;

impl<'de> Visitor<'de> for AllOrNames {
    type Value = Topics;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("`all`, or a list of names of topics: [state, wall/*]")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Topics, E> {
        match text {
            "all" => Ok(Topics::All),
            other => Err(E::custom(format!(
                "`{other}` is not `all`; allowed too: a list of names of topics, [{other}]"
            ))),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Topics, A::Error> {
        let mut names = Vec::new();
        while let Some(name) = items.next_element()? {
            names.push(name);
        }
        Ok(Topics::Named(names))
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn a_star_stands_for_any_characters_and_for_none() {
        for (pattern, name, fits) in [
            ("state", "state", true),
            ("state", "wall_states", false),
            ("wall/*", "wall/x_min/wrench", true),
            ("wall/*/wrench", "wall/x_min/wrench", true),
            ("wall/*_min*", "wall/y_min/wrench", true),
            ("wall/*_min*", "wall/y_max/wrench", false),
            ("*min", "wall/x_min/wrench", false),
            ("*", "state", true),
            ("sta*te", "state", true),
            ("sta*tate", "state", false),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}

//! YAML as parameters are written in: with types, and with the line of every value.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::{NonFiniteFloatPolicy, Options, Spanned, UserMessageFormatter};

use super::{Kind, Value};

/// A node of the text.
#[derive(Debug)]
pub(super) enum Yaml {
    Map(Vec<(Spanned<String>, Spanned<Yaml>)>),
    List(Vec<Yaml>),
    Bool(bool),
    Integer(i64),
    Double(f64),
    Text(String),
    Null,
}

/// What is wrong with a text, and in which line.
pub(super) struct Fault {
    pub line: Option<u64>,
    pub text: String,
}

pub(super) fn read(text: &str) -> Result<Spanned<Yaml>, Fault> {
    serde_saphyr::from_str_with_options(text, options()).map_err(|error| {
        let told = error.render_with_formatter(&UserMessageFormatter);
        Fault {
            line: error.location().map(|at| at.line()),
            // The place is told apart.
            text: told.split(" at line ").next().unwrap_or_default().into(),
        }
    })
}

fn options() -> Options {
    // As in ROS 2, `yes` and `off` are booleans and `.inf` is a number.
    serde_saphyr::options! {
        with_snippet: false,
        non_finite_float_policy: NonFiniteFloatPolicy::PassThrough,
    }
}

/// The line that something stands in.
pub(super) fn line<T>(at: &Spanned<T>) -> u64 {
    at.referenced.line()
}

impl Yaml {
    /// As the value of a parameter.
    pub(super) fn value(&self) -> Result<Value, String> {
        Ok(match self {
            Self::Bool(value) => Value::Bool(*value),
            Self::Integer(value) => Value::Integer(*value),
            Self::Double(value) => Value::Double(*value),
            Self::Text(value) => Value::Text(value.clone()),
            Self::List(items) => Value::Other(list(items)?),
            Self::Null => return Err("no value stands here".into()),
            Self::Map(_) => return Err("keys with values stand here; allowed: one value".into()),
        })
    }
}

fn list(items: &[Yaml]) -> Result<Kind, String> {
    let kind = |item: &Yaml| match item {
        Yaml::Bool(_) => Ok(Kind::BOOL_ARRAY),
        Yaml::Integer(_) => Ok(Kind::INTEGER_ARRAY),
        Yaml::Double(_) => Ok(Kind::DOUBLE_ARRAY),
        Yaml::Text(_) => Ok(Kind::STRING_ARRAY),
        _ => Err("a list of more than single values stands here".to_owned()),
    };
    let Some(first) = items.first() else { return Ok(Kind::STRING_ARRAY) };
    let first = kind(first)?;
    for item in items {
        if kind(item)? != first {
            return Err("a list of several types stands here; allowed: one type".into());
        }
    }
    Ok(first)
}

impl<'de> Deserialize<'de> for Yaml {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Any)
    }
}

struct Any;

impl<'de> Visitor<'de> for Any {
    type Value = Yaml;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("YAML")
    }

    fn visit_bool<E>(self, value: bool) -> Result<Yaml, E> {
        Ok(Yaml::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Yaml, E> {
        Ok(Yaml::Integer(value))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Yaml, E> {
        Ok(i64::try_from(value).map_or(Yaml::Double(value as f64), Yaml::Integer))
    }

    fn visit_i128<E>(self, value: i128) -> Result<Yaml, E> {
        Ok(Yaml::Double(value as f64))
    }

    fn visit_u128<E>(self, value: u128) -> Result<Yaml, E> {
        Ok(Yaml::Double(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Yaml, E> {
        Ok(Yaml::Double(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Yaml, E> {
        Ok(Yaml::Text(value.into()))
    }

    fn visit_unit<E>(self) -> Result<Yaml, E> {
        Ok(Yaml::Null)
    }

    fn visit_none<E>(self) -> Result<Yaml, E> {
        Ok(Yaml::Null)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Yaml, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Yaml::List(items))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Yaml, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = map.next_entry()? {
            entries.push(entry);
        }
        Ok(Yaml::Map(entries))
    }
}

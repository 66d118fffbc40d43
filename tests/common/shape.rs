//! What serde knows of a type: the names, order and types of its fields.

use std::fmt;

use serde::Deserialize;
use serde::de::{self, DeserializeSeed, SeqAccess, Visitor};

/// The shape of a type in the words of message definitions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Shape {
    /// `float64`, `string`, ...
    Primitive(&'static str),
    /// `T[]`
    Sequence(Box<Shape>),
    /// `T[n]`
    Array(Box<Shape>, usize),
    /// A message: its name, its fields.
    Struct(&'static str, Vec<(&'static str, Shape)>),
}

/// The shape of `T`.
pub(crate) fn shape_of<T: for<'de> Deserialize<'de>>() -> Shape {
    let mut shape = None;
    T::deserialize(Recorder { shape: &mut shape }).expect("a message's shape can be seen");
    shape.expect("a type says what it is")
}

/// A deserializer that serves zeros and notes what it was asked for. Every sequence gets one
/// element, so that its type is seen.
struct Recorder<'a> {
    shape: &'a mut Option<Shape>,
}

/// What cannot be part of a message.
#[derive(Debug)]
struct Foreign(String);

impl fmt::Display for Foreign {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(&self.0)
    }
}

impl std::error::Error for Foreign {}

impl de::Error for Foreign {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(message.to_string())
    }
}

macro_rules! primitives {
    ($($method:ident $visit:ident $value:expr => $name:literal;)+) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Foreign> {
            *self.shape = Some(Shape::Primitive($name));
            visitor.$visit($value)
        }
    )+};
}

impl<'de> de::Deserializer<'de> for Recorder<'_> {
    type Error = Foreign;

    primitives! {
        deserialize_bool visit_bool false => "bool";
        deserialize_i8 visit_i8 0 => "int8";
        deserialize_i16 visit_i16 0 => "int16";
        deserialize_i32 visit_i32 0 => "int32";
        deserialize_i64 visit_i64 0 => "int64";
        deserialize_u8 visit_u8 0 => "uint8";
        deserialize_u16 visit_u16 0 => "uint16";
        deserialize_u32 visit_u32 0 => "uint32";
        deserialize_u64 visit_u64 0 => "uint64";
        deserialize_f32 visit_f32 0.0 => "float32";
        deserialize_f64 visit_f64 0.0 => "float64";
        deserialize_str visit_str "" => "string";
        deserialize_string visit_str "" => "string";
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Foreign> {
        let mut element = None;
        let value = visitor.visit_seq(Elements { left: 1, element: &mut element })?;
        let element = element.ok_or_else(|| de::Error::custom("a sequence of nothing"))?;
        *self.shape = Some(Shape::Sequence(Box::new(element)));
        Ok(value)
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, n: usize, visitor: V) -> Result<V::Value, Foreign> {
        let mut element = None;
        let value = visitor.visit_seq(Elements { left: n, element: &mut element })?;
        let element = element.ok_or_else(|| de::Error::custom("an array of nothing"))?;
        *self.shape = Some(Shape::Array(Box::new(element), n));
        Ok(value)
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Foreign> {
        let mut shapes = Vec::new();
        let value = visitor.visit_seq(Fields { names: fields.iter(), shapes: &mut shapes })?;
        *self.shape = Some(Shape::Struct(name, shapes));
        Ok(value)
    }

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Foreign> {
        Err(de::Error::custom("a type that messages do not have"))
    }

    serde::forward_to_deserialize_any! {
        i128 u128 char bytes byte_buf option unit unit_struct newtype_struct tuple_struct map enum
        identifier ignored_any
    }
}

struct Elements<'a> {
    left: usize,
    element: &'a mut Option<Shape>,
}

impl<'de> SeqAccess<'de> for Elements<'_> {
    type Error = Foreign;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Foreign> {
        if self.left == 0 {
            return Ok(None);
        }
        self.left -= 1;
        seed.deserialize(Recorder { shape: self.element }).map(Some)
    }
}

struct Fields<'a> {
    names: std::slice::Iter<'static, &'static str>,
    shapes: &'a mut Vec<(&'static str, Shape)>,
}

impl<'de> SeqAccess<'de> for Fields<'_> {
    type Error = Foreign;

    fn next_element_seed<T: DeserializeSeed<'de>>(
        &mut self,
        seed: T,
    ) -> Result<Option<T::Value>, Foreign> {
        let Some(name) = self.names.next() else { return Ok(None) };
        let mut shape = None;
        let value = seed.deserialize(Recorder { shape: &mut shape })?;
        let shape = shape.ok_or_else(|| de::Error::custom("a field without a type"))?;
        self.shapes.push((name, shape));
        Ok(Some(value))
    }
}

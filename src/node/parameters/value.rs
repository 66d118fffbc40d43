//! Values and their types, as `rcl_interfaces` numbers them.

use std::fmt;

/// The type of a value, the number of `rcl_interfaces/ParameterType`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind(pub u8);

impl Kind {
    /// No value.
    pub const NOT_SET: Self = Self(0);
    /// `true` or `false`.
    pub const BOOL: Self = Self(1);
    /// A whole number.
    pub const INTEGER: Self = Self(2);
    /// A number.
    pub const DOUBLE: Self = Self(3);
    /// Text.
    pub const STRING: Self = Self(4);
    /// A list of booleans.
    pub const BOOL_ARRAY: Self = Self(6);
    /// A list of whole numbers.
    pub const INTEGER_ARRAY: Self = Self(7);
    /// A list of numbers.
    pub const DOUBLE_ARRAY: Self = Self(8);
    /// A list of texts.
    pub const STRING_ARRAY: Self = Self(9);
}

impl fmt::Display for Kind {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = [
            "not set",
            "bool",
            "integer",
            "double",
            "string",
            "byte array",
            "bool array",
            "integer array",
            "double array",
            "string array",
        ];
        match names.get(usize::from(self.0)) {
            Some(name) => to.write_str(name),
            None => write!(to, "unknown ({})", self.0),
        }
    }
}

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// `true` or `false`.
    Bool(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Double(f64),
    /// Text.
    Text(String),
    /// Of a type that no parameter here has, or none at all.
    Other(Kind),
}

impl Value {
    /// Its type.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Bool(_) => Kind::BOOL,
            Self::Integer(_) => Kind::INTEGER,
            Self::Double(_) => Kind::DOUBLE,
            Self::Text(_) => Kind::STRING,
            Self::Other(kind) => *kind,
        }
    }
}

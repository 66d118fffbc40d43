//! What every ROS 2 node says and is asked, package `rcl_interfaces`: parameters and the log. Field
//! by field as ROS 2 Jazzy defines them.

use serde::{Deserialize, Serialize};

use super::Time;
use super::schema::describe;

/// `rcl_interfaces/ParameterValue`: only the field that `kind` names counts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterValue {
    /// `type`: a number of `rcl_interfaces/ParameterType`.
    #[serde(rename = "type")]
    pub kind: u8,
    /// Type 1.
    pub bool_value: bool,
    /// Type 2.
    pub integer_value: i64,
    /// Type 3.
    pub double_value: f64,
    /// Type 4.
    pub string_value: String,
    /// Type 5.
    pub byte_array_value: Vec<u8>,
    /// Type 6.
    pub bool_array_value: Vec<bool>,
    /// Type 7.
    pub integer_array_value: Vec<i64>,
    /// Type 8.
    pub double_array_value: Vec<f64>,
    /// Type 9.
    pub string_array_value: Vec<String>,
}

/// `rcl_interfaces/Parameter`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: ParameterValue,
}

/// `rcl_interfaces/FloatingPointRange`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FloatingPointRange {
    /// Least.
    pub from_value: f64,
    /// Largest.
    pub to_value: f64,
    /// Between two values; 0 for any.
    pub step: f64,
}

/// `rcl_interfaces/IntegerRange`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct IntegerRange {
    /// Least.
    pub from_value: i64,
    /// Largest.
    pub to_value: i64,
    /// Between two values; 0 for any.
    pub step: u64,
}

/// `rcl_interfaces/ParameterDescriptor`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterDescriptor {
    /// Its name.
    pub name: String,
    /// `type`: a number of `rcl_interfaces/ParameterType`.
    pub kind: u8,
    /// What it means.
    pub description: String,
    /// What the ranges cannot say.
    pub additional_constraints: String,
    /// Whether it cannot be set.
    pub read_only: bool,
    /// Whether it may change its type.
    pub dynamic_typing: bool,
    /// None or one.
    pub floating_point_range: Vec<FloatingPointRange>,
    /// None or one.
    pub integer_range: Vec<IntegerRange>,
}

/// `rcl_interfaces/SetParametersResult`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetParametersResult {
    /// Whether it was set.
    pub successful: bool,
    /// Why not.
    pub reason: String,
}

/// `rcl_interfaces/ListParametersResult`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParametersResult {
    /// Names.
    pub names: Vec<String>,
    /// What the names are below of.
    pub prefixes: Vec<String>,
}

/// `rcl_interfaces/ParameterEvent`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterEvent {
    /// When it happened.
    pub stamp: Time,
    /// Full name of the node.
    pub node: String,
    /// Declared.
    pub new_parameters: Vec<Parameter>,
    /// Set.
    pub changed_parameters: Vec<Parameter>,
    /// Removed.
    pub deleted_parameters: Vec<Parameter>,
}

/// `rcl_interfaces/Log`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Log {
    /// When it was said.
    pub stamp: Time,
    /// 10 debug, 20 info, 30 warn, 40 error, 50 fatal.
    pub level: u8,
    /// Who says it: the name of a logger.
    pub name: String,
    /// What it says.
    pub msg: String,
    /// Where in the source.
    pub file: String,
    /// In which function.
    pub function: String,
    /// In which line.
    pub line: u32,
}

/// Request of `GetParameters`, `GetParameterTypes` and `DescribeParameters`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Names {
    /// Names of parameters.
    pub names: Vec<String>,
}

/// Response of `GetParameters`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Values {
    /// One for each name.
    pub values: Vec<ParameterValue>,
}

/// Response of `GetParameterTypes`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Types {
    /// One for each name.
    pub types: Vec<u8>,
}

/// Response of `DescribeParameters`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Descriptors {
    /// One for each name.
    pub descriptors: Vec<ParameterDescriptor>,
}

/// Request of `SetParameters` and `SetParametersAtomically`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SetParameters {
    /// The new values.
    pub parameters: Vec<Parameter>,
}

/// Response of `SetParameters`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Results {
    /// One for each parameter.
    pub results: Vec<SetParametersResult>,
}

/// Response of `SetParametersAtomically`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct OneResult {
    /// One for all parameters.
    pub result: SetParametersResult,
}

/// Request of `ListParameters`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ListParameters {
    /// Where to look; everywhere without any.
    pub prefixes: Vec<String>,
    /// How deep; 0 for all.
    pub depth: u64,
}

/// Response of `ListParameters`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Listed {
    /// What was found.
    pub result: ListParametersResult,
}

describe!(
    ParameterValue,
    "rcl_interfaces",
    "uint8 type\nbool bool_value\nint64 integer_value\nfloat64 double_value\nstring string_value\n\
     byte[] byte_array_value\nbool[] bool_array_value\nint64[] integer_array_value\n\
     float64[] double_array_value\nstring[] string_array_value\n",
    &[],
    "115fc089a387e23c7ecd3525c9189c379109119d6ab82e8dfbde0fdf6a7f9b68"
);
describe!(
    Parameter,
    "rcl_interfaces",
    "string name\nParameterValue value\n",
    &[ParameterValue::TYPE],
    "ddfe6442cffc462317adb5c92536a7b6dd55858c5c3e1e328165a6b73c2831af"
);
describe!(
    ParameterEvent,
    "rcl_interfaces",
    "builtin_interfaces/Time stamp\nstring node\nParameter[] new_parameters\n\
     Parameter[] changed_parameters\nParameter[] deleted_parameters\n",
    &[Time::TYPE, Parameter::TYPE],
    "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204"
);
describe!(
    Log,
    "rcl_interfaces",
    "builtin_interfaces/Time stamp\nuint8 level\nstring name\nstring msg\nstring file\n\
     string function\nuint32 line\n",
    &[Time::TYPE],
    "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac"
);

/// What is only asked and answered, never recorded.
#[cfg(feature = "ros")]
mod asked {
    use ros2_client::Message;

    use super::{
        Descriptors, ListParameters, Listed, Names, OneResult, Results, SetParameters, Types,
        Values,
    };

    impl Message for Names {}
    impl Message for Values {}
    impl Message for Types {}
    impl Message for Descriptors {}
    impl Message for SetParameters {}
    impl Message for Results {}
    impl Message for OneResult {}
    impl Message for ListParameters {}
    impl Message for Listed {}
}

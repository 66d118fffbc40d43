//! How the program fares, as ROS 2's diagnostics say it (REP 107).

use serde::{Deserialize, Serialize};

use super::schema::describe;
use super::standard::Header;

/// `diagnostic_msgs/KeyValue`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyValue {
    /// What.
    pub key: String,
    /// How much, with its unit in the key.
    pub value: String,
}

/// `diagnostic_msgs/DiagnosticStatus`: one part of the program.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticStatus {
    /// 0 OK, 1 WARN, 2 ERROR, 3 STALE.
    pub level: u8,
    /// The part.
    pub name: String,
    /// A sentence for a person.
    pub message: String,
    /// What the part belongs to.
    pub hardware_id: String,
    /// Numbers.
    pub values: Vec<KeyValue>,
}

/// `diagnostic_msgs/DiagnosticArray`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosticArray {
    /// When.
    pub header: Header,
    /// The parts.
    pub status: Vec<DiagnosticStatus>,
}

describe!(
    KeyValue,
    "diagnostic_msgs",
    "string key\nstring value\n",
    &[],
    "d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42"
);
describe!(
    DiagnosticStatus,
    "diagnostic_msgs",
    "byte level\nstring name\nstring message\nstring hardware_id\nKeyValue[] values\n",
    &[KeyValue::TYPE],
    "b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4"
);
describe!(
    DiagnosticArray,
    "diagnostic_msgs",
    "std_msgs/Header header\nDiagnosticStatus[] status\n",
    &[DiagnosticStatus::TYPE, Header::TYPE],
    "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"
);

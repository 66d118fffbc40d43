//! The standard messages that graintwin speaks, field by field as ROS 2 Jazzy defines them.
//!
//! Their texts hold the fields only: neither a type's hash nor a reader of recordings looks at
//! the comments.

use serde::{Deserialize, Serialize};

use super::schema::describe;

/// `builtin_interfaces/Time`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds within the second.
    pub nanosec: u32,
}

/// `std_msgs/Header`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Header {
    /// Time of the data.
    pub stamp: Time,
    /// Frame of the data.
    pub frame_id: String,
}

/// `geometry_msgs/Vector3`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Vector3 {
    /// Component along x.
    pub x: f64,
    /// Component along y.
    pub y: f64,
    /// Component along z.
    pub z: f64,
}

impl From<[f64; 3]> for Vector3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

/// `geometry_msgs/Wrench`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Wrench {
    /// Force \[N\].
    pub force: Vector3,
    /// Torque about the frame's origin \[N m\].
    pub torque: Vector3,
}

/// `geometry_msgs/WrenchStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrenchStamped {
    /// Time and frame.
    pub header: Header,
    /// Force and torque.
    pub wrench: Wrench,
}

/// `sensor_msgs/JointState`. Arrays have the length of `name`, or none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// Time and frame.
    pub header: Header,
    /// Names of the joints; here, of the walls.
    pub name: Vec<String>,
    /// Positions; here, inward displacements \[m\].
    pub position: Vec<f64>,
    /// Velocities; here, none: a quasi-static twin has no rate.
    pub velocity: Vec<f64>,
    /// Efforts; here, normal forces \[N\].
    pub effort: Vec<f64>,
}

/// `rosgraph_msgs/Clock`: the time that a simulation or a playback says it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// The time.
    pub clock: Time,
}

/// `builtin_interfaces/Duration`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds on top of them.
    pub nanosec: u32,
}

impl Duration {
    /// In nanoseconds.
    #[must_use]
    pub fn nanoseconds(self) -> i64 {
        i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec)
    }
}

/// `trajectory_msgs/JointTrajectoryPoint`. Arrays have the length of `joint_names`, or none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTrajectoryPoint {
    /// Positions of the joints \[m or rad\].
    pub positions: Vec<f64>,
    /// Velocities; a quasi-static twin has no use for them.
    pub velocities: Vec<f64>,
    /// Accelerations; no use either.
    pub accelerations: Vec<f64>,
    /// Efforts; no use either.
    pub effort: Vec<f64>,
    /// When the joints shall be there, after the stamp of the trajectory.
    pub time_from_start: Duration,
}

/// `trajectory_msgs/JointTrajectory`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointTrajectory {
    /// When it begins; zero means at once.
    pub header: Header,
    /// Names of the joints.
    pub joint_names: Vec<String>,
    /// Where they shall be when.
    pub points: Vec<JointTrajectoryPoint>,
}

describe!(
    Time,
    "builtin_interfaces",
    "int32 sec\nuint32 nanosec\n",
    &[],
    "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"
);
describe!(
    Header,
    "std_msgs",
    "builtin_interfaces/Time stamp\nstring frame_id\n",
    &[Time::TYPE],
    "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"
);
describe!(
    Vector3,
    "geometry_msgs",
    "float64 x\nfloat64 y\nfloat64 z\n",
    &[],
    "cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d"
);
describe!(
    Wrench,
    "geometry_msgs",
    "Vector3 force\nVector3 torque\n",
    &[Vector3::TYPE],
    "018e8519d57c16adbe97c9fe1460ef21fec7e31bc541de3d653a35895677ce52"
);
describe!(
    WrenchStamped,
    "geometry_msgs",
    "std_msgs/Header header\nWrench wrench\n",
    &[Wrench::TYPE, Header::TYPE],
    "8dc3deaf06b2ab281f9f9a742a8961c328ca7cec16e3fd6586d3a5c83fa78f77"
);
describe!(
    JointState,
    "sensor_msgs",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n\
           float64[] effort\n",
    &[Header::TYPE],
    "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e"
);
describe!(
    Clock,
    "rosgraph_msgs",
    "builtin_interfaces/Time clock\n",
    &[Time::TYPE],
    "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"
);
describe!(
    Duration,
    "builtin_interfaces",
    "int32 sec\nuint32 nanosec\n",
    &[],
    "e8d009f659816f758b75334ee1a9ca5b5c0b859843261f14c7f937349599d93b"
);
describe!(
    JointTrajectoryPoint,
    "trajectory_msgs",
    "float64[] positions\nfloat64[] velocities\nfloat64[] accelerations\nfloat64[] effort\n\
           builtin_interfaces/Duration time_from_start\n",
    &[Duration::TYPE],
    "de8907036d8bd45aac6f30cc9044a3d4a329c42cbf719aff7d95a584cfa532d7"
);
describe!(
    JointTrajectory,
    "trajectory_msgs",
    "std_msgs/Header header\nstring[] joint_names\nJointTrajectoryPoint[] points\n",
    &[Header::TYPE, JointTrajectoryPoint::TYPE],
    "179b33eba59d676f6d967ac71fe35e7ca2f64b2f3928f4a018cec115e213796e"
);

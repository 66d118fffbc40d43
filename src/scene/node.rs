//! The ROS 2 node.

mod joints;
mod limits;

use serde::{Deserialize, Serialize};

use super::MeasuredWrench;
pub use joints::{Joint, JointStates, JointTrajectory, WallName, Zero};
pub use limits::{Fault, Limits};

use super::check::{Field, Problems};

/// Highest DDS domain whose ports exist (RTPS 9.6.1.1).
const MAX_DOMAIN: u64 = 232;

/// The ROS 2 node.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Node {
    /// How far discovery reaches.
    pub discovery: Discovery,
    /// DDS domain, 0 to 232; 0 = that of `ROS_DOMAIN_ID`, or 0 when it is not set.
    pub domain_id: u16,
    /// Commands older than this are refused \[s\]; 0 = never.
    pub stale_after: f64,
    /// How far, how fast and how hard commands may move the walls.
    pub limits: Limits,
    /// What makes the twin hold until its faults are reset.
    pub hold_after: Vec<Fault>,
    /// What happens to commands that come faster than the twin serves them.
    pub late: Late,
    /// Joints that the walls follow, from `~/joint_states`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_states: Option<JointStates>,
    /// Joints whose trajectories the walls go through, from `~/joint_trajectory`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_trajectory: Option<JointTrajectory>,
    /// A rig inside the program publishes the load path as commands through DDS.
    pub virtual_rig: bool,
    /// How services go over DDS.
    pub service_mapping: ServiceMapping,
    /// The age of a command is counted on the time of `/clock`, not on the machine's.
    pub use_sim_time: bool,
    /// The real rig's load cells.
    pub measured_wrench: MeasuredWrench,
}

impl Default for Node {
    fn default() -> Self {
        Self {
            discovery: Discovery::Localhost,
            domain_id: 0,
            stale_after: 0.0,
            service_mapping: ServiceMapping::Auto,
            use_sim_time: false,
            measured_wrench: MeasuredWrench::default(),
            limits: Limits::default(),
            hold_after: Vec::new(),
            late: Late::Every,
            joint_states: None,
            joint_trajectory: None,
            virtual_rig: false,
        }
    }
}

impl Node {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.count(at.key("domain_id"), u64::from(self.domain_id), 0, MAX_DOMAIN);
        problems.number(at.key("stale_after"), self.stale_after, "stale_after >= 0 s", |seconds| {
            seconds >= 0.0
        });
        self.measured_wrench.check(&at.key("measured_wrench"), problems);
        self.limits.check(&at.key("limits"), problems);
        if let Some(joints) = &self.joint_states {
            joints.check(&at.key("joint_states"), problems);
        }
        if let Some(joints) = &self.joint_trajectory {
            joints.check(&at.key("joint_trajectory"), problems);
        }
    }
}

/// What happens to commands that come faster than the twin serves them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Late {
    /// Each is an increment of its own.
    #[default]
    Every,
    /// Absolute ones that lead on in one direction become one increment.
    Merge,
}

/// How far discovery reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discovery {
    /// Loopback only.
    #[default]
    Localhost,
    /// Every interface.
    Subnet,
}

/// How services go over DDS. Peers with another middleware than the mapping is for cannot call
/// them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ServiceMapping {
    /// That of the middleware which `RMW_IMPLEMENTATION` names; without it `enhanced`.
    #[default]
    Auto,
    /// Of `rmw_fastrtps_cpp` and most others.
    Enhanced,
    /// Of `rmw_cyclonedds_cpp`.
    Cyclone,
}

//! The services: requests and responses, field by field as their `.srv` texts define them.

use serde::{Deserialize, Serialize};

/// A service type as ROS 2 knows it.
#[derive(Debug, PartialEq, Eq)]
pub struct ServiceType {
    /// Package, as `graintwin_msgs`.
    pub package: &'static str,
    /// Name in the package, as `SavePack`.
    pub name: &'static str,
    /// The `.srv` text.
    pub text: &'static str,
}

/// A service: what is asked, and what is answered.
pub trait Service {
    /// The type.
    const TYPE: &'static ServiceType;
    /// What is asked.
    type Request;
    /// What is answered.
    type Response;
}

/// `std_srvs/Trigger`.
#[derive(Clone, Copy, Debug)]
pub struct Trigger;

/// The request of [`Trigger`], which says nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriggerRequest {
    /// The byte that ROS 2 sends for an empty message.
    pub structure_needs_at_least_one_member: u8,
}

/// `std_srvs/SetBool`.
#[derive(Clone, Copy, Debug)]
pub struct SetBool;

/// The request of [`SetBool`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetBoolRequest {
    /// On or off.
    pub data: bool,
}

/// `graintwin_msgs/SavePack`.
#[derive(Clone, Copy, Debug)]
pub struct SavePack;

/// The request of [`SavePack`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SavePackRequest {
    /// File to write, a CSV.
    pub path: String,
}

/// The response of every service here.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Done {
    /// Whether it was done.
    pub success: bool,
    /// What was done, or why not.
    pub message: String,
}

impl Service for Trigger {
    const TYPE: &'static ServiceType = &ServiceType {
        package: "std_srvs",
        name: "Trigger",
        text: "---\nbool success\nstring message\n",
    };
    type Request = TriggerRequest;
    type Response = Done;
}

impl Service for SetBool {
    const TYPE: &'static ServiceType = &ServiceType {
        package: "std_srvs",
        name: "SetBool",
        text: "bool data\n---\nbool success\nstring message\n",
    };
    type Request = SetBoolRequest;
    type Response = Done;
}

impl Service for SavePack {
    const TYPE: &'static ServiceType = &ServiceType {
        package: "graintwin_msgs",
        name: "SavePack",
        text: include_str!("../../msgs/graintwin_msgs/srv/SavePack.srv"),
    };
    type Request = SavePackRequest;
    type Response = Done;
}

/// Makes them messages of the node.
#[cfg(feature = "ros")]
mod over_dds {
    use super::{Done, SavePackRequest, SetBoolRequest, TriggerRequest};

    impl ros2_client::Message for TriggerRequest {}
    impl ros2_client::Message for SetBoolRequest {}
    impl ros2_client::Message for SavePackRequest {}
    impl ros2_client::Message for Done {}
}

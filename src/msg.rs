//! The messages as they go over ROS 2 and into recordings.
//!
//! The texts under `msgs/graintwin_msgs/` are the definition; the structs here have the same
//! fields in the same order, which a test holds against the texts, and their schemas are those
//! very texts. Of the standard messages only a handful are needed, so they are written out in
//! [`standard`]: the generated crates for them hold thousands of types, and tie a build without
//! DDS to their choice of it.

#[cfg(any(feature = "mcap", feature = "foxglove"))]
pub mod answer;
#[cfg(any(feature = "mcap", feature = "foxglove"))]
pub mod cdr;
mod circumstance;
pub mod convert;
pub mod diagnostics;
#[cfg(feature = "mcap")]
pub mod fields;
pub mod graintwin;
pub mod picture;
pub mod rcl;
pub mod rearrangement;
pub mod schema;
pub mod services;
pub mod standard;
pub mod topics;
pub mod transforms;

pub use diagnostics::{DiagnosticArray, DiagnosticStatus, KeyValue};
pub use graintwin::PlaneState;
pub use graintwin::{
    Bonds, BoundaryCommand, Circumstance, ContactNetwork, Cracks, Discrepancy, Event, Fabric,
    GrainMotion, Moduli, PackState, Report, Tangent, TangentModuli, WallForces, WallTargets,
};
pub use graintwin::{Dissociation, Hydrate};
pub use graintwin::{ShearCommand, ShearState};
pub use picture::{Marker, MarkerArray, PointCloud2};
pub use rearrangement::{Rearrangement, Snapshot};
pub use schema::{Described, MessageType};
pub use standard::{
    Clock, Duration, Header, JointState, JointTrajectory, JointTrajectoryPoint, Time, Vector3,
    Wrench, WrenchStamped,
};
pub use topics::Topic;
pub use transforms::{Quaternion, TFMessage, Transform, TransformStamped};

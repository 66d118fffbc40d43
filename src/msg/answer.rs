//! All messages of an answer, in the order in which recordings hold them.
//!
//! The recorder writes them, a replay makes them again to compare, a server of pictures hands them
//! on: each of them sees the same ones.

use super::cdr::{self, CdrError};
use super::convert::{self, CommandMessage};
use super::rcl::{Log, ParameterEvent};
use super::rearrangement::{self, Rearrangement, Snapshot};
use super::topics::{self, Topic};
use super::{
    Bonds, BoundaryCommand, Circumstance, ContactNetwork, Cracks, Described, DiagnosticArray,
    Discrepancy, Dissociation, Event, Fabric, GrainMotion, Hydrate, JointState, JointTrajectory,
    MarkerArray, MessageType, Moduli, PackState, PointCloud2, Report, ShearCommand, ShearState,
    TFMessage, Tangent, WallForces, WallTargets, WrenchStamped,
};
use crate::command::Stamp;
use crate::report::Measures;
use crate::sink::{Beside, Served};
use crate::view::picture::Painter;

/// A message that can be put on a topic.
pub trait Outgoing {
    /// Its type.
    fn kind(&self) -> &'static MessageType;

    /// The stamp of its header, or of its first part's.
    fn stamp(&self) -> Stamp;

    /// Replaces `bytes` by the message.
    ///
    /// # Errors
    /// As [`cdr::encode`].
    fn encode(&self, bytes: &mut Vec<u8>) -> Result<(), CdrError>;
}

/// What takes the messages; it says whether it goes on.
pub type Take<'a, E> = dyn FnMut(&'static Topic, &dyn Outgoing) -> Result<(), E> + 'a;

/// Hands every message of `served` on a topic that `wants` names to `take`: the command, the
/// measures, what the `painter` draws, and the report last, so that an increment whose report is
/// there is whole.
///
/// # Errors
/// The first of `take`.
pub fn each<E>(
    served: &Served,
    painter: Option<&Painter>,
    wants: &dyn Fn(&Topic) -> bool,
    take: &mut Take<'_, E>,
) -> Result<(), E> {
    let mut give = |topic: &'static Topic, message: &dyn Outgoing| {
        debug_assert_eq!(topic.kind, message.kind(), "topic {}", topic.name);
        if wants(topic) { take(topic, message) } else { Ok(()) }
    };
    match served.command.as_ref().map(CommandMessage::from) {
        Some(CommandMessage::Boundary(message)) => give(&topics::BOUNDARY_COMMAND, &message)?,
        Some(CommandMessage::Targets(message)) => give(&topics::WALL_TARGETS, &message)?,
        Some(CommandMessage::Dissociation(message)) => give(&topics::DISSOCIATION, &message)?,
        Some(CommandMessage::Shear(message)) => give(&topics::SHEAR_COMMAND, &message)?,
        None => {}
    }
    if let Some(measures) = &served.report.measures {
        if served.command.is_none() {
            give(&topics::TF_STATIC, &convert::wall_frames(measures))?;
        }
        each_measure(measures, wants, &mut give)?;
        if let Some(painter) = painter {
            each_picture(measures, painter, wants, &mut give)?;
        }
    }
    give(&topics::REPORT, &Report::from(&served.report))
}

fn each_measure<E>(
    measures: &Measures,
    wants: &dyn Fn(&Topic) -> bool,
    give: &mut Take<'_, E>,
) -> Result<(), E> {
    give(&topics::WALL_FORCES, &convert::wall_forces(measures))?;
    for (wall, topic) in topics::WALL_WRENCH.iter().enumerate() {
        give(topic, &convert::wall_wrench(measures, wall))?;
    }
    give(&topics::WALL_STATES, &convert::wall_states(measures))?;
    if let Some(state) = convert::pack_state(measures) {
        give(&topics::STATE, &state)?;
    }
    if let Some(moduli) = convert::moduli(measures) {
        give(&topics::MODULI, &moduli)?;
    }
    if let Some(tangent) = convert::tangent(measures) {
        give(&topics::TANGENT, &tangent)?;
    }
    // Large: not made when nobody takes it.
    if wants(&topics::CONTACT_NETWORK)
        && let Some(network) = convert::whole_network(measures)
    {
        give(&topics::CONTACT_NETWORK, &network)?;
    }
    if wants(&topics::GRAIN_MOTION)
        && let Some(motion) = convert::whole_motion(measures)
    {
        give(&topics::GRAIN_MOTION, &motion)?;
    }
    if let Some(fabric) = convert::fabric(measures) {
        give(&topics::FABRIC, &fabric)?;
    }
    if let Some(shear) = convert::shear(measures) {
        give(&topics::SHEAR_STATE, &shear)?;
    }
    if let Some(hydrate) = convert::hydrate(measures) {
        give(&topics::HYDRATE, &hydrate)?;
    }
    if let Some(plane) = convert::plane_state(measures) {
        give(&topics::PLANE_STATE, &plane)?;
    }
    if wants(&topics::BONDS)
        && let Some(bonds) = convert::whole_bonds(measures)
    {
        give(&topics::BONDS, &bonds)?;
    }
    if let Some(cracks) = convert::whole_cracks(measures) {
        give(&topics::CRACKS, &cracks)?;
    }
    for event in convert::events(measures) {
        give(&topics::EVENTS, &event)?;
    }
    for event in rearrangement::whole(measures) {
        give(&topics::REARRANGEMENTS, &event)?;
    }
    if wants(&topics::SNAPSHOTS) {
        for snapshot in rearrangement::snapshots(measures) {
            give(&topics::SNAPSHOTS, &snapshot)?;
        }
    }
    Ok(())
}

fn each_picture<E>(
    measures: &Measures,
    painter: &Painter,
    wants: &dyn Fn(&Topic) -> bool,
    give: &mut Take<'_, E>,
) -> Result<(), E> {
    // Large, as above.
    if wants(&topics::GRAINS)
        && let Some(cloud) = painter.cloud(measures)
    {
        give(&topics::GRAINS, &cloud)?;
    }
    if wants(&topics::MARKERS)
        && let Some(markers) = painter.markers(measures)
    {
        give(&topics::MARKERS, &markers)?;
    }
    Ok(())
}

/// What came or went beside the answers, as a message and its topic.
#[must_use]
pub fn beside(beside: &Beside) -> (&'static Topic, &dyn Outgoing) {
    match beside {
        Beside::Measured(wall, message) => (&topics::MEASURED_WRENCH[*wall], message),
        Beside::Discrepancy(message) => (&topics::DISCREPANCY, message),
        Beside::JointStates(message) => (&topics::JOINT_STATES, message),
        Beside::JointTrajectory(message) => (&topics::JOINT_TRAJECTORY, message),
        Beside::Diagnostics(message) => (&topics::DIAGNOSTICS, message),
        Beside::Log(message) => (&topics::ROSOUT, message),
        Beside::ParameterEvent(message) => (&topics::PARAMETER_EVENTS, message),
    }
}

/// What a message with a stamp at some place needs to be [`Outgoing`].
macro_rules! outgoing {
    ($($message:ty: $stamp:expr),+ $(,)?) => {$(
        impl Outgoing for $message {
            fn kind(&self) -> &'static MessageType {
                Self::TYPE
            }

            fn stamp(&self) -> Stamp {
                let stamp: fn(&Self) -> Stamp = $stamp;
                stamp(self)
            }

            fn encode(&self, bytes: &mut Vec<u8>) -> Result<(), CdrError> {
                cdr::encode(self, bytes)
            }
        }
    )+};
    (header of $($message:ty),+ $(,)?) => {
        outgoing!($($message: |message| message.header.stamp.into()),+);
    };
}

outgoing!(header of BoundaryCommand, WallTargets, Circumstance, Report, WallForces, WrenchStamped,
    JointState, JointTrajectory, PackState, Moduli, ContactNetwork, GrainMotion, Event, Discrepancy, Fabric, Tangent,
    DiagnosticArray, PointCloud2);
outgoing!(header of Rearrangement, Snapshot, Dissociation, Hydrate, Bonds, Cracks,
    super::PlaneState);
outgoing!(header of ShearCommand, ShearState);
outgoing!(Log: |message| message.stamp.into(), ParameterEvent: |message| message.stamp.into());
outgoing!(TFMessage: |message| {
    message.transforms.first().map(|first| first.header.stamp.into()).unwrap_or_default()
});
outgoing!(MarkerArray: |message| {
    message.markers.first().map(|first| first.header.stamp.into()).unwrap_or_default()
});

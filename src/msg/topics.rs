//! The topics of the node and of its recordings: name, type and quality of service.

use super::rcl::{Log, ParameterEvent};
use super::rearrangement::{Rearrangement, Snapshot};
use super::schema::{Described, MessageType};
use super::{
    Bonds, BoundaryCommand, Circumstance, ContactNetwork, Cracks, DiagnosticArray, Discrepancy,
    Dissociation, Event, Fabric, GrainMotion, Hydrate, JointState, JointTrajectory, MarkerArray,
    Moduli, PackState, PlaneState, PointCloud2, Report, ShearCommand, ShearState, TFMessage,
    Tangent, WallForces, WallTargets, WrenchStamped,
};
use crate::wall;

/// Name of the node when nobody renames it; recordings are made under this name.
pub const NODE: &str = "graintwin";

/// Frame of everything that concerns the whole pack.
pub const PACK_FRAME: &str = "pack";

/// Root of the frames.
pub const WORLD_FRAME: &str = "world";

/// Frame of the pictures, which are larger than the pack: `view.scale` of the scene.
pub const VIEW_FRAME: &str = "pack_view";

/// Frame of wall `wall`, `wall_x_min` and so on: axes as the pack's, origin at the wall's centre.
#[must_use]
pub fn wall_frame(wall: usize) -> String {
    format!("wall_{}", wall::NAMES[wall])
}

/// Whether a lost sample is sent again. Everything here is reliable; a best-effort subscriber
/// may still listen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reliability {
    /// Until it is acknowledged.
    Reliable,
}

/// Whether a late subscriber gets what was published before it came.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Durability {
    /// It does not.
    Volatile,
    /// It gets the last samples.
    TransientLocal,
}

/// Quality of service; the history is always keep-last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Qos {
    /// Reliability.
    pub reliability: Reliability,
    /// Durability.
    pub durability: Durability,
    /// Samples kept.
    pub depth: u32,
}

/// A topic.
#[derive(Debug, PartialEq, Eq)]
pub struct Topic {
    /// Name under the node's own, as `wall_forces`, or absolute, as `/tf_static`.
    pub name: &'static str,
    /// Type of its messages.
    pub kind: &'static MessageType,
    /// Quality of service.
    pub qos: Qos,
}

impl Topic {
    const fn new(name: &'static str, kind: &'static MessageType, depth: u32) -> Self {
        let qos =
            Qos { reliability: Reliability::Reliable, durability: Durability::Volatile, depth };
        Self { name, kind, qos }
    }

    const fn latched(mut self) -> Self {
        self.qos.durability = Durability::TransientLocal;
        self
    }

    /// The name before anything is remapped: `~/wall_forces`, or absolute, as `/tf_static`.
    #[must_use]
    pub fn graph_name(&self) -> String {
        match self.name.starts_with('/') {
            true => self.name.into(),
            false => format!("~/{}", self.name),
        }
    }

    /// The name in a recording: `/graintwin/wall_forces`.
    #[must_use]
    pub fn recorded_name(&self) -> String {
        match self.name.starts_with('/') {
            true => self.name.into(),
            false => format!("/{NODE}/{}", self.name),
        }
    }
}

/// In: [`BoundaryCommand`]; deep enough for the largest burst, since a subscriber of unlimited
/// depth loses samples.
pub static BOUNDARY_COMMAND: Topic = Topic::new("boundary_command", BoundaryCommand::TYPE, 20_000);
/// In: [`WallTargets`].
pub static WALL_TARGETS: Topic = Topic::new("wall_targets", WallTargets::TYPE, 20_000);
/// In: [`Dissociation`].
pub static DISSOCIATION: Topic = Topic::new("dissociation", Dissociation::TYPE, 20_000);
/// In: [`ShearCommand`].
pub static SHEAR_COMMAND: Topic = Topic::new("shear_command", ShearCommand::TYPE, 20_000);
/// In, when the scene maps joints: [`JointState`]. Recorded as it came, and as the [`WallTargets`] it
/// becomes.
pub static JOINT_STATES: Topic = Topic::new("joint_states", JointState::TYPE, 256);
/// In, when the scene maps joints: [`JointTrajectory`]. Recorded as it came, and as the
/// [`WallTargets`] it becomes.
pub static JOINT_TRAJECTORY: Topic = Topic::new("joint_trajectory", JointTrajectory::TYPE, 64);
/// Out: [`Report`].
pub static REPORT: Topic = Topic::new("report", Report::TYPE, 256);
/// Recorded only: [`Circumstance`].
pub static CIRCUMSTANCE: Topic = Topic::new("circumstance", Circumstance::TYPE, 64);
/// Out: [`WallForces`].
pub static WALL_FORCES: Topic = Topic::new("wall_forces", WallForces::TYPE, 64);
/// Out: [`WrenchStamped`], one topic a wall.
pub static WALL_WRENCH: [Topic; wall::COUNT] = [
    Topic::new("wall/x_min/wrench", WrenchStamped::TYPE, 64),
    Topic::new("wall/x_max/wrench", WrenchStamped::TYPE, 64),
    Topic::new("wall/y_min/wrench", WrenchStamped::TYPE, 64),
    Topic::new("wall/y_max/wrench", WrenchStamped::TYPE, 64),
    Topic::new("wall/z_min/wrench", WrenchStamped::TYPE, 64),
    Topic::new("wall/z_max/wrench", WrenchStamped::TYPE, 64),
];
/// Out: [`JointState`] with the walls as joints.
pub static WALL_STATES: Topic = Topic::new("wall_states", JointState::TYPE, 64);
/// Out: [`PackState`].
pub static STATE: Topic = Topic::new("state", PackState::TYPE, 64);
/// Out: [`Moduli`], kept for whoever comes later.
pub static MODULI: Topic = Topic::new("moduli", Moduli::TYPE, 1).latched();
/// Out: [`Tangent`], kept for whoever comes later.
pub static TANGENT: Topic = Topic::new("tangent", Tangent::TYPE, 1).latched();
/// Out: [`ContactNetwork`].
pub static CONTACT_NETWORK: Topic = Topic::new("contact_network", ContactNetwork::TYPE, 64);
/// Out: [`GrainMotion`].
pub static GRAIN_MOTION: Topic = Topic::new("grain_motion", GrainMotion::TYPE, 64);

/// Out: [`PointCloud2`] of the grains.
pub static GRAINS: Topic = Topic::new("grains", PointCloud2::TYPE, 2);
/// Out: [`MarkerArray`] with spheres, force chains, walls and a line of text.
pub static MARKERS: Topic = Topic::new("markers", MarkerArray::TYPE, 2);

/// Out: [`Fabric`].
pub static FABRIC: Topic = Topic::new("fabric", Fabric::TYPE, 64);

/// Out: [`Hydrate`], when the pack has hydrate.
pub static HYDRATE: Topic = Topic::new("hydrate", Hydrate::TYPE, 64);

/// Out: [`ShearState`], of discs.
pub static SHEAR_STATE: Topic = Topic::new("shear_state", ShearState::TYPE, 64);

/// Out: [`PlaneState`], of discs.
pub static PLANE_STATE: Topic = Topic::new("plane_state", PlaneState::TYPE, 64);

/// Out: [`Bonds`], where there is cement.
pub static BONDS: Topic = Topic::new("bonds", Bonds::TYPE, 64);
/// Out: [`Cracks`], where there is cement.
pub static CRACKS: Topic = Topic::new("cracks", Cracks::TYPE, 64);

/// Out: [`Event`], one message an event.
pub static EVENTS: Topic = Topic::new("events", Event::TYPE, 64);
/// Out: [`Rearrangement`], one message an event, or its chunks.
pub static REARRANGEMENTS: Topic = Topic::new("rearrangements", Rearrangement::TYPE, 64);
/// Recorded only: [`Snapshot`], two an event.
pub static SNAPSHOTS: Topic = Topic::new("snapshots", Snapshot::TYPE, 64);

/// In: [`WrenchStamped`] of the real rig's load cells, one topic a wall.
pub static MEASURED_WRENCH: [Topic; wall::COUNT] = [
    Topic::new("measured_wrench/x_min", WrenchStamped::TYPE, 256),
    Topic::new("measured_wrench/x_max", WrenchStamped::TYPE, 256),
    Topic::new("measured_wrench/y_min", WrenchStamped::TYPE, 256),
    Topic::new("measured_wrench/y_max", WrenchStamped::TYPE, 256),
    Topic::new("measured_wrench/z_min", WrenchStamped::TYPE, 256),
    Topic::new("measured_wrench/z_max", WrenchStamped::TYPE, 256),
];
/// Out: [`Discrepancy`], when load cells are mapped.
pub static DISCREPANCY: Topic = Topic::new("discrepancy", Discrepancy::TYPE, 64);
/// Out: [`DiagnosticArray`], once a second.
pub static DIAGNOSTICS: Topic = Topic::new("/diagnostics", DiagnosticArray::TYPE, 10);
/// Out: [`TFMessage`], kept for whoever comes later: [where every frame
/// is](super::convert::wall_frames).
pub static TF_STATIC: Topic = Topic::new("/tf_static", TFMessage::TYPE, 1).latched();

/// Out: [`Log`], kept for whoever comes later: warnings and errors.
pub static ROSOUT: Topic = Topic::new("/rosout", Log::TYPE, 1000).latched();
/// Out: [`ParameterEvent`].
pub static PARAMETER_EVENTS: Topic = Topic::new("/parameter_events", ParameterEvent::TYPE, 1000);

/// The topics of what the twin measures.
pub fn measures() -> impl Iterator<Item = &'static Topic> {
    [&WALL_FORCES].into_iter().chain(&WALL_WRENCH).chain([
        &WALL_STATES,
        &STATE,
        &MODULI,
        &TANGENT,
        &CONTACT_NETWORK,
        &GRAIN_MOTION,
        &FABRIC,
        &HYDRATE,
        &SHEAR_STATE,
        &PLANE_STATE,
        &BONDS,
        &CRACKS,
        &EVENTS,
        &REARRANGEMENTS,
        &SNAPSHOTS,
        &GRAINS,
        &MARKERS,
        &TF_STATIC,
    ])
}

/// The topics of the commands.
pub fn commands() -> impl Iterator<Item = &'static Topic> {
    [&BOUNDARY_COMMAND, &WALL_TARGETS, &DISSOCIATION, &SHEAR_COMMAND].into_iter()
}

/// Every topic that can be recorded, commands first.
pub fn all() -> impl Iterator<Item = &'static Topic> {
    commands()
        .chain([&CIRCUMSTANCE, &REPORT])
        .chain(measures())
        .chain(&MEASURED_WRENCH)
        .chain([&DISCREPANCY, &JOINT_STATES, &JOINT_TRAJECTORY])
        .chain([&DIAGNOSTICS, &ROSOUT, &PARAMETER_EVENTS])
}

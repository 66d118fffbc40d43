//! Everything the node publishes and subscribes, made in one go.

use std::time::Duration;

use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    MessageTypeName, Name, Node, Publisher, QosProfile, Subscription, WriteError, dds,
};
use serde::Serialize;

use super::names::Identity;
use super::services::Services;
use super::{NodeError, clock, mapping};
use crate::msg::{
    Bonds, BoundaryCommand, Clock, ContactNetwork, Cracks, DiagnosticArray, Discrepancy,
    Dissociation, Event, Fabric, GrainMotion, Hydrate, JointState, JointTrajectory, MarkerArray,
    Moduli, PackState, PlaneState, PointCloud2, Rearrangement, Report, ShearCommand, ShearState,
    TFMessage, Tangent, Topic, WallForces, WallTargets, WrenchStamped, topics,
};
use crate::{scene, wall};

/// How long one attempt waits for room in the window of unacknowledged samples. No sample is
/// given up after it; the next attempt starts.
const ATTEMPT: Duration = Duration::from_secs(1);

/// The publishers of the node, and the node itself. Fields drop in this order, as they must:
/// publishers before their node.
pub(super) struct Endpoints {
    pub wall_forces: Out<WallForces>,
    pub wrenches: [Out<WrenchStamped>; wall::COUNT],
    pub wall_states: Out<JointState>,
    pub state: Out<PackState>,
    pub moduli: Out<Moduli>,
    pub tangent: Out<Tangent>,
    pub contact_network: Out<ContactNetwork>,
    pub grain_motion: Out<GrainMotion>,
    pub grains: Out<PointCloud2>,
    pub markers: Out<MarkerArray>,
    pub events: Out<Event>,
    pub fabric: Out<Fabric>,
    pub hydrate: Out<Hydrate>,
    pub shear_state: Out<ShearState>,
    pub plane_state: Out<PlaneState>,
    pub bonds: Out<Bonds>,
    pub cracks: Out<Cracks>,
    pub rearrangements: Out<Rearrangement>,
    pub report: Out<Report>,
    /// When load cells are mapped.
    pub discrepancy: Option<Out<Discrepancy>>,
    pub tf_static: Out<TFMessage>,
    pub diagnostics: Out<DiagnosticArray>,
    node: Node,
}

/// A publisher and the topic it publishes on.
pub(super) struct Out<M: Serialize> {
    publisher: Publisher<M>,
    /// Name of the topic under the node's own.
    topic: &'static str,
    /// Its full name.
    name: String,
}

/// What the node subscribes to.
pub(super) struct Subscriptions {
    pub sources: Sources,
    /// Load cells, by wall.
    pub cells: Vec<(usize, Subscription<WrenchStamped>)>,
    pub clock: Option<Subscription<Clock>>,
    pub services: Services,
}

/// Where commands come from.
pub(super) struct Sources {
    pub commands: Subscription<BoundaryCommand>,
    pub targets: Subscription<WallTargets>,
    pub dissociations: Subscription<Dissociation>,
    pub shears: Subscription<ShearCommand>,
    /// When the scene maps joints.
    pub joint_states: Option<Subscription<JointState>>,
    /// When the scene maps joints.
    pub joint_trajectory: Option<Subscription<JointTrajectory>>,
}

impl Endpoints {
    /// Makes every endpoint of `node`. All of them exist before anything asks who is matched:
    /// asking while others are made has been seen to deadlock.
    pub(super) fn new(
        mut node: Node,
        identity: &Identity,
        options: &scene::Node,
    ) -> Result<(Self, Subscriptions), NodeError> {
        let cells = options.measured_wrench.cells();
        let measured = |wall: &usize| cells.is_some_and(|cells| cells.walls[*wall]);
        let [x_min, x_max, y_min, y_max, z_min, z_max] = &topics::WALL_WRENCH;
        let subscriptions = Subscriptions {
            sources: Sources {
                commands: subscribe(&mut node, identity, &topics::BOUNDARY_COMMAND)?,
                targets: subscribe(&mut node, identity, &topics::WALL_TARGETS)?,
                dissociations: subscribe(&mut node, identity, &topics::DISSOCIATION)?,
                shears: subscribe(&mut node, identity, &topics::SHEAR_COMMAND)?,
                joint_states: match options.joint_states {
                    Some(_) => Some(subscribe(&mut node, identity, &topics::JOINT_STATES)?),
                    None => None,
                },
                joint_trajectory: match options.joint_trajectory {
                    Some(_) => Some(subscribe(&mut node, identity, &topics::JOINT_TRAJECTORY)?),
                    None => None,
                },
            },
            cells: (0..wall::COUNT)
                .filter(measured)
                .map(|wall| {
                    Ok((wall, subscribe(&mut node, identity, &topics::MEASURED_WRENCH[wall])?))
                })
                .collect::<Result<_, NodeError>>()?,
            clock: options
                .use_sim_time
                .then(|| clock::subscribe(&mut node, identity))
                .transpose()?,
            services: Services::new(&mut node, identity, mapping::service_mapping(options))?,
        };
        let endpoints = Self {
            wall_forces: Out::new(&mut node, identity, &topics::WALL_FORCES)?,
            wrenches: [
                Out::new(&mut node, identity, x_min)?,
                Out::new(&mut node, identity, x_max)?,
                Out::new(&mut node, identity, y_min)?,
                Out::new(&mut node, identity, y_max)?,
                Out::new(&mut node, identity, z_min)?,
                Out::new(&mut node, identity, z_max)?,
            ],
            wall_states: Out::new(&mut node, identity, &topics::WALL_STATES)?,
            state: Out::new(&mut node, identity, &topics::STATE)?,
            moduli: Out::new(&mut node, identity, &topics::MODULI)?,
            tangent: Out::new(&mut node, identity, &topics::TANGENT)?,
            contact_network: Out::new(&mut node, identity, &topics::CONTACT_NETWORK)?,
            grain_motion: Out::new(&mut node, identity, &topics::GRAIN_MOTION)?,
            grains: Out::new(&mut node, identity, &topics::GRAINS)?,
            markers: Out::new(&mut node, identity, &topics::MARKERS)?,
            events: Out::new(&mut node, identity, &topics::EVENTS)?,
            fabric: Out::new(&mut node, identity, &topics::FABRIC)?,
            hydrate: Out::new(&mut node, identity, &topics::HYDRATE)?,
            shear_state: Out::new(&mut node, identity, &topics::SHEAR_STATE)?,
            plane_state: Out::new(&mut node, identity, &topics::PLANE_STATE)?,
            bonds: Out::new(&mut node, identity, &topics::BONDS)?,
            cracks: Out::new(&mut node, identity, &topics::CRACKS)?,
            rearrangements: Out::new(&mut node, identity, &topics::REARRANGEMENTS)?,
            report: Out::new(&mut node, identity, &topics::REPORT)?,
            discrepancy: cells
                .map(|_| Out::new(&mut node, identity, &topics::DISCREPANCY))
                .transpose()?,
            tf_static: Out::new(&mut node, identity, &topics::TF_STATIC)?,
            diagnostics: Out::new(&mut node, identity, &topics::DIAGNOSTICS)?,
            node,
        };
        Ok((endpoints, subscriptions))
    }

    /// Whether somebody subscribed to any topic that tells of the twin.
    pub(super) fn any_listener(&self) -> bool {
        self.listeners().iter().any(|(_, listeners)| *listeners > 0)
    }

    /// How many subscribers each topic that tells of the twin has.
    pub(super) fn listeners(&self) -> Vec<(&'static str, usize)> {
        let mut all = vec![self.wall_forces.listeners(self)];
        all.extend(self.wrenches.iter().map(|wrench| wrench.listeners(self)));
        all.extend([
            self.wall_states.listeners(self),
            self.state.listeners(self),
            self.moduli.listeners(self),
            self.tangent.listeners(self),
            self.contact_network.listeners(self),
            self.grain_motion.listeners(self),
            self.grains.listeners(self),
            self.markers.listeners(self),
            self.events.listeners(self),
            self.fabric.listeners(self),
            self.hydrate.listeners(self),
            self.shear_state.listeners(self),
            self.plane_state.listeners(self),
            self.bonds.listeners(self),
            self.cracks.listeners(self),
            self.rearrangements.listeners(self),
            self.report.listeners(self),
        ]);
        all.extend(self.discrepancy.as_ref().map(|discrepancy| discrepancy.listeners(self)));
        all.push(self.tf_static.listeners(self));
        all
    }
}

impl<M: Serialize> Out<M> {
    /// A publisher of `node` on a topic of the node `identity`.
    pub(super) fn new(
        node: &mut Node,
        identity: &Identity,
        topic: &'static Topic,
    ) -> Result<Self, NodeError> {
        let name = identity.resolve(&topic.graph_name());
        let (dds_topic, qos) = create_topic(node, &name, topic)?;
        let publisher = node
            .create_publisher(&dds_topic, Some(qos))
            .map_err(|error| endpoint_error(&name, &error))?;
        Ok(Self { publisher, name, topic: topic.name })
    }

    /// Whether somebody subscribed.
    pub(super) fn has_listener(&self, endpoints: &Endpoints) -> bool {
        self.is_matched(&endpoints.node)
    }

    /// The topic's name and how many subscribed.
    fn listeners(&self, endpoints: &Endpoints) -> (&'static str, usize) {
        (self.topic, self.publisher.get_subscription_count(&endpoints.node))
    }

    /// Whether a subscriber is matched, asked of the `node` that made this publisher.
    pub(super) fn is_matched(&self, node: &Node) -> bool {
        self.publisher.get_subscription_count(node) > 0
    }

    /// Publishes, waiting as long as a subscriber leaves no room. False when the message is lost.
    pub(super) async fn publish(&self, message: M) -> bool {
        let mut message = message;
        loop {
            match self.publisher.async_publish(message).await {
                Ok(()) => return true,
                Err(WriteError::WouldBlock { data }) => message = data,
                Err(error) => {
                    tracing::error!("a message on {} is lost: {error}", self.name);
                    return false;
                }
            }
        }
    }
}

/// A subscription of `node` to a topic of the node `identity`.
pub(super) fn subscribe<M: 'static>(
    node: &mut Node,
    identity: &Identity,
    topic: &Topic,
) -> Result<Subscription<M>, NodeError> {
    let name = identity.resolve(&topic.graph_name());
    let (dds_topic, qos) = create_topic(node, &name, topic)?;
    node.create_subscription(&dds_topic, Some(qos)).map_err(|error| endpoint_error(&name, &error))
}

fn create_topic(
    node: &Node,
    name: &str,
    topic: &Topic,
) -> Result<(dds::rustdds::Topic, QosProfile), NodeError> {
    let durability = match topic.qos.durability {
        topics::Durability::Volatile => Durability::Volatile,
        topics::Durability::TransientLocal => Durability::TransientLocal,
    };
    let topics::Reliability::Reliable = topic.qos.reliability;
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(ATTEMPT))
        .durability(durability)
        .history(History::KeepLast { depth: topic.qos.depth as usize });
    let parsed = Name::parse(name).map_err(|error| endpoint_error(name, &error))?;
    let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
    let dds_topic =
        node.create_topic(&parsed, kind, &qos).map_err(|error| endpoint_error(name, &error))?;
    Ok((dds_topic, qos))
}

fn endpoint_error(name: &str, error: &dyn std::error::Error) -> NodeError {
    NodeError::Endpoint { topic: name.into(), reason: error.to_string() }
}

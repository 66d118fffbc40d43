//! Everything the node publishes and subscribes, made in one go.

use std::time::Duration;

use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    MessageTypeName, Name, Node, Publisher, QosProfile, Subscription, WriteError, dds,
};
use serde::Serialize;

use super::services::Services;
use super::{NodeError, clock, mapping};
use crate::msg::{
    BoundaryCommand, Clock, ContactNetwork, DiagnosticArray, Discrepancy, Event, JointState,
    Moduli, PackState, Report, TFMessage, Topic, WallForces, WallTargets, WrenchStamped, topics,
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
    pub contact_network: Out<ContactNetwork>,
    pub events: Out<Event>,
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
    topic: &'static Topic,
}

/// What the node subscribes to.
pub(super) struct Subscriptions {
    pub commands: Subscription<BoundaryCommand>,
    pub targets: Subscription<WallTargets>,
    /// Load cells, by wall.
    pub cells: Vec<(usize, Subscription<WrenchStamped>)>,
    pub clock: Option<Subscription<Clock>>,
    pub services: Services,
}

impl Endpoints {
    /// Makes every endpoint of `node`. All of them exist before anything asks who is matched:
    /// asking while others are made has been seen to deadlock.
    pub(super) fn new(
        mut node: Node,
        options: &scene::Node,
    ) -> Result<(Self, Subscriptions), NodeError> {
        let cells = options.measured_wrench.cells();
        let measured = |wall: &usize| cells.is_some_and(|cells| cells.walls[*wall]);
        let [x_min, x_max, y_min, y_max, z_min, z_max] = &topics::WALL_WRENCH;
        let subscriptions = Subscriptions {
            commands: subscribe(&mut node, &topics::BOUNDARY_COMMAND)?,
            targets: subscribe(&mut node, &topics::WALL_TARGETS)?,
            cells: (0..wall::COUNT)
                .filter(measured)
                .map(|wall| Ok((wall, subscribe(&mut node, &topics::MEASURED_WRENCH[wall])?)))
                .collect::<Result<_, NodeError>>()?,
            clock: options.use_sim_time.then(|| clock::subscribe(&mut node)).transpose()?,
            services: Services::new(&mut node, mapping::service_mapping(options))?,
        };
        let endpoints = Self {
            wall_forces: Out::new(&mut node, &topics::WALL_FORCES)?,
            wrenches: [
                Out::new(&mut node, x_min)?,
                Out::new(&mut node, x_max)?,
                Out::new(&mut node, y_min)?,
                Out::new(&mut node, y_max)?,
                Out::new(&mut node, z_min)?,
                Out::new(&mut node, z_max)?,
            ],
            wall_states: Out::new(&mut node, &topics::WALL_STATES)?,
            state: Out::new(&mut node, &topics::STATE)?,
            moduli: Out::new(&mut node, &topics::MODULI)?,
            contact_network: Out::new(&mut node, &topics::CONTACT_NETWORK)?,
            events: Out::new(&mut node, &topics::EVENTS)?,
            report: Out::new(&mut node, &topics::REPORT)?,
            discrepancy: cells.map(|_| Out::new(&mut node, &topics::DISCREPANCY)).transpose()?,
            tf_static: Out::new(&mut node, &topics::TF_STATIC)?,
            diagnostics: Out::new(&mut node, &topics::DIAGNOSTICS)?,
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
            self.contact_network.listeners(self),
            self.events.listeners(self),
            self.report.listeners(self),
        ]);
        all.extend(self.discrepancy.as_ref().map(|discrepancy| discrepancy.listeners(self)));
        all.push(self.tf_static.listeners(self));
        all
    }
}

impl<M: Serialize> Out<M> {
    pub(super) fn new(node: &mut Node, topic: &'static Topic) -> Result<Self, NodeError> {
        let (dds_topic, qos) = create_topic(node, topic)?;
        let publisher = node
            .create_publisher(&dds_topic, Some(qos))
            .map_err(|error| endpoint_error(topic, &error))?;
        Ok(Self { publisher, topic })
    }

    /// Whether somebody subscribed.
    pub(super) fn has_listener(&self, endpoints: &Endpoints) -> bool {
        self.is_matched(&endpoints.node)
    }

    /// The topic's name and how many subscribed.
    fn listeners(&self, endpoints: &Endpoints) -> (&'static str, usize) {
        (self.topic.name, self.publisher.get_subscription_count(&endpoints.node))
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
                    tracing::error!("a message on {} is lost: {error}", self.topic.recorded_name());
                    return false;
                }
            }
        }
    }
}

/// A subscription of `node`.
pub(super) fn subscribe<M: 'static>(
    node: &mut Node,
    topic: &'static Topic,
) -> Result<Subscription<M>, NodeError> {
    let (dds_topic, qos) = create_topic(node, topic)?;
    node.create_subscription(&dds_topic, Some(qos)).map_err(|error| endpoint_error(topic, &error))
}

fn create_topic(
    node: &Node,
    topic: &'static Topic,
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
    let name =
        Name::parse(&topic.recorded_name()).map_err(|error| endpoint_error(topic, &error))?;
    let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
    let dds_topic =
        node.create_topic(&name, kind, &qos).map_err(|error| endpoint_error(topic, &error))?;
    Ok((dds_topic, qos))
}

fn endpoint_error(topic: &Topic, error: &dyn std::error::Error) -> NodeError {
    NodeError::Endpoint { topic: topic.recorded_name(), reason: error.to_string() }
}

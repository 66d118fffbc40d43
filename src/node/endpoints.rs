//! Everything the node publishes and subscribes, made in one go.

use std::time::Duration;

use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{
    MessageTypeName, Name, Node, Publisher, QosProfile, Subscription, WriteError, dds,
};
use serde::Serialize;

use super::NodeError;
use crate::msg::{
    BoundaryCommand, ContactNetwork, Event, JointState, JointTrajectory, Moduli, PackState, Report,
    Topic, WallForces, WallTargets, WrenchStamped, topics,
};
use crate::scene;
use crate::wall;

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
        options: &scene::Node,
    ) -> Result<(Self, Subscriptions), NodeError> {
        let [x_min, x_max, y_min, y_max, z_min, z_max] = &topics::WALL_WRENCH;
        let subscriptions = Subscriptions {
            commands: subscribe(&mut node, &topics::BOUNDARY_COMMAND)?,
            targets: subscribe(&mut node, &topics::WALL_TARGETS)?,
            joint_states: match options.joint_states {
                Some(_) => Some(subscribe(&mut node, &topics::JOINT_STATES)?),
                None => None,
            },
            joint_trajectory: match options.joint_trajectory {
                Some(_) => Some(subscribe(&mut node, &topics::JOINT_TRAJECTORY)?),
                None => None,
            },
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
            node,
        };
        Ok((endpoints, subscriptions))
    }

    /// Whether somebody subscribed to any topic.
    pub(super) fn any_listener(&self) -> bool {
        self.wall_forces.has_listener(self)
            || self.wrenches.iter().any(|wrench| wrench.has_listener(self))
            || self.wall_states.has_listener(self)
            || self.state.has_listener(self)
            || self.moduli.has_listener(self)
            || self.contact_network.has_listener(self)
            || self.events.has_listener(self)
            || self.report.has_listener(self)
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

//! The ROS 2 node, alone or with a subscriber.

use std::net::Ipv4Addr;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread::sleep;
use std::time::Duration;

use graintwin::msg::{self, topics};
use graintwin::node::{Node, NodeSink, Setup};
use graintwin::scene::Scene;
use graintwin::sink::Sink;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{
    Context, MessageTypeName, Name, NodeName, NodeOptions, QosProfile, Subscription,
};
use tokio::runtime::{Builder, Runtime};

/// The node, and a subscriber when there is one.
pub(crate) struct Linked {
    node: Node,
    pub(crate) sink: NodeSink,
    subscriber: Option<Subscriber>,
}

/// A subscription to the contact network in a participant of its own.
struct Subscriber {
    _subscription: Subscription<msg::ContactNetwork>,
    _node: ros2_client::Node,
    _spinner: Runtime,
}

impl Linked {
    pub(crate) fn start(subscribed: bool, scene: &Scene) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let node =
            Node::start(&scene.node, Setup::default(), &scene.outputs, &stop).expect("a node");
        let sink = node.sink();
        Self { node, sink, subscriber: subscribed.then(Subscriber::new) }
    }

    /// Waits until the subscriber is there.
    pub(crate) fn settle(&self) {
        while self.subscriber.is_some() && !self.sink.demand().contact_network {
            sleep(Duration::from_millis(20));
        }
    }

    /// Publishes what is left.
    pub(crate) fn end(self) {
        self.node.stop();
    }
}

impl Subscriber {
    fn new() -> Self {
        let topic = &topics::CONTACT_NETWORK;
        let participant = DomainParticipantBuilder::new(0)
            .with_only_networks([Ipv4Addr::LOCALHOST])
            .build()
            .expect("a participant");
        let context = Context::from_domain_participant(participant).expect("a context");
        let name = NodeName::new("/", "listener").expect("a name");
        let mut node = context.new_node(name, NodeOptions::new()).expect("a node");
        let name = Name::parse(&topic.recorded_name()).expect("a name");
        let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
        let qos = QosProfile::publisher_default();
        let topic = node.create_topic(&name, kind, &qos).expect("a topic");
        let subscription = node.create_subscription(&topic, None).expect("a subscription");
        let spinner = Builder::new_multi_thread().worker_threads(1).build().expect("a thread");
        spinner.spawn(node.spinner().expect("a spinner").spin());
        Self { _subscription: subscription, _node: node, _spinner: spinner }
    }
}

//! A subscriber for tests that ask who is there.

use std::net::Ipv4Addr;

use graintwin::msg::Topic;
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, QosProfile, Subscription,
};
use tokio::runtime::{Builder, Runtime};

/// A subscriber in a participant of its own, with the middleware of the node.
pub(crate) struct Listener<M: 'static> {
    subscription: Subscription<M>,
    node: Node,
    _spinner: Runtime,
}

impl<M: 'static> Listener<M> {
    /// Subscribes to `topic`.
    pub(crate) fn new(topic: &Topic) -> Self {
        let domain = std::env::var("ROS_DOMAIN_ID").map_or(0, |text| text.parse().unwrap());
        let participant = DomainParticipantBuilder::new(domain)
            .with_only_networks([Ipv4Addr::LOCALHOST])
            .build()
            .unwrap();
        let context = Context::from_domain_participant(participant).unwrap();
        let name = NodeName::new("/", "listener").unwrap();
        let mut node = context.new_node(name, NodeOptions::new()).unwrap();
        let qos = QosProfile::publisher_default();
        let topic_name = Name::parse(&topic.recorded_name()).unwrap();
        let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
        let topic = node.create_topic(&topic_name, kind, &qos).unwrap();
        let subscription = node.create_subscription(&topic, None).unwrap();
        let spinner = Builder::new_multi_thread().worker_threads(1).build().unwrap();
        spinner.spawn(node.spinner().unwrap().spin());
        Self { subscription, node, _spinner: spinner }
    }

    /// How many publishers of the topic there are.
    pub(crate) fn publishers(&self) -> usize {
        self.subscription.get_publisher_count(&self.node)
    }
}

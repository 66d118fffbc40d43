//! A subscriber for tests that ask who is there.

use graintwin::msg::Topic;
use ros2_client::{MessageTypeName, Name, Node, QosProfile, Subscription};
use tokio::runtime::{Builder, Runtime};

use crate::joined::join;

/// A subscriber in a participant of its own, with the middleware of the node.
pub(crate) struct Listener<M: 'static> {
    subscription: Subscription<M>,
    node: Node,
    _spinner: Runtime,
}

impl<M: 'static> Listener<M> {
    /// Subscribes to `topic`.
    pub(crate) fn new(topic: &Topic) -> Self {
        let mut node = join("listener");
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

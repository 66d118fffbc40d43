//! Another node for tests that ask one, with the middleware of the node itself.

use std::future::Future;
use std::time::Duration;

use graintwin::msg::Topic;
use graintwin::msg::services::Service;
use ros2_client::{
    Client, Message, MessageTypeName, Name, Node, QosProfile, ServiceMapping, ServiceTypeName,
    Subscription,
};
use tokio::runtime::{Builder, Runtime};

use crate::joined::join;

/// A minute, for a machine that is busy with other things.
const PATIENCE: Duration = Duration::from_secs(60);

/// A node in a participant of its own.
pub(crate) struct Partner {
    node: Node,
    runtime: Runtime,
}

impl Partner {
    pub(crate) fn new() -> Self {
        let mut node = join("partner");
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_time().build().unwrap();
        runtime.spawn(node.spinner().unwrap().spin());
        Self { node, runtime }
    }

    /// A client of a service of the node, in the mapping of most middlewares.
    pub(crate) fn client<S>(&mut self, name: &str) -> Client<S::Request, S::Response>
    where
        S: Service,
        S::Request: Message + Clone + 'static,
        S::Response: Message + 'static,
    {
        let name = Name::parse(&format!("/graintwin/{name}")).unwrap();
        let kind = ServiceTypeName::new(S::TYPE.package, S::TYPE.name);
        let qos = QosProfile::publisher_default();
        self.node.create_client(ServiceMapping::Enhanced, &name, &kind, qos.clone(), qos).unwrap()
    }

    pub(crate) fn subscribe<M: 'static>(&mut self, topic: &Topic) -> Subscription<M> {
        let name = Name::parse(&topic.recorded_name()).unwrap();
        let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
        let qos = QosProfile::publisher_default();
        let topic = self.node.create_topic(&name, kind, &qos).unwrap();
        self.node.create_subscription(&topic, None).unwrap()
    }

    /// Returns when the service has been found, and the node has had time to find us.
    pub(crate) fn find<Req, Resp>(&self, client: &Client<Req, Resp>)
    where
        Req: Message + 'static,
        Resp: Message + 'static,
    {
        self.wait(client.wait_for_service(&self.node));
        std::thread::sleep(Duration::from_millis(500));
    }

    /// Waits for something that must come.
    pub(crate) fn wait<T>(&self, what: impl Future<Output = T>) -> T {
        self.runtime.block_on(async { tokio::time::timeout(PATIENCE, what).await }).unwrap()
    }
}

//! Who takes the answers.

use std::sync::Arc;

use graintwin::report::Demand;
use graintwin::scene::Scene;
use graintwin::sink::{Served, Sink};

use crate::variant::Listens;

/// A sink with what it needs to live.
pub(crate) enum Listener {
    Nobody,
    #[cfg(feature = "mcap")]
    Recorder(graintwin::record::Recorder, tempfile::TempDir),
    #[cfg(feature = "ros")]
    Node(Box<subscriber::Linked>),
}

impl Listener {
    pub(crate) fn start(listens: Listens, scene: &Scene) -> Self {
        match listens {
            Listens::Nobody => Self::Nobody,
            #[cfg(feature = "mcap")]
            Listens::Recorder => {
                use graintwin::record::{Provenance, Recorder};
                let folder = tempfile::tempdir().expect("a folder");
                let provenance = Provenance {
                    scene: String::new(),
                    pack_csv: Vec::new(),
                    pack_json: Vec::new(),
                    pack_history: None,
                    threads: 1,
                };
                let bag = folder.path().join("bag");
                let recorder = Recorder::create(&bag, &scene.record, &provenance);
                Self::Recorder(recorder.expect("a new bag"), folder)
            }
            #[cfg(feature = "ros")]
            Listens::Node | Listens::Subscriber => {
                Self::Node(Box::new(subscriber::Linked::start(listens, scene)))
            }
        }
    }

    /// What it wants of the next increment.
    pub(crate) fn demand(&self) -> Demand {
        match self {
            Self::Nobody => Demand::default(),
            #[cfg(feature = "mcap")]
            Self::Recorder(recorder, _) => recorder.demand(),
            #[cfg(feature = "ros")]
            Self::Node(linked) => linked.sink.demand(),
        }
    }

    pub(crate) fn served(&mut self, served: &Arc<Served>) {
        match self {
            Self::Nobody => {}
            #[cfg(feature = "mcap")]
            Self::Recorder(recorder, _) => recorder.served(served),
            #[cfg(feature = "ros")]
            Self::Node(linked) => linked.sink.served(served),
        }
    }

    /// Waits until a subscriber that is to come is there.
    pub(crate) fn settle(&self) {
        match self {
            #[cfg(feature = "ros")]
            Self::Node(linked) => linked.settle(),
            _ => {}
        }
    }

    /// Publishes and writes what is left.
    pub(crate) fn end(self) {
        match self {
            Self::Nobody => {}
            #[cfg(feature = "mcap")]
            Self::Recorder(recorder, _folder) => {
                recorder.finish().expect("the bag is written");
            }
            #[cfg(feature = "ros")]
            Self::Node(linked) => linked.end(),
        }
    }
}

#[cfg(feature = "ros")]
mod subscriber {
    use std::net::Ipv4Addr;
    use std::sync::Arc;
    use std::sync::atomic::AtomicBool;
    use std::thread::sleep;
    use std::time::Duration;

    use graintwin::msg::{self, topics};
    use graintwin::node::{Node, NodeSink};
    use graintwin::scene::Scene;
    use graintwin::sink::Sink;
    use ros2_client::dds::rustdds::DomainParticipantBuilder;
    use ros2_client::{
        Context, MessageTypeName, Name, NodeName, NodeOptions, QosProfile, Subscription,
    };
    use tokio::runtime::{Builder, Runtime};

    use crate::variant::Listens;

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
        pub(super) fn start(listens: Listens, scene: &Scene) -> Self {
            let stop = Arc::new(AtomicBool::new(false));
            let node = Node::start(&scene.node, &scene.outputs, &stop).expect("a node");
            let sink = node.sink();
            let subscriber = (listens == Listens::Subscriber).then(Subscriber::new);
            Self { node, sink, subscriber }
        }

        pub(super) fn settle(&self) {
            while self.subscriber.is_some() && !self.sink.demand().contact_network {
                sleep(Duration::from_millis(20));
            }
        }

        pub(super) fn end(self) {
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
            let topic =
                node.create_topic(&name, kind, &QosProfile::publisher_default()).expect("a topic");
            let subscription = node.create_subscription(&topic, None).expect("a subscription");
            let spinner = Builder::new_multi_thread().worker_threads(1).build().expect("a thread");
            spinner.spawn(node.spinner().expect("a spinner").spin());
            Self { _subscription: subscription, _node: node, _spinner: spinner }
        }
    }
}

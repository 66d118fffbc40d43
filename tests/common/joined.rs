//! A ros2-client node of a test, in a participant of its own on loopback.

use std::net::Ipv4Addr;

use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::{Context, Node, NodeName, NodeOptions};

/// The node `/name` in the domain of the environment. Its spinner is the caller's.
pub(crate) fn join(name: &str) -> Node {
    let domain = std::env::var("ROS_DOMAIN_ID").map_or(0, |text| text.parse().unwrap());
    let participant = DomainParticipantBuilder::new(domain)
        .with_only_networks([Ipv4Addr::LOCALHOST])
        .build()
        .unwrap();
    let context = Context::from_domain_participant(participant).unwrap();
    context.new_node(NodeName::new("/", name).unwrap(), NodeOptions::new()).unwrap()
}

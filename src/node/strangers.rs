//! Peers that have another type than the node for a topic of commands: DDS does not connect them,
//! and without a word nobody would see why nothing moves.

use std::collections::BTreeSet;
use std::time::Duration;

use ros2_client::Context;
use tokio::time::interval;

use super::names::Identity;
use crate::msg::{MessageType, topics};
use crate::scene;

/// How often the topics that peers have are looked at.
const LOOK: Duration = Duration::from_secs(1);

/// Full names of the topics that commands come from, with their types.
pub(super) fn watched(
    identity: &Identity,
    options: &scene::Node,
) -> Vec<(String, &'static MessageType)> {
    let mut watched: Vec<_> = topics::commands().collect();
    watched.extend(options.joint_states.as_ref().map(|_| &topics::JOINT_STATES));
    watched.extend(options.joint_trajectory.as_ref().map(|_| &topics::JOINT_TRAJECTORY));
    watched.into_iter().map(|topic| (identity.resolve(&topic.graph_name()), topic.kind)).collect()
}

/// Warns once of every other type on one of the `watched` topics.
pub(super) async fn warn(context: Context, watched: Vec<(String, &'static MessageType)>) {
    let mut told = BTreeSet::new();
    let mut look = interval(LOOK);
    loop {
        look.tick().await;
        for found in context.discovered_topics() {
            let kind = ros_name(&found.type_name);
            for (topic, own) in &watched {
                let concerned = found.name.strip_prefix("rt") == Some(topic);
                if concerned && kind != own.full_name() && told.insert((topic, kind.clone())) {
                    tracing::warn!(
                        "a peer has type {kind} for {topic}: only {} is taken there",
                        own.full_name()
                    );
                }
            }
        }
    }
}

/// `std_msgs/msg/String` for `std_msgs::msg::dds_::String_`.
fn ros_name(dds_name: &str) -> String {
    let name = dds_name.strip_suffix('_').unwrap_or(dds_name);
    name.replace("::dds_::", "::").replace("::", "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_called_as_ros_calls_them_whoever_named_them() {
        assert_eq!(ros_name("std_msgs::msg::dds_::String_"), "std_msgs/msg/String");
        assert_eq!(ros_name("Position"), "Position");
    }
}

//! Joining the DDS domain: which one, and over which interfaces.

mod reach;

use std::ffi::OsString;
use std::net::Ipv4Addr;

use ros2_client::Context;
use ros2_client::dds::rustdds::DomainParticipantBuilder;

use super::NodeError;
use crate::scene::{self, Discovery};

/// Largest domain that ROS 2 allows: the UDP ports of the next one are out of range.
const LAST_DOMAIN: u16 = 232;

/// Variable that says which domain the ROS 2 programs of a machine are in.
const DOMAIN_VARIABLE: &str = "ROS_DOMAIN_ID";

/// A new participant in the domain that `options` and the environment name, and what of the
/// environment cannot be done, in sentences.
pub(super) fn join(options: &scene::Node) -> Result<(Context, Vec<String>), NodeError> {
    let domain = domain(options.domain_id, std::env::var_os(DOMAIN_VARIABLE))?;
    let (discovery, undone) = reach::reach(options.discovery, |name| std::env::var_os(name));
    let mut builder = DomainParticipantBuilder::new(domain);
    if discovery == Discovery::Localhost {
        builder = builder.with_only_networks([Ipv4Addr::LOCALHOST]);
    }
    let participant =
        builder.build().map_err(|error| NodeError::Domain { domain, reason: error.to_string() })?;
    let context = Context::from_domain_participant(participant)
        .map_err(|error| NodeError::Domain { domain, reason: error.to_string() })?;
    Ok((context, undone))
}

/// The scene's domain when it names one, else the machine's, else 0.
fn domain(scene: u16, variable: Option<OsString>) -> Result<u16, NodeError> {
    if scene > LAST_DOMAIN {
        return Err(NodeError::DomainOutOfRange {
            origin: "node.domain_id",
            found: scene.to_string(),
        });
    }
    match variable {
        Some(text) if scene == 0 && !text.is_empty() => text
            .to_str()
            .and_then(|text| text.parse().ok())
            .filter(|domain| *domain <= LAST_DOMAIN)
            .ok_or_else(|| NodeError::DomainOutOfRange {
                origin: DOMAIN_VARIABLE,
                found: text.to_string_lossy().into_owned(),
            }),
        _ => Ok(scene),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable(text: &str) -> Option<OsString> {
        Some(text.into())
    }

    #[test]
    fn the_machines_domain_counts_only_when_the_scene_names_none() {
        assert_eq!(domain(0, None).unwrap(), 0);
        assert_eq!(domain(0, variable("")).unwrap(), 0);
        assert_eq!(domain(0, variable("42")).unwrap(), 42);
        assert_eq!(domain(7, variable("42")).unwrap(), 7);
        assert_eq!(domain(7, variable("nonsense")).unwrap(), 7);
        assert_eq!(domain(232, None).unwrap(), 232);
    }

    #[test]
    fn a_domain_out_of_range_is_refused_with_where_it_came_from() {
        let told = domain(233, None).unwrap_err().to_string();
        assert_eq!(told, "node.domain_id is `233`: a whole number from 0 to 232 is allowed");
        for text in ["233", "-1", "1.5", "70000", "home"] {
            let told = domain(0, variable(text)).unwrap_err().to_string();
            assert!(told.starts_with(&format!("ROS_DOMAIN_ID is `{text}`:")), "{told}");
        }
    }
}

//! How far discovery reaches, by the variables that all ROS 2 programs of a machine look at.

use std::ffi::OsString;

use crate::scene::Discovery;

/// 1 = loopback only, whatever the other two say. ROS 2 has it for old setups.
const LOCALHOST_ONLY: &str = "ROS_LOCALHOST_ONLY";

/// `SUBNET`, `LOCALHOST`, `OFF` or `SYSTEM_DEFAULT`.
const RANGE: &str = "ROS_AUTOMATIC_DISCOVERY_RANGE";

/// Addresses of peers out of the range.
const PEERS: &str = "ROS_STATIC_PEERS";

/// How far discovery reaches: as the environment says, or the `scene` where it says nothing.
/// Beside it, what of the environment cannot be done, in sentences.
pub(super) fn reach(
    scene: Discovery,
    variable: impl Fn(&str) -> Option<OsString>,
) -> (Discovery, Vec<String>) {
    let set = |name| variable(name).filter(|value| !value.is_empty());
    if set(LOCALHOST_ONLY).is_some_and(|value| value == "1") {
        return (Discovery::Localhost, Vec::new());
    }
    let mut undone = Vec::new();
    if set(PEERS).is_some() {
        undone
            .push(format!("{PEERS} is not used: the middleware of this node knows no such peers"));
    }
    let Some(range) = set(RANGE) else { return (scene, undone) };
    let discovery = match range.to_str() {
        Some("SUBNET" | "SYSTEM_DEFAULT") => Discovery::Subnet,
        Some("LOCALHOST") => Discovery::Localhost,
        Some("OFF") => {
            undone.push(format!(
                "{RANGE} is OFF: the middleware of this node cannot go without discovery, it is \
                 found on this machine only"
            ));
            Discovery::Localhost
        }
        _ => {
            undone.push(format!(
                "{RANGE} is `{}`, taken as LOCALHOST: SUBNET, LOCALHOST, OFF and SYSTEM_DEFAULT \
                 are allowed",
                range.display()
            ));
            Discovery::Localhost
        }
    };
    (discovery, undone)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(scene: Discovery, set: &[(&str, &str)]) -> (Discovery, usize) {
        let variable = |name: &str| {
            set.iter().find(|(set, _)| *set == name).map(|(_, value)| OsString::from(value))
        };
        let (discovery, undone) = reach(scene, variable);
        (discovery, undone.len())
    }

    #[test]
    fn the_environment_comes_before_the_scene_and_the_old_variable_before_the_new() {
        use Discovery::{Localhost, Subnet};
        for (scene, set, expected) in [
            (Localhost, &[][..], (Localhost, 0)),
            (Subnet, &[], (Subnet, 0)),
            (Subnet, &[(LOCALHOST_ONLY, ""), (RANGE, "")], (Subnet, 0)),
            (Subnet, &[(LOCALHOST_ONLY, "0")], (Subnet, 0)),
            (Subnet, &[(LOCALHOST_ONLY, "1")], (Localhost, 0)),
            (Subnet, &[(LOCALHOST_ONLY, "1"), (RANGE, "SUBNET"), (PEERS, "a")], (Localhost, 0)),
            (Localhost, &[(LOCALHOST_ONLY, "0"), (RANGE, "SUBNET")], (Subnet, 0)),
            (Localhost, &[(RANGE, "SYSTEM_DEFAULT")], (Subnet, 0)),
            (Subnet, &[(RANGE, "LOCALHOST")], (Localhost, 0)),
            (Subnet, &[(RANGE, "OFF")], (Localhost, 1)),
            (Subnet, &[(RANGE, "subnet")], (Localhost, 1)),
            (Subnet, &[(PEERS, "10.0.0.1;10.0.0.2")], (Subnet, 1)),
        ] {
            assert_eq!(told(scene, set), expected, "{scene:?} {set:?}");
        }
    }
}

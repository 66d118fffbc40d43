use std::ffi::OsString;

use proptest::prelude::*;

use super::*;
use crate::node::args;

/// The identity that a launcher's remap rules give.
fn identity(rules: &[&str]) -> Identity {
    let arguments = rules.iter().flat_map(|rule| ["-r", rule]);
    let line = ["--ros-args"].into_iter().chain(arguments).map(OsString::from);
    Identity::new(&args::split(line).unwrap().1.unwrap().remaps)
}

#[test]
fn without_rules_the_names_are_those_of_the_contract() {
    let plain = Identity::default();
    assert_eq!(plain.full_name(), "/graintwin");
    assert_eq!(plain.resolve("~/wall_forces"), "/graintwin/wall_forces");
    assert_eq!(plain.resolve("clock"), "/clock");
    assert_eq!(plain.resolve("/rosout"), "/rosout");
    for topic in topics::all() {
        assert_eq!(plain.resolve(&topic.graph_name()), topic.recorded_name());
    }
}

#[test]
fn node_and_namespace_move_every_private_and_relative_name() {
    let moved = identity(&["__ns:=/lab/rig_1", "__node:=twin"]);
    assert_eq!(moved.full_name(), "/lab/rig_1/twin");
    assert_eq!(moved.logger(), "lab.rig_1.twin");
    assert_eq!(moved.resolve("~/wall/x_min/wrench"), "/lab/rig_1/twin/wall/x_min/wrench");
    assert_eq!(moved.resolve("clock"), "/lab/rig_1/clock");
    assert_eq!(moved.resolve("/rosout"), "/rosout");
}

#[test]
fn the_first_rule_that_fits_counts_and_its_target_is_not_renamed_again() {
    let twin = identity(&[
        "~/state:=/a",
        "/graintwin/state:=/b",
        "/a:=/c",
        "~/report:=reports",
        "__name:=graintwin",
        "__node:=too_late",
    ]);
    assert_eq!(twin.name(), "graintwin");
    assert_eq!(twin.resolve("~/state"), "/a");
    assert_eq!(twin.resolve("/a"), "/c");
    assert_eq!(twin.resolve("~/report"), "/reports");
}

#[test]
fn a_rule_for_a_node_fits_its_name_before_for_the_name_and_after_for_all_else() {
    let twin = identity(&[
        "other:__node:=wrong",
        "graintwin:__node:=twin",
        "graintwin:__ns:=/wrong",
        "twin:__ns:=/lab",
        "graintwin:~/state:=/wrong",
        "twin:~/state:=/right",
    ]);
    assert_eq!(twin.full_name(), "/lab/twin");
    assert_eq!(twin.resolve("~/state"), "/right");
}

proptest! {
    #[test]
    fn whatever_the_rules_every_resolved_name_is_one_that_ros_allows(
        rules in prop::collection::vec(
            ("([a-z]{1,3}:)?", "(__node|__ns|__name|[~/]{0,2}[a-c_1]{0,2}(/[a-c]{0,2}){0,2})",
             "[~/]{0,2}[a-c_1]{0,2}(/[a-c]{0,2}){0,2}"),
            0..8,
        ),
    ) {
        let rules: Vec<String> =
            rules.iter().map(|(node, from, to)| format!("{node}{from}:={to}")).collect();
        let valid: Vec<&str> = rules
            .iter()
            .map(String::as_str)
            .filter(|rule| args::split(["--ros-args", "-r", rule].map(OsString::from)).is_ok())
            .collect();
        let identity = identity(&valid);
        for name in [identity.full_name(), identity.resolve("~/a"), identity.resolve("b"), identity.resolve("/c")] {
            prop_assert!(ros2_client::Name::parse(&name).is_ok_and(|n| n.is_absolute()), "{name}");
        }
        prop_assert!(ros2_client::NodeName::new(identity.namespace(), identity.name()).is_ok());
    }
}

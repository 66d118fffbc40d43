//! How services go over DDS: two middlewares, two ways, and a peer of the other gets nothing.

use std::ffi::OsStr;

use ros2_client::ServiceMapping;

use crate::scene;

/// Variable that names the middleware of the ROS 2 programs of a machine.
const RMW_VARIABLE: &str = "RMW_IMPLEMENTATION";

/// The middleware with a mapping of its own.
const CYCLONE: &str = "rmw_cyclonedds_cpp";

/// The mapping of every service of the node: that of the scene, or of the environment's middleware
/// where the scene leaves it open.
pub(super) fn service_mapping(options: &scene::Node) -> ServiceMapping {
    choose(options.service_mapping, std::env::var_os(RMW_VARIABLE).as_deref())
}

fn choose(scene: scene::ServiceMapping, middleware: Option<&OsStr>) -> ServiceMapping {
    match scene {
        scene::ServiceMapping::Enhanced => ServiceMapping::Enhanced,
        scene::ServiceMapping::Cyclone => ServiceMapping::Cyclone,
        scene::ServiceMapping::Auto if middleware == Some(OsStr::new(CYCLONE)) => {
            ServiceMapping::Cyclone
        }
        scene::ServiceMapping::Auto => ServiceMapping::Enhanced,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_environment_decides_only_what_the_scene_leaves_open() {
        let cyclone = Some(OsStr::new("rmw_cyclonedds_cpp"));
        let fast = Some(OsStr::new("rmw_fastrtps_cpp"));
        for (scene, middleware, expected) in [
            (scene::ServiceMapping::Auto, None, ServiceMapping::Enhanced),
            (scene::ServiceMapping::Auto, Some(OsStr::new("")), ServiceMapping::Enhanced),
            (scene::ServiceMapping::Auto, fast, ServiceMapping::Enhanced),
            (scene::ServiceMapping::Auto, cyclone, ServiceMapping::Cyclone),
            (scene::ServiceMapping::Enhanced, cyclone, ServiceMapping::Enhanced),
            (scene::ServiceMapping::Cyclone, fast, ServiceMapping::Cyclone),
        ] {
            assert_eq!(choose(scene, middleware), expected, "{scene:?} {middleware:?}");
        }
    }
}

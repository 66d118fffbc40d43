//! `run --ros`: the node, and the rig inside the program when it has one.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use graintwin::node::rig::{Played, Rig, RigError};
use graintwin::node::{self, Node};
use graintwin::path::Path;
use graintwin::scene::Scene;
use graintwin::sink::Sink;

use super::Failure;
use super::source::Source;

/// The node and whoever plays to it.
pub(super) struct Link {
    node: Node,
    rig: Option<(Rig, usize)>,
}

/// What the node and the rig did.
pub(super) struct Linked {
    pub(super) node: node::Summary,
    pub(super) rig: Option<Result<Played, RigError>>,
}

impl Link {
    /// Starts the node; a rig plays `path` to it when the scene has one or when its commands were
    /// `given` by name.
    pub(super) fn start(
        scene: &Scene,
        path: Path,
        given: bool,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let node = Node::start(&scene.node, &scene.outputs, stop).map_err(Failure::other)?;
        let plays = scene.node.virtual_rig || given;
        if !plays && path.length() > 0 {
            tracing::warn!(
                "commands come from the topic, not from load_path: node.virtual_rig plays it there"
            );
        }
        let rig = match plays {
            false => None,
            true => {
                let count = path.length();
                let rig = Rig::start(&scene.node, path, node.end_of_commands(), stop);
                Some((rig.map_err(Failure::other)?, count))
            }
        };
        Ok(Self { node, rig })
    }

    pub(super) fn sink(&self) -> Box<dyn Sink> {
        Box::new(self.node.sink())
    }

    /// How many commands will come, if anybody knows.
    pub(super) fn length(&self) -> Option<usize> {
        self.rig.as_ref().map(|(_, count)| *count)
    }

    pub(super) fn commands(&mut self) -> Box<dyn Source + '_> {
        Box::new(self.node.commands())
    }

    /// Leaves the domain, the node after the rig.
    pub(super) fn end(self) -> Linked {
        self.node.end_of_commands().declare();
        let rig = self.rig.map(|(rig, _)| rig.join());
        Linked { node: self.node.stop(), rig }
    }
}

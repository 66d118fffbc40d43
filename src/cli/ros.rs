//! `run --ros`: the node, and the rig inside the program when it has one.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use graintwin::command::request::Intake;
pub(super) use graintwin::node::Setup;
use graintwin::node::args::{RosArgs, Severity};
use graintwin::node::parameters::{Changes, Parameters, overrides};
use graintwin::node::rig::{Played, Rig, RigError};
use graintwin::node::rosout::Records;
use graintwin::node::{self, Identity, Node};
use graintwin::scene::{Late, Scene};
use graintwin::sink::Sink;
use graintwin::twin::Settings;
use graintwin::view::picture::Painter;

use super::job::Sender;
use super::orders::Orders;
use super::source::Source;
use super::summary::Summary;
use super::{Cli, Failure};

/// The node and whoever plays to it.
pub(super) struct Link {
    node: Node,
    rig: Option<(Rig, usize)>,
    changes: Option<Changes>,
}

/// The commands of the node, and the changes of its parameters.
struct FromNode<'a> {
    commands: &'a mut node::Commands,
    changes: Option<&'a Changes>,
}

impl Source for FromNode<'_> {
    fn next(&mut self) -> Option<Intake> {
        self.commands.next()
    }

    fn changed(&mut self) -> Option<(Settings, Late)> {
        let live = self.changes?.take()?;
        Some((live.settings(), live.late()))
    }

    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize) {
        while waiting.len() < most
            && let Some(intake) = self.commands.next_waiting()
        {
            waiting.push_back(intake);
        }
    }
}

/// What the node and the rig did.
pub(super) struct Linked {
    pub(super) node: node::Summary,
    pub(super) rig: Option<Result<Played, RigError>>,
}

impl Link {
    /// Starts the node that `setup` describes, and the rig inside the program that plays `orders`
    /// to it when that is the `sender`.
    pub(super) fn start(
        scene: &Scene,
        setup: Setup,
        orders: Orders,
        sender: Sender,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let twin = setup.identity.clone();
        let changes = setup.parameters.as_ref().map(Parameters::changes);
        let node = Node::start(&scene.node, setup, &scene.outputs, stop).map_err(Failure::other)?;
        let plays = sender == Sender::Inside;
        if !plays && orders.length() > 0 {
            tracing::warn!(
                "commands come from the topic, not from load_path: node.virtual_rig plays it there"
            );
        }
        let rig = match plays {
            false => None,
            true => {
                let path = orders.into_path()?;
                let count = path.length();
                let rig = Rig::start(&scene.node, &twin, path, node.end_of_commands(), stop);
                Some((rig.map_err(Failure::other)?, count))
            }
        };
        Ok(Self { node, rig, changes })
    }

    /// Starts the node that `setup` describes to show answers; it takes no commands.
    pub(super) fn showing(
        scene: &Scene,
        setup: Setup,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let node = Node::start(&scene.node, setup, &scene.outputs, stop).map_err(Failure::other)?;
        node.end_of_commands().declare();
        Ok(Self { node, rig: None, changes: None })
    }

    /// Starts the diagnostics; the `recording` gets what the solver does not see.
    pub(super) fn diagnose(
        &mut self,
        scene: &Scene,
        recording: Option<Arc<dyn graintwin::sink::Recording>>,
    ) {
        self.node.diagnose(&scene.name, recording);
    }

    pub(super) fn sink(&self) -> Box<dyn Sink> {
        Box::new(self.node.sink())
    }

    /// How many commands will come, if anybody knows.
    pub(super) fn length(&self) -> Option<usize> {
        self.rig.as_ref().map(|(_, count)| *count)
    }

    pub(super) fn commands(&mut self) -> Box<dyn Source + '_> {
        let Self { node, changes, .. } = self;
        Box::new(FromNode { commands: node.commands(), changes: changes.as_ref() })
    }

    /// Leaves the domain, the node after the rig, and tells the summary.
    pub(super) fn end_into(self, summary: &mut Summary) {
        self.node.end_of_commands().declare();
        let rig = self.rig.map(|(rig, _)| rig.join());
        summary.linked(Linked { node: self.node.stop(), rig });
    }
}

/// The node that the command line asks for; `None` when it asks for none. The values that it gives
/// to parameters are written into `scene`.
pub(super) fn setup(
    asked: bool,
    cli: &Cli,
    scene: &mut Scene,
    log: Option<Records>,
) -> Result<Option<Setup>, Failure> {
    if !asked && cli.ros_args.is_none() {
        return Ok(None);
    }
    let args = cli.ros_args.clone().unwrap_or_default();
    let identity = Identity::new(&args.remaps);
    let overrides = overrides::read(&args.parameters, &identity).map_err(Failure::input)?;
    let parameters = Parameters::new(scene, threads(cli));
    for sentence in parameters.start_with(&overrides).map_err(Failure::input)? {
        tracing::warn!("{sentence}");
    }
    parameters.live().write_to(scene);
    Ok(Some(Setup { identity, parameters: Some(parameters), log, painter: None }))
}

/// A node whose pictures the `painter` draws.
pub(super) fn drawn_by(setup: Setup, painter: Painter) -> Setup {
    Setup { painter: Some(painter), ..setup }
}

/// Threads that the solver will work on.
fn threads(cli: &Cli) -> usize {
    match cli.threads() {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        threads => threads,
    }
}

/// Directives for the log: the middleware's, `level` or what `--log-level` puts in its place, and
/// the loggers it names. The node's own logger is the program.
pub(super) fn log_filter(cli: &Cli, level: &'static str) -> String {
    let RosArgs { log, remaps, .. } = cli.ros_args.clone().unwrap_or_default();
    let mut filter =
        format!("{},{}", graintwin::node::LOG_FILTER, log.level.map_or(level, directive));
    let own = Identity::new(&remaps).logger();
    for (logger, severity) in &log.loggers {
        let target = match *logger == own {
            true => env!("CARGO_PKG_NAME").into(),
            false => logger.replace('.', "::"),
        };
        filter.push_str(&format!(",{target}={}", directive(*severity)));
    }
    filter
}

fn directive(severity: Severity) -> &'static str {
    match severity {
        Severity::Debug => "debug",
        Severity::Info => "info",
        Severity::Warn => "warn",
        Severity::Error => "error",
        // What ends the program is told outside of the log.
        Severity::Fatal => "off",
    }
}

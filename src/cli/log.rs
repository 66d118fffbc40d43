//! Messages on stderr, above the progress bars, and on `/rosout` when there is a node.

use std::io::{self, IsTerminal, Write};

use indicatif::{MultiProgress, ProgressDrawTarget};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

use super::Cli;

/// What the log has for the node.
#[cfg(feature = "ros")]
pub(super) type ForNode = Option<graintwin::node::rosout::Records>;
#[cfg(not(feature = "ros"))]
pub(super) type ForNode = ();

/// Starts the log and gives the place for progress bars; `quiet` hides both but errors. Beside it,
/// what a node is to publish.
pub(super) fn start(cli: &Cli) -> (MultiProgress, ForNode) {
    let bars = MultiProgress::new();
    if cli.quiet {
        bars.set_draw_target(ProgressDrawTarget::hidden());
    }
    let level = match (cli.quiet, cli.verbose) {
        (true, _) => "error",
        (false, 0) => "warn",
        (false, 1) => "info",
        (false, _) => "debug",
    };
    #[cfg(feature = "ros")]
    let level = super::ros::log_filter(cli, level);
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new(level));
    let console = tracing_subscriber::fmt::layer()
        .with_ansi(io::stderr().is_terminal())
        .with_target(false)
        .without_time()
        .with_writer(AboveBars(bars.clone()));
    let log = tracing_subscriber::registry().with(filter);
    #[cfg(feature = "ros")]
    {
        let asked = cli.ros_args.as_ref().map(|args| args.log.clone()).unwrap_or_default();
        let (rosout, records) = graintwin::node::rosout::layer();
        log.with(asked.console.then_some(console)).with(asked.rosout.then_some(rosout)).init();
        (bars, asked.rosout.then_some(records))
    }
    #[cfg(not(feature = "ros"))]
    {
        log.with(console).init();
        (bars, ())
    }
}

/// Clears the bars while a line is written.
#[derive(Clone)]
struct AboveBars(MultiProgress);

impl Write for AboveBars {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.suspend(|| io::stderr().write_all(bytes))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}

impl<'a> MakeWriter<'a> for AboveBars {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

//! The command line. Results go to stdout, everything else to stderr.

#[cfg(unix)]
mod bench;
mod check;
mod completions;
mod failure;
#[cfg_attr(not(feature = "foxglove"), path = "cli/without/foxglove.rs")]
mod foxglove;
mod generate;
mod given;
mod job;
mod log;
mod orders;
pub(crate) mod output;
#[cfg(feature = "mcap")]
mod pace;
#[cfg(feature = "mcap")]
mod plot;
mod progress;
#[cfg_attr(not(feature = "mcap"), path = "cli/without/recording.rs")]
mod recording;
#[cfg(feature = "mcap")]
mod recover;
#[cfg(feature = "mcap")]
mod replay;
#[cfg_attr(not(feature = "mcap"), path = "cli/without/resume.rs")]
mod resume;
#[cfg_attr(not(feature = "ros"), path = "cli/without/ros.rs")]
mod ros;
mod run;
mod serve;
mod source;
mod specimen;
mod stop;
mod summary;

use std::ffi::OsString;
use std::path::Path;

use clap::{ArgAction, Parser, Subcommand};

#[cfg(feature = "ros")]
use graintwin::node::args::{self, RosArgs};
use graintwin::scene::{self, Loaded};

pub(crate) use failure::{Failure, Outcome};

/// A digital twin of a granular specimen in a lab loading rig.
///
/// The specimen is a box of elastic grains between six elastic walls. Each command moves the walls;
/// the twin finds the new equilibrium and answers with wall forces, stresses and moduli.
/// Units are SI (m, N, Pa, s); compression is positive.
#[derive(Debug, Parser)]
#[command(
    name = "graintwin",
    version = version(),
    propagate_version = true,
    after_long_help = "Exit codes: 0 done; 1 failure; 2 wrong arguments or input file; \
                       3 finished, but a command was refused or data was lost.\n\n\
                       Results go to stdout, messages and progress to stderr. RUST_LOG, when set, \
                       takes the place of -v, -q and --log-level.\n\n\
                       --ros-args ... [--] takes what ros2 launch and ros2 run pass to a node \
                       (-r, -p, --params-file, --log-level); run then joins ROS 2 as with --ros."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    verb: Verb,

    /// Says more on stderr; twice for every detail.
    #[arg(short, long, global = true, action = ArgAction::Count, conflicts_with = "quiet")]
    verbose: u8,

    /// Says errors only, and shows no progress.
    #[arg(short, long, global = true)]
    quiet: bool,

    /// Threads of the solver [default: one a core]. Results do not depend on it.
    #[arg(long, global = true, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,

    /// Prints the scene with all defaults and does nothing else.
    #[arg(long, global = true)]
    print_config: bool,

    /// What stood behind --ros-args.
    #[cfg(feature = "ros")]
    #[arg(skip)]
    ros_args: Option<RosArgs>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Run(run::Args),
    #[cfg(feature = "mcap")]
    Replay(replay::Args),
    Generate(generate::Args),
    Check(check::Args),
    #[cfg(feature = "mcap")]
    Recover(recover::Args),
    #[cfg(feature = "mcap")]
    Plot(plot::Args),
    #[cfg(unix)]
    Bench(bench::Args),
    Completions(completions::Args),
}

#[cfg(feature = "ros")]
impl Verb {
    fn can_join_ros(&self) -> bool {
        #[cfg(feature = "mcap")]
        if matches!(self, Self::Replay(_)) {
            return true;
        }
        matches!(self, Self::Run(_))
    }
}

impl Cli {
    /// Threads of the solver, 0 for one a core.
    fn threads(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }

    /// Loads a scene; `None` when it was to be printed and was.
    fn scene(&self, file: &Path) -> Result<Option<Loaded>, Failure> {
        let loaded = scene::load(file)?;
        if self.print_config {
            output::print(&loaded.scene.to_yaml()?)?;
            return Ok(None);
        }
        Ok(Some(loaded))
    }
}

/// Reads the command line. Wrong arguments of the program's own end it here, with 2.
pub(crate) fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Cli, Failure> {
    #[cfg(feature = "ros")]
    let (arguments, ros_args) = args::split(arguments).map_err(Failure::input)?;
    let cli = Cli::parse_from(arguments);
    #[cfg(feature = "ros")]
    let cli = Cli { ros_args, ..cli };
    Ok(cli)
}

/// Does what the arguments ask for.
pub(crate) fn run(cli: &Cli) -> Result<Outcome, Failure> {
    let (bars, log) = log::start(cli);
    #[cfg(feature = "ros")]
    for sentence in cli.ros_args.iter().flat_map(|args| &args.ignored) {
        tracing::warn!("{sentence}");
    }
    #[cfg(feature = "ros")]
    if cli.ros_args.is_some() && !cli.verb.can_join_ros() {
        tracing::warn!("--ros-args is for `run` and `replay`, and is ignored");
    }
    match &cli.verb {
        Verb::Run(args) => run::run(args, cli, &bars, log),
        #[cfg(feature = "mcap")]
        Verb::Replay(args) => replay::run(args, cli, &bars, log),
        Verb::Generate(args) => generate::run(args, cli, &bars),
        Verb::Check(args) => check::run(args, cli),
        #[cfg(feature = "mcap")]
        Verb::Recover(args) => recover::run(args),
        #[cfg(feature = "mcap")]
        Verb::Plot(args) => plot::run(args),
        #[cfg(unix)]
        Verb::Bench(args) => bench::run(args, cli, &bars),
        Verb::Completions(args) => completions::run(args),
    }
}

const fn version() -> &'static str {
    match (cfg!(feature = "ros"), cfg!(feature = "mcap")) {
        (true, true) => concat!(env!("CARGO_PKG_VERSION"), " (features: ros, mcap)"),
        (true, false) => concat!(env!("CARGO_PKG_VERSION"), " (features: ros)"),
        (false, true) => concat!(env!("CARGO_PKG_VERSION"), " (features: mcap)"),
        (false, false) => concat!(env!("CARGO_PKG_VERSION"), " (features: none)"),
    }
}

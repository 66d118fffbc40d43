//! `graintwin run`

use std::path::PathBuf;

use indicatif::MultiProgress;

use graintwin::command::Command;
use graintwin::path;
use graintwin::sink::Sink;
use graintwin::twin::Twin;

use super::progress::Progress;
use super::summary::Summary;
use super::{Cli, Failure, Outcome, output, serve, specimen, stop};

/// Makes or loads the pack of a scene and serves commands until they end or Ctrl-C.
///
/// Commands come from --commands, else from the scene's own load_path. Without either the pack is
/// brought to equilibrium and measured. At the end a summary goes to stdout.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  \
    graintwin run launch_configs/quickstart.yaml --json\n\n\
    A command CSV has the header stamp,x_min,x_max,y_min,y_max,z_min,z_max: the time in s and the \
    inward displacement of each wall since the start of the run in m. A column left out leaves its \
    wall where it is; # starts a comment.")]
pub(super) struct Args {
    /// The scene, YAML.
    scene: PathBuf,

    /// Takes the commands from this CSV instead of the scene's load_path (s, m).
    #[arg(long, value_name = "FILE")]
    commands: Option<PathBuf>,

    /// Prints the summary as one JSON object (SI units).
    #[arg(long)]
    json: bool,
}

pub(super) fn run(args: &Args, cli: &Cli, bars: &MultiProgress) -> Result<Outcome, Failure> {
    let Some(loaded) = cli.scene(&args.scene)? else { return Ok(Outcome::Done) };
    let given = args.commands.as_deref().map(path::read_csv).transpose()?;
    let pack = specimen::build(&loaded, cli.threads(), bars)?;
    let commands = match given {
        Some(commands) => commands,
        None => path::commands(&loaded.scene.load_path, loaded.folder(), &pack.bounds)?,
    };

    let mut twin = Twin::new(&loaded.scene, &pack, cli.threads())?;
    let mut summary = Summary::new(&loaded, &pack);
    let stop = stop::on_signal()?;
    {
        let commands = Box::new(commands.into_iter()) as Box<dyn Iterator<Item = Command>>;
        let progress = Progress::new(commands.size_hint().1, bars);
        let mut sinks: Vec<Box<dyn Sink + '_>> = vec![Box::new(&mut summary), Box::new(progress)];
        serve::serve(&mut twin, loaded.scene.outputs, commands, &mut sinks, &stop)?;
    }
    output::print(&if args.json { summary.json()? } else { summary.table() })?;
    Ok(if summary.refused() == 0 { Outcome::Done } else { Outcome::Incomplete })
}

//! `graintwin run`

use std::cell::RefCell;
use std::path::PathBuf;
#[cfg(feature = "mcap")]
use std::sync::{Arc, atomic::AtomicBool};

use indicatif::MultiProgress;

use graintwin::command::request::Intake;
#[cfg(feature = "mcap")]
use graintwin::pack::Pack;
use graintwin::path::Path as LoadPath;
#[cfg(feature = "mcap")]
use graintwin::record::Closing;
#[cfg(feature = "mcap")]
use graintwin::scene::Loaded;
use graintwin::sink::Sink;
use graintwin::twin::Twin;

use super::given::{self, Commands, Recorded};
use super::log::ForNode;
use super::progress::Progress;
#[cfg(feature = "mcap")]
use super::recording::{self, Recording};
#[cfg(feature = "ros")]
use super::ros::{self, Link};
use super::source::{Given, Source};
use super::summary::Summary;
use super::{Cli, Failure, Outcome, output, serve, specimen, stop};

/// Makes or loads the pack of a scene and serves commands until they end or Ctrl-C.
///
/// Commands come from --commands, else from the scene's own load_path. Without either the pack is
/// brought to equilibrium and measured. With --ros they come from the topics of the node /graintwin;
/// when the scene has a node.virtual_rig, or --commands is given, a rig inside the program publishes
/// them there. --ros-args ... [--] takes what ros2 launch passes to a node. At the end a summary goes
/// to stdout.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  \
    graintwin run launch_configs/rig_log.yaml --ros --record bags/rig_log\n\n\
    A command CSV has the header stamp,x_min,x_max,y_min,y_max,z_min,z_max: the time in s and the \
    inward displacement of each wall since the start of the run in m. A column left out leaves its \
    wall where it is; x_min:stress (Pa) or x_min:force (N) puts the wall under a load instead; \
    # starts a comment.")]
pub(super) struct Args {
    /// The scene, YAML.
    scene: PathBuf,

    /// Takes the commands from this CSV (s, m) or bag instead of the scene's load_path.
    #[arg(long, value_name = "FILE")]
    commands: Option<PathBuf>,

    /// Topic of the bag that has the commands: its own, or joints that the scene maps
    /// (node.joint_states, node.joint_trajectory). Without it the only one there is.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "NAME", requires = "commands")]
    topic: Option<String>,

    /// Records everything into this folder, which must be new or empty.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,

    /// Joins ROS 2 as the node /graintwin.
    #[cfg(feature = "ros")]
    #[arg(long)]
    ros: bool,

    /// Prints the summary as one JSON object (SI units).
    #[arg(long)]
    json: bool,
}

pub(super) fn run(
    args: &Args,
    cli: &Cli,
    bars: &MultiProgress,
    log: ForNode,
) -> Result<Outcome, Failure> {
    let Some(loaded) = cli.scene(&args.scene)? else { return Ok(Outcome::Done) };
    #[cfg(feature = "ros")]
    let (loaded, setup) = {
        let mut loaded = loaded;
        let setup = ros::setup(args.ros, cli, &mut loaded.scene, log)?;
        (loaded, setup)
    };
    #[cfg(not(feature = "ros"))]
    let () = log;
    #[cfg(feature = "mcap")]
    let read = |file| given::read(file, args.topic.as_deref(), &loaded.scene.node);
    #[cfg(not(feature = "mcap"))]
    let read = given::read;
    let given = args.commands.as_deref().map(read).transpose()?;
    #[cfg(feature = "mcap")]
    args.record.as_deref().map(recording::reserve).transpose()?;
    let specimen = specimen::build(&loaded, cli.threads(), bars)?;
    let pack = &specimen.pack;
    #[cfg(feature = "ros")]
    let plays = given.is_some();
    let (path, recorded) = match given {
        Some(Commands::Known(commands)) => (LoadPath::from(commands), None),
        #[cfg(all(feature = "mcap", feature = "ros"))]
        Some(Commands::Recorded(recorded)) if setup.is_some() => {
            (LoadPath::from(given::all(recorded)?), None)
        }
        #[cfg(feature = "mcap")]
        Some(Commands::Recorded(recorded)) => (LoadPath::from(Vec::new()), Some(recorded)),
        None => {
            let path = LoadPath::new(&loaded.scene.load_path, loaded.folder(), &pack.bounds)?;
            (path, None)
        }
    };
    let whereabouts = path.whereabouts();
    let broken = Broken::default();
    let mut twin = Twin::new(&loaded.scene, pack, cli.threads())?;
    let mut summary = Summary::new(&loaded, &specimen);
    let stop = stop::on_signal()?;
    let length = recorded.as_ref().map_or(path.length(), |recorded| recorded.messages);
    tracing::info!("{length} commands for {} grains", pack.grains.len());
    #[cfg(feature = "mcap")]
    let mut recording = start_recording(args, &loaded, pack, twin.threads(), &stop)?;

    #[cfg(feature = "ros")]
    let (mut link, path) = match setup {
        Some(setup) => (Some(Link::start(&loaded.scene, setup, path, plays, &stop)?), None),
        None => (None, Some(path)),
    };
    #[cfg(feature = "ros")]
    if let Some(link) = &mut link {
        #[cfg(feature = "mcap")]
        let handle = recording.as_ref().map(Recording::handle);
        #[cfg(not(feature = "mcap"))]
        let handle = None;
        link.diagnose(&loaded.scene, handle);
    }
    #[cfg(not(feature = "ros"))]
    let path = Some(path);
    let served = {
        // Who makes the next command must have heard of the last one first.
        let mut sinks: Vec<Box<dyn Sink + '_>> = vec![Box::new(whereabouts)];
        #[cfg(feature = "ros")]
        let (mut source, length) = match &mut link {
            Some(link) => {
                sinks.push(link.sink());
                let length = link.length();
                (link.commands(), length)
            }
            None => from_file(path, recorded, &broken),
        };
        #[cfg(not(feature = "ros"))]
        let (mut source, length) = from_file(path, recorded, &broken);
        #[cfg(feature = "mcap")]
        sinks.extend(recording.as_mut().map(|recording| Box::new(recording) as Box<dyn Sink>));
        sinks.push(Box::new(&mut summary));
        sinks.push(Box::new(Progress::new(length, bars)));
        let how = (loaded.scene.outputs, loaded.scene.node.late);
        serve::serve(&mut twin, how, source.as_mut(), &mut sinks, &stop)
    };
    #[cfg(feature = "ros")]
    if let Some(link) = link {
        summary.linked(link.end());
    }
    #[cfg(feature = "mcap")]
    if let Some(mut recording) = recording {
        recording.close_with(Closing { increment: twin.increment(), digest: twin.digest() });
        summary.recorded(recording.finish());
    }
    served?;
    if let Some(error) = broken.into_inner() {
        return Err(error);
    }
    summary.histograms(twin.coordination());
    output::print(&if args.json { summary.json()? } else { summary.table() })?;
    Ok(if summary.complete() { Outcome::Done } else { Outcome::Incomplete })
}

/// Why the commands ended before their end.
type Broken = RefCell<Option<Failure>>;

/// The commands of a path or a bag, and how many there are.
fn from_file(
    path: Option<LoadPath>,
    recorded: Option<Recorded>,
    broken: &Broken,
) -> (Box<dyn Source + '_>, Option<usize>) {
    let keep = |failure: Failure| {
        broken.replace(Some(failure));
    };
    if let Some(Recorded { intakes, messages }) = recorded {
        let intakes = intakes.map_while(move |intake| intake.map_err(keep).ok());
        return (Box::new(Given(intakes)), Some(messages));
    }
    let length = path.as_ref().map(LoadPath::length);
    let commands = path.into_iter().flatten().map_while(move |command| {
        command.map(Intake::from).map_err(Failure::from).map_err(keep).ok()
    });
    (Box::new(Given(commands)), length)
}

#[cfg(feature = "mcap")]
fn start_recording(
    args: &Args,
    loaded: &Loaded,
    pack: &Pack,
    threads: usize,
    stop: &Arc<AtomicBool>,
) -> Result<Option<Recording>, Failure> {
    let folder = args.record.as_deref();
    folder.map(|folder| Recording::start(folder, loaded, pack, threads, stop)).transpose()
}

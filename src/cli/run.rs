//! `graintwin run`

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use indicatif::MultiProgress;

use super::job::{self, Job, Sender};
use super::log::ForNode;
use super::orders::Feed;
use super::resume::Earlier;
use super::{Cli, Failure, Outcome, foxglove, given, ros, stop};

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
    #[cfg_attr(feature = "mcap", arg(required_unless_present = "resume"))]
    #[cfg_attr(not(feature = "mcap"), arg(required = true))]
    scene: Option<PathBuf>,

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

    /// Goes on with the recording in this folder, which may have been broken off: it is made
    /// whole, run again up to its last answer, compared on the way, and continued there with the
    /// same bits as if nothing had happened. Without SCENE its own scene is taken.
    #[cfg(feature = "mcap")]
    #[arg(long, value_name = "BAG", conflicts_with = "record")]
    resume: Option<PathBuf>,

    /// Joins ROS 2 as the node /graintwin.
    #[cfg(feature = "ros")]
    #[arg(long)]
    ros: bool,

    #[command(flatten)]
    foxglove: foxglove::Asked,

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
    let earlier = args.resume().map(Earlier::open).transpose()?;
    let mut loaded = match (&args.scene, &earlier) {
        (Some(scene), _) => {
            let Some(loaded) = cli.scene(scene)? else { return Ok(Outcome::Done) };
            loaded
        }
        (None, Some(earlier)) => earlier.scene()?,
        // The parser asks for one of them.
        (None, None) => {
            return Err(Failure::Input(anyhow!("no scene; allowed: SCENE or --resume")));
        }
    };
    let setup = ros::setup(args.ros(), cli, &mut loaded.scene, log)?;
    let given = args.commands.as_deref();
    let feed = given.map(|file| given::read(file, args.topic(), &loaded.scene.node)).transpose()?;
    let sender = match feed.is_some() || loaded.scene.node.virtual_rig {
        true => Sender::Inside,
        false => Sender::Outside,
    };
    let feed = feed.unwrap_or(Feed::Scene);
    let (record, json) = (args.record(), args.json);
    let live = args.foxglove.start()?;
    let stop = stop::on_signal()?;
    job::carry_out(Job {
        cli,
        bars,
        stop,
        loaded,
        feed,
        setup,
        sender,
        live,
        record,
        earlier,
        json,
    })
}

impl Args {
    /// Whether a node is asked for.
    fn ros(&self) -> bool {
        #[cfg(feature = "ros")]
        return self.ros;
        #[cfg(not(feature = "ros"))]
        false
    }

    /// Where to record.
    fn record(&self) -> Option<&Path> {
        #[cfg(feature = "mcap")]
        return self.record.as_deref();
        #[cfg(not(feature = "mcap"))]
        None
    }

    /// The recording to go on with.
    fn resume(&self) -> Option<&Path> {
        #[cfg(feature = "mcap")]
        return self.resume.as_deref();
        #[cfg(not(feature = "mcap"))]
        None
    }

    /// The topic of a bag that is meant.
    fn topic(&self) -> Option<&str> {
        #[cfg(feature = "mcap")]
        return self.topic.as_deref();
        #[cfg(not(feature = "mcap"))]
        None
    }
}

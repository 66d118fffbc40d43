//! `graintwin replay`

mod verdict;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use indicatif::MultiProgress;

use graintwin::command::Stamp;
use graintwin::command::circumstance::Happened;
use graintwin::record::reader::{Bag, Source};
use graintwin::record::replay::{Compared, Difference, Replay, ReplayError, Step, Tape};
use graintwin::relax::lanes;
use graintwin::scene::{self, Loaded, Outputs};
use graintwin::sink::Sink;
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

use super::job::{self, Job, Sender};
use super::log::ForNode;
use super::orders::Feed;
use super::pace::{Pace, Rate};
use super::progress::Progress;
use super::recording::{self, Recording};
use super::ros::Link;
use super::specimen::Specimen;
use super::summary::Summary;
use super::{Cli, Failure, Outcome, foxglove, given, output, ros, serve, stop};
use verdict::Verdict;

/// Makes a recorded run again from the recording alone, or shows it live.
///
/// Scene, pack, commands and whatever else bore on the answers come out of the bag. With --verify
/// every answer is compared with the recorded one bit by bit, solve_seconds excepted: the exit code
/// is 0 only when all are equal, otherwise the first difference is named. The number of threads
/// and the processor make no difference; a recording of another version may differ.
///
/// With --ros the answers go out on the topics of the node /graintwin, at the pace of the
/// recording unless --rate says otherwise; commands on its topics are not taken meanwhile. A program
/// that was built with the feature `foxglove` shows them to viewers with --foxglove.
///
/// A bag of another program, as a rig's joint states from ros2 bag record, needs a --scene that says
/// what the specimen is and maps its joints to walls; its commands are then served.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Examples:\n  \
    graintwin replay bags/rig_log --verify\n  \
    graintwin replay bags/rig_log --ros --rate 10\n  \
    graintwin replay bags/rig_log --record bags/again\n  \
    graintwin replay rig_bag --scene SCENE.yaml --topic /rig/joint_states --ros")]
pub(super) struct Args {
    /// A bag: its folder, or .mcap.
    bag: PathBuf,

    /// Compares every answer with the recorded one, bit by bit.
    #[arg(long)]
    verify: bool,

    /// Takes this scene instead of the one in the bag; a bag of another program needs one.
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,

    /// Serves the commands or joints on this topic of the bag to the specimen of --scene.
    #[arg(long, value_name = "NAME", requires = "scene", conflicts_with = "verify")]
    topic: Option<String>,

    /// Pace as a multiple of the recorded one, or `full` [default: 1 with --ros or
    /// --foxglove, else full].
    #[arg(long, value_name = "R")]
    rate: Option<Rate>,

    /// Records the replay into this folder, which must be new or empty.
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,

    /// Joins ROS 2 as the node /graintwin.
    #[cfg(feature = "ros")]
    #[arg(long)]
    ros: bool,

    #[command(flatten)]
    foxglove: foxglove::Asked,

    /// Prints the summary, or with --verify the verdict, as one JSON object (SI units).
    #[arg(long)]
    json: bool,
}

pub(super) fn run(
    args: &Args,
    cli: &Cli,
    bars: &MultiProgress,
    log: ForNode,
) -> Result<Outcome, Failure> {
    let scene = args.scene.as_deref().map(scene::load).transpose()?;
    let bag = Bag::open(&args.bag).map_err(Failure::input)?;
    if let Some(scene) = scene.as_ref().filter(|_| args.topic.is_some()) {
        return others(args, scene.clone(), cli, bars, log);
    }
    match Replay::open(&bag, scene.as_ref().map(|loaded| loaded.scene.clone())) {
        Ok(replay) => own(args, &replay, cli, bars, log),
        Err(ReplayError::Foreign { .. }) if !args.verify && scene.is_some() => {
            // Just seen to be there.
            let Some(scene) = scene else { return Ok(Outcome::Done) };
            others(args, scene, cli, bars, log)
        }
        Err(error) => Err(Failure::input(error)),
    }
}

/// Serves the commands of a bag of another program.
fn others(
    args: &Args,
    mut loaded: Loaded,
    cli: &Cli,
    bars: &MultiProgress,
    log: ForNode,
) -> Result<Outcome, Failure> {
    if cli.print_config {
        output::print(&loaded.scene.to_yaml()?)?;
        return Ok(Outcome::Done);
    }
    let setup = ros::setup(args.ros(), cli, &mut loaded.scene, log)?;
    let live = args.foxglove.start()?;
    let stop = stop::on_signal()?;
    let pace = Pace::new(args.rate(setup.is_some() || live.is_some()), Arc::clone(&stop));
    let source = Source::new(&loaded.scene.node, args.topic.as_deref());
    let feed = Feed::Recorded(given::recorded(&args.bag, &source, Some(pace))?);
    let (record, json) = (args.record.as_deref(), args.json);
    let (sender, earlier) = (Sender::Nobody, None);
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

/// Makes a recording of this program again.
fn own(
    args: &Args,
    replay: &Replay<'_>,
    cli: &Cli,
    bars: &MultiProgress,
    log: ForNode,
) -> Result<Outcome, Failure> {
    if cli.print_config {
        output::print(&replay.scene.to_yaml()?)?;
        return Ok(Outcome::Done);
    }
    let program = Program::of(replay);
    program.tell();
    args.record.as_deref().map(recording::reserve).transpose()?;
    let loaded = Loaded { scene: replay.scene.clone(), file: args.bag.clone() };
    let specimen = Specimen { pack: replay.pack.clone(), prepared: Vec::new() };
    let mut twin = Twin::new(&replay.scene, &replay.pack, cli.threads())?;
    let mut summary = Summary::new(&loaded, &specimen);
    let stop = stop::on_signal()?;
    let mut of_node = loaded.scene.clone();
    let setup = ros::setup(args.ros(), cli, &mut of_node, log)?;
    let mut live = args.foxglove.start()?;
    let pace = Pace::new(args.rate(setup.is_some() || live.is_some()), Arc::clone(&stop));
    // Of this scene: the command line may scale what is shown.
    let shown = Painter::new(&of_node, &replay.pack.bounds, replay.pack.grains.len());
    let seen = live.as_mut().map(|live| live.sink(shown.clone())).transpose()?;
    let setup = setup.map(|setup| ros::drawn_by(setup, shown));
    let mut link = setup.map(|setup| Link::showing(&of_node, setup, &stop)).transpose()?;
    let recording = args
        .record
        .as_deref()
        .map(|folder| Recording::start(folder, &loaded, &specimen.pack, twin.threads(), &stop));
    let mut recording = recording.transpose()?;
    if let Some(link) = &mut link {
        link.diagnose(&loaded.scene, recording.as_ref().map(Recording::handle));
    }
    let compared = args.verify.then(Compared::default);
    let painter = Painter::new(&replay.scene, &replay.pack.bounds, replay.pack.grains.len());
    let outputs = loaded.scene.outputs;
    let mut run = Run { twin: &mut twin, pace, outputs, compared, painter };
    let mut tape = replay.tape();
    let ended = {
        let mut sinks: Vec<Box<dyn Sink + '_>> = Vec::new();
        sinks.extend(link.as_ref().map(Link::sink));
        sinks.extend(seen);
        sinks.extend(recording.as_mut().map(|recording| Box::new(recording) as Box<dyn Sink>));
        sinks.push(Box::new(&mut summary));
        sinks.push(Box::new(Progress::new(None, bars)));
        run.play(&mut tape, &mut sinks)
    };
    let compared = run.compared.take();
    if let Some(link) = link {
        link.end_into(&mut summary);
    }
    if let Some(live) = live {
        live.end();
    }
    if let Some(recording) = recording {
        recording.end(&twin, &mut summary);
    }
    let (whole, difference) = match ended? {
        Ended::Whole => (true, None),
        Ended::Early => (false, None),
        Ended::Different(difference) => (true, Some(difference)),
    };
    if let Some(compared) = compared {
        let verdict = Verdict::new(compared, difference, whole, &program, twin.threads());
        output::print(&if args.json { verdict.json()? } else { verdict.text() })?;
        return verdict.outcome();
    }
    summary.ends(&mut twin, outputs);
    output::print(&if args.json { summary.json()? } else { summary.table() })?;
    Ok(if whole && summary.is_undamaged() { Outcome::Done } else { Outcome::Incomplete })
}

impl Args {
    /// Whether a node is asked for.
    fn ros(&self) -> bool {
        #[cfg(feature = "ros")]
        return self.ros;
        #[cfg(not(feature = "ros"))]
        false
    }

    /// The pace that was asked for, or the one that suits people who look on live or do not.
    fn rate(&self, live: bool) -> Rate {
        self.rate.unwrap_or(if live { Rate::RECORDED } else { Rate::Full })
    }
}

/// What made the recording, and what of it this program can do.
struct Program {
    version: String,
    kernels: String,
    /// Why these kernels are not used.
    missing: Option<String>,
}

impl Program {
    /// Takes the kernels that the recording names into use.
    fn of(replay: &Replay<'_>) -> Self {
        let named = |what: &str| replay.program.get(what).cloned().unwrap_or_default();
        let (version, kernels) = (named("version"), named("kernels"));
        let missing = lanes::choose(&kernels).err();
        Self { version, kernels, missing }
    }

    fn tell(&self) {
        if let Some(missing) = &self.missing {
            tracing::warn!("{missing}");
        }
        let here = env!("CARGO_PKG_VERSION");
        if self.version != here {
            tracing::warn!(
                "recorded by version `{}`, this is {here}: the bits may differ",
                self.version
            );
        }
    }
}

/// The replay under way.
struct Run<'a> {
    twin: &'a mut Twin,
    pace: Pace,
    outputs: Outputs,
    compared: Option<Compared>,
    painter: Painter,
}

/// How a replay ended.
enum Ended {
    /// With the recording.
    Whole,
    /// Before: the recording is damaged or cut off, or somebody asked to stop.
    Early,
    /// At the first difference.
    Different(Difference),
}

impl Run<'_> {
    fn play(
        &mut self,
        tape: &mut Tape,
        sinks: &mut [Box<dyn Sink + '_>],
    ) -> Result<Ended, Failure> {
        for step in &mut *tape {
            let step = match step {
                Ok(step) => step,
                Err(ReplayError::Read(damage)) => {
                    tracing::error!("{damage}; `graintwin recover` makes of it a whole one");
                    return Ok(Ended::Early);
                }
                Err(error) => return Err(Failure::input(error)),
            };
            if !self.pace.wait(step.time) {
                return Ok(Ended::Early);
            }
            if let Err(difference) = self.step(&step, sinks) {
                return Ok(Ended::Different(difference));
            }
        }
        if tape.is_cut_off() {
            tracing::error!("the recording ends in the middle of an answer, which is left out");
            return Ok(Ended::Early);
        }
        if let (Some(compared), Some(closing)) = (&mut self.compared, tape.closing())
            && let Err(difference) = compared.closing(closing, &self.twin.digest())
        {
            return Ok(Ended::Different(difference));
        }
        Ok(Ended::Whole)
    }

    /// Makes one step again, compares it when that was asked for, and hands it over.
    fn step(&mut self, step: &Step, sinks: &mut [Box<dyn Sink + '_>]) -> Result<(), Difference> {
        let live = serve::demand(self.outputs, sinks);
        let demand = match self.compared {
            Some(_) => live.or(serve::ordered(self.outputs, step.demand())),
            None => live,
        };
        let start = Instant::now();
        let (mut served, said) = step.play(self.twin, demand);
        if let Some(last) = served.last_mut() {
            serve::took(&mut last.report, start);
        }
        if let Some(compared) = &mut self.compared {
            compared.request(step, said.as_ref())?;
            compared.answers(step, &mut served, &self.painter)?;
        }
        let stamp = Stamp::default();
        let stamp = stamp.later(i64::try_from(step.time).unwrap_or(0)).unwrap_or(stamp);
        for what in step.circumstances(said) {
            let happened = Happened { increment: self.twin.increment(), stamp, what };
            sinks.iter_mut().for_each(|sink| sink.happened(&happened));
        }
        for served in served {
            serve::give(served, sinks);
        }
        Ok(())
    }
}

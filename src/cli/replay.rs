//! `graintwin replay`

mod pace;
mod verdict;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use indicatif::MultiProgress;

use graintwin::command::circumstance::Happened;
use graintwin::record::reader::Bag;
use graintwin::record::replay::{Compared, Difference, Replay, Step};
use graintwin::record::{Closing, replay};
use graintwin::relax::lanes;
use graintwin::scene::{self, Loaded};
use graintwin::sink::Sink;
use graintwin::twin::Twin;

use super::log::ForNode;
use super::progress::Progress;
use super::recording::{self, Recording};
#[cfg(feature = "ros")]
use super::ros::{self, Link};
use super::specimen::Specimen;
use super::summary::Summary;
use super::{Cli, Failure, Outcome, output, serve, stop};
use pace::{Pace, Rate};
use verdict::Verdict;

/// Makes a recorded run again from the recording alone, or shows it live.
///
/// Scene, pack, commands and whatever else bore on the answers come out of the bag. With --verify
/// every answer is compared with the recorded one bit by bit, solve_seconds excepted: the exit code
/// is 0 only when all are equal, otherwise the first difference is named. The number of threads
/// and the processor make no difference; a recording of another version may differ.
///
/// With --ros the answers go out on the topics of the node /graintwin, at the pace of the
/// recording unless --rate says otherwise; commands on its topics are not taken meanwhile.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Examples:\n  \
    graintwin replay bags/rig_log --verify\n  \
    graintwin replay bags/rig_log --ros --rate 10\n  \
    graintwin replay bags/rig_log --record bags/again")]
pub(super) struct Args {
    /// A bag: its folder, or .mcap.
    bag: PathBuf,

    /// Compares every answer with the recorded one, bit by bit.
    #[arg(long)]
    verify: bool,

    /// Takes this scene instead of the one in the bag.
    #[arg(long, value_name = "SCENE")]
    scene: Option<PathBuf>,

    /// Pace as a multiple of the recorded one, or `full` [default: 1 with --ros, else full].
    #[arg(long, value_name = "R")]
    rate: Option<Rate>,

    /// Records the replay into this folder, which must be new or empty.
    #[arg(long, value_name = "DIR")]
    record: Option<PathBuf>,

    /// Joins ROS 2 as the node /graintwin.
    #[cfg(feature = "ros")]
    #[arg(long)]
    ros: bool,

    /// Prints the summary, or with --verify the verdict, as one JSON object (SI units).
    #[arg(long)]
    json: bool,
}

impl Args {
    /// Whether somebody looks on over the network.
    fn is_live(&self, cli: &Cli) -> bool {
        #[cfg(feature = "ros")]
        return self.ros || cli.ros_args.is_some();
        #[cfg(not(feature = "ros"))]
        {
            let _ = cli;
            false
        }
    }

    /// The pace that was asked for, or the one that suits.
    fn rate(&self, cli: &Cli) -> Rate {
        self.rate.unwrap_or(if self.is_live(cli) { Rate::RECORDED } else { Rate::Full })
    }
}

pub(super) fn run(
    args: &Args,
    cli: &Cli,
    bars: &MultiProgress,
    log: ForNode,
) -> Result<Outcome, Failure> {
    let bag = Bag::open(&args.bag).map_err(Failure::input)?;
    let own = args.scene.as_deref().map(scene::load).transpose()?;
    let replay = Replay::open(&bag, own.map(|loaded| loaded.scene)).map_err(Failure::input)?;
    if cli.print_config {
        output::print(&replay.scene.to_yaml()?)?;
        return Ok(Outcome::Done);
    }
    let program = Program::of(&replay);
    program.tell();
    args.record.as_deref().map(recording::reserve).transpose()?;
    let loaded = Loaded { scene: replay.scene.clone(), file: args.bag.clone() };
    let specimen = Specimen { pack: replay.pack.clone(), prepared: Vec::new() };
    let mut twin = Twin::new(&replay.scene, &replay.pack, cli.threads())?;
    let mut summary = Summary::new(&loaded, &specimen);
    let stop = stop::on_signal()?;
    #[cfg(feature = "ros")]
    let mut link = {
        let mut scene = loaded.scene.clone();
        scene.node.virtual_rig = false;
        let setup = ros::setup(args.ros, cli, &mut scene, log)?;
        let started = setup.map(|setup| Link::replaying(&scene, setup, &stop)).transpose()?;
        started
    };
    #[cfg(not(feature = "ros"))]
    let () = log;
    let mut recording = match &args.record {
        None => None,
        Some(folder) => {
            Some(Recording::start(folder, &loaded, &specimen.pack, twin.threads(), &stop)?)
        }
    };
    #[cfg(feature = "ros")]
    if let Some(link) = &mut link {
        link.diagnose(&loaded.scene, recording.as_ref().map(Recording::handle));
    }

    let mut run = Run {
        twin: &mut twin,
        pace: Pace::new(args.rate(cli), Arc::clone(&stop)),
        outputs: loaded.scene.outputs,
        compared: args.verify.then(Compared::default),
    };
    let mut tape = replay.tape();
    let mut error = None;
    let mut difference = None;
    {
        let mut sinks: Vec<Box<dyn Sink + '_>> = Vec::new();
        #[cfg(feature = "ros")]
        sinks.extend(link.as_ref().map(Link::sink));
        sinks.extend(recording.as_mut().map(|recording| Box::new(recording) as Box<dyn Sink>));
        sinks.push(Box::new(&mut summary));
        sinks.push(Box::new(Progress::new(None, bars)));
        for step in &mut tape {
            let step = match step {
                Ok(step) => step,
                Err(found) => {
                    error = Some(found);
                    break;
                }
            };
            if !run.pace.wait(step.time) {
                break;
            }
            difference = run.step(&step, &mut sinks).err();
            if difference.is_some() {
                break;
            }
        }
    }
    let closing = tape.closing().filter(|_| difference.is_none() && !run.pace.is_stopped());
    if let (Some(compared), Some(closing)) = (&mut run.compared, closing) {
        difference = compared.closing(closing, &run.twin.digest()).err();
    }
    let compared = run.compared.take();
    let stopped = run.pace.is_stopped();
    #[cfg(feature = "ros")]
    if let Some(link) = link {
        summary.linked(link.end());
    }
    if let Some(mut recording) = recording {
        recording.close_with(Closing { increment: twin.increment(), digest: twin.digest() });
        summary.recorded(recording.finish());
    }
    let whole = match &error {
        Some(replay::ReplayError::Read(damage)) => {
            tracing::error!("{damage}; `graintwin recover` makes it whole");
            false
        }
        Some(_) => false,
        None if tape.is_cut_off() => {
            tracing::error!("the recording ends in the middle of an answer, which is left out");
            false
        }
        None => !stopped,
    };
    if let Some(error) = error
        && !matches!(error, replay::ReplayError::Read(_))
    {
        return Err(Failure::input(error));
    }
    match compared {
        Some(compared) => {
            let verdict = Verdict::new(compared, difference, whole, &program, twin.threads());
            output::print(&if args.json { verdict.json()? } else { verdict.text() })?;
            verdict.outcome()
        }
        None => {
            summary.histograms(twin.coordination());
            output::print(&if args.json { summary.json()? } else { summary.table() })?;
            Ok(if whole && summary.is_undamaged() { Outcome::Done } else { Outcome::Incomplete })
        }
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
    outputs: scene::Outputs,
    compared: Option<Compared>,
}

impl Run<'_> {
    /// Makes one step again, compares it when that was asked for, and hands it over.
    fn step(&mut self, step: &Step, sinks: &mut [Box<dyn Sink + '_>]) -> Result<(), Difference> {
        let live = serve::demand(self.outputs, sinks);
        let demand = match self.compared {
            Some(_) => live.or(step.demand()),
            None => live,
        };
        let start = Instant::now();
        let (mut served, said) = step.play(self.twin, demand);
        if let Some(last) = served.last_mut() {
            serve::took(&mut last.report, start);
        }
        if let Some(compared) = &mut self.compared {
            compared.request(step, said.as_ref())?;
            compared.answers(step, &mut served)?;
        }
        self.circumstances(step, said, sinks);
        for served in served {
            serve::give(served, sinks);
        }
        Ok(())
    }

    fn circumstances(
        &self,
        step: &Step,
        said: Option<Result<String, String>>,
        sinks: &mut [Box<dyn Sink + '_>],
    ) {
        for what in step.circumstances(said) {
            let stamp = graintwin::command::Stamp::default();
            let stamp = stamp.later(i64::try_from(step.time).unwrap_or(0)).unwrap_or(stamp);
            let happened = Happened { increment: self.twin.increment(), stamp, what };
            sinks.iter_mut().for_each(|sink| sink.happened(&happened));
        }
    }
}

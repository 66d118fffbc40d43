//! `graintwin bench`

mod clock;
mod table;

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use anyhow::anyhow;
use indicatif::{MultiProgress, ProgressBar};
use serde::Serialize;

use graintwin::bench::{self, Job, NoReference, Reference, Row, Timing};
use graintwin::command::Command;
use graintwin::pack::Pack;
use graintwin::path::Path as LoadPath;
use graintwin::report::{Demand, Report};
use graintwin::scene::{Loaded, Scene};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::view;

use super::progress::waiting;
use super::{Cli, Failure, Outcome, output, specimen, stop};

/// Measures what accuracy costs on the load path of a scene: the work-precision table.
///
/// Walks the first increments with every solver method and tolerance, each from the same pack, and
/// compares with a reference that Newton's method converges as far as the pack allows. A row says
/// the CPU time of an increment, evaluations of the gradient and products with the Hessian (medians
/// over the increments), the memory of state and scratch, and the errors of wall forces, positions
/// and secant moduli. The solver works on one thread unless --threads says otherwise; the scene's
/// own solver.method and solver.tolerance do not count.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "Example:\n  \
    graintwin bench launch_configs/quickstart.yaml --out plots/quickstart")]
pub(super) struct Args {
    /// The scene, YAML, with a load_path.
    scene: PathBuf,

    /// Increments walked, the first of the load path.
    #[arg(long, value_name = "N", default_value_t = 10)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=10_000))]
    increments: u32,

    /// Walks of each row; of each increment the shortest time counts.
    #[arg(long, value_name = "N", default_value_t = 3)]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// CPU time after which a row ends with the increment at hand, s.
    #[arg(long, value_name = "SECONDS", default_value_t = 60)]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    limit: u64,

    /// Folder for bench.csv, bench.json and the diagram bench.svg; files of these names are
    /// replaced.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,

    /// Prints the table as one JSON object (SI units).
    #[arg(long)]
    json: bool,
}

/// What was measured; SI units.
#[derive(Debug, Serialize)]
struct Measured {
    version: &'static str,
    scene: String,
    file: PathBuf,
    grains: usize,
    threads: usize,
    increments: usize,
    limit_seconds: u64,
    reference: Reference,
    /// Largest memory of the process so far, whatever it was for.
    peak_resident_bytes: Option<u64>,
    rows: Vec<Row>,
    /// Whether every row was tried; not when a signal ended it.
    whole: bool,
}

pub(super) fn run(args: &Args, cli: &Cli, bars: &MultiProgress) -> Result<Outcome, Failure> {
    let Some(loaded) = cli.scene(&args.scene)? else { return Ok(Outcome::Done) };
    if let Some(folder) = &args.out {
        fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    }
    let threads = cli.threads.map_or(1, usize::from);
    let pack = specimen::build(&loaded, threads, bars)?.pack;
    let path = LoadPath::new(&loaded.scene, loaded.folder(), &pack.bounds)?;
    let commands = walked(path, args.increments as usize, &loaded.scene, &pack, threads)?;
    if commands.is_empty() {
        return Err(Failure::Input(anyhow!(
            "{}: load_path has no increment; needed: at least one to walk",
            args.scene.display()
        )));
    }
    let job = Job { scene: &loaded.scene, pack: &pack, commands: &commands, threads };
    let stop = stop::on_signal()?;
    let reference = waiting("walking the reference".into(), bars, |_| Reference::of(&job));
    let reference = reference.map_err(|error| match error {
        NoReference::Twin(error) => error.into(),
        NoReference::Failed { .. } => Failure::other(error),
    })?;
    let (rows, whole) =
        waiting("measuring".into(), bars, |bar| measure(&job, &reference, args, &stop, bar))?;
    let measured = Measured {
        version: env!("CARGO_PKG_VERSION"),
        scene: loaded.scene.name.clone(),
        file: loaded.file.clone(),
        grains: pack.grains.len(),
        threads,
        increments: commands.len(),
        limit_seconds: args.limit,
        reference,
        peak_resident_bytes: clock::peak_resident_bytes(),
        rows,
        whole,
    };
    let mut json = serde_json::to_string_pretty(&measured).map_err(Failure::other)?;
    json.push('\n');
    if let Some(folder) = &args.out {
        save(folder, &measured, &loaded, &json)?;
    }
    output::print(&if args.json { json } else { table::write(&measured) })?;
    Ok(if measured.whole { Outcome::Done } else { Outcome::Incomplete })
}

/// The first `most` commands of `path` as a twin of the scene meets them.
fn walked(
    path: LoadPath,
    most: usize,
    scene: &Scene,
    pack: &Pack,
    threads: usize,
) -> Result<Vec<Command>, Failure> {
    let mut here = path.whereabouts();
    let mut twin = Twin::new(scene, pack, threads)?;
    let depends = path.depends_on_the_twin();
    let mut hear = |command: Option<Command>, report: Report| {
        here.served(&Arc::new(Served { command, report }));
    };
    if depends {
        hear(None, twin.start(Demand::default()));
    }
    let mut commands = Vec::new();
    for command in path.take(most) {
        let command = command?;
        if depends {
            hear(Some(command.clone()), twin.apply(&command, Demand::default()));
        }
        commands.push(command);
    }
    Ok(commands)
}

/// The rows, and whether these are all.
fn measure(
    job: &Job<'_>,
    reference: &Reference,
    args: &Args,
    stop: &AtomicBool,
    bar: &ProgressBar,
) -> Result<(Vec<Row>, bool), Failure> {
    clock::check()?;
    let limit = Duration::from_secs(args.limit);
    let timing = Timing { rounds: args.rounds, limit, clock: &clock::process };
    let mut whole = true;
    let rows = bench::measure(job, reference, &timing, &mut |row| {
        let done = format!("{} at {:.0e}", row.method.name(), row.tolerance);
        tracing::info!("{done}: {}", table::note(row));
        bar.set_message(format!("measured {done}"));
        whole = !stop.load(Ordering::SeqCst);
        if whole { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    })?;
    Ok((rows, whole))
}

fn save(folder: &Path, measured: &Measured, loaded: &Loaded, json: &str) -> Result<(), Failure> {
    let Measured { grains, increments, threads, reference, .. } = measured;
    let subtitle = format!(
        "{grains} grains, {increments} increments, {threads} thread(s). Medians over the \
         increments; errors against {} at {:.0e}.",
        reference.method.name(),
        reference.tolerance
    );
    let sheet = view::work_precision(&measured.rows, &loaded.scene.name, &subtitle);
    let (csv, svg) = (bench::to_csv(&measured.rows), sheet.to_svg());
    for (name, text) in [("bench.csv", csv.as_str()), ("bench.json", json), ("bench.svg", &svg)] {
        let file = folder.join(name);
        fs::write(&file, text).map_err(|error| unwritable(&file, &error))?;
        tracing::info!("wrote {}", file.display());
    }
    Ok(())
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Other(anyhow!("cannot write {}: {error}", path.display()))
}

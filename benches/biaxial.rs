//! The biaxial test of B 3.2: a thousand discs, a thousand increments, on one thread. How long the
//! whole test takes at several tolerances, and what accuracy costs in its first increments, with
//! Newton's method, with van Baars' own (18-19) and with the motion that he compares it with (13-14).
//! `cargo bench --bench biaxial --no-default-features`
//!
//! Times are of one thread; on a machine that does other things too, compare ratios and work counts.
//! Beyond the first instability neighbouring solutions part, so that the stress at the end scatters with
//! the tolerance as it does with the sample: errors are those of the first increments.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

use graintwin::bench::{self, Job, Reference, Row, Timing};
use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{self, Pack};
use graintwin::report::Demand;
use graintwin::scene::{self, Scene};
use graintwin::twin::Twin;
use graintwin::wall::WallTarget;

/// Grains and increments, and the axial strain at the end.
const GRAINS: usize = 1000;
const INCREMENTS: u32 = 1000;
const AXIAL_STRAIN: f64 = 0.04;
/// σ3 \[Pa\].
const LATERAL_STRESS: f64 = 1e5;
/// Increments of the work-precision table.
const FIRST: usize = 5;
/// Seconds after which a row of the table ends with the increment at hand.
const LIMIT: u64 = 60;

fn main() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("launch_configs/sand_biaxial.yaml");
    let mut loaded = scene::load(&file).expect("it is shipped");
    let made = loaded.scene.pack.generate.as_mut().expect("its pack is made");
    made.grains = GRAINS;
    let start = Instant::now();
    let pack = pack::build(&loaded).expect("the shipped scene makes its pack");
    println!("{GRAINS} discs of grading A made in {:.2} s", start.elapsed().as_secs_f64());
    let commands: Vec<Command> = (1..=INCREMENTS).map(|k| command(&pack, k)).collect();
    first_increments(&loaded.scene, &pack, &commands[..FIRST]);
    println!("\nthe whole test: {INCREMENTS} increments to an axial strain of {AXIAL_STRAIN}");
    println!("tolerance  applied   time s  Newton steps  balances  factorisations  peak σ1/σ3");
    for tolerance in [1e-4, 1e-6, 1e-8] {
        whole(&loaded.scene, &pack, &commands, tolerance);
    }
}

/// Both platens closer by the k-th part of the way, the sides under the stress of the pack.
fn command(pack: &Pack, k: u32) -> Command {
    let way = 0.5 * AXIAL_STRAIN * pack.bounds.sides()[1] * f64::from(k) / f64::from(INCREMENTS);
    let [side, platen] = [WallTarget::Stress(LATERAL_STRESS), WallTarget::Displacement(way)];
    Command {
        stamp: Stamp::default(),
        session: "biaxial".into(),
        sequence: u64::from(k),
        mode: Mode::Absolute,
        ask: Ask::Targets([side, side, platen, platen, WallTarget::Keep, WallTarget::Keep]),
        age: None,
    }
}

fn first_increments(scene: &Scene, pack: &Pack, commands: &[Command]) {
    let job = Job { scene, pack, commands, threads: 1 };
    let reference = Reference::of(&job).expect("the first increments are stable");
    println!("\nfirst {FIRST} increments, against {:.0e}, medians", reference.tolerance);
    println!(
        "method        tolerance  CPU ms  steps or sweeps  error of wall forces  of positions"
    );
    let start = Instant::now();
    let clock = || start.elapsed();
    let timing = Timing { rounds: 3, limit: Duration::from_secs(LIMIT), clock: &clock };
    let mut print = |row: &Row| {
        println!(
            "{:<12}  {:9.0e}  {:6.1}  {:15.0}  {:20.1e}  {:12.1e}",
            row.method.name(),
            row.tolerance,
            1e3 * row.cpu_seconds_median,
            row.iterations,
            row.force_error.worst,
            row.position_error.worst,
        );
        ControlFlow::Continue(())
    };
    bench::measure(&job, &reference, &timing, &mut print).expect("one thread");
}

fn whole(scene: &Scene, pack: &Pack, commands: &[Command], tolerance: f64) {
    let mut scene = scene.clone();
    scene.solver.tolerance = tolerance;
    let mut twin = Twin::new(&scene, pack, 1).expect("one thread");
    let (mut applied, mut steps, mut peak) = (0, 0, 0.0_f64);
    let start = Instant::now();
    let demand = Demand { state: true, ..Demand::NONE };
    twin.start(demand);
    for command in commands {
        let report = twin.apply(command, demand);
        applied += u32::from(report.disposition == Disposition::Applied);
        if let Some(state) = report.measures.and_then(|measures| measures.state) {
            steps += state.iterations;
            peak = peak.max(state.stress_walls[4] / state.stress_walls[0]);
        }
    }
    let seconds = start.elapsed().as_secs_f64();
    let effort = twin.effort();
    println!(
        "{tolerance:9.0e}  {applied:7}  {seconds:7.2}  {steps:12}  {:8}  {:14}  {peak:11.3}",
        effort.gradients, effort.products
    );
}

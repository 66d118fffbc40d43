//! How the work grows with the number of grains: making a pack at 10 MPa, and three uniaxial
//! increments of 1e-5 and three of 1e-4, to a residual of 1e-8.
//! `cargo bench --bench growth --no-default-features -- 2740 20000 100000` (those are the sizes it
//! takes of its own accord), on one thread and on two, as a markdown table. With the word
//! `friction` behind them the contacts have μ = 0.3 once the pack is made.
//!
//! Seconds are CPU time of the process, those of the walls' clock beside them; on a machine that
//! does other things too, compare the counts. The exponent is that of CPU time over grains from
//! the smallest size to the largest.
#![allow(clippy::print_stdout, clippy::expect_used)] // A bench prints, and ends when its input is not there.

use std::time::{Duration, Instant};

use graintwin::model::{Friction, Model};
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::relax::advance::advance;
use graintwin::relax::{Workspace, relax};
use graintwin::scene::{Coulomb, Generate, Law, Material, Radius, Solver, Update, Walls};
use graintwin::state::State;
use graintwin::wall::standing;

/// Sizes when none is asked for.
const SIZES: [usize; 3] = [2_740, 20_000, 100_000];
const THREADS: [usize; 2] = [1, 2];
/// Increments of strain, each taken so many times.
const STRAINS: [f64; 2] = [1e-5, 1e-4];
const TIMES: usize = 3;
const STRESS: f64 = 10e6;
/// Coefficient where friction is asked for.
const FRICTION: f64 = 0.3;
const GLASS: Material = Material { young: 70e9, poisson: 0.2, density: 2420.0, spread: 0.0 };

/// CPU time and that of the walls' clock \[s\].
#[derive(Clone, Copy, Debug)]
struct Spent {
    cpu: f64,
    wall: f64,
}

/// What one increment took.
#[derive(Clone, Copy, Debug)]
struct Increment {
    spent: Spent,
    steps: u32,
    products: u64,
    gradients: u64,
    events: usize,
    converged: bool,
}

/// One size on so many threads.
#[derive(Clone, Debug)]
struct Run {
    grains: usize,
    threads: usize,
    made: Spent,
    /// The increments of each strain.
    increments: [Vec<Increment>; 2],
    bytes: usize,
    /// Of the positions at the end: one number a size, whatever the threads.
    bits: u64,
}

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|arg| arg.parse().ok()).collect();
    let friction = if std::env::args().any(|arg| arg == "friction") { FRICTION } else { 0.0 };
    let sizes = if asked.is_empty() { SIZES.to_vec() } else { asked };
    let mut runs = Vec::new();
    println!("{}", header());
    for threads in THREADS {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        for &grains in &sizes {
            let run = pool.install(|| take(grains, threads, friction));
            for line in lines(&run) {
                println!("{line}");
            }
            runs.push(run);
        }
    }
    println!();
    for threads in THREADS {
        let of: Vec<&Run> = runs.iter().filter(|run| run.threads == threads).collect();
        if let (Some(small), Some(large)) = (of.first(), of.last())
            && small.grains != large.grains
        {
            println!("{}", exponents(small, large));
        }
    }
    for run in runs.iter().filter(|run| run.threads != THREADS[0]) {
        let same = runs.iter().all(|one| one.grains != run.grains || one.bits == run.bits);
        println!(
            "{} grains on {} threads: {}.",
            run.grains,
            run.threads,
            if same { "the same bits" } else { "OTHER BITS" }
        );
    }
}

fn take(grains: usize, threads: usize, friction: f64) -> Run {
    let spec = Generate {
        grains,
        radius: Radius::Uniform([0.07e-3, 0.13e-3]),
        material: "glass".into(),
        seed: 1,
        confining_stress: STRESS,
        aspect: [1.0; 3],
        expand_floaters: 0,
        compaction_friction: 0.0,
    };
    let (pack, made) = timed(|| {
        generate(&spec, &GLASS, &Walls::default(), friction, Solver::default()).expect("a pack")
    });
    let (increments, bytes, bits) = strain(&pack, friction);
    Run { grains, threads, made, increments, bytes, bits }
}

/// The increments, bytes of state and scratch after them, and the bits of the positions.
fn strain(pack: &Pack, friction: f64) -> ([Vec<Increment>; 2], usize, u64) {
    let walls = Walls::default();
    let mut model = Model::with(pack, &walls, [0.0; 3], Solver::default(), None);
    let coulomb = Coulomb { coefficient: friction, law: Law::ReturnMap, update: Update::Frozen };
    model.friction = Friction::new(&model.grains, &walls, &coulomb, true);
    let mut state = State::new(&model);
    let mut work = Workspace::new(&model);
    let mut here = relax(&model, &mut state, &mut work);
    let mut target = [0.0; 6];
    let increments = STRAINS.map(|strain| {
        let increment = |_| {
            target[5] += strain * model.start.sides()[2];
            let before = work.effort();
            let (done, spent) =
                timed(|| advance(&model, &mut state, &mut work, &standing(&target), here));
            here = done.outcome;
            let after = work.effort();
            Increment {
                spent,
                steps: done.iterations,
                products: after.products - before.products,
                gradients: after.gradients - before.gradients,
                events: done.jumps.len(),
                converged: done.outcome.status.is_equilibrium(),
            }
        };
        (0..TIMES).map(increment).collect()
    });
    let bits = state.position.iter().flat_map(|at| at.iter().copied().collect::<Vec<f64>>());
    let bits = bits.fold(0u64, |sum, x| sum.rotate_left(7) ^ x.to_bits());
    (increments, state.heap_bytes() + work.heap_bytes(), bits)
}

fn header() -> String {
    "| grains | threads | making, CPU s | making, s | strain | CPU s an increment: median (each) \
     | s, median | Newton steps | products | gradients | events | bytes a grain |\n\
     |---|---|---|---|---|---|---|---|---|---|---|---|"
        .into()
}

fn lines(run: &Run) -> Vec<String> {
    let each = |of: &[Increment], what: &dyn Fn(&Increment) -> String| -> String {
        of.iter().map(what).collect::<Vec<_>>().join(" ")
    };
    (STRAINS.iter().zip(&run.increments))
        .map(|(strain, of)| {
            let all = if of.iter().all(|i| i.converged) { "" } else { " NOT CONVERGED" };
            format!(
                "| {} | {} | {:.2} | {:.2} | {strain:.0e}{all} | {:.3} ({}) | {:.3} | {} | {} | {} \
                 | {} | {} |",
                run.grains,
                run.threads,
                run.made.cpu,
                run.made.wall,
                median(of, |i| i.spent.cpu),
                each(of, &|i| format!("{:.3}", i.spent.cpu)),
                median(of, |i| i.spent.wall),
                each(of, &|i| i.steps.to_string()),
                each(of, &|i| i.products.to_string()),
                each(of, &|i| i.gradients.to_string()),
                each(of, &|i| i.events.to_string()),
                run.bytes / run.grains,
            )
        })
        .collect()
}

/// CPU time and products go with the number of grains to these powers.
fn exponents(small: &Run, large: &Run) -> String {
    let ratio = (large.grains as f64 / small.grains as f64).ln();
    let power = |of: &dyn Fn(&Run) -> f64| (of(large) / of(small)).ln() / ratio;
    let increments: Vec<String> = (STRAINS.iter().enumerate())
        .map(|(k, strain)| {
            let cpu = power(&|run| median(&run.increments[k], |i| i.spent.cpu));
            let products = power(&|run| median(&run.increments[k], |i| i.products as f64));
            format!("{cpu:.2} for an increment of {strain:.0e} (products {products:.2})")
        })
        .collect();
    format!(
        "Threads: {}. From {} to {} grains CPU time goes with their number to the power of {:.2} for \
         making the pack, {}.",
        small.threads,
        small.grains,
        large.grains,
        power(&|run| run.made.cpu),
        increments.join(", "),
    )
}

fn median(of: &[Increment], what: impl Fn(&Increment) -> f64) -> f64 {
    let mut sorted: Vec<f64> = of.iter().map(what).collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}

fn timed<T>(what: impl FnOnce() -> T) -> (T, Spent) {
    let (cpu, start) = (cpu_time(), Instant::now());
    let done = what();
    let wall = start.elapsed().as_secs_f64();
    let cpu = cpu.zip(cpu_time()).map_or(wall, |(before, after)| (after - before).as_secs_f64());
    (done, Spent { cpu, wall })
}

/// CPU time of the process, where the system tells.
fn cpu_time() -> Option<Duration> {
    #[cfg(unix)]
    return nix::time::clock_gettime(nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID)
        .ok()
        .map(Duration::from);
    #[cfg(not(unix))]
    None
}

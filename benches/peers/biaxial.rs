//! A biaxial test of discs beside LAMMPS: `-- biaxial`.
//!
//! Dense sand of `launch_configs/sand_biaxial.yaml`, 400 grains, both from the same pack. LAMMPS strains it
//! at a steady rate, this program in increments; the same with 20 sweeps over the grains in each
//! increment and no equilibrium, as B has it (2.3, table 1).

use std::error::Error;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::Stdio;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{self, Pack};
use graintwin::report::Demand;
use graintwin::scene::{self, Coulomb, Friction, Loaded, Method, Update};
use graintwin::twin::Twin;
use graintwin::wall::WallTarget;
use serde::Deserialize;

use crate::lammps;

const SEEDS: [u64; 3] = [1, 2, 3];
const GRAINS: usize = 400;
const STRAIN: f64 = 2.5e-2;
const INCREMENT: f64 = 4e-5;
const STRESS: f64 = 1e5;
/// Steps of LAMMPS for one per cent of strain.
const STEPS: [u32; 2] = [5_000, 20_000];
/// Sweeps of an increment (B table 1).
const SWEEPS: u32 = 20;
/// Axial strains at which stress ratios are printed.
const PLACES: [f64; 6] = [1e-3, 2e-3, 3e-3, 5e-3, 1e-2, 2e-2];
/// Stretch of strain over which ratios are averaged: peaks of single increments say little.
const STRETCH: f64 = 1e-3;

/// ε1 and σ1/σ3, in order.
type Curve = Vec<[f64; 2]>;

#[derive(Deserialize)]
struct Line {
    axial: f64,
    major: f64,
    minor: f64,
}

/// Runs the tests and prints a row for each.
pub(crate) fn run(root: &Path) -> Result<(), Box<dyn Error>> {
    println!("σ1/σ3 at an axial strain, and the peak of its mean over {STRETCH:e}:\n");
    let places: Vec<String> =
        PLACES.iter().map(|place| format!("{:.1} %", 100.0 * place)).collect();
    println!("| seed | code | {} | peak | φ' [°] |", places.join(" | "));
    println!("| --- | --- |{} --- | --- |", " --- |".repeat(PLACES.len()));
    for seed in SEEDS {
        let job = scene(root, seed)?;
        let pack = pack::build(&job)?;
        for steps in STEPS {
            let (number, curve) = peer(root, &job, &pack, steps)?;
            row(seed, &format!("LAMMPS, I = {number:.1e}"), &curve);
        }
        for update in [Update::Frozen, Update::Current] {
            row(
                seed,
                &format!("newton, {update:?}").to_lowercase(),
                &own(&job, &pack, update, None),
            );
        }
        let name = format!("gauss_seidel, {SWEEPS} sweeps");
        row(seed, &name, &own(&job, &pack, Update::Current, Some(SWEEPS)));
    }
    Ok(())
}

fn scene(root: &Path, seed: u64) -> Result<Loaded, Box<dyn Error>> {
    let mut job = scene::load(&root.join("launch_configs/sand_biaxial.yaml"))?;
    let spec = job.scene.pack.generate.as_mut().ok_or("the scene makes its pack")?;
    (spec.grains, spec.seed) = (GRAINS, seed);
    job.scene.solver.tolerance = 1e-6;
    Ok(job)
}

fn peer(
    root: &Path,
    job: &Loaded,
    pack: &Pack,
    steps: u32,
) -> Result<(f64, Curve), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("graintwin-biaxial-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let file = folder.join("pack.csv");
    pack::save(pack, &file)?;
    let mut command = lammps::command();
    command.arg(root.join("benches/peers/lammps_biaxial.py"));
    command.arg("--pack").arg(&file).arg("--box").arg(pack::box_file(&file));
    command.args(["--steps", &steps.to_string()]);
    for (name, value) in [
        ("--strain", STRAIN),
        ("--stress", STRESS),
        ("--friction", job.scene.contact.friction.coefficient()),
        ("--wall-young", job.scene.walls.young),
        ("--wall-poisson", job.scene.walls.poisson),
    ] {
        command.arg(name).arg(format!("{value:e}"));
    }
    let mut process = command.stdout(Stdio::piped()).spawn()?;
    let lines = BufReader::new(process.stdout.take().ok_or("no stdout")?).lines();
    let mut number = f64::NAN;
    let mut curve = Curve::new();
    for line in lines {
        let line = line?;
        match serde_json::from_str::<Line>(&line) {
            Ok(Line { axial, major, minor }) => curve.push([axial, major / minor]),
            Err(_) => {
                let first: serde_json::Value = serde_json::from_str(&line)?;
                number = first["inertial_number"].as_f64().ok_or("no inertial number")?;
            }
        }
    }
    let ended = process.wait()?;
    std::fs::remove_dir_all(&folder)?;
    if ended.success() { Ok((number, curve)) } else { Err("LAMMPS ended early".into()) }
}

/// The same by this program; with `sweeps` as B does it.
fn own(job: &Loaded, pack: &Pack, update: Update, sweeps: Option<u32>) -> Curve {
    let mut scene = job.scene.clone();
    let coefficient = scene.contact.friction.coefficient();
    scene.contact.friction =
        Friction::Coulomb(Coulomb { coefficient, update, ..Coulomb::default() });
    scene.solver.sweeps = sweeps;
    if sweeps.is_some() {
        scene.solver.method = Method::GaussSeidel;
    }
    let mut twin = Twin::new(&scene, pack, 1).expect("the pack has grains");
    twin.start(Demand::NONE);
    let height = pack.bounds.sides()[1];
    let mut curve = Curve::new();
    for k in 1..=(STRAIN / INCREMENT).round() as u32 {
        let axial = f64::from(k) * INCREMENT;
        let platen = WallTarget::Displacement(0.5 * axial * height);
        let [side, keep] = [WallTarget::Stress(STRESS), WallTarget::Keep];
        let command = Command {
            stamp: Stamp::default(),
            session: "peers".into(),
            sequence: u64::from(k),
            mode: Mode::Absolute,
            ask: Ask::Targets([side, side, platen, platen, keep, keep]),
            age: None,
        };
        let report = twin.apply(&command, Demand { state: true, ..Demand::NONE });
        if report.disposition != Disposition::Applied {
            break;
        }
        let state = report.measures.and_then(|measures| measures.state).expect("it was asked for");
        curve.push([axial, state.stress_walls[4] / state.stress_walls[0]]);
    }
    curve
}

fn row(seed: u64, name: &str, curve: &Curve) {
    let mean = |from: f64, to: f64| {
        let ratios: Vec<f64> = curve
            .iter()
            .filter(|[at, _]| from < *at && *at <= to)
            .map(|[_, ratio]| *ratio)
            .collect();
        ratios.iter().sum::<f64>() / ratios.len() as f64
    };
    let end = curve.last().map_or(0.0, |[at, _]| *at);
    let around = |place: f64| match place + 0.1 * STRETCH <= end {
        true => format!("{:.3}", mean(place - 0.11 * STRETCH, place + 0.11 * STRETCH)),
        false => "-".into(),
    };
    let places: Vec<String> = PLACES.iter().map(|place| around(*place)).collect();
    let peak = (curve.iter().map(|[at, _]| *at).filter(|at| *at >= STRETCH))
        .map(|at| mean(at - STRETCH, at))
        .fold(0.0, f64::max);
    let angle = ((peak - 1.0) / (peak + 1.0)).asin().to_degrees();
    println!("| {seed} | {name} | {} | {peak:.3} | {angle:.1} |", places.join(" | "));
}

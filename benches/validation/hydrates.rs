//! T fig. 5.4: moduli of a sediment whose hydrate dissociates.

mod figure;
mod tables;

use std::path::Path;

use graintwin::command::{Ask, Command, Disposition, Dissociation, Mode, Stamp};
use graintwin::measure::moduli;
use graintwin::pack::hydrate::{Filling, fill_at};
use graintwin::pack::{Pack, generate};
use graintwin::report::{Demand, Hydrate, PackState, Report, Tangent};
use graintwin::scene::{self, BIOT, ModuliKind, Scene};
use graintwin::twin::Twin;
use graintwin::wall;

use crate::specimen::TOLERANCE;

pub(crate) use figure::sheet;
pub(crate) use tables::print;

/// Isotropic effective stress at the start \[Pa\].
const START: f64 = 21e6;

/// Which grains are hydrate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Choice {
    /// The smallest, up to the saturation that the thesis gives.
    Saturation(f64),
    /// Those below the radius that the thesis gives \[m\].
    Radius(f64),
}

/// What T 5.3 says of both.
pub(crate) const CHOICES: [Choice; 2] = [Choice::Saturation(0.22), Choice::Radius(0.075e-3)];

/// Excess pore pressures \[Pa\] at a saturation loss of 0.01, and saturation losses at 1 MPa.
const PRESSURES: (u32, f64, f64) = (10, 1e6, 0.01);
const LOSSES: (u32, f64, f64) = (15, 0.015, 1e6);

/// Strain of the uniaxial test along z, and its increments (T 3.6.4.2: 5e-5 to 5e-4).
const TEST: (f64, u32) = (2e-4, 2);

/// One state on the way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) loss: f64,
    pub(crate) pressure: f64,
    pub(crate) hydrate: Hydrate,
    pub(crate) state: PackState,
    /// K and G of the state \[Pa\].
    pub(crate) tangent: [f64; 2],
    /// K and G of a uniaxial test from there \[Pa\] (T 2.6.3).
    pub(crate) secant: [f64; 2],
}

/// The courses of a seed with one choice.
#[derive(Clone, Debug)]
pub(crate) struct Dissociations {
    pub(crate) choice: Choice,
    pub(crate) seed: u64,
    /// Grains that are hydrate, and their largest radius \[m\].
    pub(crate) grains: (usize, f64),
    /// The state before anything happened, then the pore pressure rises at a fixed loss.
    pub(crate) by_pressure: Vec<Point>,
    /// The state before anything happened, then saturation is lost at a fixed pressure.
    pub(crate) by_loss: Vec<Point>,
}

impl Dissociations {
    pub(crate) fn run(seed: u64, choice: Choice) -> Self {
        let pack = sediment(seed, choice);
        let hydrate: Vec<f64> =
            pack.grains.iter().filter(|grain| grain.hydrate).map(|grain| grain.radius).collect();
        let (count, pressure, loss) = PRESSURES;
        let rising = (0..=count).map(|k| (loss, pressure * f64::from(k) / f64::from(count)));
        let by_pressure = course(seed, &pack, rising);
        let (count, loss, pressure) = LOSSES;
        let shrinking = (0..=count).map(|k| (loss * f64::from(k) / f64::from(count), pressure));
        let by_loss = course(seed, &pack, shrinking);
        let grains = (hydrate.len(), hydrate.iter().copied().fold(0.0, f64::max));
        Self { choice, seed, grains, by_pressure, by_loss }
    }
}

fn scene(seed: u64) -> Scene {
    let text = format!(
        "pack: {{generate: {{grains: 2740, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
         material: quartz, seed: {seed}, confining_stress: {START:e}}}}}"
    );
    let mut scene = scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right");
    scene.solver.tolerance = TOLERANCE;
    scene.outputs.moduli = ModuliKind::Tangent;
    scene
}

/// Quartz and hydrate at [`START`].
fn sediment(seed: u64, choice: Choice) -> Pack {
    let scene = scene(seed);
    let spec = scene.pack.generate.as_ref().expect("the scene asks for it");
    let quartz = &scene.materials[&spec.material];
    let material = &scene.materials["hydrate"];
    let solver = graintwin::scene::Solver::default();
    let sand = generate::generate(spec, quartz, &scene.walls, 0.0, solver).expect("it is found");
    match choice {
        Choice::Saturation(saturation) => {
            let filling = Filling { saturation, material, seed };
            fill_at(&sand, &filling, START, &scene.walls, solver).expect("it is found")
        }
        Choice::Radius(radius) => {
            let mut pack = sand;
            for grain in pack.grains.iter_mut().filter(|grain| grain.radius < radius) {
                (grain.young, grain.poisson) = (material.young, material.poisson);
                (grain.density, grain.hydrate) = (material.density, true);
            }
            generate::compact(&pack, START, &scene.walls, solver).expect("it is found")
        }
    }
}

/// The initial state and those of `ends`, losses and pressures since the start.
fn course(seed: u64, pack: &Pack, ends: impl Iterator<Item = (f64, f64)>) -> Vec<Point> {
    let scene = scene(seed);
    let mut twin = Twin::new(&scene, pack, 1).expect("the pack has grains");
    let report = twin.start(Demand::ALL);
    let mut points = vec![point(&scene, &twin, &report, (0.0, 0.0))];
    for (sequence, (saturation_loss, pore_pressure)) in (1..).zip(ends) {
        let asked = Dissociation { saturation_loss, pore_pressure, biot: BIOT };
        let report = twin.apply(&command(sequence, Ask::Dissociation(asked)), Demand::ALL);
        if report.disposition != Disposition::Applied {
            println!("    seed {seed}, {saturation_loss}, {pore_pressure:e} Pa: {}", report.text);
            break;
        }
        points.push(point(&scene, &twin, &report, (saturation_loss, pore_pressure)));
    }
    points
}

fn command(sequence: u64, ask: Ask) -> Command {
    let (stamp, session) = (Stamp::default(), "hydrates".into());
    Command { stamp, session, sequence, mode: Mode::Absolute, ask, age: None }
}

fn point(scene: &Scene, twin: &Twin, report: &Report, (loss, pressure): (f64, f64)) -> Point {
    let measures = report.measures.as_ref().expect("it moved");
    let Tangent { stands, .. } = measures.tangent.expect("the scene asks for it");
    Point {
        loss,
        pressure,
        hydrate: measures.hydrate.expect("there is hydrate"),
        state: measures.state.expect("it was demanded"),
        tangent: [stands.bulk, stands.shear],
        secant: uniaxial(scene, &twin.pack()),
    }
}

/// K and G of a uniaxial strain of a copy (T 2.15), over the whole test.
fn uniaxial(scene: &Scene, pack: &Pack) -> [f64; 2] {
    let mut twin = Twin::new(scene, pack, 1).expect("the pack has grains");
    let state = Demand { state: true, ..Demand::NONE };
    let take = |report: Report| report.measures.and_then(|measures| measures.state);
    let Some(start) = take(twin.start(state)) else { return [f64::NAN; 2] };
    let (strain, increments) = TEST;
    let mut end = start;
    for k in 1..=increments {
        let mut displacement = [0.0; wall::COUNT];
        let share = f64::from(k) / f64::from(increments);
        displacement[4..].fill(0.5 * strain * share * pack.bounds.sides()[2]);
        let report = twin.apply(&command(u64::from(k), Ask::Displacement(displacement)), state);
        let Some(state) = take(report) else { return [f64::NAN; 2] };
        end = state;
    }
    let stress = [0, 4, 8].map(|k| end.stress_walls[k] - start.stress_walls[k]);
    let strain = [0, 1, 2].map(|k| end.strain[k] - start.strain[k]);
    let found = moduli::secant(stress, strain, 1.0);
    [found.bulk, found.shear]
}

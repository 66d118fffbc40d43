//! T figs. 2.6 and 2.13: contacts of the grains while a pack is made, directions of the largest
//! forces under an axial load.

mod figures;
mod tables;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{Pack, generate};
use graintwin::report::{ContactNetwork, Demand, Fabric, Report};
use graintwin::scene::Scene;
use graintwin::twin::Twin;
use graintwin::wall::{self, WallTarget};

use crate::curve::Curve;
use crate::specimen::{TOLERANCE, compact, scene};

pub(crate) use figures::sheets;
pub(crate) use tables::print;

/// Stresses of the stages of fig. 2.6 \[Pa\]: a pack that hardly carries anything stands for the
/// thesis' sediment.
pub(crate) const STAGES: [f64; 3] = [0.01e6, 0.2e6, 10e6];

/// Lateral stresses of the axial loads \[Pa\]: one where a frictionless pack is weak, and the two
/// of fig. 2.13.
pub(crate) const LATERAL: [f64; 3] = [10e6, 0.11e9, 1.28e9];

/// Axial over lateral stress of fig. 2.13 (b).
pub(crate) const THESIS_RATIO: f64 = 1.39 / 1.28;

/// Increments of an axial load, at most.
const INCREMENTS: usize = 30;

/// Axial minus lateral over mean stress at which it ends; that of fig. 2.13 (b) is 0.084.
const END: f64 = 0.1;

/// Axial strain of an increment at 10 MPa; it follows the overlaps, as the stress to the power 2/3.
const STRAIN: f64 = 3e-4;

/// One equilibrium of an axial load.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// Axial minus lateral over mean stress of the walls.
    pub(crate) ratio: f64,
    pub(crate) fabric: Fabric,
    /// Share of the largest forces in the axial cone with the contacts at walls among them.
    pub(crate) with_walls: f64,
}

/// The networks of a seed.
#[derive(Clone, Debug)]
pub(crate) struct Networks {
    pub(crate) seed: u64,
    /// At each of [`STAGES`].
    pub(crate) stages: Vec<Fabric>,
    /// Courses of axial loads, one for each of [`LATERAL`].
    pub(crate) axial: Vec<Vec<Point>>,
}

impl Networks {
    /// Makes the packs of `seed` and loads them.
    pub(crate) fn run(seed: u64) -> Self {
        let mut pack = barely_touching(seed);
        let mut stages = vec![isotropic(seed, &pack)];
        for stress in &STAGES[1..] {
            pack = compact(&pack, seed, *stress);
            stages.push(isotropic(seed, &pack));
        }
        let axial = LATERAL.map(|lateral| {
            pack = compact(&pack, seed, lateral);
            load(seed, &pack, lateral)
        });
        Self { seed, stages, axial: axial.into() }
    }
}

/// A value over the stress ratio of the axial load `which`, a curve for each seed. Where a
/// rearrangement lets the ratio fall, the first value of a ratio is the one that is read.
fn curves(networks: &[Networks], which: usize, of: impl Fn(&Point) -> f64) -> Vec<Curve> {
    let course = |one: &Networks| -> Curve {
        let points = one.axial[which].iter().enumerate();
        // Rounding leaves the isotropic state beside 0.
        points.map(|(k, point)| [if k == 0 { 0.0 } else { point.ratio }, of(point)]).collect()
    };
    networks.iter().map(course).collect()
}

fn smooth(seed: u64) -> Scene {
    let mut scene = scene(seed);
    scene.solver.tolerance = TOLERANCE;
    scene
}

fn barely_touching(seed: u64) -> Pack {
    let scene = scene(seed);
    let mut spec = scene.pack.generate.clone().expect("the scene asks for it");
    spec.confining_stress = STAGES[0];
    let glass = &scene.materials[&spec.material];
    generate::generate(&spec, glass, &scene.walls, 0.0, scene.solver).expect("the pack is found")
}

/// The network of a pack as it is.
fn isotropic(seed: u64, pack: &Pack) -> Fabric {
    let mut twin = Twin::new(&smooth(seed), pack, 1).expect("the pack has grains");
    let measures = twin.start(Demand::ALL).measures.expect("the pack is in equilibrium");
    measures.fabric.expect("it was demanded")
}

/// Strains `pack` along z while the side walls carry `lateral` \[Pa\].
fn load(seed: u64, pack: &Pack, lateral: f64) -> Vec<Point> {
    let mut twin = Twin::new(&smooth(seed), pack, 1).expect("the pack has grains");
    let mut course = vec![point(&twin.start(Demand::ALL))];
    let strain = STRAIN * (lateral / 10e6).powf(2.0 / 3.0);
    for step in 1..=INCREMENTS {
        let travel = 0.5 * strain * step as f64 * pack.bounds.sides()[2];
        let mut targets = [WallTarget::Stress(lateral); wall::COUNT];
        targets[4..].fill(WallTarget::Displacement(travel));
        let report = twin.apply(
            &Command {
                stamp: Stamp::default(),
                session: "network".into(),
                sequence: step as u64,
                mode: Mode::Absolute,
                ask: Ask::Targets(targets),
                age: None,
            },
            Demand::ALL,
        );
        if report.disposition == Disposition::NotConverged {
            println!("    seed {seed}, {lateral:e} Pa, increment {step}: {}", report.text);
            break;
        }
        course.push(point(&report));
        if course[step].ratio > END {
            break;
        }
    }
    course
}

fn point(report: &Report) -> Point {
    let measures = report.measures.as_ref().expect("the walls moved");
    let state = measures.state.expect("it was demanded");
    let fabric = measures.fabric.clone().expect("it was demanded");
    let network = measures.network.as_ref().expect("it was demanded");
    Point {
        ratio: state.deviatoric_stress / state.confining_stress,
        with_walls: with_walls(network, fabric.chains.threshold),
        fabric,
    }
}

/// See [`Point::with_walls`].
fn with_walls(network: &ContactNetwork, threshold: f64) -> f64 {
    let forces = network.normal_force.iter().zip(network.normal.chunks_exact(3));
    let largest: Vec<_> = forces.filter(|(force, _)| **force >= threshold).collect();
    let inside = largest.iter().filter(|(_, normal)| normal[2] * normal[2] >= 0.5).count();
    inside as f64 / largest.len() as f64
}

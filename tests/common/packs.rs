//! Small packs, and a rig that drives them.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use std::path::Path;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::generate::generate;
use graintwin::pack::{Grain, Pack};
use graintwin::report::{Demand, Measures, PackState, Report};
use graintwin::scene::{self, Generate, Material, Radius, Scene, Solver, Walls};
use graintwin::twin::Twin;
use graintwin::wall::{self, Bounds, WallTarget};

/// Glass without spread: E* between grains is 36458333333.333336 Pa, against the default walls
/// 72347700983.85123 Pa (the peers' `g2740_10MPa.json` computed both).
pub(crate) const GLASS: Material =
    Material { young: 70e9, poisson: 0.2, density: 2420.0, spread: 0.0 };
/// E* of two glass grains \[Pa\].
pub(crate) const E_GRAINS: f64 = 36_458_333_333.333_336;
/// E* of a glass grain and a wall \[Pa\].
pub(crate) const E_WALL: f64 = 72_347_700_983.851_23;

/// A scene with defaults; its pack is not read.
pub(crate) fn scene() -> Scene {
    scene::parse("pack: {file: none.csv, material: glass}", Path::new("scene.yaml")).unwrap()
}

/// A scene whose relaxation has this tolerance.
pub(crate) fn scene_to(tolerance: f64) -> Scene {
    let mut scene = scene();
    scene.solver.tolerance = tolerance;
    scene
}

/// A glass bead.
pub(crate) fn bead(position: [f64; 3], radius: f64) -> Grain {
    let Material { young, poisson, density, .. } = GLASS;
    Grain { position, radius, young, poisson, density, friction: 0.0, hydrate: false }
}

/// A box around the origin.
pub(crate) fn centered(sides: [f64; 3]) -> Bounds {
    Bounds { min: sides.map(|s| -0.5 * s), max: sides.map(|s| 0.5 * s) }
}

/// What makes a pack of glass beads of 0.07 to 0.13 mm.
pub(crate) fn recipe(grains: usize, confining_stress: f64, seed: u64) -> Generate {
    Generate {
        grains,
        radius: Radius::Uniform([0.07e-3, 0.13e-3]),
        material: "glass".into(),
        seed,
        confining_stress,
        aspect: [1.0; 3],
        expand_floaters: 0,
        compaction_friction: 0.0,
    }
}

/// Makes a pack of equal glass in equilibrium.
pub(crate) fn made(grains: usize, confining_stress: f64, seed: u64) -> Pack {
    let recipe = recipe(grains, confining_stress, seed);
    generate(&recipe, &GLASS, &Walls::default(), 0.0, Solver::default()).unwrap()
}

/// A twin with somebody who counts the commands.
pub(crate) struct Rig {
    pub(crate) twin: Twin,
    pub(crate) sequence: u64,
}

impl Rig {
    /// A twin at its initial equilibrium, with the report of it.
    pub(crate) fn start(scene: &Scene, pack: &Pack) -> (Self, Report) {
        Self::start_on(scene, pack, 1)
    }

    /// As [`Rig::start`], on some threads.
    pub(crate) fn start_on(scene: &Scene, pack: &Pack, threads: usize) -> (Self, Report) {
        let mut twin = Twin::new(scene, pack, threads).unwrap();
        let report = twin.start(Demand::ALL);
        (Self { twin, sequence: 0 }, report)
    }

    /// Sends the walls to an absolute displacement.
    pub(crate) fn send(&mut self, displacement: [f64; wall::COUNT]) -> Report {
        self.sequence += 1;
        self.twin.apply(&absolute(self.sequence, displacement), Demand::ALL)
    }

    /// Sends the walls their targets.
    pub(crate) fn aim(&mut self, targets: [WallTarget; wall::COUNT]) -> Report {
        self.sequence += 1;
        let ask = Ask::Targets(targets);
        let command = Command { ask, ..absolute(self.sequence, [0.0; wall::COUNT]) };
        self.twin.apply(&command, Demand::ALL)
    }

    /// As [`Rig::aim`]; the command must be applied.
    pub(crate) fn take(&mut self, targets: [WallTarget; wall::COUNT]) -> Measures {
        let report = self.aim(targets);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        report.measures.unwrap()
    }

    /// As [`Rig::send`]; the command must be applied.
    pub(crate) fn go(&mut self, displacement: [f64; wall::COUNT]) -> Measures {
        let report = self.send(displacement);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        report.measures.unwrap()
    }

    /// As [`Rig::go`], on a path without an event: nothing was reported.
    pub(crate) fn go_quietly(&mut self, displacement: [f64; wall::COUNT]) -> Measures {
        let report = self.send(displacement);
        assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
        report.measures.unwrap()
    }
}

/// An absolute command of the session `test`.
pub(crate) fn absolute(sequence: u64, displacement: [f64; wall::COUNT]) -> Command {
    Command {
        stamp: Stamp { sec: 7, nanosec: 9 },
        session: "test".into(),
        sequence,
        mode: Mode::Absolute,
        ask: Ask::Displacement(displacement),
        age: None,
    }
}

/// The state that [`Demand::ALL`] always brings.
pub(crate) fn state(measures: &Measures) -> PackState {
    measures.state.unwrap()
}

/// Displacements that strain the axes of `bounds`, both walls of a pair by half.
pub(crate) fn by_strain(bounds: &Bounds, strain: [f64; 3]) -> [f64; wall::COUNT] {
    let sides = bounds.sides();
    std::array::from_fn(|w| 0.5 * strain[wall::axis(w)] * sides[wall::axis(w)])
}

/// |a - b| over |b|.
pub(crate) fn off(a: f64, b: f64) -> f64 {
    (a - b).abs() / b.abs()
}

/// Asserts that `got` is within `tolerance` of `want`, relative to `want`.
#[track_caller]
pub(crate) fn close(what: &str, got: f64, want: f64, tolerance: f64) {
    let off = off(got, want);
    assert!(off <= tolerance, "{what}: {got:e} is off {want:e} by {off:.1e}");
}

/// Bits of a pack: box, then grains.
pub(crate) fn bits(pack: &Pack) -> Vec<u64> {
    let grain = |g: &Grain| {
        let [x, y, z] = g.position;
        let numbers = [x, y, z, g.radius, g.young, g.poisson, g.density, g.friction];
        numbers.map(f64::to_bits).into_iter().chain([u64::from(g.hydrate)])
    };
    let walls = pack.bounds.min.iter().chain(&pack.bounds.max).map(|wall| wall.to_bits());
    walls.chain(pack.grains.iter().flat_map(grain)).collect()
}

//! The sample and the walls that press it.

use std::path::Path;

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::pack::{Pack, generate};
use graintwin::report::{ContactNetwork, Demand, PackState, Report};
use graintwin::scene::{self, Coulomb, Friction, Scene, Solver, Update};
use graintwin::twin::Twin;
use graintwin::wall::{self, Bounds};

/// Stress at which the scattered grains are made into a pack \[Pa\].
pub(crate) const LOOSE: f64 = 1.0e6;

/// Residual of the equilibria: the wall forces are then right to eight digits.
pub(crate) const TOLERANCE: f64 = 1e-6;

/// A tangential force above this share of its limit counts as near it.
pub(crate) const NEAR_LIMIT: f64 = 0.9;

/// What a run is made with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    pub(crate) friction: f64,
    pub(crate) update: Update,
    pub(crate) solver: Solver,
}

/// One equilibrium of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Equilibrium {
    /// Everything that the twin says of the pack.
    pub(crate) state: PackState,
    /// Contacts whose tangential force is above [`NEAR_LIMIT`] of its limit, over all.
    pub(crate) near_limit: f64,
}

impl Equilibrium {
    /// Normal stresses on the walls \[Pa\].
    pub(crate) fn stress(&self) -> [f64; 3] {
        [0, 4, 8].map(|k| self.state.stress_walls[k])
    }
}

/// The scene of a sample: beads and walls of T table 2.1.
pub(crate) fn scene(seed: u64) -> Scene {
    let text = format!(
        "pack: {{generate: {{grains: 2740, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
         material: glass, seed: {seed}, confining_stress: {LOOSE:e}}}}}"
    );
    scene::parse(&text, Path::new("validation.yaml")).expect("the scene is right")
}

/// The pack of a seed at [`LOOSE`], without friction.
pub(crate) fn loose(seed: u64) -> Pack {
    let scene = scene(seed);
    let spec = scene.pack.generate.as_ref().expect("the scene asks for it");
    let glass = &scene.materials[&spec.material];
    generate::generate(spec, glass, &scene.walls, 0.0, scene.solver).expect("the pack is found")
}

/// Brings `pack` to an isotropic stress \[Pa\] without friction: phase (a) of T 3.6.2.
pub(crate) fn compact(pack: &Pack, seed: u64, stress: f64) -> Pack {
    let scene = scene(seed);
    generate::compact(pack, stress, &scene.walls, scene.solver).expect("the pack can be compacted")
}

/// Walls that press a pack along z, and what the pack answers.
pub(crate) struct Press {
    twin: Twin,
    friction: f64,
    height: f64,
    sequence: u64,
    travel: f64,
    /// The equilibria so far, the initial one first.
    pub(crate) course: Vec<Equilibrium>,
}

impl Press {
    /// Puts `pack` between the walls; the strains that are reported refer to the box `reference`.
    pub(crate) fn new(seed: u64, setting: Setting, pack: &Pack, reference: Bounds) -> Self {
        let Setting { friction, update, solver } = setting;
        let mut scene = scene(seed);
        scene.solver = solver;
        scene.reference = Some(reference);
        if friction > 0.0 {
            let coulomb = Coulomb { coefficient: friction, update, ..Coulomb::default() };
            scene.contact.friction = Friction::Coulomb(coulomb);
        }
        let mut pack = pack.clone();
        for grain in &mut pack.grains {
            grain.friction = friction;
        }
        let twin = Twin::new(&scene, &pack, 1).expect("the pack has grains");
        let height = pack.bounds.sides()[2];
        let mut press = Self { twin, friction, height, sequence: 0, travel: 0.0, course: vec![] };
        let report = press.twin.start(Demand::ALL);
        assert!(press.take(&report), "{}", report.text);
        press
    }

    /// The last equilibrium.
    pub(crate) fn last(&self) -> &Equilibrium {
        self.course.last().expect("it begins with one")
    }

    /// Mean of the three normal stresses now \[Pa\].
    pub(crate) fn confining_stress(&self) -> f64 {
        self.last().state.confining_stress
    }

    /// Strains the pack along z by `strain` of its height at the start, both walls moving; whether
    /// it found an equilibrium.
    #[must_use]
    pub(crate) fn strain(&mut self, strain: f64) -> bool {
        self.travel += 0.5 * strain * self.height;
        self.sequence += 1;
        let mut displacement = [0.0; wall::COUNT];
        displacement[4..].fill(self.travel);
        let command = Command {
            stamp: Stamp::default(),
            session: "validation".into(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement(displacement),
            age: None,
        };
        let report = self.twin.apply(&command, Demand::ALL);
        self.take(&report)
    }

    fn take(&mut self, report: &Report) -> bool {
        if report.disposition == Disposition::NotConverged {
            println!("    stopped at {:.2} MPa: {}", self.confining_stress() / 1e6, report.text);
            return false;
        }
        let measures = report.measures.as_ref().expect("the walls moved");
        let state = measures.state.expect("it was demanded");
        let network = measures.network.as_ref().expect("it was demanded");
        let near_limit = near_limit(network, self.friction);
        self.course.push(Equilibrium { state, near_limit });
        true
    }
}

/// See [`Equilibrium::near_limit`].
fn near_limit(network: &ContactNetwork, friction: f64) -> f64 {
    let tangential = network.tangential_force.chunks_exact(3);
    let near = network.normal_force.iter().zip(tangential).filter(|(normal, q)| {
        let size = q.iter().map(|q| q * q).sum::<f64>().sqrt();
        friction > 0.0 && size > NEAR_LIMIT * friction * *normal
    });
    near.count() as f64 / network.normal_force.len() as f64
}

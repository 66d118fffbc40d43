//! A uniaxial stress test as the thesis has it: axial compression, lateral expansion.

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::measure::moduli;
use graintwin::pack::{Kept, Pack};
use graintwin::report::{Demand, PackState, Report};
use graintwin::scene::{Coulomb, Friction, Normal, Solver};
use graintwin::twin::Twin;
use graintwin::wall;

use super::runs::{END, LONGEST, Test};
use super::sample::scene;
use crate::specimen::TOLERANCE;

/// Lateral expansion over axial compression (T 4.8.1).
const EXPANSION: f64 = 0.25;

/// What a test gave.
pub(crate) struct Course {
    /// Its equilibria, the initial one first.
    pub(crate) states: Vec<PackState>,
    /// Bonds of touching bodies and bonds across gaps.
    pub(crate) bonds: [usize; 2],
}

/// Young's modulus between two equilibria.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Interval {
    /// Mean axial stress \[Pa\].
    pub(crate) axial: f64,
    /// Mean of the axial minus the lateral stress \[Pa\].
    pub(crate) deviatoric: f64,
    /// Mean lateral stress \[Pa\].
    pub(crate) lateral: f64,
    /// Least squares of Hooke's law over the three axes \[Pa\] (T 2.15).
    pub(crate) young: f64,
    /// Poisson's ratio of the same fit.
    pub(crate) poisson: f64,
}

impl Course {
    /// Runs `test` on `pack`.
    pub(crate) fn run(test: &Test, seed: u64, pack: &Pack) -> Self {
        let mut scene = scene(seed);
        let mut pack = pack.clone();
        if let Some(cement) = test.cement {
            scene.contact.normal = Normal::Cement(cement);
        }
        if test.friction > 0.0 {
            let coulomb =
                Coulomb { coefficient: test.friction, update: test.update, ..Coulomb::default() };
            scene.contact.friction = Friction::Coulomb(coulomb);
            pack.grains.iter_mut().for_each(|grain| grain.friction = test.friction);
        }
        // Increments as asked for, whatever the overlaps are.
        scene.solver = Solver {
            max_strain_increment: test.increment,
            max_overlap_share: 100.0,
            tolerance: TOLERANCE,
            ..Solver::default()
        };
        let mut twin = Twin::new(&scene, &pack, 1).expect("the pack has grains");
        let mut states = vec![state(&twin.start(DEMAND)).expect("the pack is in equilibrium")];
        let bonds = bonds(&twin.pack());
        let sides = pack.bounds.sides();
        while !ended(&states[states.len() - 1]) {
            let strain = test.increment * states.len() as f64;
            let strains = [-EXPANSION * strain, -EXPANSION * strain, strain];
            let displacement: [f64; wall::COUNT] =
                std::array::from_fn(|w| 0.5 * strains[w / 2] * sides[w / 2]);
            let report = twin.apply(
                &Command {
                    stamp: Stamp::default(),
                    session: "cement".into(),
                    sequence: states.len() as u64,
                    mode: Mode::Absolute,
                    ask: Ask::Displacement(displacement),
                    age: None,
                },
                DEMAND,
            );
            match state(&report) {
                Some(state) => states.push(state),
                None => {
                    println!("    {test:?}, seed {seed}: {}", report.text);
                    break;
                }
            }
        }
        Self { states, bonds }
    }

    /// Its intervals of an axial strain of at least `width`.
    pub(crate) fn intervals(&self, width: f64) -> Vec<Interval> {
        let mut intervals = Vec::new();
        let mut from = 0;
        for (to, state) in self.states.iter().enumerate() {
            // Strains come with rounding.
            if state.strain[2] - self.states[from].strain[2] >= width * (1.0 - 1e-3) {
                intervals.push(interval(&self.states[from], state));
                from = to;
            }
        }
        intervals
    }
}

const DEMAND: Demand = Demand { state: true, ..Demand::NONE };

fn state(report: &Report) -> Option<PackState> {
    let found = report.disposition != Disposition::NotConverged;
    found.then(|| report.measures.as_ref()?.state).flatten()
}

fn ended(state: &PackState) -> bool {
    state.stress_walls[8].min(state.deviatoric_stress) > END || state.strain[2] > LONGEST
}

fn bonds(pack: &Pack) -> [usize; 2] {
    let bonds = pack.history.iter().flat_map(|history| &history.bonds);
    let intact = bonds.filter(|bond| bond.condition == Kept::Intact);
    let (touching, across): (Vec<_>, Vec<_>) = intact.partition(|bond| bond.overlap > 0.0);
    [touching.len(), across.len()]
}

fn interval(from: &PackState, to: &PackState) -> Interval {
    let stress = |state: &PackState| [0, 4, 8].map(|k| state.stress_walls[k]);
    let change = |from: [f64; 3], to: [f64; 3]| std::array::from_fn(|k| to[k] - from[k]);
    // The density matters to wave speeds only.
    let fit = moduli::secant(change(stress(from), stress(to)), change(from.strain, to.strain), 1.0);
    let axial = 0.5 * (from.stress_walls[8] + to.stress_walls[8]);
    let deviatoric = 0.5 * (from.deviatoric_stress + to.deviatoric_stress);
    Interval {
        axial,
        deviatoric,
        lateral: axial - deviatoric,
        young: fit.young,
        poisson: fit.poisson,
    }
}

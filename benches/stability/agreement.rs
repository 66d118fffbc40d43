//! How often an increment ends where the gradient flow from its affine start ends: random strain
//! increments of random small packs, each followed by the solver and by `reference`.

use graintwin::contact::Other;
use graintwin::measure::contacts::Contacts;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::generate::generate;
use graintwin::relax::advance::move_walls;
use graintwin::relax::{Workspace, relax};
use graintwin::scene::{Coulomb, Friction, Law, Solver, Update, Walls};
use graintwin::state::State;
use graintwin::wall;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::packs::{GLASS, recipe, scene};
use crate::reference;

/// Increments of each pack.
const INCREMENTS: usize = 6;
/// Confining stresses of the packs \[Pa\].
const STRESSES: [f64; 3] = [1e5, 1e6, 1e7];
/// Strains of the increments over the mean overlap strain. The program takes no more than 0.05 at
/// once by itself; 0.2 provokes instabilities.
const SHARES: [f64; 4] = [0.01, 0.05, 0.05, 0.2];
/// Two end states are one when their wall forces differ by less than this share of the mean, and
const FORCE: f64 = 1e-4;
/// no grain that carries load is this many mean overlaps apart.
const APART: f64 = 0.01;
/// Contacts weaker than this over the mean do not hold a grain in its place.
const WEAK: f64 = 1e-3;

/// Counts of the increments of one size.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    /// Largest strain of an increment over the mean overlap strain.
    pub(crate) share: f64,
    /// Increments without an event, and those of them that ended where the flow does.
    pub(crate) quiet: [u32; 2],
    /// The same of increments with an event.
    pub(crate) loud: [u32; 2],
    /// Increments in which the solver followed the flow.
    pub(crate) followed: u32,
    /// Increments in which it found no equilibrium.
    pub(crate) failed: u32,
}

/// Compares the increments of `packs` packs at each stress, by their size.
pub(crate) fn tally(packs: u64, friction: f64) -> [Tally; 3] {
    let mut tallies = [0.01, 0.05, 0.2].map(|share| Tally { share, ..Tally::default() });
    for seed in 1..=packs {
        for (k, stress) in STRESSES.into_iter().enumerate() {
            let Some(mut case) = Case::new(seed, k as u64, stress, friction) else { continue };
            for _ in 0..INCREMENTS {
                let Some(seen) = case.increment() else { break };
                let row = usize::from(seen.share > 0.01) + usize::from(seen.share > 0.05);
                let tally = &mut tallies[row];
                tally.followed += u32::from(seen.followed);
                let Some(same) = seen.same else {
                    tally.failed += 1;
                    break;
                };
                let count = if seen.event { &mut tally.loud } else { &mut tally.quiet };
                count[0] += 1;
                count[1] += u32::from(same);
                if !same {
                    let (forces, overlaps) = seen.apart;
                    eprintln!(
                        "seed {seed}, {stress:.0e} Pa, friction {friction}, step {}: wall forces \
                         apart by {forces:.0e}, grains by {overlaps:.0e} overlaps",
                        seen.share
                    );
                }
            }
        }
    }
    tallies
}

/// A small pack on its way.
pub(crate) struct Case {
    model: Model,
    state: State,
    work: Workspace,
    rng: Pcg64,
}

/// What one increment came to.
pub(crate) struct Seen {
    share: f64,
    /// Whether the solver followed the flow.
    followed: bool,
    /// Whether it reported an event.
    pub(crate) event: bool,
    /// Whether the reference saw one: a dip of the force, and then a grain that carries load and
    /// went further than the mean overlap.
    pub(crate) dipped: bool,
    /// Whether it ended where the reference did; `None` when it found no equilibrium.
    pub(crate) same: Option<bool>,
    /// Wall forces over the mean, and positions over the mean overlap, apart.
    apart: (f64, f64),
}

impl Case {
    pub(crate) fn new(seed: u64, k: u64, stress: f64, friction: f64) -> Option<Self> {
        let mut rng = Pcg64::seed_from_u64(10 * seed + k);
        let recipe = recipe(rng.random_range(20..=60usize), stress, seed);
        let mut pack = generate(&recipe, &GLASS, &Walls::default(), 0.0, Solver::default()).ok()?;
        let mut scene = scene();
        if friction > 0.0 {
            let coefficient = friction;
            let coulomb = Coulomb { coefficient, law: Law::ReturnMap, update: Update::Frozen };
            scene.contact.friction = Friction::Coulomb(coulomb);
            pack.grains.iter_mut().for_each(|grain| grain.friction = friction);
        }
        let model = Model::new(&pack, &scene);
        let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
        work.start(&model, &state);
        let outcome = relax(&model, &mut state, &mut work);
        work.commit(&model, &mut state);
        outcome.status.is_equilibrium().then_some(Self { model, state, work, rng })
    }

    /// One random increment; `None` where the reference takes too long.
    fn increment(&mut self) -> Option<Seen> {
        let share = SHARES[self.rng.random_range(0..SHARES.len())];
        let direction = std::array::from_fn(|_| 2.0 * self.rng.random::<f64>() - 1.0);
        self.strain(share, direction)
    }

    /// One increment whose largest strain is `share` of the mean overlap strain; `None` as above.
    pub(crate) fn strain(&mut self, share: f64, direction: [f64; 3]) -> Option<Seen> {
        let Self { model, state, work, .. } = self;
        let longest = direction.iter().map(|d| d.abs()).fold(0.0, f64::max);
        let overlap = work.balance.sums.mean_overlap();
        let strain = share * overlap / (2.0 * model.mean_radius) / longest;
        let sides = model.start.sides();
        let target: [f64; wall::COUNT] = std::array::from_fn(|w| {
            state.displacement[w] + 0.5 * strain * direction[w / 2] * sides[w / 2]
        });
        work.begin(model, state);
        move_walls(model, state, &target, 1.0);
        let mut wanted = state.clone();
        let dip = reference::follow(model, &mut wanted, work)?;
        let far = work.balance.sums.mean_overlap();
        work.jumps.clear();
        let outcome = relax(model, state, work);
        let (followed, event) = (outcome.descents > 0, !work.jumps.is_empty());
        let dipped = dip.is_some_and(|dip| {
            let mut moved = wanted.position.iter().zip(&dip).zip(&state.carries);
            moved.any(|((to, from), &carries)| carries && (to - from).norm() > far)
        });
        if !outcome.status.is_equilibrium() {
            return Some(Seen { share, followed, event, dipped, same: None, apart: (0.0, 0.0) });
        }
        let apart = apart(model, state, &mut wanted, work, overlap);
        work.evaluate(model, state, &state.bounds(model));
        work.commit(model, state);
        let same = Some(apart.0 <= FORCE && apart.1 <= APART);
        Some(Seen { share, followed, event, dipped, same, apart })
    }
}

fn apart(
    model: &Model,
    state: &State,
    wanted: &mut State,
    work: &mut Workspace,
    overlap: f64,
) -> (f64, f64) {
    wanted.carries.copy_from_slice(&state.carries);
    work.neighbours.refresh(model, &wanted.position, &state.bounds(model));
    let there = walls::normal_forces(model, wanted, &work.neighbours);
    work.neighbours.refresh(model, &state.position, &state.bounds(model));
    let here = walls::normal_forces(model, state, &work.neighbours);
    let mean = here.iter().sum::<f64>() / wall::COUNT as f64;
    let forces = here.iter().zip(there).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / mean;
    let contacts = Contacts::of(model, state, &work.neighbours);
    let mut holds = vec![0; model.len()];
    for contact in contacts.list.iter().filter(|c| c.force > WEAK * contacts.mean_force) {
        holds[contact.first as usize] += 1;
        if let Other::Grain(j) = contact.second {
            holds[j as usize] += 1;
        }
    }
    let needed = if model.friction.is_some() { 2 } else { 4 };
    let moved = (0..model.len())
        .filter(|&i| state.carries[i] && holds[i] >= needed)
        .map(|i| (state.position[i] - wanted.position[i]).norm())
        .fold(0.0, f64::max);
    (forces, moved / overlap)
}

//! One load increment: walls to a target, in sub-increments that the pack can follow.

use crate::Vec3;
use crate::contact::Other;
use crate::measure::contacts::{Contact, Contacts};
use crate::measure::{stress, walls};
use crate::model::Model;
use crate::relax::breakage::{self, Crack, Relaxed};
use crate::relax::jump::{Carried, Jump};
use crate::relax::servo::{self, Drive};
use crate::relax::tangential::Changes;
use crate::relax::{Outcome, Status, Workspace, accuracy, newton, relax, two_step};
use crate::scene::{Method, Update};
use crate::state::{Ledger, State};
use crate::wall::{self, Control, Load, Setpoint};

/// A sub-increment is never smaller than this share of `solver.max_strain_increment`, so that
/// decompression passes the point where the overlaps vanish.
const LEAST_SHARE: f64 = 0.01;
/// A command of exactly the largest strain may come out larger by rounding and is not halved.
pub(super) const ROUNDING: f64 = 1e-9;
/// Halvings of a sub-increment that finds no equilibrium.
pub(super) const HALVINGS: u32 = 6;
/// Most times that the limits of friction are renewed and the increment solved again.
const RENEWALS: u32 = 3;
/// Walls under loads may go this many times as far in a sub-increment as those that are moved.
const STRETCH: f64 = 4.0;
/// Halvings after which walls creep whose loads find no equilibrium nearby, the first time.
const YIELDS: u32 = 2;
/// Most times that they do so in one increment.
const MOST_CREEPS: u32 = 300;
/// A load that is less than this share of the one asked for is as good as none.
const LITTLE: f64 = 0.1;

/// What an increment came to.
#[derive(Clone, Debug)]
pub struct Advance {
    /// The last relaxation.
    pub outcome: Outcome,
    /// Equilibria on the way, the last included.
    pub substeps: u32,
    /// Steps of the method of all relaxations.
    pub iterations: u32,
    /// Legs of the flow of all relaxations, each from a configuration that was unstable.
    pub descents: u32,
    /// Estimated error of the normal forces on the walls at the end, the largest \[N\]
    /// ([`accuracy`]).
    pub wall_force_error: f64,
    /// Strain by which walls yielded to loads that no equilibrium nearby carried.
    pub crept: f64,
    /// Instabilities that the pack went through, in order.
    pub jumps: Vec<Jump>,
    /// Bonds that broke, in order.
    pub cracks: Vec<Crack>,
    /// Contacts that opened and formed, and what is left of the error of freezing the limits.
    pub changes: Changes,
}

impl Advance {
    /// One that has not begun.
    pub(crate) fn at(outcome: Outcome) -> Self {
        Self {
            outcome,
            substeps: 0,
            iterations: 0,
            descents: 0,
            wall_force_error: 0.0,
            crept: 0.0,
            jumps: Vec::new(),
            cracks: Vec::new(),
            changes: Changes::default(),
        }
    }

    /// What it and the `next` one came to.
    pub(super) fn add(&mut self, mut next: Self) {
        self.outcome = next.outcome;
        self.substeps += next.substeps;
        self.iterations += next.iterations;
        self.descents += next.descents;
        self.wall_force_error = next.wall_force_error;
        self.crept += next.crept;
        self.jumps.append(&mut next.jumps);
        self.cracks.append(&mut next.cracks);
        self.count(next.changes);
    }

    pub(crate) fn count(&mut self, changes: Changes) {
        self.changes.add(changes);
    }
}

/// Moves the walls of `state`, an equilibrium, to where `setpoint` has them and relaxes: those that
/// stand to their displacement, those under a load until they carry it.
///
/// When no equilibrium is found `state` is what it was before. `here` is the outcome that led to
/// `state`.
pub fn advance(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    setpoint: &Setpoint,
    here: Outcome,
) -> Advance {
    let start = state.clone();
    let mut last = state.clone();
    let mut so_far = Advance::at(here);
    work.neighbours.refresh(model, &state.position, &state.bounds(model));
    let mut forces = walls::normal_forces(model, state, &work.neighbours);
    let goal = Drive::of(model, setpoint);
    let mut drives = present(model, &goal, &forces, state);
    let (mut crept, mut creeps) = (false, 0);
    loop {
        let target = standing_target(setpoint, state);
        let arrived = state.displacement == target && drives == goal;
        if arrived && so_far.substeps > 0 {
            break;
        }
        let limit = strain_limit(model, &so_far.outcome);
        let way = remaining_strain(model, state, &target) / limit;
        let ratio = way.max(remaining_load(model, &drives, &goal, &so_far.outcome) / limit);
        let parts = (ratio * (1.0 - ROUNDING)).ceil().max(1.0);
        let mut share = 1.0 / parts;
        last.copy_from(state);
        let patience = if crept { 0 } else { YIELDS };
        crept = false;
        for attempt in 0.. {
            work.begin(model, state);
            work.jumps.clear();
            move_walls(model, state, &target, share);
            let aim = part_of_the_way(&drives, &goal, share);
            press(model, state, &aim);
            work.reference.membranes.follow(model, state);
            work.servo.begin(&on_walls(model, &aim), STRETCH * limit);
            // The seeds' methods begin where the walls take the grains.
            let predicts = model.solver.method == Method::Newton && !model.is_two_step();
            if work.reference.active && predicts {
                newton::predict(model, state, work);
            }
            let mut outcome = solve(model, state, work);
            let lost = matches!(outcome.status, Status::Unstable | Status::Stalled);
            let creeps_on = lost && work.servo.is_active() && !model.is_two_step();
            if creeps_on && attempt >= patience && creeps < MOST_CREEPS {
                state.copy_from(&last);
                outcome = creep(model, state, work, &target, (share, limit));
                crept = true;
                creeps += 1;
            }
            work.servo.begin(&[], 0.0);
            so_far.outcome = outcome;
            so_far.iterations += outcome.iterations;
            so_far.descents += outcome.descents;
            if outcome.status.is_equilibrium() {
                drives = aim;
                break;
            }
            state.copy_from(&last);
            crept = false;
            if attempt == HALVINGS {
                state.copy_from(&start);
                so_far.jumps.clear();
                so_far.cracks.clear();
                return so_far;
            }
            share *= 0.5;
        }
        so_far.substeps += 1;
        let changes = work.commit(model, state);
        so_far.count(changes);
        let next = walls::normal_forces(model, state, &work.neighbours);
        if crept {
            // What was lost on the way is asked for anew.
            drives = present(model, &goal, &next, state);
            so_far.crept += strain_between(model, &last, state);
        } else if drives == goal && state.displacement == standing_target(setpoint, state) {
            so_far.wall_force_error =
                accuracy::wall_force_error(model, state, work, &so_far.outcome);
        }
        so_far.jumps.append(&mut work.jumps);
        add_work(state, &last.displacement, &forces, &next);
        state.wall_work += work.reference.membranes.work(state);
        forces = next;
        let cracks = so_far.cracks.len();
        if !crack(model, state, work, &mut so_far, &mut forces) {
            state.copy_from(&start);
            so_far.jumps.clear();
            so_far.cracks.clear();
            return so_far;
        }
        if so_far.cracks.len() > cracks && !goal.is_empty() {
            // The loads that the walls lost are asked for anew.
            drives = present(model, &goal, &forces, state);
        }
    }
    so_far
}

/// Breaks the overloaded bonds of `state`, an equilibrium, one by one, with all walls where they are:
/// walls that carry a load are slow against cracks. Says whether there was an equilibrium after each.
fn crack(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    so_far: &mut Advance,
    forces: &mut [f64; wall::COUNT],
) -> bool {
    let cracks = so_far.cracks.len();
    while let Some((place, mut crack)) = breakage::weakest(model, state) {
        let stored = so_far.outcome.sums.energy + state.friction.stored;
        let had = so_far.outcome.sums.energy + ledger(state);
        let start = Ends::of(model, state, work, &crack);
        breakage::break_bond(state, place, crack.mode);
        work.begin(model, state);
        work.jumps.clear();
        let outcome = solve(model, state, work);
        so_far.outcome = outcome;
        so_far.iterations += outcome.iterations;
        so_far.descents += outcome.descents;
        if !outcome.status.is_equilibrium() {
            return false;
        }
        let changes = work.commit(model, state);
        so_far.count(changes);
        // What is neither stored nor lost by slip or instabilities was lost with the cement.
        let has = outcome.sums.energy + ledger(state);
        let released = had - has - work.jumps.iter().map(Jump::released).sum::<f64>();
        state.friction.broken += released;
        let end = Ends::of(model, state, work, &crack);
        crack.relaxed = Relaxed {
            substep: so_far.substeps,
            jumps: so_far.jumps.len() as u32,
            stress: [start.stress, end.stress],
            energy: stored,
            released,
            moved: [0, 1].map(|k| end.at[k] - start.at[k]),
            turned: [0, 1].map(|k| end.turn[k] - start.turn[k]),
            apart: end.apart,
        };
        so_far.cracks.push(crack);
        so_far.jumps.append(&mut work.jumps);
    }
    if so_far.cracks.len() > cracks {
        *forces = walls::normal_forces(model, state, &work.neighbours);
        let outcome = &so_far.outcome;
        so_far.wall_force_error = accuracy::wall_force_error(model, state, work, outcome);
    }
    true
}

/// A state as the two bodies of a crack see it.
struct Ends {
    /// Confining stress of the contacts \[Pa\].
    stress: f64,
    /// Where they are \[m\].
    at: [Vec3; 2],
    /// How they are turned \[rad\].
    turn: [Vec3; 2],
    /// Whether they do not touch.
    apart: bool,
}

impl Ends {
    fn of(model: &Model, state: &State, work: &mut Workspace, crack: &Crack) -> Self {
        let bounds = state.bounds(model);
        work.neighbours.refresh(model, &state.position, &bounds);
        let contacts = Contacts::of(model, state, &work.neighbours);
        let (first, second) = (crack.first as usize, crack.second);
        let own = |c: &Contact| (c.first, c.second) == (crack.first, second);
        let [other, turn] = match second {
            Other::Grain(j) => [state.position[j as usize], state.rotation[j as usize]],
            Other::Wall(w) => {
                let w = usize::from(w);
                let mut at = Vec3::zeros();
                at[wall::axis(w)] = bounds.position(w);
                [at, Vec3::zeros()]
            }
        };
        Self {
            stress: stress::from_contacts(&contacts.list, &bounds).trace() / 3.0,
            at: [state.position[first], other],
            turn: [state.rotation[first], turn],
            apart: !contacts.list.iter().any(own),
        }
    }
}

/// Energy that shear, torsion and cement store, and what slip has taken \[J\].
pub(crate) fn ledger(state: &State) -> f64 {
    let Ledger { stored, slip, renewal, .. } = state.friction;
    stored + slip + renewal
}

/// Adds the work of the walls on the way of `state` from the displacements `from`, on which their
/// normal forces went from `before` to `after`.
pub(crate) fn add_work(
    state: &mut State,
    from: &[f64; wall::COUNT],
    before: &[f64; wall::COUNT],
    after: &[f64; wall::COUNT],
) {
    for w in 0..wall::COUNT {
        let path = state.displacement[w] - from[w];
        state.wall_work += 0.5 * (before[w] + after[w]) * path;
    }
}

/// Where the walls that stand shall go; those under a load are where they are.
pub(crate) fn standing_target(setpoint: &Setpoint, state: &State) -> [f64; wall::COUNT] {
    std::array::from_fn(|w| match setpoint[w] {
        Control::Displacement(displacement) => displacement,
        Control::Load(_) => state.displacement[w],
    })
}

/// The drives of `goal` with the loads that the walls carry now, and the membranes.
fn present(
    model: &Model,
    goal: &[Drive],
    forces: &[f64; wall::COUNT],
    state: &State,
) -> Vec<Drive> {
    let bounds = state.bounds(model);
    let now = |drive: &Drive| {
        if drive.is_membrane(model) {
            return Drive { load: Load::Stress(state.pressure[drive.wall()]), ..*drive };
        }
        let force = drive.force(forces);
        let load = match drive.load {
            Load::Force(_) => Load::Force(force),
            Load::Stress(_) => Load::Stress(force / bounds.area(drive.wall())),
        };
        Drive { load, ..*drive }
    };
    goal.iter().map(now).collect()
}

/// The drives of walls among `drives`.
fn on_walls(model: &Model, drives: &[Drive]) -> Vec<Drive> {
    drives.iter().filter(|drive| !drive.is_membrane(model)).copied().collect()
}

/// Membranes press as `drives` have it.
fn press(model: &Model, state: &mut State, drives: &[Drive]) {
    for drive in drives.iter().filter(|drive| drive.is_membrane(model)) {
        state.pressure[drive.wall()] = drive.load.force(1.0);
    }
}

/// Relaxes; where walls under loads stand beside membranes, until their areas are those of the pack.
fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let mut outcome = at_rest(model, state, work);
    for _ in 0..RENEWALS {
        if !outcome.status.is_equilibrium() || work.reference.membranes.is_empty() {
            break;
        }
        let moved = work.reference.membranes.lead(model, state);
        if !(moved && work.servo.is_active()) {
            break;
        }
        let (iterations, descents) = (outcome.iterations, outcome.descents);
        outcome = at_rest(model, state, work);
        outcome.iterations += iterations;
        outcome.descents += descents;
    }
    outcome
}

/// Loads after `share` of the way from `drives` to `goal`.
pub(crate) fn part_of_the_way(drives: &[Drive], goal: &[Drive], share: f64) -> Vec<Drive> {
    if share >= 1.0 {
        return goal.to_vec();
    }
    let part = |(now, goal): (&Drive, &Drive)| {
        let load = match (now.load, goal.load) {
            (Load::Force(now), Load::Force(goal)) => Load::Force(now + share * (goal - now)),
            (Load::Stress(now), Load::Stress(goal)) => Load::Stress(now + share * (goal - now)),
            (_, other) => other,
        };
        Drive { load, ..*goal }
    };
    drives.iter().zip(goal).map(part).collect()
}

/// Strain that the rest of the loads will take, from the law of Hertz: h ~ P^(2/3).
pub(crate) fn remaining_load(
    model: &Model,
    drives: &[Drive],
    goal: &[Drive],
    here: &Outcome,
) -> f64 {
    let overlap_strain = here.sums.mean_overlap() / (2.0 * model.mean_radius);
    let change = |(now, goal): (&Drive, &Drive)| {
        let [now, goal] = [now.load, goal.load].map(|load| load.force(1.0));
        // From next to nothing the law says nothing.
        if now == goal { 0.0 } else { (goal - now).abs() / now.max(LITTLE * goal) }
    };
    let most = drives.iter().zip(goal).map(change).fold(0.0, f64::max);
    if overlap_strain == 0.0 { 0.0 } else { 2.0 / 3.0 * most * overlap_strain }
}

/// Largest strain of an axis between two states.
fn strain_between(model: &Model, one: &State, other: &State) -> f64 {
    let (before, after) = (one.bounds(model).sides(), other.bounds(model).sides());
    (0..3).map(|axis| (after[axis] / before[axis] - 1.0).abs()).fold(0.0, f64::max)
}

/// From `state`, an equilibrium, lets the walls yield to their loads by a strain of `limit` at most
/// and the standing ones go `share` of the way to `target`, and then relaxes with all of them held:
/// walls that carry a load are slow against grains that jump.
fn creep(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    target: &[f64; wall::COUNT],
    (share, limit): (f64, f64),
) -> Outcome {
    let drives = std::mem::take(&mut work.servo.drives);
    work.servo.begin(&drives, limit);
    let displacement = servo::yielding(model, state, work);
    work.servo.begin(&[], 0.0);
    let target: [f64; wall::COUNT] = std::array::from_fn(|w| match target[w] {
        still if still == state.displacement[w] => displacement[w],
        target => state.displacement[w] + share * (target - state.displacement[w]),
    });
    move_walls(model, state, &target, 1.0);
    solve(model, state, work)
}

/// Relaxes or, where the scene has it so, solves in two linear steps; and with friction up to date renews the limits and relaxes again.
fn at_rest(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    if model.is_two_step() {
        return two_step::solve(model, state, work);
    }
    let mut outcome = relax(model, state, work);
    if model.friction.as_ref().is_some_and(|friction| friction.update == Update::Current) {
        for _ in 0..RENEWALS {
            if outcome.status != Status::Converged {
                break;
            }
            work.reference.renew(model, state);
            let (iterations, descents) = (outcome.iterations, outcome.descents);
            outcome = relax(model, state, work);
            let settled = outcome.iterations == 0;
            outcome.iterations += iterations;
            outcome.descents += descents;
            if settled {
                break;
            }
        }
    }
    outcome
}

/// Largest strain of an axis that is left, against the box at the start, a shift of the whole box counted as a strain too.
pub(crate) fn remaining_strain(model: &Model, state: &State, target: &[f64; wall::COUNT]) -> f64 {
    if let Some(cell) = &model.cell {
        return cell.remaining_strain(&state.displacement, target);
    }
    let sides = model.start.sides();
    (0..3)
        .map(|axis| {
            let left = |w: usize| (target[w] - state.displacement[w]).abs();
            (left(2 * axis) + left(2 * axis + 1)) / sides[axis]
        })
        .fold(0.0, f64::max)
}

/// Largest strain of one sub-increment: a share of the mean overlap strain h/(2R), because
/// contacts that open and close between two equilibria are what makes them hard to find.
pub(crate) fn strain_limit(model: &Model, here: &Outcome) -> f64 {
    let most = model.solver.max_strain_increment;
    let overlap_strain = here.sums.mean_overlap() / (2.0 * model.mean_radius);
    if overlap_strain == 0.0 {
        return most;
    }
    (model.solver.max_overlap_share * overlap_strain).clamp(LEAST_SHARE * most, most)
}

/// Moves the walls by `share` of what is left to `target`, and the grains affinely with them.
pub fn move_walls(model: &Model, state: &mut State, target: &[f64; wall::COUNT], share: f64) {
    let before = state.bounds(model);
    for (now, target) in state.displacement.iter_mut().zip(target) {
        *now = if share >= 1.0 { *target } else { *now + share * (target - *now) };
    }
    let carried = Carried::new(&before, &state.bounds(model));
    for at in &mut state.position {
        *at = carried.to(at);
    }
}

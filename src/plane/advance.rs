//! One load increment of discs: walls to a target, in sub-increments that the pack can follow.

use super::boundary::{self, SIDES};
use super::pressed::Pressed;
use super::work::{Drive, Legs, Workspace};
use super::{commit, contacts, crack, dynamic, gauss_seidel, glue, loads, newton};
use crate::contact::neighbours::Neighbours;
use crate::model::Model;
use crate::relax::advance::{
    Advance, ledger, part_of_the_way, remaining_load, standing_target, strain_limit,
};
use crate::relax::jump::{Jump, Pose};
use crate::relax::servo::Drive as Load;
use crate::relax::{Outcome, Status};
use crate::scene::{Method, Update};
use crate::state::State;
use crate::wall::{self, Bounds, Setpoint};

/// A command of exactly the largest strain may come out larger by rounding and is not halved.
const ROUNDING: f64 = 1e-9;
/// Halvings of a sub-increment that finds no equilibrium.
const HALVINGS: u32 = 6;
/// Most times that the limits of friction, or loads that go with areas, are renewed.
const RENEWALS: u32 = 12;
/// Steps after which contacts of a pack on its way to another equilibrium are taken as they are now. With
/// those of the last equilibrium a pack that moves far would have no friction where it is.
const LEG: u32 = 40;
/// A load is what was asked for to this share of it, and limits to this share of the mean force.
const SETTLED: f64 = 1e-10;
const LIMITS_SETTLED: f64 = 1e-7;
/// Largest strain of a sub-increment in which walls give way to loads.
const LOAD_STRAIN: f64 = 1e-3;

/// Relaxes the pack as it was given: increment 0.
pub fn settle(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
) -> Advance {
    work.jumps.clear();
    loads::wrap(model, state);
    if state.bonds.is_empty() {
        // The walls that the pack was made between may not be there any more: what touched sticks.
        near.refresh(model, &state.position, &state.bounds(model));
        crack::deposit(model, state, near);
    }
    work.begin(model, state, near, true);
    for membrane in &work.membranes {
        state.outline[membrane.side] = membrane.position(&work.pose.at);
    }
    work.drives.clear();
    let mut reached = Advance::at(solve(model, state, work, near));
    if reached.outcome.status.is_equilibrium() && model.plane.as_ref().is_some_and(|s| s.glue) {
        if reached.outcome.iterations > 0 {
            commit::commit(model, state, work);
        }
        let iterations = reached.outcome.iterations;
        glue::apply(model, state, &work.bodies);
        work.begin(model, state, near, true);
        reached.outcome = solve(model, state, work, near);
        reached.outcome.iterations += iterations;
    }
    if reached.outcome.status.is_equilibrium() {
        reached.changes = match reached.outcome.iterations {
            // What was an equilibrium stays what it was, to the bit.
            0 => commit::keep(state, work),
            _ => commit::commit(model, state, work),
        };
        reached.changes.add(work.legs.changes);
        reached.descents = reached.outcome.descents;
        reached.wall_force_error = newton::wall_force_error(model, state, work, near);
        reached.jumps.append(&mut work.jumps);
    }
    reached.iterations = reached.outcome.iterations;
    reached.substeps = u32::from(reached.iterations > 0);
    reached
}

/// Moves the walls of `state`, an equilibrium, to where `setpoint` has them, tilts the box to `tilt`
/// and relaxes; as [`crate::relax::advance::advance`] does for spheres.
pub fn advance(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
    setpoint: &Setpoint,
    tilt: f64,
    here: Outcome,
) -> Advance {
    let start = state.clone();
    let mut last = state.clone();
    let mut so_far = Advance::at(here);
    near.refresh(model, &state.position, &state.bounds(model));
    let mut pressed = Pressed::of(model, state, near);
    let goal = loads::of(model, setpoint);
    let mut loads = loads::present(model, &goal, &carried(state, model, &pressed), state);
    loop {
        let target = standing_target(setpoint, state);
        if state.displacement == target
            && state.tilt == tilt
            && loads == goal
            && so_far.substeps > 0
        {
            return so_far;
        }
        let limit = strain_limit(model, &so_far.outcome);
        let way =
            loads::remaining_strain(model, state, &target).max((tilt - state.tilt).abs()) / limit;
        let load = remaining_load(model, &loads, &goal, &so_far.outcome) / limit.max(LOAD_STRAIN);
        let parts = (way.max(load) * (1.0 - ROUNDING)).ceil().max(1.0);
        let mut share = 1.0 / parts;
        last.copy_from(state);
        let had = so_far.outcome.sums.energy + ledger(state);
        for attempt in 0.. {
            work.jumps.clear();
            work.begin(model, state, near, false);
            let aim = part_of_the_way(&loads, &goal, share);
            let moved = move_walls(model, state, work, (&target, tilt), share);
            loads::press(model, state, work, &aim);
            set_drives(work, &aim, state, model, pressed.drag);
            let predicts = model.solver.sweeps.is_none() && model.solver.method != Method::Dynamic;
            if predicts && (moved || !work.drives.is_empty()) {
                newton::predict(model, state, work, near);
            }
            let outcome = follow(model, state, work, near);
            so_far.outcome = outcome;
            so_far.iterations += outcome.iterations;
            so_far.descents += outcome.descents;
            if outcome.status.is_equilibrium() {
                loads = aim;
                break;
            }
            state.copy_from(&last);
            if attempt == HALVINGS {
                state.copy_from(&start);
                so_far.jumps.clear();
                so_far.cracks.clear();
                return so_far;
            }
            share *= 0.5;
        }
        so_far.substeps += 1;
        let changes = commit::commit(model, state, work);
        so_far.count(changes);
        so_far.count(work.legs.changes);
        so_far.wall_force_error = newton::wall_force_error(model, state, work, near);
        near.refresh(model, &state.position, &state.bounds(model));
        let next = Pressed::of(model, state, near);
        let worked = state.wall_work;
        state.wall_work += Pressed::work((&last, &pressed), (state, &next));
        state.wall_work += work.legs.worked + loads::membrane_work(&last, work);
        pressed = next;
        if let Some(jump) = work.jumps.last_mut() {
            // What is neither stored nor lost by slip was lost in the jump.
            let stored = so_far.outcome.sums.energy + ledger(state);
            jump.energy_before = jump.energy_after + (state.wall_work - worked) - (stored - had);
        }
        so_far.jumps.append(&mut work.jumps);
        let cracks = so_far.cracks.len();
        if !break_bonds(model, state, work, near, &mut so_far, &mut pressed) {
            state.copy_from(&start);
            so_far.jumps.clear();
            so_far.cracks.clear();
            return so_far;
        }
        if so_far.cracks.len() > cracks && !goal.is_empty() {
            // The loads that the walls lost are asked for anew.
            loads = loads::present(model, &goal, &carried(state, model, &pressed), state);
        }
    }
}

/// What the walls carry as loads have it \[N\]: the stress across each side of the box as it leans, times
/// the area of the side when it does not.
fn carried(state: &State, model: &Model, pressed: &Pressed) -> [f64; wall::COUNT] {
    let mut carried = [0.0; wall::COUNT];
    for (side, to) in carried.iter_mut().enumerate().take(SIDES) {
        let mut shares = [0.0; SIDES];
        shares[side] = 1.0;
        let leaning = leaning(&shares, pressed.drag, state.tilt, &state.bounds(model));
        let membrane = model.plane.as_ref().is_some_and(|setup| setup.cell.is_membrane(side));
        *to = if membrane { pressed.normal[side] } else { pressed.sides[side] - leaning };
    }
    carried
}

/// What the walls of a drive with these `shares` do against the shear of the box as it moves and the box
/// leans by `tilt` \[N\]. A y side that goes its way takes its shear force along; and as an x side moves, so
/// does the part of the shear stress that a leaning side has from above and below.
fn leaning(shares: &[f64; SIDES], drag: [f64; 2], tilt: f64, bounds: &Bounds) -> f64 {
    let [x_min, x_max, y_min, y_max] = shares;
    let [width, height, _] = bounds.sides();
    let mean = 0.5 * (drag[0] + drag[1]);
    tilt * (y_min * drag[0] + y_max * drag[1] - (x_min + x_max) * mean * height / width)
}

/// Turns the loads of walls into drives of the sides, with the areas of `state` and the shear forces
/// `drag` of the y sides \[N\].
fn set_drives(work: &mut Workspace, loads: &[Load], state: &State, model: &Model, drag: [f64; 2]) {
    work.drives.clear();
    let bounds = state.bounds(model);
    let Some(setup) = &model.plane else { return };
    let driven = loads.iter().filter(|load| !setup.cell.is_membrane(loads::side(load)));
    work.drives.extend(driven.map(|load| {
        let mut shares = [0.0; SIDES];
        shares[2 * load.axis..2 * load.axis + 2].copy_from_slice(&load.shares);
        // Both walls of a pair carry the load each; together they move by the way of the drive.
        let area = model.wall_area(loads::side(load), &state.displacement);
        let force = load.load.force(area) + leaning(&shares, drag, state.tilt, &bounds);
        Drive { shares, force, load: load.load }
    }));
}

/// Moves the standing walls, and tilts the box, by `share` of what is left to `target`, the grains
/// affinely with them. Says whether anything moved.
fn move_walls(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    (target, tilt): (&[f64; wall::COUNT], f64),
    share: f64,
) -> bool {
    let bounds = state.bounds(model);
    let mut ways = [0.0; SIDES];
    for (w, (now, target)) in state.displacement.iter_mut().zip(target).enumerate() {
        let next = if share >= 1.0 { *target } else { *now + share * (target - *now) };
        if w < SIDES {
            ways[w] = next - *now;
        }
        *now = next;
    }
    let next = if share >= 1.0 { tilt } else { state.tilt + share * (tilt - state.tilt) };
    let more = next - state.tilt;
    for (i, at) in work.pose.at.iter_mut().enumerate() {
        if model.solver.sweeps.is_some() || glue::side(&state.glued, i).is_some() {
            continue;
        }
        *at += boundary::carried(model, &bounds, state.tilt, &ways, *at);
        *at += boundary::sheared(model, more, *at);
    }
    state.tilt = next;
    let moved = ways != [0.0; SIDES] || more != 0.0;
    if moved {
        let before = work.bodies.clone();
        boundary::bodies(model, &state.displacement, state.tilt, &mut work.bodies);
        glue::place(&state.glued, &before, &work.bodies, &mut work.pose);
    }
    moved
}

/// What an increment asks of the grains: an equilibrium, or no more than so many sweeps.
fn follow(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
) -> Outcome {
    match model.solver.sweeps {
        None => solve(model, state, work, near),
        Some(sweeps) => {
            work.legs = Legs::default();
            work.follow(model, state);
            let outcome = gauss_seidel::sweeps(model, state, work, near, sweeps);
            work.follow(model, state);
            outcome
        }
    }
}

/// Relaxes until loads, limits of friction and open contacts are what they shall be.
fn solve(model: &Model, state: &mut State, work: &mut Workspace, near: &mut Neighbours) -> Outcome {
    work.legs = Legs::default();
    let current = limits_are_current(model);
    let newton = model.solver.method == Method::Newton;
    // Steps of all relaxations, legs, and steps of the legs of the relaxation at hand.
    let (mut iterations, mut legs, mut spent) = (0, 0, 0);
    let mut before = Pose::default();
    before.copy(state);
    for at in before.position.iter_mut().zip(&work.pose.at) {
        (at.0.x, at.0.y) = (at.1.x, at.1.y);
    }
    work.follow(model, state);
    let mut concave = false;
    let mut virial: Option<f64> = None;
    let mut renewals = 0;
    loop {
        if virial.is_none() {
            work.evaluate(model, state);
            virial = Some(work.balance.sums.virial.iter().sum());
        }
        let left = newton::most_steps(model) - spent;
        let flows = newton && model.friction.is_some() && left > LEG;
        let mut outcome = match model.solver.method {
            Method::GaussSeidel => gauss_seidel::relax(model, state, work, near),
            Method::Dynamic => dynamic::relax(model, state, work, near),
            Method::Newton | Method::ConjugateGradient => {
                newton::relax(model, state, work, near, if flows { LEG } else { left })
            }
        };
        concave |= work.search.concave;
        iterations += outcome.iterations;
        legs += outcome.descents;
        (outcome.iterations, outcome.descents) = (iterations, legs);
        if flows && outcome.status == Status::MaxIterations {
            legs += 1;
            spent += LEG;
            flow_on(model, state, work, near);
            continue;
        }
        if !outcome.status.is_equilibrium() {
            return outcome;
        }
        spent = 0;
        let opened = newton::open(model, state, work);
        let bent = work.follow(model, state);
        let loaded = renew_loads(model, state, work) || bent;
        let limited = current && renewals < RENEWALS && renew_limits(model, state, work);
        renewals += 1;
        if !(opened || loaded || limited) {
            if concave && let Some(virial) = virial {
                work.jumps.extend(jump(model, state, work, before, virial));
            }
            return outcome;
        }
    }
}

/// Ends a leg of a way down that is long: contacts get the shear and the limits that they have now, and
/// new ones begin to rub.
pub(super) fn flow_on(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
) {
    let changes = commit::commit(model, state, work);
    work.legs.changes.add(changes);
    work.legs.worked += loads::membrane_work(state, work);
    work.begin(model, state, near, false);
}

/// Whether friction is limited by the present normal force.
pub(super) fn limits_are_current(model: &Model) -> bool {
    model.friction.as_ref().is_some_and(|friction| friction.update == Update::Current)
}

/// Renews the limits of friction; says whether any changed.
pub(super) fn renew_limits(model: &Model, state: &State, work: &mut Workspace) -> bool {
    let mut reference = std::mem::take(&mut work.reference);
    let most = reference.renew(model, |joint| newton::overlap(model, state, work, joint));
    work.reference = reference;
    most > LIMITS_SETTLED * work.balance.sums.mean_force()
}

/// Forces of the loads follow the areas and the shear of a leaning box; says whether any changed.
fn renew_loads(model: &Model, state: &State, work: &mut Workspace) -> bool {
    let bounds = state.bounds(model);
    let mut changed = false;
    for drive in &mut work.drives {
        let side = drive.shares.iter().position(|share| *share != 0.0).unwrap_or(0);
        let load = drive.load.force(model.wall_area(side, &state.displacement));
        let force = load + leaning(&drive.shares, work.balance.drag, state.tilt, &bounds);
        changed |= (force - drive.force).abs() > SETTLED * load;
        drive.force = force;
    }
    changed
}

/// What the pack did on its way from `before`, where its virial was `virial` \[J\], to another minimum;
/// `None` where no grain went further than the mean overlap.
fn jump(
    model: &Model,
    state: &mut State,
    work: &Workspace,
    before: Pose,
    virial: f64,
) -> Option<Jump> {
    work.put(state);
    let sums = &work.balance.sums;
    let far = sums.mean_overlap();
    let grains: Vec<(u32, f64)> = before
        .moved(model, state)
        .enumerate()
        .filter(|(i, _)| state.carries[*i])
        .map(|(i, way)| (i as u32, way.norm()))
        .filter(|&(_, way)| way > far)
        .collect();
    if grains.is_empty() {
        return None;
    }
    let volume = 2.0 * state.volume(model);
    let mut after = Pose::default();
    after.copy(state);
    Some(Jump {
        stress_before: virial / volume,
        stress_after: sums.virial.iter().sum::<f64>() / volume,
        // The ledger of the increment tells what was lost.
        energy_before: work.balance.potential(),
        energy_after: work.balance.potential(),
        grains,
        before,
        after,
    })
}

/// Breaks the overloaded bonds of `state`, an equilibrium, one by one, with all walls where they are, as
/// [`crate::relax::advance`] does for cement. Says whether there was an equilibrium after each.
fn break_bonds(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
    so_far: &mut Advance,
    pressed: &mut Pressed,
) -> bool {
    let cracks = so_far.cracks.len();
    while !state.bonds.is_empty() {
        let found = contacts::of(model, state, near);
        let Some((place, mut crack)) = crack::weakest(model, state, &found) else { break };
        let start = crack::Ends::of(model, state, &found, &crack);
        let stored = so_far.outcome.sums.energy + state.friction.stored;
        let had = so_far.outcome.sums.energy + ledger(state);
        crack::break_bond(state, place, crack.mode);
        work.jumps.clear();
        work.begin(model, state, near, false);
        work.drives.clear();
        let outcome = follow(model, state, work, near);
        so_far.outcome = outcome;
        so_far.iterations += outcome.iterations;
        if !outcome.status.is_equilibrium() {
            return false;
        }
        let changes = commit::commit(model, state, work);
        so_far.count(changes);
        so_far.count(work.legs.changes);
        let has = outcome.sums.energy + ledger(state);
        let worked: f64 = work.membranes.iter().map(|m| m.work(&work.pose.at, m.pressure)).sum();
        let worked = worked + work.legs.worked;
        state.wall_work += worked;
        let released = had + worked - has - work.jumps.iter().map(Jump::released).sum::<f64>();
        state.friction.broken += released;
        near.refresh(model, &state.position, &state.bounds(model));
        let end = crack::Ends::of(model, state, &contacts::of(model, state, near), &crack);
        crack.relaxed = crate::relax::breakage::Relaxed {
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
        *pressed = Pressed::of(model, state, near);
        so_far.wall_force_error = newton::wall_force_error(model, state, work, near);
    }
    true
}

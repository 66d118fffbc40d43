//! Rattlers: grains with too few contacts to carry load. They are left out of the balance, moved
//! out of the way of those that carry, and taken in again where they turn out to be caught.

mod site;

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::heap;
use crate::model::Model;
use crate::relax::rows::{Near, Rows};
use crate::relax::{Workspace, newton};
use crate::state::State;
use crate::wall::Room;
use site::{Settled, Site};

/// Contacts with an overlap below this share of the mean do not count as support.
const FAINT: f64 = 1e-4;
/// Sweeps over the floating grains.
const SWEEPS: u32 = 60;
/// Sweeps in which grains fall under their weight.
const MOST_FALLS: u32 = 10_000;
/// A contact of a floating grain is open when its force is below this share of the tolerance
/// times the mean force.
const OPEN: f64 = 0.1;

/// Contacts that a membrane counts as: more than any grain has.
const PRESSED_ON: u32 = 1000;

/// A grain whose weight is below this share of the mean contact force floats where nothing holds
/// it, as it would without gravity.
const LIGHT: f64 = 1e-4;

/// Whether the weight of grain `i` matters among contact forces of `mean_force` \[N\].
#[must_use]
pub fn weighs(model: &Model, i: usize, mean_force: f64) -> bool {
    model.weight.get(i).is_some_and(|weight| weight.norm() > LIGHT * mean_force)
}

/// Scratch of this module.
#[derive(Clone, Debug, Default)]
pub struct Rattlers {
    /// Neighbours of the grains that need it.
    near: Rows<Near>,
    degree: Vec<u32>,
    stack: Vec<u32>,
}

impl Rattlers {
    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        self.near.heap_bytes() + heap::bytes(&self.degree) + heap::bytes(&self.stack)
    }
}

/// Marks in `state.carries` the grains that are left when those with too few contacts are taken
/// away, and then those that lost their support by it, and so on. A contact that can carry shear
/// counts twice: two of them hold a grain.
pub fn find(model: &Model, state: &mut State, work: &mut Workspace) {
    let n = model.len();
    let bounds = state.bounds(model);
    let position = &state.position;
    let apart = |i: usize, j: usize| (position[i] - position[j]).norm();
    work.neighbours.refresh(model, position, &bounds);
    let Workspace { neighbours, rattlers, reference, .. } = work;
    let least = FAINT * mean_overlap(model, position, &bounds, neighbours);
    rattlers.near.fill_pairs(neighbours, model, |i, j, reach| reach - apart(i, j) > least);
    rattlers.degree.clear();
    rattlers.degree.extend_from_slice(rattlers.near.lengths());
    let holds = |i: u32, second: Other| u32::from(reference.holds(i, second, least));
    for (i, at) in position.iter().enumerate() {
        for (wall, reach) in neighbours.walls_near(model, i) {
            let gap = wall_gap(at, usize::from(wall), &bounds);
            if reach - gap > least {
                rattlers.degree[i] += 1 + holds(i as u32, Other::Wall(wall));
            }
        }
    }
    let needed = model.contacts_to_carry();
    for held in &reference.contacts {
        let shears = held.reference_overlap > least && held.present_overlap(model, state) > least;
        // Cement alone holds a grain: it goes where its neighbour goes.
        let counts = if held.is_bonded() { needed } else { u32::from(shears) };
        match held.second {
            Other::Grain(j) => {
                rattlers.degree[held.first as usize] += counts;
                rattlers.degree[j as usize] += counts;
            }
            // Shear at a wall was counted above.
            Other::Wall(_) if held.is_bonded() => rattlers.degree[held.first as usize] += counts,
            Other::Wall(_) => {}
        }
    }
    rattlers.stack.clear();
    for i in 0..n {
        // What a membrane presses on goes on until something holds it.
        if reference.membranes.press_on(i) {
            rattlers.degree[i] += PRESSED_ON;
        }
        state.carries[i] = rattlers.degree[i] >= needed;
        if !state.carries[i] {
            rattlers.stack.push(i as u32);
        }
    }
    while let Some(i) = rattlers.stack.pop() {
        for near in rattlers.near.row(i as usize) {
            let j = near.second as usize;
            rattlers.degree[j] -= 1 + holds(i, Other::Grain(j as u32));
            if state.carries[j] && rattlers.degree[j] < needed {
                state.carries[j] = false;
                rattlers.stack.push(j as u32);
            }
        }
    }
}

fn mean_overlap(model: &Model, position: &[Vec3], bounds: &Room, near: &Neighbours) -> f64 {
    let mut sum = 0.0;
    let mut count = 0u32;
    let mut add = |h: f64| {
        if h > 0.0 {
            sum += h;
            count += 1;
        }
    };
    for i in 0..model.len() {
        for k in near.row(i) {
            let apart = (position[i] - position[near.second[k] as usize]).norm();
            add(near.reach(model, i, k) - apart);
        }
        for (wall, reach) in near.walls_near(model, i) {
            add(reach - wall_gap(&position[i], usize::from(wall), bounds));
        }
    }
    sum / f64::from(count.max(1))
}

/// Moves floating grains out of the overlaps that they have; says whether some of them carry load
/// after all and were taken into the balance.
pub fn settle(model: &Model, state: &mut State, work: &mut Workspace) -> bool {
    if state.carries.iter().all(|&carries| carries) {
        return false;
    }
    let bounds = state.bounds(model);
    let mean = work.balance.sums.mean_force().max(work.negligible_force);
    let open = OPEN * model.solver.tolerance * mean;
    let Workspace { neighbours, rattlers, .. } = work;
    let mut joined = false;
    let mut listed = None;
    let mut sweep = 0;
    let mut falls = 0;
    while sweep <= SWEEPS && falls <= MOST_FALLS {
        neighbours.refresh(model, &state.position, &bounds);
        if listed != Some(neighbours.rebuilds) {
            let carries = &state.carries;
            let floats = |i: usize, j: usize, _| !carries[i] || !carries[j];
            rattlers.near.fill_pairs(neighbours, model, floats);
            listed = Some(neighbours.rebuilds);
        }
        let mut quiet = true;
        let mut falling = false;
        for i in 0..model.len() {
            if state.carries[i] {
                continue;
            }
            let heavy = weighs(model, i, mean);
            let near = rattlers.near.row(i);
            let site = Site { model, neighbours, near, bounds: &bounds, grain: i, heavy };
            match site.settle(&mut state.position, open) {
                Settled::Free => {}
                Settled::Falling if falls < MOST_FALLS => falling = true,
                // Grains that keep pushing each other about are left to the balance.
                Settled::Moved if sweep < SWEEPS => quiet = false,
                Settled::Falling | Settled::Moved | Settled::Caught => {
                    state.carries[i] = true;
                    joined = true;
                }
            }
        }
        // A fall takes as many sweeps as it is deep; they do not count.
        match falling {
            true => falls += 1,
            false if quiet => break,
            false => sweep += 1,
        }
    }
    joined
}

/// Under gravity and with friction: whether all that keeps the balance from its tolerance is grains
/// that nothing holds. Those are taken out of the balance, to roll or fall on their own until they are caught,
/// or to float where they have no weight or a negligible one among the contact forces.
pub fn release(model: &Model, state: &mut State, work: &mut Workspace) -> bool {
    let tolerance = model.solver.tolerance;
    let bounds = state.bounds(model);
    let Workspace { neighbours, balance, support, reference, .. } = work;
    support.clear();
    support.resize(model.len(), 0);
    for i in 0..model.len() {
        let first = neighbours.row(i).start;
        let row = &balance.links[first..first + balance.links_in_row[i] as usize];
        support[i] += row.len() as u32;
        if reference.membranes.press_on(i) {
            support[i] += PRESSED_ON;
        }
        for link in row {
            support[link.second as usize] += 1;
        }
        support[i] += match bounds.is_round() {
            false => balance.wall_stiffness[i].iter().filter(|&&k| k > 0.0).count() as u32,
            true => walls_under(model, state, neighbours, &bounds, i),
        };
    }
    let needed = model.contacts_to_carry();
    for (held, traction) in reference.contacts.iter().zip(&balance.tractions) {
        let holds = traction.live && !traction.slides;
        let bonded = held.is_bonded();
        if holds && (bonded || held.present_overlap(model, state) > 0.0) {
            let counts = if bonded { needed } else { 1 };
            support[held.first as usize] += counts;
            if let Other::Grain(j) = held.second {
                support[j as usize] += counts;
            }
        }
    }
    let mean_force = balance.sums.mean_force();
    let force = |i: usize| {
        let moment = balance.moment.get(i).map_or(0.0, Vec3::norm);
        balance.gradient[i].norm().max(moment)
    };
    let unbalanced = |i: usize| newton::residual(model, force(i), mean_force) > tolerance;
    let loose = |i: usize| {
        let weight = model.weight.get(i).map_or(0.0, Vec3::norm);
        support[i] < needed || !weighs(model, i, mean_force) && force(i) <= 2.0 * weight
    };
    let rest = (0..model.len()).filter(|&i| unbalanced(i)).all(loose);
    if rest {
        for i in (0..model.len()).filter(|&i| unbalanced(i)) {
            state.carries[i] = false;
        }
    }
    rest
}

/// Walls that grain `i` presses on; none where it takes no part in the balance.
fn walls_under(model: &Model, state: &State, near: &Neighbours, room: &Room, i: usize) -> u32 {
    let presses = |&(wall, reach): &(u8, f64)| {
        state.carries[i] && wall_gap(&state.position[i], usize::from(wall), room) < reach
    };
    near.walls_near(model, i).filter(presses).count() as u32
}

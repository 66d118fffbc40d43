//! Newton's method: the minimum of the potential over the grains and the walls that carry loads.
//!
//! The unknowns are the grains' freedoms v and the way e of every drive, which takes the grains along
//! affinely, x = v + X e. With the derivative H of the balance over the grains, and the drive's columns
//! C, a step is
//!
//! ```text
//! H v = -g - C e,    (S - C·H⁻¹C) e = -(Γ - C·H⁻¹g)
//! ```
//!
//! Where H is not positive definite the pack is on its way to another minimum. Then what is positive in it
//! takes its place for a few steps: without the parts by which contacts push their grains aside every
//! step goes downhill. How far is looked for along it ([`line`]).

use nalgebra::{SMatrix, SVector};

use super::act::Scenery;
use super::balance::Balance;
use super::boundary::{self, SIDES};
use super::line::{self, dot, longest};
use super::matrix::FREEDOMS;
use super::membrane::Membrane;
use super::reference::Joint;
use super::work::{Drive, Workspace};
use super::{DRIVES, floating, glue};
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::model::Model;
use crate::relax::{Outcome, Status};
use crate::scene::Method;
use crate::state::State;
use crate::wall;

/// Shift over the mean stiffness that is always there, so that grains which nothing holds on one side
/// stay where they are; its growth, and the largest.
const LEAST_SHIFT: f64 = 1e-7;
const GROWTH: f64 = 10.0;
const MOST_SHIFT: f64 = 1e3;
/// The same for the convex part, over the least; and steps for which it is taken where the whole is not
/// positive.
const CONVEX_SHIFT: f64 = 100.0;
const WAIT: u32 = 5;
/// Steps before a relaxation is given up, where the scene does not say: from grains that hardly touch to a
/// dense pack without friction takes some hundreds.
const MOST_STEPS: u32 = 5000;
/// Residual below which a minimum is near.
const NEAR: f64 = 1e-5;
/// Residual below which contacts that are open stay open.
pub(super) const OPENS: f64 = 1e-3;
/// Steps without a smaller residual after which rounding is what is left, and the residual from which on
/// that may be so.
const ROUNDED: f64 = 1e-6;
const PATIENCE: u32 = 30;

/// Scratch of a search.
#[derive(Clone, Debug, Default)]
pub(super) struct Search {
    /// Step of the grains, three numbers each.
    pub(super) step: Vec<f64>,
    /// H⁻¹ g, and H⁻¹ C of each drive.
    answers: [Vec<f64>; 1 + DRIVES],
    /// Where each drive takes the grains: X, three numbers a grain.
    pub(super) carried: [Vec<f64>; DRIVES],
    /// C of each drive.
    column: [Vec<f64>; DRIVES],
    /// Way of each drive \[m\].
    pub(super) way: [f64; DRIVES],
    /// Whether the step at hand is that of the convex part, and for how many steps more that is taken.
    convex: bool,
    waits: u32,
    /// Shift of the last step beside membranes, where it had to be more than the least \[N/m\].
    shift: f64,
    /// Whether the pack was met where it is no minimum.
    pub(super) concave: bool,
}

impl Search {
    pub(super) fn heap_bytes(&self) -> usize {
        let lists = self.carried.iter().chain(&self.column).chain(&self.answers);
        heap::bytes(&self.step) + lists.map(heap::bytes).sum::<usize>()
    }
}

/// Largest force that a grain is out of balance by \[N\].
pub(super) fn largest(balance: &Balance) -> f64 {
    longest(&balance.gradient)
}

/// What residuals are measured in \[N\]: the mean contact force, or what a load makes of it where
/// nothing touches yet.
pub(super) fn unit_force(model: &Model, work: &Workspace) -> f64 {
    let weight = if model.has_gravity() { model.gravity.norm() * heaviest(model) } else { 0.0 };
    let sums = &work.balance.sums;
    let load = |drive: &Drive| {
        let side = drive.shares.iter().position(|share| *share != 0.0).unwrap_or(0);
        let length = model.start.sides()[1 - wall::axis(side)];
        drive.force * 2.0 * model.mean_radius / length
    };
    let loads = work.drives.iter().map(load).fold(0.0, f64::max);
    let presses =
        |membrane: &Membrane| membrane.pressure * membrane.depth * 2.0 * model.mean_radius;
    let loads = work.membranes.iter().map(presses).fold(loads, f64::max);
    let least = model.least_force.max(work.negligible);
    sums.mean_force().max(weight).max(loads).max(least).max(f64::MIN_POSITIVE)
}

fn heaviest(model: &Model) -> f64 {
    (0..model.len()).map(|i| model.mass(i)).fold(0.0, f64::max)
}

/// Residual of the balance at the pose: largest unbalanced force of a grain or of a wall under a load
/// over the mean contact force.
pub(super) fn residual(model: &Model, work: &Workspace) -> f64 {
    let walls = work.unbalance(&work.balance).iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    let unbalanced = largest(&work.balance).max(walls);
    if unbalanced <= model.rounding_force { 0.0 } else { unbalanced / unit_force(model, work) }
}

/// Most steps of a relaxation, if the scene does not say.
pub(super) fn most_steps(model: &Model) -> u32 {
    model.solver.max_iterations.unwrap_or(MOST_STEPS)
}

/// Relaxes `state` from where it is in at most `most` steps; the pose and the reference are those of
/// `work`.
pub(super) fn relax(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
    most: u32,
) -> Outcome {
    let tolerance = model.solver.tolerance;
    let mut outcome = Outcome { status: Status::MaxIterations, ..Outcome::NONE };
    let (mut best, mut worse) = (f64::INFINITY, 0);
    (work.search.convex, work.search.waits, work.search.shift) = (false, 0, 0.0);
    work.search.concave = false;
    work.floating.begin(model.len());
    work.slope.begin();
    work.refresh(model, state, near);
    work.evaluate(model, state);
    for iteration in 0..=most {
        outcome.iterations = iteration;
        outcome.sums = work.balance.sums;
        outcome.residual = residual(model, work);
        if !outcome.residual.is_finite() {
            outcome.status = Status::NonFinite;
            return outcome;
        }
        if outcome.residual <= tolerance && !work.search.convex {
            if floating::rejoin(model, state, work) {
                work.refresh(model, state, near);
                work.evaluate(model, state);
                (best, worse) = (f64::INFINITY, 0);
                continue;
            }
            outcome.status = work.rest();
            return outcome;
        }
        if outcome.residual <= tolerance && worse > PATIENCE {
            // In balance, but on a ridge.
            outcome.status = Status::Unstable;
            return outcome;
        }
        if outcome.residual < best {
            (best, worse) = (outcome.residual, 0);
        } else {
            // On the way down from where there is no minimum residuals grow.
            worse += u32::from(!work.search.convex);
            // Far from a minimum residuals may rise for long.
            if worse > PATIENCE && best < ROUNDED {
                outcome.status = Status::Stalled;
                return outcome;
            }
        }
        let dropped = floating::drop_loose(model, state, work);
        // A grain that nothing but the shear of an open contact pulls at would have no balance.
        let opened = outcome.residual < OPENS && open(model, state, work);
        if floating::rejoin(model, state, work) || dropped || opened {
            work.evaluate(model, state);
            // Another balance: the way down begins anew.
            (best, worse) = (f64::INFINITY, 0);
        }
        if iteration == most {
            break;
        }
        if !step(model, state, work, near, outcome.residual) || !line::go(model, state, work) {
            outcome.status = Status::Unstable;
            return outcome;
        }
        if work.refresh(model, state, near) {
            work.slope.begin();
            work.evaluate(model, state);
        }
    }
    outcome
}

/// Takes shear from contacts that opened. Says whether there were any.
pub(super) fn open(model: &Model, state: &State, work: &mut Workspace) -> bool {
    let mut reference = std::mem::take(&mut work.reference);
    let any = reference.open(|joint| overlap(model, state, work, joint));
    work.reference = reference;
    any
}

/// Overlap of `joint` at the pose \[m\].
pub(super) fn overlap(model: &Model, state: &State, work: &Workspace, joint: &Joint) -> f64 {
    let at = work.pose.at[joint.first as usize];
    match joint.second {
        Other::Grain(j) if state.carries[j as usize] && state.carries[joint.first as usize] => {
            joint.reach - (at - work.pose.at[j as usize]).norm()
        }
        Other::Wall(b) if state.carries[joint.first as usize] => {
            work.bodies[usize::from(b)].near(at, model.radius[joint.first as usize]).overlap
        }
        _ => f64::NEG_INFINITY,
    }
}

/// Stiffness of a typical contact \[N/m\].
pub(super) fn stiffness(work: &Workspace) -> f64 {
    let sums = &work.balance.sums;
    // Where all bonds are pulled nothing overlaps.
    match sums.mean_force() > work.negligible && sums.overlap > 0.0 {
        true => 1.5 * sums.force / sums.overlap,
        false => work.slope.idle,
    }
}

/// Finds the step from the pose. Says whether there is one.
fn step(
    model: &Model,
    state: &State,
    work: &mut Workspace,
    near: &Neighbours,
    residual: f64,
) -> bool {
    let unit = stiffness(work);
    let least = LEAST_SHIFT * unit;
    work.search.convex = false;
    let assembled = work.search.waits == 0 || residual < NEAR;
    if assembled {
        assemble(model, state, work, near, false);
        if work.slope.matrix.factorise(least) && solve(state, work, least) {
            work.search.shift = 0.0;
            return true;
        }
        work.search.concave = true;
        work.search.waits = WAIT;
    }
    work.search.waits -= work.search.waits.min(1);
    // What membranes do has no convex part: there the whole is shifted until it is positive.
    work.search.convex = work.membranes.is_empty();
    let first = if work.search.convex { CONVEX_SHIFT * least } else { GROWTH * least };
    let mut shift = first.max(work.search.shift / (GROWTH * GROWTH));
    if work.search.convex || !assembled {
        assemble(model, state, work, near, false);
    }
    work.search.convex = true;
    while shift <= MOST_SHIFT * unit {
        if work.slope.matrix.factorise(shift) && solve(state, work, shift) {
            work.search.shift = if work.membranes.is_empty() { 0.0 } else { shift };
            return true;
        }
        shift *= GROWTH;
    }
    false
}

/// Takes the derivative at the pose; `goes_on` as [`Scenery`] has it.
pub(super) fn assemble(
    model: &Model,
    state: &State,
    work: &mut Workspace,
    near: &Neighbours,
    goes_on: bool,
) {
    let Some(setup) = &model.plane else { return };
    let Workspace { reference, bodies, membranes, slope, pose, search, .. } = work;
    let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
    slope.assemble(&Scenery { goes_on, ..scenery }, pose, search.convex);
    if work.lacks_pairs() {
        work.couple(near);
    }
    let bounds = state.bounds(model);
    for (k, drive) in work.drives.iter().enumerate() {
        let carried = &mut work.search.carried[k];
        carried.clear();
        for (i, at) in work.pose.at.iter().enumerate() {
            let way = match glue::side(&state.glued, i).map(usize::from) {
                Some(side) => work.bodies[side].slide * drive.shares[side],
                None => boundary::carried(model, &bounds, state.tilt, &drive.shares, *at),
            };
            carried.extend([way.x, way.y, 0.0]);
        }
        let column = &mut work.search.column[k];
        column.clear();
        column.resize(carried.len(), 0.0);
        work.slope.multiply(carried, (&work.reference, &work.links), column);
        for (side, &share) in drive.shares.iter().enumerate().filter(|(_, share)| **share != 0.0) {
            column.iter_mut().zip(&work.slope.columns[side]).for_each(|(to, c)| *to += share * c);
        }
        // Grains that float go with the walls.
        for (own, _) in column.chunks_exact_mut(FREEDOMS).zip(&state.carries).filter(|(_, c)| !**c)
        {
            own.fill(0.0);
        }
    }
    glue::stiffen(&state.glued, &mut work.slope);
}

/// Solves with the factors at hand for the balance at the pose. Says whether the walls under loads are
/// held by the pack.
pub(super) fn solve(state: &State, work: &mut Workspace, shift: f64) -> bool {
    let count = work.drives.len();
    let unbalance = work.unbalance(&work.balance);
    let Workspace { slope, search, balance, drives, .. } = work;
    let rights = std::iter::once(&balance.gradient).chain(&search.column);
    for (answer, right) in search.answers.iter_mut().zip(rights).take(1 + count) {
        answer.clear();
        answer.extend_from_slice(right);
        glue::clear(&state.glued, answer);
    }
    slope.matrix.solve(&mut search.answers[..=count]);
    search.answers[..=count].iter_mut().for_each(|answer| glue::clear(&state.glued, answer));
    let [newton, responses @ ..] = &search.answers;
    let mut stiff = SMatrix::<f64, DRIVES, DRIVES>::identity();
    let mut load = SVector::<f64, DRIVES>::zeros();
    for k in 0..count {
        let (x, c) = (&search.carried[k], &search.column[k]);
        load[k] = -(unbalance[k] + dot(x, &balance.gradient) - dot(c, newton));
        for l in 0..count {
            // X·HX + X·C of the drive's own columns is X·C̃; the rest is the walls' own.
            let own: f64 = (0..SIDES)
                .map(|side| {
                    let (a, b) = (drives[k].shares[side], drives[l].shares[side]);
                    let column = &slope.columns[side];
                    let cross = if a == 0.0 { 0.0 } else { a * dot(column, &search.carried[l]) };
                    cross + a * b * slope.corner[side]
                })
                .sum();
            stiff[(k, l)] = dot(x, &search.column[l]) + own - dot(c, &responses[l]);
        }
        stiff[(k, k)] += shift;
    }
    let Some(factors) = stiff.cholesky() else { return false };
    let way = factors.solve(&load);
    search.way = way.into();
    search.step.clear();
    search.step.extend(newton.iter().map(|v| -v));
    for k in 0..count {
        let response = responses[k].iter();
        search.step.iter_mut().zip(response).for_each(|(v, z)| *v -= z * way[k]);
    }
    true
}

/// Takes a first step from the pose, where the walls have just taken the grains along, as if every
/// contact went on as in the last increment: what stuck sticks, what slid slides.
pub(super) fn predict(model: &Model, state: &mut State, work: &mut Workspace, near: &Neighbours) {
    let Some(setup) = &model.plane else { return };
    boundary::bodies(model, &state.displacement, state.tilt, &mut work.bodies);
    let Workspace { reference, bodies, membranes, balance, pose, .. } = work;
    let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
    balance.evaluate(&Scenery { goes_on: true, ..scenery }, pose);
    work.search.convex = false;
    assemble(model, state, work, near, true);
    let shift = LEAST_SHIFT * stiffness(work);
    if !work.slope.matrix.factorise(shift) || !solve(state, work, shift) {
        return;
    }
    let share = line::longest_share(model, state, work);
    line::try_share(model, state, work, share);
    std::mem::swap(&mut work.pose, &mut work.trial);
    state.displacement = work.trial_displacement;
}

/// Estimate of the largest error of a wall's normal force \[N\]: what a last step with the factors at
/// hand would change, and what rounding may. Motion has no factors: it takes a whole step from its end.
pub(super) fn wall_force_error(
    model: &Model,
    state: &State,
    work: &mut Workspace,
    near: &Neighbours,
) -> f64 {
    let sums = work.balance.sums;
    if sums.contacts == 0 {
        return 0.0;
    }
    let bounds = state.bounds(model);
    let far =
        bounds.min[..2].iter().chain(&bounds.max[..2]).fold(0.0_f64, |far, x| far.max(x.abs()));
    let rounding = stiffness(work) * far * f64::EPSILON * f64::from(sums.contacts).sqrt();
    if model.solver.method == Method::Dynamic {
        return rounding + last_step(model, state, work, near);
    }
    let Workspace { slope, search, balance, .. } = work;
    if !slope.matrix.is_factorised() {
        return rounding;
    }
    let answer = &mut search.answers[0];
    answer.clear();
    answer.extend_from_slice(&balance.gradient);
    slope.matrix.solve(&mut search.answers[..1]);
    glue::clear(&state.glued, &mut search.answers[0]);
    glue::add_columns(state, &work.bodies, &work.reference, slope);
    let change = |column: &Vec<f64>| dot(column, &search.answers[0]).abs();
    rounding + slope.columns.iter().map(change).fold(0.0, f64::max)
}

/// Largest change of what a side is pressed with in a step from the pose \[N\].
fn last_step(model: &Model, state: &State, work: &mut Workspace, near: &Neighbours) -> f64 {
    work.search.convex = false;
    assemble(model, state, work, near, false);
    let unit = stiffness(work);
    let mut shift = LEAST_SHIFT * unit;
    while !(work.slope.matrix.factorise(shift) && solve(state, work, shift)) {
        shift *= GROWTH;
        if shift > MOST_SHIFT * unit {
            return f64::INFINITY;
        }
    }
    let Workspace { slope, search, bodies, reference, drives, .. } = work;
    let Search { step, carried, way, .. } = search;
    for (x, way) in carried.iter().zip(way.iter()).take(drives.len()) {
        step.iter_mut().zip(x).for_each(|(to, x)| *to += x * way);
    }
    glue::clear(&state.glued, step);
    glue::add_columns(state, bodies, reference, slope);
    let change = |side: usize| {
        let own = drives.iter().zip(way.iter()).map(|(drive, way)| drive.shares[side] * way);
        dot(&slope.columns[side], step) + slope.corner[side] * own.sum::<f64>()
    };
    (0..SIDES).map(|side| change(side).abs()).fold(0.0, f64::max)
}

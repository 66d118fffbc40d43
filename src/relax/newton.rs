//! Newton's method on the energy: linearise, solve by conjugate gradients, accept what descends.

use crate::Vec3;
use crate::model::Model;
use crate::relax::balance::Balance;
use crate::relax::linear::Inner;
use crate::relax::servo::{self, Motion};
use crate::relax::{Status, Workspace, rattlers};
use crate::state::State;
use crate::wall::Room;

/// First shift of a grain, and the one below which it is dropped, over the sum of P/r of a grain.
const FIRST_SHIFT: f64 = 0.02;
/// Shifted steps in a row after which the configuration counts as unstable, without friction and
/// with it: a grain that hardly touches anything is then dragged along in steps of the cap.
const MOST_SHIFTED: [u32; 2] = [40, 150];
/// Residual at which floating grains are moved out of the way for the first time.
const SETTLE: f64 = 1e-3;
/// Once the energy was concave a grain may go this many mean overlaps from where it started.
const LEAP: f64 = 1.0;
/// Steps between two looks for grains that nothing holds.
const PATIENCE: u32 = 20;
/// What whole steps divide the shifts by, without friction; with it they drop them.
const RELIEF: f32 = 4.0;
/// With friction a grain is loose whose unbalanced force is this many times the root mean square,
/// and this share of that is what is left of it.
const LOOSE: f64 = 4.0;
pub(super) const LOOSE_AIM: f64 = 2.5e-3;
/// With friction every step is damped as if moving by the cap took this share of the root mean
/// square of the unbalanced forces: groups of grains that nothing holds stay where they are.
const DAMPING: f64 = 0.03;
/// Least damping of cemented packs over the reference stiffness: where bonds broke some grains hang on
/// so little that single precision does not resolve it. After [`PATIENCE`] it is halved in every
/// step: what is unstable must get away.
const CEMENT_DAMPING: f32 = 1e-6;
/// Reduction of the residual of the step that takes contacts to stick.
const PREDICTION: f64 = 0.1;
/// Reduction of the residual that is asked of a linear solve: the least, without friction and
/// loads and with either, where it costs less than another linearisation, and the most.
const FORCING: [f64; 2] = [0.1, 0.02];
const MOST_FORCING: f64 = 0.5;
/// Shifts tried in one step.
const MOST_SHIFTS: u32 = 60;
/// Most that one linear solve may take.
const MOST_PRODUCTS: u32 = 4000;
/// Slopes that differ by this share are the same: a constant force up to rounding.
const FLAT: f64 = 1e-6;
/// Halvings of a step before it is shortened by a shift.
const HALVINGS: u32 = 6;
/// Shifted steps beyond convergence before a state counts as a minimum all the same.
const EXTRA_STEPS: u32 = 4;

/// Longest Newton step with friction over the mean overlap: beyond it the contacts that slide are
/// others.
const FRICTIONAL_CAP: f64 = 0.03;

/// What a Newton solve came to.
#[derive(Clone, Copy, Debug)]
pub struct Solved {
    /// How it ended.
    pub status: Status,
    /// Largest unbalanced force over the mean contact force.
    pub residual: f64,
    /// Steps.
    pub iterations: u32,
}

/// Relaxes the grains of `state` that carry load.
pub fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    let tolerance = model.solver.tolerance;
    let mut iterations = 0;
    let mut extra = 0;
    work.shift.clear();
    work.shift.resize(model.len(), 0.0);
    work.loose.begin(model.len());
    work.adjacency.begin();
    let mut shifted = false;
    let mut in_a_row = 0;
    let mut settled = false;
    work.servo.search();
    work.evaluate(model, state, &state.bounds(model));
    loop {
        let bounds = state.bounds(model);
        let sums = work.balance.sums;
        let largest = work.balance.largest();
        let mean_force = sums.mean_force();
        let residual = residual(model, largest, mean_force).max(work.servo.residual(
            &work.balance.unbalance,
            &bounds,
            mean_force,
        ));
        let end = move |status| Solved { status, residual, iterations };
        if !(largest.is_finite() && sums.energy.is_finite()) {
            return end(Status::NonFinite);
        }
        if !model.has_gravity() && mean_force < work.negligible_force {
            if work.servo.is_active() {
                // No position nearby carries the loads.
                return end(Status::Unstable);
            }
            return Solved { residual: 0.0, ..end(Status::Unjammed) };
        }
        let patient = iterations > 0 && iterations % PATIENCE == 0;
        let may_release = model.has_gravity() || work.reference.active;
        if patient && may_release && rattlers::release(model, state, work) {
            return end(Status::Converged);
        }
        if residual <= tolerance {
            // A state reached by a shifted step may still be a saddle: look once more.
            if !shifted || extra == EXTRA_STEPS {
                work.near_minimum = iterations > 0 && !shifted;
                return end(Status::Converged);
            }
            extra += 1;
        }
        if !settled && tolerance < residual && residual <= SETTLE {
            // Grains that turn out to carry load are better found before the balance is fine.
            settled = true;
            let list = work.neighbours.rebuilds;
            // Grains that were moved may have taken another list, which is not that of the balance.
            if rattlers::settle(model, state, work) || work.neighbours.rebuilds != list {
                work.evaluate(model, state, &bounds);
                continue;
            }
        }
        if iterations >= model.solver.most_iterations() {
            return end(Status::MaxIterations);
        }
        iterations += 1;
        if work.reference.active {
            find_loose(model, work);
        }
        work.assemble(model);
        let least = FORCING[usize::from(work.reference.active || work.servo.is_active())];
        let forcing = (0.3 * tolerance / residual).clamp(least, MOST_FORCING);
        let least_damping = match work.reference.is_cemented() {
            true => CEMENT_DAMPING * 0.5_f32.powi(iterations.saturating_sub(PATIENCE) as i32),
            false => 0.0,
        };
        match step(model, state, work, &bounds, (forcing, least_damping), largest) {
            Some(used) => shifted = used,
            None if work.concave && work.follows => return end(Status::Unstable),
            // Rounding leaves nothing to descend: looking once more found no other minimum.
            None if residual <= tolerance => return end(Status::Converged),
            None => return end(Status::Stalled),
        }
        if work.servo.ran_away() || work.concave && work.follows && leapt(model, state, work) {
            return Solved { iterations, ..end(Status::Unstable) };
        }
        in_a_row = if shifted { in_a_row + 1 } else { 0 };
        if in_a_row > MOST_SHIFTED[usize::from(work.reference.active)] {
            if may_release && rattlers::release(model, state, work) {
                return end(Status::Converged);
            }
            return Solved { iterations, ..end(Status::Unstable) };
        }
    }
}

/// Takes the grains as loose that are much further from their balance than the others.
fn find_loose(model: &Model, work: &mut Workspace) {
    let Workspace { balance, loose, reference, .. } = work;
    let limit = least_loose(model, balance).powi(2);
    for (i, (force, moment)) in balance.gradient.iter().zip(&balance.moment).enumerate() {
        let far = force.norm_squared().max(moment.norm_squared()) > limit;
        // One by one grains do not feel the pressure of a membrane.
        if far && !reference.membranes.press_on(i) {
            loose.add(i);
        }
    }
}

/// Least unbalanced force of a grain that is loose \[N\]; one within the tolerance is not.
pub(super) fn least_loose(model: &Model, balance: &Balance) -> f64 {
    let enough = model.solver.tolerance * balance.sums.mean_force();
    (LOOSE * mean_square(balance).sqrt()).max(enough)
}

/// Whether a grain that carries load is far from where it started: a shifted step goes downhill,
/// but after many of them the pack may be in another basin than the flow leads to.
fn leapt(model: &Model, state: &State, work: &Workspace) -> bool {
    let far = (LEAP * work.balance.sums.mean_overlap()).powi(2);
    let moved = work.origin.moved(model, state);
    moved.zip(&state.carries).any(|(moved, &carries)| carries && moved.norm_squared() > far)
}

/// Takes one step as if contacts that stuck would stick on: moving with the walls without turning
/// makes grains slide that in truth roll, and it takes long to find out which.
pub(super) fn predict(model: &Model, state: &mut State, work: &mut Workspace) {
    work.reference.sticks = true;
    work.evaluate(model, state, &state.bounds(model));
    work.assemble(model);
    work.reference.sticks = false;
    work.shift.clear();
    work.shift.resize(model.len(), 0.0);
    let largest = work.balance.largest();
    if largest == 0.0 || work.solve(largest, PREDICTION, MOST_PRODUCTS) != Inner::Step {
        return;
    }
    let longest = work.balance.sums.mean_overlap();
    cut_to(&mut work.step, &mut work.turn, longest);
    work.servo.search();
    work.reference.sticks = true;
    servo::drive(model, state, work, &state.bounds(model), longest);
    work.reference.sticks = false;
    for i in 0..model.len() {
        state.position[i] += work.step[i];
        state.rotation[i] += work.turn[i] / model.radius[i];
    }
    state.displacement = work.servo.displaced(&state.displacement, 1.0);
}

/// Cuts steps and turns to `longest` \[m\].
fn cut_to(step: &mut [Vec3], turn: &mut [Vec3], longest: f64) {
    for (step, turn) in step.iter_mut().zip(turn) {
        let length = step.norm().max(turn.norm());
        if length > longest {
            *step *= longest / length;
            *turn *= longest / length;
        }
    }
}

/// What residuals are measured in \[N\]: the mean contact force, or what stands for it.
pub(super) fn unit_force(model: &Model, mean_force: f64) -> f64 {
    let weight = model.weight.iter().map(Vec3::norm).fold(0.0, f64::max);
    mean_force.max(weight).max(model.least_force).max(f64::MIN_POSITIVE)
}

/// Largest unbalanced force over the mean contact force; weights count where nothing touches.
pub(super) fn residual(model: &Model, largest: f64, mean_force: f64) -> f64 {
    if largest < model.rounding_force {
        return 0.0;
    }
    largest / unit_force(model, mean_force)
}

/// Takes one accepted step; says whether it was shifted, `None` when no step descends.
///
/// Where the energy is concave the whole Hessian is shifted, and the step leads downhill the way
/// an overdamped specimen would go. Where a grain would move further than the linearisation
/// holds, its own block alone is shifted: one grain on the jump must not stop the others. With
/// friction such a grain is loose: its step is cut, and the rest is found from where that ends.
fn step(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    bounds: &Room,
    (forcing, least_damping): (f64, f32),
    largest: f64,
) -> Option<bool> {
    let sums = work.balance.sums;
    // Without contacts (grains that fall) any positive stiffness will do.
    let bending = (2.0 * sums.bending / (model.len() as f64 * work.reference_stiffness)).max(1e-9);
    let first = (FIRST_SHIFT * bending) as f32;
    work.first_shift.clear();
    match work.reference.active {
        false => work.first_shift.resize(model.len(), first),
        // A grain that hardly touches anything is not to be held as if it carried what others do.
        true => work.first_shift.extend(work.coupled.bending().map(|b| FIRST_SHIFT as f32 * b)),
    }
    let slides = work.reference.active && !work.reference.smooth;
    let cap = (if slides { FRICTIONAL_CAP } else { work.step_cap })
        * if sums.contacts > 0 { sums.mean_overlap() } else { 0.1 * model.mean_radius };
    let damping = match work.reference.active {
        false => 0.0,
        true => {
            let force = DAMPING * mean_square(&work.balance).sqrt();
            ((force / (cap * work.reference_stiffness)) as f32).max(least_damping)
        }
    };
    let mut yields = false;
    for _ in 0..MOST_SHIFTS {
        for shift in &mut work.shift {
            *shift = shift.max(damping);
        }
        let inner = match largest > 0.0 {
            true => work.solve(largest, forcing, MOST_PRODUCTS),
            false => work.rest(),
        };
        if inner == Inner::NegativeCurvature {
            work.concave = true;
            let concave = |i: usize| work.reference.active && work.coupled.curvature(i) < 0.0;
            let some = (0..model.len()).any(concave);
            for i in (0..model.len()).filter(|&i| !some || concave(i)) {
                work.shift[i] = (4.0 * work.shift[i]).max(work.first_shift[i]);
            }
            continue;
        }
        let shortened = work.reference.active && cut(work, cap);
        if !work.reference.active && hold_back(work, cap) {
            continue;
        }
        if servo::drive(model, state, work, bounds, cap) == Motion::Yielding {
            work.servo.renew();
            yields = true;
        }
        let shifted = shortened || work.shift.iter().any(|&shift| shift > damping);
        let Some(whole) = search(model, state, work, bounds) else {
            for (shift, first) in work.shift.iter_mut().zip(&work.first_shift) {
                *shift = (4.0 * *shift).max(*first);
            }
            continue;
        };
        for (shift, first) in work.shift.iter_mut().zip(&work.first_shift) {
            *shift = match () {
                () if !whole => *shift,
                () if *shift <= *first || work.reference.active => 0.0,
                () => *shift / RELIEF,
            };
        }
        return Some(shifted || yields);
    }
    None
}

/// Shifts the blocks of the grains whose step is longer than `cap` \[m\]; says whether there are any.
fn hold_back(work: &mut Workspace, cap: f64) -> bool {
    let Workspace { step, shift, first_shift, .. } = work;
    let mut any = false;
    for ((step, shift), first) in step.iter().zip(shift).zip(&*first_shift) {
        if step.norm() > cap {
            *shift = (4.0 * *shift).max(*first);
            any = true;
        }
    }
    any
}

/// Cuts the steps longer than `cap` \[m\] and takes those grains as loose; says whether there are any.
fn cut(work: &mut Workspace, cap: f64) -> bool {
    let Workspace { step, turn, loose, reference, .. } = work;
    let mut any = false;
    for (i, (step, turn)) in step.iter_mut().zip(turn).enumerate() {
        let length = step.norm().max(turn.norm());
        if length > cap {
            *step *= cap / length;
            *turn *= cap / length;
            if !reference.membranes.press_on(i) {
                loose.add(i);
            }
            any = true;
        }
    }
    any
}

/// Backtracks along the step; says whether the whole step was taken, `None` when nothing descends.
fn search(model: &Model, state: &mut State, work: &mut Workspace, bounds: &Room) -> Option<bool> {
    let before = work.balance.potential();
    let slope = work.slope(&work.balance);
    let square: f64 = square(&work.balance);
    // With friction the balance is taken in the current geometry and the potential follows it to
    // the strain.
    let flat = if work.reference.active { f64::INFINITY } else { 1e-10 };
    let potential = model.has_potential();
    let mut factor = 1.0;
    for _ in 0..=HALVINGS {
        match work.reference.active {
            false => work.try_step(model, state, factor),
            true => work.try_settled_step(model, state, factor),
        }
        let after = &work.trial_balance;
        let change = after.potential() - before - loads(model, state, work, bounds, factor);
        let size = before.abs().max(after.potential().abs());
        let accepted = slope < 0.0
            && ((potential && change <= 1e-4 * factor * slope)
                || (change.abs() <= flat * size && work.slope(after).abs() <= 0.9 * slope.abs())
                // Against friction alone the force stays as it is until something else resists; of
                // a grain that hardly touches anything the potential does not tell.
                || (work.reference.active
                    && (!potential || change.abs() <= 1e-10 * size)
                    && (slope * (1.0 + FLAT)..0.0).contains(&work.slope(after)))
                || (change.abs() <= 1e-13 * size && self::square(after) < square));
        if accepted {
            work.accept(state);
            work.servo.took(bounds, factor);
            return Some(factor == 1.0);
        }
        factor *= 0.5;
    }
    // The list may have been made for a trial that was refused.
    work.neighbours.refresh(model, &state.position, bounds);
    None
}

/// Work of the loads of walls on the way to the configuration on trial \[J\]. Weights have their
/// potential against the centre of the box, which moves with its walls.
fn loads(model: &Model, state: &State, work: &Workspace, bounds: &Room, factor: f64) -> f64 {
    if !work.servo.is_active() {
        return 0.0;
    }
    let after = model.bounds(&work.trial_displacement);
    let moved = Vec3::from(after.center()) - Vec3::from(bounds.center());
    let weights = model.weight.iter().zip(&state.carries).filter(|&(_, &carries)| carries);
    let sunk: f64 = weights.map(|(weight, _)| weight.dot(&moved)).sum();
    work.servo.work(bounds, &after, factor) + sunk
}

/// Mean over the grains of the squares of the unbalanced forces \[N²\].
pub(super) fn mean_square(balance: &Balance) -> f64 {
    square(balance) / balance.gradient.len().max(1) as f64
}

/// Sum of the squares of the unbalanced forces.
pub(super) fn square(balance: &Balance) -> f64 {
    balance.gradient.iter().chain(&balance.moment).map(Vec3::norm_squared).sum()
}

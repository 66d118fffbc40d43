//! How far the wall forces of an equilibrium may be from those of the exact one.
//!
//! The state x is off the exact equilibrium of its branch by s = -H⁻¹ g, up to terms of second
//! order, and the normal force of wall w by a·s, where a = dF/dx has the stiffnesses of the wall's
//! contacts. One more linear solve gives both terms of the estimate 2 max|a·s| + 0.1 √(k g·H⁻¹g):
//! the first is the error itself, as well as a loose solve knows it. The second is a bound:
//! (a·s)² <= (a·H⁻¹a) (g·H⁻¹g) by Cauchy and Schwarz, and a·H⁻¹a is at most the sum k of those
//! stiffnesses, because a stable pack resists its wall. A tenth of it covers what the solve has not
//! found. `docs/accuracy.md` has the measurements behind the factors.

use crate::contact::Other;
use crate::contact::hertz;
use crate::contact::neighbours::wall_gap;
use crate::model::Model;
use crate::relax::balance::Sums;
use crate::relax::linear::Inner;
use crate::relax::tangential::Traction;
use crate::relax::{Outcome, Status, Workspace, two_step};
use crate::state::State;
use crate::wall;

/// Reduction of the preconditioned residual, and most products that it may take.
const FORCING: f64 = 0.3;
const MOST_PRODUCTS: u32 = 20;
/// Share of the predicted change, and of its bound.
const PREDICTED: f64 = 2.0;
const BOUND: f64 = 0.1;
/// First shift of a state that is no minimum, over the mean sum of P/r of a grain; times what it
/// grows, and how often.
const FIRST_SHIFT: f64 = 0.02;
const GROWTH: f32 = 4.0;
const MOST_SHIFTS: u32 = 20;

/// Estimate of the largest error of the normal force on a wall \[N\], against the exact
/// equilibrium of the branch that `state` is on; `here` is the outcome that led to it. Infinite
/// where the linearised balance says nothing.
///
/// To be taken while the reference is still the one that led to the equilibrium.
#[must_use]
pub fn wall_force_error(model: &Model, state: &State, work: &mut Workspace, here: &Outcome) -> f64 {
    let sums = &here.sums;
    if here.status == Status::Unjammed {
        // The exact forces are zero: all that is left is the error.
        return sums.force;
    }
    if !work.near_minimum {
        // The neighbour list may have been made anew since the balance was taken.
        work.evaluate(model, state, &state.bounds(model));
    }
    let largest = work.balance.largest();
    if largest == 0.0 {
        return rounding(model, state, work, sums);
    }
    if !predict(model, work, largest) {
        return f64::INFINITY;
    }
    let Change { force, stiffness } = change(model, state, work);
    let energy = (-work.slope(&work.balance)).max(0.0);
    PREDICTED * force
        + BOUND * (stiffness * energy).sqrt()
        + rounding(model, state, work, sums)
        + two_step::departure(model, state)
}

/// Solves for the step to the equilibrium, with a shift where the state is no minimum; says whether
/// there is one.
fn predict(model: &Model, work: &mut Workspace, largest: f64) -> bool {
    // The last step of the search was so small that its linearisation is that of the state.
    if work.near_minimum && work.solve_as_it_is(largest, FORCING, MOST_PRODUCTS) == Inner::Step {
        return true;
    }
    work.shift.clear();
    work.shift.resize(model.len(), 0.0);
    work.assemble(model);
    let bending = 2.0 * work.balance.sums.bending / (model.len() as f64 * work.reference_stiffness);
    let first = (FIRST_SHIFT * bending.max(1e-9)) as f32;
    for _ in 0..MOST_SHIFTS {
        if work.solve(largest, FORCING, MOST_PRODUCTS) == Inner::Step {
            return true;
        }
        let next = (GROWTH * work.shift[0]).max(first);
        work.shift.fill(next);
    }
    false
}

/// What the step does to the walls.
struct Change {
    /// Largest change of a normal force \[N\].
    force: f64,
    /// Largest sum of the stiffnesses of a wall's contacts \[N/m\].
    stiffness: f64,
}

fn change(model: &Model, state: &State, work: &Workspace) -> Change {
    let bounds = state.bounds(model);
    let mut force = [0.0_f64; wall::COUNT];
    let mut stiffness = [0.0; wall::COUNT];
    for i in (0..model.len()).filter(|&i| state.carries[i]) {
        for (wall, reach) in work.neighbours.walls_near(model, i) {
            let w = usize::from(wall);
            let overlap = reach - wall_gap(&state.position[i], w, &bounds);
            if overlap > 0.0 {
                let k = hertz::stiffness(work.neighbours.wall_modulus(i, w), overlap);
                stiffness[w] += k;
                force[w] -= k * work.step[i].dot(&bounds.normal(&state.position[i], w));
            }
        }
    }
    for (held, traction) in work.reference.contacts.iter().zip(&work.balance.tractions) {
        if let (Other::Wall(wall), true) = (held.second, held.is_bonded()) {
            let (w, k) = (usize::from(wall), f64::from(traction.axial));
            stiffness[w] += k;
            let i = held.first as usize;
            force[w] -= k * work.step[i].dot(&bounds.normal(&state.position[i], w));
        }
    }
    let largest = |list: [f64; wall::COUNT]| list.into_iter().fold(0.0, f64::max);
    Change { force: largest(force.map(f64::abs)), stiffness: largest(stiffness) }
}

/// What double precision leaves undecided \[N\]: every contact's force is off by its stiffness
/// times the rounding of a coordinate, in no order.
fn rounding(model: &Model, state: &State, work: &Workspace, sums: &Sums) -> f64 {
    if sums.contacts == 0 {
        return 0.0;
    }
    let bounds = state.bounds(model);
    let far = bounds.min.iter().chain(&bounds.max).fold(0.0_f64, |far, x| far.max(x.abs()));
    // 3/2 P/h of all contacts together.
    let hertz = 1.5 * sums.force / sums.overlap;
    // Cement may resist without carrying anything.
    let axial = |t: &Traction| f64::from(t.axial);
    let stiffness = work.balance.tractions.iter().map(axial).fold(hertz, f64::max);
    stiffness * far * f64::EPSILON * f64::from(sums.contacts).sqrt()
}

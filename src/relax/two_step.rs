//! An increment of a cemented pack in two linear steps (T A.2.2).
//!
//! Step I fixes the directions of the loads, the stiffnesses and the network as they are at the
//! reference and solves for the displacements. Step II does so anew where that led, with the walls
//! as they are. Loads are the sums of the linear increments (4.1, 4.5, 4.7): unlike the effective
//! laws in the geometry at the end, which they follow to second order in the increment.
//!
//! Contacts without cement are linear in a step too, with Hertz' stiffness, and stick. Between steps
//! their normal force is Hertz' and their tangential one is cut to its limit; the next step balances
//! what that leaves. What touches for the first time in a step counts from the next one on.
//!
//! The linear balance is solved by conjugate gradients with the blocks of the grains as
//! preconditioner; walls under loads are unknowns like the grains.

mod coordinates;
mod network;

use crate::Vec3;
use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::relax::tangential::Changes;
use crate::relax::{Outcome, Status, Workspace, newton, rattlers};
use crate::state::State;
use crate::wall;
use coordinates::Coordinates;
use network::{Count, Network, Walls};

/// Most products of a step where the scene does not say: as many, and as many more a grain. Without
/// rounding there would be six a grain.
const MOST_PRODUCTS: [u32; 2] = [1000, 12];
/// Times that the search begins anew from the forces that are really left, before what is left is
/// taken for rounding.
const REFRESHES: u32 = 20;
/// Share of the tolerance that a search goes down to: what is really left is a little more.
const AIM: f64 = 0.3;

/// Scratch of the two steps.
#[derive(Clone, Debug, Default)]
pub struct TwoStep {
    /// Centres \[m\] and inward displacements of the walls \[m\] at the reference.
    position: Vec<Vec3>,
    displacement: [f64; wall::COUNT],
    network: Network,
    /// θ.
    x: Coordinates,
    /// Forces that θ leaves.
    left: Coordinates,
    direction: Coordinates,
    product: Coordinates,
    preconditioned: Coordinates,
    /// What the last increment did to the contacts.
    pub(super) changes: Changes,
    /// Products of a stiffness with a vector.
    pub(super) products: u64,
}

/// Why a step has no solution.
struct Failure {
    status: Status,
    residual: f64,
}

impl TwoStep {
    /// Takes `state` as the reference.
    pub(super) fn begin(&mut self, state: &State) {
        self.position.clone_from(&state.position);
        self.displacement = state.displacement;
    }

    pub(super) fn heap_bytes(&self) -> usize {
        let lists = [&self.x, &self.left, &self.direction, &self.product, &self.preconditioned];
        heap::bytes(&self.position)
            + self.network.heap_bytes()
            + lists.into_iter().map(Coordinates::heap_bytes).sum::<usize>()
    }

    /// Solves for the θ that leaves no force, from the one at hand. `state` is the reference.
    fn solve(
        &mut self,
        model: &Model,
        state: &State,
        walls: &Walls<'_>,
        most: u32,
    ) -> Result<u32, Failure> {
        let Self { network, x, left, direction, product, preconditioned, products, .. } = self;
        let carries = &state.carries;
        let (shifts, turns) = (x.shift.len(), x.turn.len());
        network.factorise(model, walls.drives);
        preconditioned.clear(shifts, turns);
        direction.clear(shifts, turns);
        let (mut iterations, mut now) = (0, f64::NAN);
        let fail = |status, residual| Err(Failure { status, residual });
        for _ in 0..REFRESHES {
            network.forces(model, carries, walls, (x, Count::Loads), left);
            let mean_force = network.mean_force(model, walls, x);
            now = residual(model, walls, left, mean_force);
            if !now.is_finite() {
                return fail(Status::NonFinite, now);
            }
            if now <= model.solver.tolerance {
                return Ok(iterations);
            }
            let mut before = 0.0;
            while residual(model, walls, left, mean_force) > AIM * model.solver.tolerance {
                if iterations == most {
                    return fail(Status::MaxIterations, residual(model, walls, left, mean_force));
                }
                iterations += 1;
                network.precondition(left, preconditioned);
                let along = left.dot(preconditioned);
                let beta = if before > 0.0 { along / before } else { 0.0 };
                direction.combine(beta, 1.0, preconditioned);
                before = along;
                *products += 1;
                network.forces(model, carries, walls, (direction, Count::Changes), product);
                let curvature = -direction.dot(product);
                if curvature.is_nan() || curvature <= 0.0 {
                    // Nothing resists in this direction.
                    break;
                }
                let alpha = along / curvature; // (A.5)
                x.add(alpha, direction);
                left.add(alpha, product);
            }
        }
        fail(Status::Stalled, now)
    }
}

/// Largest force of `left` on a grain over `mean_force` \[N\], or on a drive over its load.
fn residual(model: &Model, walls: &Walls<'_>, left: &Coordinates, mean_force: f64) -> f64 {
    let loads = walls.drives.iter().zip(left.drive).map(|(drive, left)| {
        left.abs() / drive.goal(walls.bounds).max(mean_force).max(model.least_force)
    });
    // No coordinate rounds the loads, so that there is no floor.
    let grains = left.largest() / newton::unit_force(model, mean_force);
    loads.fold(grains, |most, x| if x > most || x.is_nan() { x } else { most })
}

/// Solves the increment of `state` from where `work` began to where its walls and, as the first
/// guess, its grains are. On a status that is no equilibrium the state is not to be used.
///
/// The residual is that of the loads turned with the contacts to where the second step ended.
pub(super) fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let [least, a_grain] = MOST_PRODUCTS;
    let most = least.saturating_add(a_grain.saturating_mul(model.len() as u32));
    let most = model.solver.max_iterations.unwrap_or(most);
    let to = state.displacement;
    let two = &mut work.two_step;
    let moved = std::array::from_fn(|w| to[w] - two.displacement[w]);
    two.changes = Changes::default();
    two.x.clear(model.len(), state.rotation.len());
    for ((x, at), from) in two.x.shift.iter_mut().zip(&mut state.position).zip(&two.position) {
        *x = *at - from;
        *at = *from;
    }
    state.displacement = two.displacement;
    rattlers::find(model, state, work);
    let mut iterations = 0;
    for moved in [moved, [0.0; wall::COUNT]] {
        match step(model, state, work, moved, most) {
            Ok(products) => iterations += products,
            Err(Failure { status, residual }) => {
                return Outcome { status, residual, iterations: most, ..Outcome::NONE };
            }
        }
        for w in (0..wall::COUNT).filter(|&w| moved[w] != 0.0) {
            // To the bit, whatever the sum was rounded to.
            state.displacement[w] = to[w];
        }
        work.begin(model, state);
        work.two_step.x.clear(model.len(), state.rotation.len());
    }
    Outcome { iterations, ..judge(model, state, work) }
}

/// One linear step of `state`, the reference, from the θ at hand.
fn step(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    moved: [f64; wall::COUNT],
    most: u32,
) -> Result<u32, Failure> {
    take_springs(model, state, work);
    let Workspace { two_step: two, servo, reference, memory, .. } = work;
    let bounds = state.bounds(model);
    let walls = Walls { drives: &servo.drives, moved, bounds: &bounds };
    let iterations = two.solve(model, state, &walls, most)?;
    let TwoStep { network, x, .. } = two;
    for (at, by) in state.position.iter_mut().zip(&x.shift) {
        *at += by;
    }
    for ((at, by), radius) in state.rotation.iter_mut().zip(&x.turn).zip(&model.radius) {
        *at += by / *radius;
    }
    for (at, by) in state.displacement.iter_mut().zip(moved) {
        *at += by;
    }
    servo.step = x.drive;
    state.displacement = servo.displaced(&state.displacement, 1.0);
    let deformations = network.deformations(model, &walls, x);
    let changes = reference.load(model, state, &network.springs, deformations, memory);
    two.changes.opened += changes.opened;
    two.changes.excess = changes.excess;
    Ok(iterations)
}

/// What `state`, which `work` began with, is worth as it stands.
pub(super) fn judge(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    take_springs(model, state, work);
    let Workspace { two_step: two, servo, .. } = work;
    let TwoStep { network, x, left, .. } = two;
    let bounds = state.bounds(model);
    let walls = Walls { drives: &servo.drives, moved: [0.0; wall::COUNT], bounds: &bounds };
    x.clear(model.len(), state.rotation.len());
    network.forces(model, &state.carries, &walls, (x, Count::Loads), left);
    let mean_force = network.mean_force(model, &walls, x);
    let residual = residual(model, &walls, left, mean_force);
    let status = match network.springs.is_empty() {
        true => Status::Unjammed,
        false => Status::Converged,
    };
    work.near_minimum = false;
    work.evaluate(model, state, &bounds);
    Outcome { status, residual, sums: work.balance.sums, ..Outcome::NONE }
}

/// Takes the springs of `state`, the reference.
fn take_springs(model: &Model, state: &State, work: &mut Workspace) {
    let Workspace { two_step: two, neighbours, reference, .. } = work;
    two.network.springs.clear();
    reference.springs(model, state, &mut two.network.springs);
    two.network.press(model, neighbours, state);
}

/// Begins with `state`, whose cement is new or was given with the pack: what is new bears the
/// weight of the grains.
pub(crate) fn start(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    cement_is_new: bool,
) -> Outcome {
    work.begin(model, state);
    rattlers::find(model, state, work);
    let outcome = judge(model, state, work);
    match cement_is_new && outcome.residual > model.solver.tolerance {
        true => solve(model, state, work),
        false => outcome,
    }
}

/// Largest normal force on a wall by which the loads that the bonds of `state` remember are off
/// those of the law \[N\].
pub(super) fn departure(model: &Model, state: &State) -> f64 {
    let Some(cement) = &model.cement else { return 0.0 };
    let bounds = state.bounds(model);
    let mut off = [0.0_f64; wall::COUNT];
    for bond in state.bonds.iter().filter(|bond| bond.holds()) {
        let (Other::Wall(w), Some(force)) = (bond.second, bond.normal_force) else { continue };
        let law = model.law_of(cement, bond);
        off[usize::from(w)] += force - bond.force_by_law(&law, &state.position, &bounds);
    }
    off.into_iter().fold(0.0, |most, off| most.max(off.abs()))
}

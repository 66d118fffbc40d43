//! Tangent stiffness of an equilibrium: how the walls' normal forces change with small motions of
//! the walls, the grains following to balance.
//!
//! With x the positions and rotations of the grains, d the inward displacements of the walls, g the
//! gradient and F the normal forces on the walls, a motion t = (x, d) changes them by H t, where H
//! is the exact derivative of the balance ([`hessian`](self), in double precision). A mode moves
//! walls by d and all grains affinely with them by q; they then go on by z until they balance:
//!
//! ```text
//! J z = -(H q)_g,    stiffness S d = (H (q + z))_F,    J = ∂g/∂x
//! ```
//!
//! J z is solved for by flexible GMRES with the linear system of the relaxation as preconditioner.
//! With ε_m = both walls across m by L_m/2 and q_m that affine motion, and σ_l the mean normal force
//! over the area, which shrinks when another pair closes in,
//!
//! ```text
//! V dσ_l/dε_m = q_l·H (q_m + z_m) + V σ_l (1 - δ_lm)
//! ```
//!
//! is the relaxed modulus and without z_m the affine one (Born's term): without friction
//! q_l·H q_m is the second derivative of the energy along the affine strain.
//!
//! Smooth walls let a pair of them take the pack along: that mode changes no force at all, and
//! half of the other is that of one wall.

mod gmres;
mod hessian;
mod preconditioner;

use nalgebra::{Matrix3, Matrix6};

use crate::Vec3;
use crate::measure::walls;
use crate::model::Model;
use crate::relax::balance::{Balance, Configuration};
use crate::relax::tangential::Reference;
use crate::relax::{Outcome, Status, Workspace, newton};
use crate::state::State;
use crate::wall::{self, Room};
use gmres::{dot, norm};
use hessian::Hessian;
use preconditioner::Preconditioner;

/// Reduction of the residual that is asked of each response, and most directions it may take.
const REDUCTION: f64 = 1e-10;
const MOST_DIRECTIONS: u32 = 120;
/// What may be left of the residual where rounding or the budget leave no less.
const ENOUGH: f64 = 1e-6;
/// Relative error above which the moduli are taken as unknown.
const MOST_ERROR: f64 = 1e-6;
/// A residual this many times the tolerance is that of another state.
const ANOTHER: f64 = 10.0;

/// Stiffness of a pack between its walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// dσ_l/dε_m \[Pa\], the grains in balance; of discs over xx, yy and γ = 2 εxy.
    pub relaxed: Matrix3<f64>,
    /// The same with the grains moving affinely, without turning.
    pub affine: Matrix3<f64>,
    /// Change of the normal force on wall v with the inward motion of wall w \[N/m\].
    pub walls: Matrix6<f64>,
    /// Estimate of the relative error that solving for the balance leaves, of the largest entry.
    pub error: f64,
}

impl Stiffness {
    /// Of a pack that carries nothing.
    pub(crate) const NONE: Self = Self {
        relaxed: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        affine: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        walls: Matrix6::from_array_storage(nalgebra::ArrayStorage([[0.0; 6]; 6])),
        error: 0.0,
    };
}

/// Stiffnesses of one state.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    /// With contacts that slide as they stand; `None` where it cannot be told.
    pub stands: Option<Stiffness>,
    /// With contacts that all stick; the same without friction.
    pub sticks: Option<Stiffness>,
    /// Products of the linear system that it took.
    pub products: u64,
}

/// The tangent stiffness of `state`, to which `here` led. It changes nothing; `work` holds the
/// neighbours of the state and the reference of the increment that led there.
#[must_use]
pub fn tangent(model: &Model, state: &State, work: &Workspace, here: &Outcome) -> Tangent {
    if here.status == Status::Unjammed {
        let none = Some(Stiffness::NONE);
        return Tangent { stands: none, sticks: none, products: 0 };
    }
    let mut products = 0;
    let mut take = |reference: &Reference, balance: &Balance| {
        stiffness(model, state, work, reference, balance, &mut products)
    };
    if !work.reference.active {
        let stiffness = take(&work.reference, &balance(model, state, work, &work.reference));
        return Tangent { stands: stiffness, sticks: stiffness, products };
    }
    let mut reference = work.reference.clone();
    let mut there = balance(model, state, work, &reference);
    let residual = newton::residual(model, there.largest(), there.sums.mean_force());
    if residual.is_nan() || residual > ANOTHER * model.solver.tolerance {
        // Not the increment that led here.
        reference.begin(model, state, &work.neighbours, true);
        there = balance(model, state, work, &reference);
    }
    let stands = take(&reference, &there);
    reference.begin_sticking(model, state, &work.neighbours);
    let sticks = take(&reference, &balance(model, state, work, &reference));
    Tangent { stands, sticks, products }
}

fn configuration<'a>(
    model: &'a Model,
    state: &'a State,
    work: &'a Workspace,
    reference: &'a Reference,
    bounds: &'a Room,
) -> Configuration<'a> {
    Configuration {
        model,
        neighbours: &work.neighbours,
        position: &state.position,
        rotation: &state.rotation,
        reference,
        carries: &state.carries,
        bounds,
        reference_stiffness: work.reference_stiffness,
    }
}

fn balance(model: &Model, state: &State, work: &Workspace, reference: &Reference) -> Balance {
    let mut balance = Balance::default();
    balance.evaluate(&configuration(model, state, work, reference, &state.bounds(model)));
    balance
}

/// A motion of the walls, and what it does.
struct Mode {
    /// q, of the grains alone.
    affine: Vec<Vec3>,
    /// (H q)_g and (H q)_F.
    push: Vec<Vec3>,
    affine_force: [f64; wall::COUNT],
    /// z, and the residual of it.
    response: Vec<Vec3>,
    left: Vec<Vec3>,
    /// (H (q + z))_F.
    force: [f64; wall::COUNT],
}

/// The stiffness with contacts as `reference` has them; `balance` is that of the state.
fn stiffness(
    model: &Model,
    state: &State,
    work: &Workspace,
    reference: &Reference,
    balance: &Balance,
    products: &mut u64,
) -> Option<Stiffness> {
    let bounds = state.bounds(model);
    let at = configuration(model, state, work, reference, &bounds);
    let hessian = Hessian::new(&at);
    let mut preconditioner = Preconditioner::new(model, balance, &at);
    let mut modes = Vec::new();
    for walls in motions(reference.active) {
        let mode = respond(state, &bounds, &hessian, &mut preconditioner, &walls);
        *products = preconditioner.products();
        modes.push(mode?);
    }
    let stress = stress(model, state, work, &bounds);
    let stiffness = gather(&modes, &bounds, &stress);
    (stiffness.error <= MOST_ERROR).then_some(stiffness)
}

/// Inward motions of the walls that are solved for \[m\].
fn motions(frictional: bool) -> Vec<[f64; wall::COUNT]> {
    let moves =
        |which: &dyn Fn(usize) -> bool| std::array::from_fn(|w| if which(w) { 1.0 } else { 0.0 });
    match frictional {
        false => (0..3).map(|axis| moves(&|w| wall::axis(w) == axis)).collect(),
        true => (0..wall::COUNT).map(|wall| moves(&|w| w == wall)).collect(),
    }
}

fn respond(
    state: &State,
    bounds: &Room,
    hessian: &Hessian<'_>,
    preconditioner: &mut Preconditioner,
    walls: &[f64; wall::COUNT],
) -> Option<Mode> {
    let affine = carried(state, bounds, walls, hessian.len());
    let (push, affine_force) = hessian.times(&affine, walls);
    let still = [0.0; wall::COUNT];
    let right: Vec<Vec3> = push.iter().map(|g| -g).collect();
    let solution = gmres::solve(
        |x| hessian.times(x, &still).0,
        |r| preconditioner.solve(r),
        &right,
        REDUCTION,
        MOST_DIRECTIONS,
    );
    let solved = norm(&solution.left) <= ENOUGH * norm(&right);
    if solution.concave || !solved {
        return None;
    }
    let (_, relaxing) = hessian.times(&solution.x, &still);
    let force = std::array::from_fn(|w| affine_force[w] + relaxing[w]);
    Some(Mode { affine, push, affine_force, response: solution.x, left: solution.left, force })
}

/// Where `walls` take the grains that carry, affinely.
fn carried(state: &State, bounds: &Room, walls: &[f64; wall::COUNT], length: usize) -> Vec<Vec3> {
    let (low, sides) = (Vec3::from(bounds.min), Vec3::from(bounds.sides()));
    let mut carried = vec![Vec3::zeros(); length];
    for (i, at) in state.position.iter().enumerate().filter(|(i, _)| state.carries[*i]) {
        let share = (at - low).component_div(&sides);
        carried[i] = Vec3::from_fn(|axis, _| {
            walls[2 * axis] * (1.0 - share[axis]) - walls[2 * axis + 1] * share[axis]
        });
    }
    carried
}

/// Mean normal force of each pair of walls over its area \[Pa\].
fn stress(model: &Model, state: &State, work: &Workspace, bounds: &Room) -> [f64; 3] {
    let forces = walls::normal_forces(model, state, &work.neighbours);
    std::array::from_fn(|l| 0.5 * (forces[2 * l] + forces[2 * l + 1]) / bounds.area(2 * l))
}

fn gather(modes: &[Mode], bounds: &Room, stress: &[f64; 3]) -> Stiffness {
    let sides = bounds.sides();
    // One wall is a mode, or half of that of its pair.
    let (share, of) = match modes.len() {
        3 => (0.5, [0, 0, 1, 1, 2, 2]),
        _ => (1.0, [0, 1, 2, 3, 4, 5]),
    };
    let walls = Matrix6::from_fn(|v, w| share * modes[of[w]].force[v]);
    let affine_walls = |v: usize, w: usize| {
        let (to, by) = (&modes[of[v]], &modes[of[w]]);
        share * (by.affine_force[v] + share * dot(&to.affine, &by.push))
    };
    let strained = |stiffness: &dyn Fn(usize, usize) -> f64| {
        Matrix3::from_fn(|l, m| {
            let sum: f64 = [(0, 0), (0, 1), (1, 0), (1, 1)]
                .map(|(a, b)| stiffness(2 * l + a, 2 * m + b))
                .iter()
                .sum();
            let shrinking = if l == m { 0.0 } else { stress[l] };
            0.25 * sides[l] * sides[m] * sum / bounds.volume() + shrinking
        })
    };
    let off = |a: &Mode| modes.iter().map(|b| dot(&a.response, &b.left).abs()).fold(0.0, more);
    let error = share * modes.iter().map(off).fold(0.0, more) / walls.amax();
    Stiffness {
        relaxed: strained(&|v, w| walls[(v, w)]),
        affine: strained(&affine_walls),
        walls,
        error,
    }
}

/// The larger, and no number where one is none.
fn more(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

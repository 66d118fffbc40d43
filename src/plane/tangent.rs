//! Tangent stiffness of an equilibrium of discs: how the forces on the sides of a box change with small
//! motions of the sides and the tilt, the grains following to balance.
//!
//! With x the freedoms of the grains and b the inward displacements of the four sides and the tilt, the
//! potential of the increment has the derivative F over b, the forces on the sides and the moment on the
//! tilt, and the second derivatives K over x, C over x and b (`rim`) and D over b. The grains follow by
//! z, and
//!
//! ```text
//! K z = -C,    S = ∂F/∂b = D + Cᵀ z
//! ```
//!
//! K is that of Newton's method ([`slope`](super::slope)) without the secants that it takes of contacts which
//! turn round. It is factorised once, with a shift that the responses have taken out again: a grain that slides
//! at all its contacts turns freely. The moduli of the box follow from S (`strain`).

mod rim;
mod strain;

use nalgebra::{Matrix3, Matrix6, SMatrix, SVector};

use super::act::Scenery;
use super::balance::Balance;
use super::boundary::{self, Body, SIDES};
use super::line::{dot, longest};
use super::matrix::FREEDOMS;
use super::pose::Pose;
use super::reference::Reference;
use super::slope::Slope;
use super::work::Workspace;
use super::{Setup, Vec2, glue, newton};
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::model::Model;
use crate::relax::Status;
use crate::relax::advance::Advance;
use crate::relax::tangent::{Stiffness, Tangent};
use crate::state::State;
use rim::Rim;
use strain::Leaning;

/// Motions of the boundary: the sides and the tilt.
const MOTIONS: usize = SIDES + 1;
/// Strains of the box: xx, yy, and γ, twice xy.
const STRAINS: usize = 3;

/// Shift over the mean stiffness of the contacts.
const SHIFT: f64 = 1e-10;
/// Reduction of the residual that is asked of each response, and times that one is looked at.
const REDUCTION: f64 = 1e-12;
const LOOKS: u32 = 30;
/// What may be left of the residual where rounding leaves no less.
const ENOUGH: f64 = 1e-6;
/// Relative error above which the moduli are taken as unknown.
const MOST_ERROR: f64 = 1e-6;
/// A residual this many times the tolerance is that of another state.
const ANOTHER: f64 = 10.0;

/// The tangent stiffness of `state`, to which `reached` led: `relaxed` and `affine` over xx, yy and xy. It
/// changes nothing; `work` has the reference of the increment that led there, `near` the contacts of the
/// state.
#[must_use]
pub fn tangent(
    model: &Model,
    state: &State,
    work: &Workspace,
    near: &Neighbours,
    reached: &Advance,
) -> Tangent {
    let none = Some(Stiffness::NONE);
    if reached.outcome.status == Status::Unjammed {
        return Tangent { stands: none, sticks: none, products: 0 };
    }
    // Whether grains are locked is seen to when all is added up: glued ones turn with their wall.
    let Some(setup) = model.plane.clone().map(|setup| Setup { turns: true, ..setup }) else {
        return Tangent { stands: None, sticks: None, products: 0 };
    };
    let mut bodies = Vec::new();
    boundary::bodies(model, &state.displacement, state.tilt, &mut bodies);
    let at: Vec<Vec2> = state.position.iter().map(|at| Vec2::new(at.x, at.y)).collect();
    let scenery = |reference| Scenery::of(model, &setup, state, (reference, &bodies, &[]));
    let unit = newton::stiffness(work);
    let mut products = 0;
    let mut take = |place: &Place<'_>| {
        products += 1;
        place.stiffness(unit)
    };
    let mut reference = Reference::default();
    reference.begin(model, state, near, &bodies, true);
    reference.smooth();
    let mut sticking = reference.clone();
    sticking.stick();
    let mut last = work.reference.clone();
    last.smooth();
    let anew = Pose { at: at.clone(), turn: vec![0.0; model.len()] };
    // A pack that was given in equilibrium has no increment behind it.
    let given = reached.substeps == 0;
    let there = Pose { at, turn: work.pose.turn.clone() };
    let there = (there.turn.len() == model.len())
        .then(|| Place::new(Scenery { goes_on: given, ..scenery(&last) }, state, there));
    let allowed = ANOTHER * model.solver.tolerance * newton::unit_force(model, work);
    let stands = match there.filter(|place| longest(&place.balance.gradient) <= allowed) {
        Some(place) => take(&place),
        // Not the increment that led here.
        None => {
            let goes_on = Scenery { goes_on: true, ..scenery(&reference) };
            take(&Place::new(goes_on, state, anew.clone()))
        }
    };
    if model.friction.is_none() {
        return Tangent { stands, sticks: stands, products };
    }
    let sticks = take(&Place::new(scenery(&sticking), state, anew));
    Tangent { stands, sticks, products }
}

/// The pack at an equilibrium.
struct Place<'a> {
    scenery: Scenery<'a>,
    state: &'a State,
    pose: Pose,
    balance: Balance,
}

impl<'a> Place<'a> {
    fn new(scenery: Scenery<'a>, state: &'a State, pose: Pose) -> Self {
        let mut balance = Balance::default();
        balance.evaluate(&scenery, &pose);
        if !turns(scenery.model) {
            hold_turns(&mut balance.gradient);
        }
        Self { scenery, state, pose, balance }
    }

    /// `unit` is the stiffness of a typical contact \[N/m\].
    fn stiffness(&self, unit: f64) -> Option<Stiffness> {
        let Self { scenery, state, .. } = self;
        let model = scenery.model;
        let mut slope = self.arranged(unit);
        slope.assemble(scenery, &self.pose, false);
        let mut rim = Rim::new(scenery, &self.pose, &slope);
        if !turns(model) {
            lock(&mut slope);
            rim.columns.iter_mut().for_each(|column| hold_turns(column));
        }
        let leaning = Leaning::new(model, state);
        let affine = self.affine(&leaning, &rim, &slope) / leaning.volume();
        glue::stiffen(&state.glued, &mut slope);
        if !slope.matrix.factorise(SHIFT * unit) {
            // The state is no minimum.
            return None;
        }
        let mut responses = Vec::with_capacity(MOTIONS);
        for column in &rim.columns {
            responses.push(self.response(&mut slope, column)?);
        }
        let stiff = SMatrix::<f64, MOTIONS, MOTIONS>::from_fn(|a, b| {
            rim.corner[(a, b)] + dot(&rim.columns[a], &responses[b].way)
        });
        let walls =
            Matrix6::from_fn(|v, w| if v < SIDES && w < SIDES { stiff[(v, w)] } else { 0.0 });
        let error = off(&responses, leaning.height()) / walls.amax();
        if error.is_nan() || error > MOST_ERROR {
            return None;
        }
        let turning = leaning.turning(&self.force());
        let [relaxed, affine] = [leaning.over_strains(&stiff), affine].map(|of| {
            let of = of + turning;
            if self.rubs() { of } else { strain::without_shear(&of) }
        });
        Some(Stiffness { relaxed, affine, walls, error })
    }

    /// A slope for the contacts that act.
    fn arranged(&self, idle: f64) -> Slope {
        let pairs = &self.scenery.reference.pairs;
        let mut acts = vec![false; pairs.len()];
        self.scenery.pairs(&self.pose).for_each(|(k, ..)| acts[k] = true);
        let (mut start, mut second) = (vec![0], Vec::with_capacity(pairs.len()));
        for joint in pairs {
            let Other::Grain(j) = joint.second else { continue };
            start.resize(joint.first as usize + 1, second.len() as u32);
            second.push(j);
        }
        start.resize(self.pose.at.len() + 1, second.len() as u32);
        let positions: Vec<[f64; 2]> = self.pose.at.iter().map(|at| [at.x, at.y]).collect();
        let mut slope = Slope::default();
        slope.idle = idle;
        slope.matrix.arrange(&positions, &start, &second, |k| acts[k], &[]);
        slope
    }

    /// What the grains do when the boundary pushes them by `column`.
    fn response(&self, slope: &mut Slope, column: &[f64]) -> Option<Response> {
        let glued = &self.state.glued;
        let mut way = vec![0.0; column.len()];
        let mut left = column.to_vec();
        let push = longest(column);
        for _ in 0..LOOKS {
            if longest(&left) <= REDUCTION * push {
                break;
            }
            let mut more = left.clone();
            slope.matrix.solve(std::slice::from_mut(&mut more));
            glue::clear(glued, &mut more);
            let before = longest(&left);
            let mut trial = way.clone();
            trial.iter_mut().zip(&more).for_each(|(way, more)| *way -= more);
            let mut next = column.to_vec();
            slope.multiply(&trial, (self.scenery.reference, &[]), &mut next);
            glue::clear(glued, &mut next);
            // Rounding, or a direction that nothing holds and something pushes.
            if longest(&next) >= before {
                break;
            }
            (way, left) = (trial, next);
        }
        (longest(&left) <= ENOUGH * push).then_some(Response { way, left })
    }

    /// T_l·H T_m of the motions T that take the grains along affinely with the box \[J\].
    fn affine(&self, leaning: &Leaning, rim: &Rim, slope: &Slope) -> Matrix3<f64> {
        let Self { scenery, state, pose, .. } = self;
        let model = scenery.model;
        let motions: [(Vec<f64>, SVector<f64, MOTIONS>); STRAINS] = std::array::from_fn(|m| {
            let mut ways = Vec::with_capacity(FREEDOMS * pose.at.len());
            for (i, at) in pose.at.iter().enumerate() {
                // Glued grains are parts of the boundary.
                let free = state.carries[i] && glue::side(&state.glued, i).is_none();
                let (way, turn) = if free { leaning.carry(m, *at) } else { (Vec2::zeros(), 0.0) };
                let turn = if turns(model) { turn * model.radius[i] } else { 0.0 };
                ways.extend([way.x, way.y, turn]);
            }
            (ways, leaning.motion(m))
        });
        let pushed: Vec<Vec<f64>> = motions
            .iter()
            .map(|(ways, _)| {
                let mut pushed = vec![0.0; ways.len()];
                slope.multiply(ways, (scenery.reference, &[]), &mut pushed);
                pushed
            })
            .collect();
        let across = |ways: &[f64], motion: &SVector<f64, MOTIONS>| -> f64 {
            rim.columns.iter().zip(motion).map(|(column, b)| b * dot(column, ways)).sum()
        };
        Matrix3::from_fn(|l, m| {
            let ((to, b_to), (by, b_by)) = (&motions[l], &motions[m]);
            dot(to, &pushed[m])
                + across(to, b_by)
                + across(by, b_to)
                + b_to.dot(&(rim.corner * b_by))
        })
    }

    /// F at the state: forces on the sides \[N\], and the moment on the tilt \[N m\].
    fn force(&self) -> SVector<f64, MOTIONS> {
        let Balance { sides, tilt, .. } = &self.balance;
        SVector::from_fn(|a, _| sides.get(a).copied().unwrap_or(*tilt))
    }

    /// Whether the sides can shear the pack.
    fn rubs(&self) -> bool {
        let Scenery { model, setup, .. } = &self.scenery;
        let rough = |friction: &crate::model::Friction| friction.wall_coefficient > 0.0;
        setup.glue || model.friction.as_ref().is_some_and(rough)
    }
}

/// z of one motion of the boundary, and what is left of its residual.
struct Response {
    way: Vec<f64>,
    left: Vec<f64>,
}

/// The largest |z_a·r_b| of the sides and of the tilt times the height \[N/m\], r the residual.
fn off(responses: &[Response], height: f64) -> f64 {
    let scale = |a: usize| if a < SIDES { 1.0 } else { height.recip() };
    let each = responses.iter().enumerate().flat_map(|(a, one)| {
        let left = move |(b, other): (usize, &Response)| {
            dot(&one.way, &other.left).abs() * scale(a) * scale(b)
        };
        responses.iter().enumerate().map(left)
    });
    each.fold(0.0, more)
}

/// Whether the grains turn.
fn turns(model: &Model) -> bool {
    model.plane.as_ref().is_some_and(|setup| setup.turns)
}

/// Takes the turns out of the derivative, which locked grains do not have.
fn lock(slope: &mut Slope) {
    let turn = FREEDOMS - 1;
    for block in slope.matrix.diagonal.iter_mut().chain(&mut slope.matrix.pairs) {
        block.iter_mut().for_each(|row| row[turn] = 0.0);
        block[turn].fill(0.0);
    }
    slope.matrix.diagonal.iter_mut().for_each(|block| block[turn][turn] = slope.idle);
}

/// The same in a list of three numbers a grain.
fn hold_turns(list: &mut [f64]) {
    list.iter_mut().skip(FREEDOMS - 1).step_by(FREEDOMS).for_each(|turn| *turn = 0.0);
}

/// The larger, and no number where one is none.
fn more(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

/// Normal of `body`; nothing where it is no plane.
fn normal(body: &Body) -> Option<Vec2> {
    match body.shape {
        boundary::Shape::Plane(normal) => Some(normal),
        boundary::Shape::Disc(_) | boundary::Shape::Ring(_) | boundary::Shape::Nothing => None,
    }
}

//! Grain by grain to its own equilibrium, over and over (18-19).

use nalgebra::{Matrix3, Vector3};

use super::act::{Act, Scenery};
use super::advance;
use super::balance::Balance;
use super::boundary::{self, SIDES};
use super::floating;
use super::matrix::FREEDOMS;
use super::newton::{self, residual};
use super::slope::own_block;
use super::work::Workspace;
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::model::Model;
use crate::relax::{Outcome, Status};
use crate::state::State;

/// Sweeps between two looks at the residual.
const LOOK: u32 = 10;

/// Joints of each grain, in rows: those of pairs, and beyond them those of edges.
#[derive(Clone, Debug, Default)]
pub(super) struct Adjacency {
    start: Vec<u32>,
    joints: Vec<u32>,
}

impl Adjacency {
    fn build(&mut self, work: &super::reference::Reference, grains: usize) {
        self.start.clear();
        self.start.resize(grains + 1, 0);
        let ends = |k: usize| {
            let joint = work.pairs.get(k).unwrap_or_else(|| &work.edges[k - work.pairs.len()]);
            let other = match joint.second {
                Other::Grain(j) => Some(j),
                Other::Wall(_) => None,
            };
            [Some(joint.first), other].into_iter().flatten()
        };
        let count = work.pairs.len() + work.edges.len();
        for k in 0..count {
            ends(k).for_each(|grain| self.start[grain as usize + 1] += 1);
        }
        for grain in 0..grains {
            self.start[grain + 1] += self.start[grain];
        }
        let mut next = self.start.clone();
        self.joints.clear();
        self.joints.resize(next[grains] as usize, 0);
        for k in 0..count {
            for grain in ends(k) {
                let place = &mut next[grain as usize];
                self.joints[*place as usize] = k as u32;
                *place += 1;
            }
        }
    }

    fn row(&self, grain: usize) -> &[u32] {
        &self.joints[self.start[grain] as usize..self.start[grain + 1] as usize]
    }
}

/// Relaxes `state` by sweeps; a step of the outcome is one of them.
pub(super) fn relax(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
) -> Outcome {
    let mut outcome = Outcome { status: Status::MaxIterations, ..Outcome::NONE };
    work.search.concave = false;
    work.floating.begin(model.len());
    let most = model.solver.most_iterations();
    let mut sweeps = 0;
    loop {
        work.refresh(model, state, near);
        work.evaluate(model, state);
        if floating::drop_loose(model, state, work) {
            work.evaluate(model, state);
        }
        outcome.iterations = sweeps;
        outcome.sums = work.balance.sums;
        outcome.residual = residual(model, work);
        if !outcome.residual.is_finite() {
            outcome.status = Status::NonFinite;
            return outcome;
        }
        if outcome.residual <= model.solver.tolerance {
            if floating::rejoin(model, state, work) {
                continue;
            }
            outcome.status = work.rest();
            return outcome;
        }
        if sweeps >= most {
            return outcome;
        }
        let mut adjacency = std::mem::take(&mut work.adjacency);
        adjacency.build(&work.reference, model.len());
        for _ in 0..LOOK {
            sweep(model, state, work, &adjacency);
            yield_to_loads(model, state, work);
            sweeps += 1;
            work.balance.evaluations += 1;
        }
        work.adjacency = adjacency;
    }
}

/// Takes so many `sweeps` and leaves out of balance what then is, as B does: the outcome counts as an
/// equilibrium. Contacts that open lose their shear, and limits of friction are renewed, after each.
pub(super) fn sweeps(
    model: &Model,
    state: &mut State,
    work: &mut Workspace,
    near: &mut Neighbours,
    sweeps: u32,
) -> Outcome {
    let current = advance::limits_are_current(model);
    work.search.concave = false;
    work.floating.begin(model.len());
    let mut adjacency = std::mem::take(&mut work.adjacency);
    for k in 0..sweeps {
        if work.refresh(model, state, near) || k == 0 {
            adjacency.build(&work.reference, model.len());
        }
        sweep(model, state, work, &adjacency);
        yield_to_loads(model, state, work);
        newton::open(model, state, work);
        if current {
            advance::renew_limits(model, state, work);
        }
    }
    work.adjacency = adjacency;
    work.refresh(model, state, near);
    work.evaluate(model, state);
    work.balance.evaluations += u64::from(sweeps);
    if floating::drop_loose(model, state, work) | floating::rejoin(model, state, work) {
        work.evaluate(model, state);
    }
    let residual = residual(model, work);
    let status = if residual.is_finite() { Status::Converged } else { Status::NonFinite };
    Outcome { status, iterations: sweeps, residual, sums: work.balance.sums, ..Outcome::NONE }
}

/// Brings every grain to its own equilibrium, one after the other.
fn sweep(model: &Model, state: &State, work: &mut Workspace, adjacency: &Adjacency) {
    let Some(setup) = &model.plane else { return };
    let Workspace { reference, bodies, membranes, pose, .. } = work;
    for i in (0..model.len()).filter(|&i| state.carries[i]) {
        let mut force = Vector3::zeros();
        let mut slope = Matrix3::zeros();
        {
            let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
            for &k in adjacency.row(i) {
                let k = k as usize;
                let (joint, act): (_, Option<Act>) = match reference.pairs.get(k) {
                    Some(joint) => (joint, scenery.pair(joint, pose)),
                    None => {
                        let joint = &reference.edges[k - reference.pairs.len()];
                        (joint, scenery.edge(joint, pose))
                    }
                };
                let Some(mut act) = act else { continue };
                if model.solver.sweeps.is_some() && act.normal.force > 0.0 {
                    // The thesis takes the secant (5), two thirds of Hertz' stiffness: an over-relaxed
                    // step. It matters where sweeps do not end in an equilibrium.
                    act.normal.stiffness = act.normal.force / act.overlap;
                }
                let first = joint.first as usize == i;
                let (sign, arm) = if first { (1.0, joint.arm[0]) } else { (-1.0, joint.arm[1]) };
                let push = act.force() * sign;
                let lever = arm / model.radius[i];
                force += Vector3::new(push.x, push.y, lever * act.shear.force);
                let flat = joint.is_flat(bodies);
                let block = own_block(&act, sign * lever, flat, setup.turns);
                slope += Matrix3::from_fn(|a, b| block[a][b]);
            }
        }
        for membrane in &*membranes {
            let push = membrane.force(i as u32, pose);
            force += Vector3::new(push.x, push.y, 0.0);
        }
        if model.has_gravity() {
            let weight = model.gravity * model.mass(i);
            force += Vector3::new(weight.x, weight.y, 0.0);
        }
        if !setup.turns {
            force.z = 0.0;
            slope[(2, 2)] = 1.0;
        }
        let scale = slope.trace() / FREEDOMS as f64;
        // A grain that its contacts do not hold on all sides is moved by its force alone.
        let way = slope
            .cholesky()
            .or_else(|| (slope + Matrix3::identity() * scale).cholesky())
            .map_or_else(Vector3::zeros, |factors| factors.solve(&force));
        let longest = model.solver.step_cap * model.radius[i];
        let length = way.xy().norm().max(way.z.abs());
        let share = if length > longest { longest / length } else { 1.0 };
        pose.at[i] += way.xy() * share;
        pose.turn[i] += way.z * share / model.radius[i];
    }
}

/// Moves the walls under loads as far as their own contacts give way.
fn yield_to_loads(model: &Model, state: &mut State, work: &mut Workspace) {
    if work.drives.is_empty() {
        return;
    }
    let Some(setup) = &model.plane else { return };
    let Workspace { reference, bodies, membranes, pose, balance, drives, .. } = work;
    let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
    let mut pressed = [0.0; SIDES];
    let mut stiffness = [0.0; SIDES];
    for joint in &reference.edges {
        let (Some(act), Other::Wall(b)) = (scenery.edge(joint, pose), joint.second) else {
            continue;
        };
        let body = &scenery.bodies[b as usize];
        let side = body.side as usize;
        pressed[side] += Balance::pressed(&act, body);
        let close = act.sign * act.along.dot(&body.slide) + body.growth;
        stiffness[side] += act.normal.stiffness * close * close;
    }
    balance.sides = pressed;
    for drive in drives {
        let along =
            |of: &[f64; SIDES]| of.iter().zip(drive.shares).map(|(f, s)| f * s).sum::<f64>();
        let squares = drive.shares.map(|share| share * share);
        let stiff: f64 = stiffness.iter().zip(squares).map(|(k, s)| k * s).sum();
        let way = (drive.force - along(&pressed)) / stiff.max(f64::MIN_POSITIVE);
        let longest = model.solver.step_cap * model.mean_radius;
        let way = way.clamp(-longest, longest);
        for (to, share) in state.displacement.iter_mut().zip(drive.shares) {
            *to += share * way;
        }
    }
    boundary::bodies(model, &state.displacement, state.tilt, bodies);
}

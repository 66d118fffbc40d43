//! Relaxation to static equilibrium: the minimum of the potential energy (T 2.5, A.2).
//!
//! [`advance`](advance::advance) moves the walls in sub-increments and calls [`relax`] after each.
//! That leaves out the grains that cannot carry load ([`rattlers`]), minimises the energy of the
//! others by [`newton`], and where that runs into an instability follows the grains downhill as
//! overdamped motion would take them (`downhill`, [`flow`]) and notes who jumped ([`jump`]). The
//! methods of the seeds take the place of [`newton`] where the scene asks for one:
//! `conjugate_gradient`, `gauss_seidel` and `dynamic`.

pub mod accuracy;
pub mod advance;
pub mod balance;
mod block;
pub mod breakage;
mod conjugate_gradient;
pub mod cool;
pub mod coupled;
mod crew;
pub mod curvature;
pub mod dissociate;
mod downhill;
pub(crate) mod dynamic;
pub mod fire;
pub mod flow;
mod gauss_seidel;
pub mod jump;
pub mod lanes;
pub mod linear;
mod loose;
pub(crate) mod membrane;
pub mod newton;
pub mod rattlers;
mod rows;
pub mod servo;
mod site;
mod split;
mod sticking;
mod sym3;
mod sym6;
pub mod tangent;
pub mod tangential;
pub mod two_step;
mod verdict;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::model::Model;
use crate::plane;
use crate::report::Surface;
use crate::scene::Method;
use crate::state::{Bond, Memory, State};
use crate::wall::{self, Room};
use balance::{Balance, Configuration, Sums};
use coupled::Coupled;
use dynamic::Inertia;
use jump::{Jump, Pose};
use linear::{Inner, Linear};
use loose::Loose;
use newton::Solved;
use rattlers::Rattlers;
use servo::Servo;
use site::{Adjacency, Others};
use tangential::{Changes, Reference};
use two_step::TwoStep;

/// Times that a pack slides into new membranes, and most steps of each.
const WRAPS: u32 = 5;
const WRAP_STEPS: u32 = 20_000;
/// Residual at which it need not any more, and its root mean square to which it does.
const NEAR: f64 = 3e-2;
const WRAPPED: f64 = 1e-3;

/// Times that floating grains which turn out to carry load may join the balance.
const ROUNDS: u32 = 40;

/// How a relaxation ended. All but the first two leave no state to trust.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The residual is below the tolerance at a minimum.
    Converged,
    /// No grain carries load: the forces are zero.
    Unjammed,
    /// The steps ran out.
    MaxIterations,
    /// Newton's method found no minimum nearby: the pack is on its way to another one.
    Unstable,
    /// No step descends any more: the tolerance is below what rounding allows.
    Stalled,
    /// A position or force is not finite.
    NonFinite,
}

impl Status {
    /// Whether the state is an equilibrium.
    #[must_use]
    pub fn is_equilibrium(self) -> bool {
        matches!(self, Self::Converged | Self::Unjammed)
    }
}

/// What a relaxation came to.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// How it ended.
    pub status: Status,
    /// Largest unbalanced force of a grain over the mean contact force.
    pub residual: f64,
    /// Steps of the method.
    pub iterations: u32,
    /// Legs of the flow from a configuration that was unstable.
    pub descents: u32,
    /// Sums at the end.
    pub sums: Sums,
}

impl Outcome {
    /// Before the first relaxation.
    pub const NONE: Self = Self {
        status: Status::Unjammed,
        residual: 0.0,
        iterations: 0,
        descents: 0,
        sums: Sums::NONE,
    };
}

/// What the work is counted in, on any machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Evaluations of the balance: energy and gradient. A sweep grain by grain counts as one.
    pub gradients: u64,
    /// Products of the linearised balance with a vector.
    pub products: u64,
}

/// Scratch that may be thrown away at any time.
#[derive(Clone, Debug)]
pub struct Workspace {
    /// Pairs that can touch.
    pub neighbours: Neighbours,
    /// The balance at the state.
    pub balance: Balance,
    /// Walls under loads.
    pub servo: Servo,
    /// Where shear and torsion are counted from.
    pub reference: Reference,
    /// For discs, all but the neighbour list.
    pub plane: plane::Workspace,
    /// The linear system of the present step without friction.
    pub linear: Linear,
    /// The linear system of the present step with friction.
    pub coupled: Coupled,
    /// Stiffness that single precision is scaled by \[N/m\].
    pub reference_stiffness: f64,
    /// Whether an instability is followed the way overdamped motion goes. If not, any minimum
    /// nearby will do.
    pub follows: bool,
    /// Instabilities followed since the list was last emptied.
    pub jumps: Vec<Jump>,
    /// Newton steps of a grain longer than this many mean overlaps are shortened, without shear in
    /// the contacts.
    pub step_cap: f64,
    /// Shift of each grain's block, shape (n).
    shift: Vec<f32>,
    /// First shift of each grain, and the one below which it is dropped, shape (n).
    first_shift: Vec<f32>,
    /// Contacts of each grain, shape (n), those that stick twice; for packs with weight or friction.
    support: Vec<u32>,
    /// The present step \[m\], shape (n), and its rotations times radius \[m\], shape (n) or empty.
    step: Vec<Vec3>,
    turn: Vec<Vec3>,
    /// The first stage of a step of the flow, as `step` and `turn`.
    first_step: Vec<Vec3>,
    first_turn: Vec<Vec3>,
    trial: Vec<Vec3>,
    trial_rotation: Vec<Vec3>,
    trial_displacement: [f64; wall::COUNT],
    /// Where the present search began.
    origin: Pose,
    /// Whether the present search met negative curvature.
    concave: bool,
    /// Velocities of an inertial descent, of the grains and then of their rotations.
    velocity: Vec<Vec3>,
    trial_balance: Balance,
    /// For the memory that is being written.
    memory: Memory,
    rattlers: Rattlers,
    adjacency: Adjacency,
    /// Sweeps grain by grain so far.
    sweeps: u64,
    loose: Loose,
    /// The increment in two linear steps.
    two_step: TwoStep,
    inertia: Inertia,
    /// Whether the linear system at hand is that of the last step of a search that found a minimum.
    near_minimum: bool,
    negligible_force: f64,
}

impl Workspace {
    /// Scratch for `model`.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let compliance = model.compliance.iter().sum::<f64>() / model.len().max(1) as f64;
        let modulus = hertz::modulus(0.5 * model.mean_radius, 2.0 * compliance);
        Self {
            neighbours: Neighbours::default(),
            balance: Balance::default(),
            servo: Servo::default(),
            reference: Reference::default(),
            plane: plane::Workspace::default(),
            linear: Linear::default(),
            coupled: Coupled::default(),
            reference_stiffness: hertz::stiffness(modulus, 1e-2 * model.mean_radius),
            step_cap: 1.0,
            follows: true,
            jumps: Vec::new(),
            shift: vec![0.0; model.len()],
            first_shift: Vec::with_capacity(model.len()),
            support: Vec::new(),
            step: Vec::with_capacity(model.len()),
            turn: Vec::new(),
            first_step: Vec::new(),
            first_turn: Vec::new(),
            trial: Vec::with_capacity(model.len()),
            trial_rotation: Vec::new(),
            trial_displacement: [0.0; wall::COUNT],
            origin: Pose::default(),
            concave: false,
            velocity: Vec::with_capacity(model.len()),
            trial_balance: Balance::default(),
            memory: Memory::default(),
            rattlers: Rattlers::default(),
            adjacency: Adjacency::default(),
            sweeps: 0,
            near_minimum: false,
            loose: Loose::default(),
            two_step: TwoStep::default(),
            inertia: Inertia::default(),
            negligible_force: model.negligible_force(),
        }
    }

    /// The work done so far.
    #[must_use]
    pub fn effort(&self) -> Effort {
        let plane = self.plane.effort();
        Effort {
            gradients: self.balance.evaluations
                + self.trial_balance.evaluations
                + self.sweeps
                + plane.gradients,
            products: self.linear.products
                + self.coupled.products
                + self.two_step.products
                + plane.products,
        }
    }

    /// Memory that its lists hold \[bytes\].
    #[must_use]
    pub fn heap_bytes(&self) -> usize {
        let single = heap::bytes(&self.shift) + heap::bytes(&self.first_shift);
        let steps = [&self.step, &self.turn, &self.first_step, &self.first_turn];
        let trials = [&self.trial, &self.trial_rotation, &self.velocity];
        let jumps = self.jumps.iter().map(Jump::heap_bytes).sum::<usize>();
        self.neighbours.heap_bytes()
            + self.balance.heap_bytes()
            + self.trial_balance.heap_bytes()
            + self.servo.heap_bytes()
            + self.reference.heap_bytes()
            + self.linear.heap_bytes()
            + self.coupled.heap_bytes()
            + self.memory.heap_bytes()
            + self.rattlers.heap_bytes()
            + self.adjacency.heap_bytes()
            + self.loose.heap_bytes()
            + self.plane.heap_bytes()
            + self.two_step.heap_bytes()
            + self.inertia.heap_bytes()
            + single
            + heap::bytes(&self.support)
            + heap::bytes(&self.jumps)
            + jumps
            + self.origin.heap_bytes()
            + steps.into_iter().chain(trials).map(heap::bytes).sum::<usize>()
    }

    /// Evaluates the balance of `state` in the box `bounds`.
    pub fn evaluate(&mut self, model: &Model, state: &State, bounds: &Room) {
        self.neighbours.refresh(model, &state.position, bounds);
        self.balance.evaluate(&Configuration {
            model,
            neighbours: &self.neighbours,
            position: &state.position,
            rotation: &state.rotation,
            reference: &self.reference,
            carries: &state.carries,
            bounds,
            reference_stiffness: self.reference_stiffness,
        });
        let grains = (&*state.position, &*state.carries);
        let cement = &self.balance.cement_on_walls;
        let near = &self.neighbours;
        self.balance.unbalance = self.servo.unbalance(model, near, grains, bounds, cement);
    }

    /// Takes the equilibrium `state` as the reference that shear and torsion count from.
    pub fn begin(&mut self, model: &Model, state: &State) {
        self.neighbours.refresh(model, &state.position, &state.bounds(model));
        self.take_bonds(model, state);
        self.reference.membranes.wrap(model, state);
        self.reference.begin(model, state, &self.neighbours, false);
        if model.is_two_step() {
            self.two_step.begin(state);
        }
    }

    /// Takes the pack as it was given as the reference. It may carry what it remembers even where
    /// that is beyond the limit: it was so in equilibrium.
    pub fn start(&mut self, model: &Model, state: &State) {
        self.neighbours.refresh(model, &state.position, &state.bounds(model));
        self.take_bonds(model, state);
        self.reference.membranes.wrap(model, state);
        self.reference.begin(model, state, &self.neighbours, true);
    }

    /// Puts the membranes of a pack as it was given around it. One that is far from the balance with
    /// them, and remembers no friction, slides into it first: grains that only a wall held are far from
    /// any.
    pub fn wrap(&mut self, model: &Model, state: &mut State) {
        let Some(cell) = &model.cell else { return };
        membrane::begin(cell, state);
        if state.pressure.iter().all(|&pressure| pressure == 0.0) {
            return;
        }
        let fresh = state.memory.contacts.is_empty();
        for _ in 0..WRAPS {
            self.begin(model, state);
            if !fresh {
                break;
            }
            self.evaluate(model, state, &state.bounds(model));
            let (largest, mean) = (self.balance.largest(), self.balance.sums.mean_force());
            if newton::residual(model, largest, mean) < NEAR {
                break;
            }
            let goal =
                fire::Goal { residual: WRAPPED, pressure: None, even: false, steps: WRAP_STEPS };
            fire::descend(model, state, self, goal);
            self.commit(model, state);
            rattlers::find(model, state, self);
        }
        self.reference.membranes.mark(model, state);
    }

    /// Moves the sides of an equilibrium that are membranes with the pack.
    pub fn lead(&mut self, model: &Model, state: &mut State) {
        self.reference.membranes.lead(model, state);
    }

    /// The membranes on spheres around `state`, whose balance was taken last.
    pub(crate) fn surfaces(&self, model: &Model, state: &State) -> Vec<Surface> {
        self.reference.membranes.surfaces(model, state)
    }

    /// Tells the neighbour list where cement stands between the bodies or stood.
    fn take_bonds(&mut self, model: &Model, state: &State) {
        if let Some(cement) = &model.cement {
            let bonds = state.bonds.iter();
            let relieved = bonds.map(|bond| (bond.key(), bond.unstressed(cement)));
            self.neighbours.relieve(relieved.filter(|&(_, approach)| approach != 0.0));
            // What cement holds together need not press.
            let holds = state.bonds.iter().any(Bond::holds);
            self.negligible_force = if holds { 0.0 } else { model.negligible_force() };
        }
    }

    /// Ends a relaxation that did not move anything: `state` remembers what it did before.
    pub fn keep(&self, state: &mut State) -> Changes {
        state.friction.stored = self.reference.carried_energy();
        Changes::default()
    }

    /// Ends an increment: `state`, whose balance was taken last, remembers its tangential loads.
    pub fn commit(&mut self, model: &Model, state: &mut State) -> Changes {
        if model.is_two_step() {
            // Each step left its loads there.
            return self.two_step.changes;
        }
        self.reference.commit(model, state, &self.balance, &self.neighbours, &mut self.memory)
    }

    /// Takes the linearisation of the balance.
    pub fn assemble(&mut self, model: &Model) {
        self.near_minimum = false;
        match self.reference.active {
            false => self.linear.assemble(&self.balance, &self.neighbours),
            true => self.coupled.assemble(
                &self.balance,
                &self.neighbours,
                &self.reference,
                &model.radius,
                self.reference_stiffness,
            ),
        }
    }

    /// Factorises the linearisation with the shifts as they are.
    fn factorise(&mut self) {
        match self.reference.active {
            false => self.linear.factorise(&self.shift),
            true => self.coupled.factorise(&self.shift),
        }
    }

    /// Solves for the step in at most `most` products after [`assemble`](Self::assemble), with the
    /// shifts as they are, until the preconditioned residual fell by `forcing`; `largest` \[N\]
    /// scales it.
    pub fn solve(&mut self, largest: f64, forcing: f64, most: u32) -> Inner {
        self.factorise();
        self.solve_as_it_is(largest, forcing, most)
    }

    /// The step of grains that are in balance, after [`assemble`](Self::assemble).
    fn rest(&mut self) -> Inner {
        self.factorise();
        for (step, of) in
            [(&mut self.step, &self.balance.gradient), (&mut self.turn, &self.balance.moment)]
        {
            step.clear();
            step.resize(of.len(), Vec3::zeros());
        }
        Inner::Step
    }

    /// As [`solve`](Self::solve), with the last linearisation and shifts.
    fn solve_as_it_is(&mut self, largest: f64, forcing: f64, most: u32) -> Inner {
        let balance = std::mem::take(&mut self.balance);
        let inner = self.solve_again(&balance, largest, forcing, most);
        self.balance = balance;
        inner
    }

    /// Solves with the last linearisation and shifts for the gradient of another balance.
    fn solve_again(&mut self, balance: &Balance, largest: f64, forcing: f64, most: u32) -> Inner {
        let Self { linear, coupled, step, turn, .. } = self;
        let unit = largest / self.reference_stiffness;
        step.clear();
        turn.clear();
        if self.reference.active {
            let inner = coupled.solve(&balance.gradient, &balance.moment, largest, forcing, most);
            for i in 0..balance.gradient.len() {
                let [u, w] = coupled.step(i, unit);
                step.push(u);
                turn.push(w);
            }
            return inner;
        }
        let inner = linear.solve(&balance.gradient, largest, forcing, most);
        step.extend((0..balance.gradient.len()).map(|i| linear.step(i, unit)));
        inner
    }

    /// Takes the balance of `state` moved by `factor` times the step into `trial_balance`.
    fn try_step(&mut self, model: &Model, state: &State, factor: f64) {
        let bounds = self.go(model, state, factor);
        self.judge(model, state, &bounds);
    }

    /// As [`try_step`](Self::try_step), with the loose grains brought to balance where that leads.
    fn try_settled_step(&mut self, model: &Model, state: &State, factor: f64) {
        let bounds = &self.go(model, state, factor);
        self.neighbours.refresh(model, &self.trial, bounds);
        let aim = newton::LOOSE_AIM * newton::least_loose(model, &self.balance);
        let overlap = self.balance.sums.mean_overlap();
        let Self { neighbours, reference, loose, adjacency, trial, trial_rotation, .. } = self;
        let carries = &state.carries;
        let others = Others { model, neighbours, reference, carries, bounds };
        self.concave |= loose.settle(&others, adjacency, trial, trial_rotation, aim, overlap);
        self.judge(model, state, bounds);
    }

    /// Puts the grains of `state`, moved by `factor` times the step, on trial, and the walls under
    /// loads with them; returns the box.
    fn go(&mut self, model: &Model, state: &State, factor: f64) -> Room {
        self.trial_displacement = self.servo.displaced(&state.displacement, factor);
        self.trial.clear();
        self.trial
            .extend(state.position.iter().zip(&self.step).map(|(at, step)| at + step * factor));
        self.trial_rotation.clone_from(&state.rotation);
        for ((at, turn), radius) in
            self.trial_rotation.iter_mut().zip(&self.turn).zip(&model.radius)
        {
            *at += turn * (factor / radius);
        }
        model.bounds(&self.trial_displacement)
    }

    /// Takes the balance of the grains on trial.
    fn judge(&mut self, model: &Model, state: &State, bounds: &Room) {
        self.neighbours.refresh(model, &self.trial, bounds);
        self.trial_balance.evaluate(&Configuration {
            model,
            neighbours: &self.neighbours,
            position: &self.trial,
            rotation: &self.trial_rotation,
            reference: &self.reference,
            carries: &state.carries,
            bounds,
            reference_stiffness: self.reference_stiffness,
        });
        let grains = (&*self.trial, &*state.carries);
        let cement = &self.trial_balance.cement_on_walls;
        let near = &self.neighbours;
        self.trial_balance.unbalance = self.servo.unbalance(model, near, grains, bounds, cement);
    }

    /// Makes the configuration that was tried last the one of `state`.
    fn accept(&mut self, state: &mut State) {
        std::mem::swap(&mut state.position, &mut self.trial);
        std::mem::swap(&mut state.rotation, &mut self.trial_rotation);
        std::mem::swap(&mut self.balance, &mut self.trial_balance);
        state.displacement = self.trial_displacement;
    }

    /// Change of the potential of `balance` along the step \[J\].
    fn slope(&self, balance: &Balance) -> f64 {
        let along = |gradient: &[Vec3], step: &[Vec3]| -> f64 {
            gradient.iter().zip(step).map(|(g, s)| g.dot(s)).sum()
        };
        let walls: f64 = balance.unbalance.iter().zip(self.servo.step).map(|(f, e)| f * e).sum();
        along(&balance.gradient, &self.step) + along(&balance.moment, &self.turn) + walls
    }
}

/// Relaxes `state` at its walls. On a status that is no equilibrium the state is not to be used.
///
/// Where Newton's method runs into an instability the pack goes back to where it was and is
/// followed downhill as overdamped motion would take it, until Newton's method ends in the basin
/// that this leads to. A pack that jumped on the way is noted in `work.jumps`.
pub fn relax(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    work.origin.copy(state);
    let outcome = carrying(model, state, work);
    let descends = model.solver.method == Method::Newton;
    if !descends
        || work.servo.is_active()
        || !matches!(outcome.status, Status::Unstable | Status::Stalled)
    {
        // The other methods descend step by step of their own accord; under loads the walls creep
        // (`advance`).
        return outcome;
    }
    downhill::descend(model, state, work, outcome)
}

/// Relaxes `state` where a minimum is near; instabilities are not followed, and on a status that is
/// no equilibrium the state is not to be used.
pub fn relax_nearby(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    work.origin.copy(state);
    carrying(model, state, work)
}

/// Relaxes the grains that carry load by the scene's method alone.
fn solve(model: &Model, state: &mut State, work: &mut Workspace) -> Solved {
    match model.solver.method {
        Method::Newton => newton::solve(model, state, work),
        Method::ConjugateGradient => conjugate_gradient::solve(model, state, work),
        Method::GaussSeidel => gauss_seidel::solve(model, state, work),
        Method::Dynamic => dynamic::solve(model, state, work),
    }
}

/// Relaxes by the scene's method alone, the floating grains beside those that carry.
fn carrying(model: &Model, state: &mut State, work: &mut Workspace) -> Outcome {
    let (mut iterations, mut round) = (0, 0);
    work.concave = false;
    rattlers::find(model, state, work);
    loop {
        let solved = solve(model, state, work);
        iterations += solved.iterations;
        let (residual, sums) = (solved.residual, work.balance.sums);
        let outcome = |status| Outcome { status, residual, iterations, sums, descents: 0 };
        if !solved.status.is_equilibrium() {
            return outcome(solved.status);
        }
        let joined = rattlers::settle(model, state, work);
        // Grains that were released leave a residual behind that is no longer that of the rest.
        if !joined && residual <= model.solver.tolerance {
            return outcome(solved.status);
        }
        if round == ROUNDS {
            return outcome(Status::MaxIterations);
        }
        round += 1;
    }
}

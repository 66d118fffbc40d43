//! Cooling: grains pushed apart from where they were scattered keep moving, against a drag so
//! weak that they lose their energy over thousands of steps.
//!
//! A pack that is made to descend as fast as it can is caught in the first shallow minimum, on
//! the edge of one rearrangement after another, and spends its time in them. The inertia carries
//! a pack that cools slowly over those edges, into a minimum that is stable against what is left
//! of the motion and that Newton's method reaches in a few steps. It is a little denser.
//!
//! The box sides move too, by the virial of their stress against the one asked for, as in
//! [`fire`](crate::relax::fire). The drag does not couple grains that are far apart, and so the
//! work of a step and the number of steps hardly depend on each other.

mod part;

use rayon::prelude::*;

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::Neighbours;
use crate::model::{self, Model};
use crate::relax::{Status, Workspace};
use crate::state::State;
use crate::wall::Bounds;
use part::{Part, Point, Step, Sums};

/// Mass of a mean grain: 4 times the stiffness of a contact with an overlap of 1e-2.
const MASS: f64 = 0.6;
/// Time step where the mean overlap is 1e-2; it goes with the period of a contact.
const TIME_STEP: f64 = 1.0;
const OVERLAP: f64 = 1e-2;
/// Longest step of a grain over the mean radius, and of a side over itself.
const LONGEST: (f64, f64) = (0.1, 1e-3);
/// Mean contact force over stress and squared mean radius in a jammed pack.
pub const FORCE_PER_STRESS: f64 = 3.4;
/// Skin of the list over the mean radius, and its bounds; it grows when a list served fewer steps
/// than the one and shrinks when it served more than the other.
const SKIN: f64 = 0.2;
const SKINS: (f64, f64) = (0.05, 0.5);
const SERVICE: (u32, u32) = (20, 80);
/// Share of what the skin allows at which the list is made anew rather than measured again.
const SPENT: f64 = 0.7;

/// Where cooling ends.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// Root mean square of the unbalanced forces over the mean contact force.
    pub residual: f64,
    /// Stress that the box is to have \[Pa\]; each normal stress ends within `residual` of it.
    pub pressure: f64,
    /// Share of its velocity that a grain loses in a step, and a side.
    pub drag: f64,
    /// Most steps.
    pub steps: u32,
}

/// What lengths and moduli are counted in.
#[derive(Clone, Copy, Debug)]
struct Units {
    /// Mean radius \[m\].
    length: f64,
    /// M of two mean grains, times the root of the length \[N/m\].
    modulus: f64,
}

/// Cools `state` to `goal`, all grains taking part, with the walls moved alike on both sides of
/// the box. Returns `Converged`, `MaxIterations` or `NonFinite`.
pub fn cool(model: &Model, state: &mut State, work: &mut Workspace, goal: Goal) -> Status {
    state.carries.fill(true);
    let stride = model.len().div_ceil(model::parts(model.len())).max(1);
    let mut motion = Motion::new(model, state, goal.pressure, stride);
    let status = motion.run(model, &mut work.neighbours, &goal);
    motion.leave(model, state);
    status
}

/// A pack in motion; its box has its center at the origin.
struct Motion {
    units: Units,
    position: Vec<Point>,
    parts: Vec<Part>,
    /// Grains of each part but the last.
    stride: usize,
    half: Point,
    center: Vec3,
    /// Rate of the logarithm of each side.
    rate: Point,
    stress: f64,
    list: List,
}

/// What tells whether the list of neighbours still holds.
struct List {
    made_at: Vec<Point>,
    made_in: Point,
    skin: f64,
    /// How far a grain may go before it is to be measured how far they went.
    allowance: f64,
    served: u32,
}

impl Motion {
    /// The pack at rest, in parts of `stride` grains.
    fn new(model: &Model, state: &State, pressure: f64, stride: usize) -> Self {
        let length = model.mean_radius;
        let count = model.len() as f64;
        let compliance = model.compliance.iter().sum::<f64>() / count;
        let modulus = hertz::modulus(0.5 * length, 2.0 * compliance);
        let units = Units { length, modulus };
        let bounds = state.bounds(model);
        let center = Vec3::from(bounds.center());
        let position = (state.position.iter())
            .map(|at| {
                let [x, y, z] = ((at - center) / length).into();
                [x, y, z, 0.0]
            })
            .collect();
        let mass = |(radius, own): (&f64, &f64)| {
            // More contacts on a larger grain, and the stiffness of each.
            let (radius, stiffness) = (radius / length, compliance / own);
            MASS * stiffness * radius.sqrt() * 0.5 * (1.0 + radius * radius)
        };
        let lightness: Vec<f64> =
            (model.radius.iter().zip(&model.compliance)).map(|grain| 1.0 / mass(grain)).collect();
        let parts = (lightness.chunks(stride).enumerate())
            .map(|(k, some)| Part::new(k * stride, some.to_vec()))
            .collect();
        let [x, y, z] = bounds.sides().map(|side| 0.5 * side / length);
        let stress = pressure / modulus * length.sqrt();
        let half = [x, y, z, 0.0];
        let list = List {
            made_at: Vec::new(),
            made_in: half,
            skin: SKIN,
            allowance: 0.0,
            served: SERVICE.0,
        };
        Self { units, position, parts, stride, half, center, rate: [0.0; 4], stress, list }
    }

    fn run(&mut self, model: &Model, neighbours: &mut Neighbours, goal: &Goal) -> Status {
        let count = model.len() as f64;
        // The overlap at the stress asked for bounds the time step where nothing touches.
        let least = (FORCE_PER_STRESS * self.stress).powf(2.0 / 3.0);
        for _ in 0..goal.steps {
            if self.list.allowance <= 0.0 {
                self.refresh(model, neighbours);
            }
            let sums = self.press();
            let volume = 8.0 * self.half[0] * self.half[1] * self.half[2];
            let excess: Point =
                std::array::from_fn(|axis| sums.virial[axis] - self.stress * volume);
            let overlap = sums.mean_overlap().max(least);
            let time = TIME_STEP * (OVERLAP / overlap).powf(0.25);
            self.go(time, 1.0 - goal.drag, &excess, MASS * count);
            let square: f64 = self.parts.iter().map(|part| part.square).sum();
            if !square.is_finite() {
                return Status::NonFinite;
            }
            let uneven = excess[..3].iter().fold(0.0_f64, |most, e| most.max(e.abs()));
            let balanced = (square / count).sqrt() <= goal.residual * sums.mean_force();
            if balanced && uneven <= goal.residual * self.stress * volume {
                return Status::Converged;
            }
        }
        Status::MaxIterations
    }

    /// Takes the forces.
    fn press(&mut self) -> Sums {
        let Self { parts, position, half, .. } = self;
        match parts.as_mut_slice() {
            [only] => only.press(position, half),
            several => several.par_iter_mut().for_each(|part| part.press(position, half)),
        }
        let mut sums = Sums::default();
        for part in parts.iter() {
            sums.add(&part.sums);
        }
        sums
    }

    /// Moves grains and box for `time`, with a share `keep` of their velocities.
    fn go(&mut self, time: f64, keep: f64, excess: &Point, mass: f64) {
        let fastest = LONGEST.1 / time;
        let mut stretch = [1.0; 4];
        for axis in 0..3 {
            let rate = self.rate[axis] * keep + excess[axis] * (time / mass);
            self.rate[axis] = rate.clamp(-fastest, fastest);
            stretch[axis] += self.rate[axis] * time;
            self.half[axis] *= stretch[axis];
        }
        let step = Step { time, keep, limit: LONGEST.0 / time, stretch };
        match self.parts.as_mut_slice() {
            [only] => only.go(&mut self.position, &step),
            several => several
                .par_iter_mut()
                .zip(self.position.par_chunks_mut(self.stride))
                .for_each(|(part, position)| part.go(position, &step)),
        }
        let fastest = self.parts.iter().map(|part| part.fastest).fold(0.0, f64::max);
        self.list.allowance -= fastest * time;
        self.list.served += 1;
    }

    /// Measures how far the grains have gone since the list was made, and makes it anew where that
    /// is about as far as its skin allows.
    fn refresh(&mut self, model: &Model, neighbours: &mut Neighbours) {
        let Self { list, half, units, .. } = self;
        if list.made_at.len() == self.position.len() {
            let scale: [f64; 3] = std::array::from_fn(|axis| half[axis] / list.made_in[axis]);
            let closest = scale.iter().fold(1.0, |least: f64, &s| least.min(s));
            let far2 = (self.position.iter().zip(&list.made_at))
                .map(|(now, made)| {
                    (0..3).map(|k| (now[k] - scale[k] * made[k]).powi(2)).sum::<f64>()
                })
                .fold(0.0, f64::max);
            let reach = 2.0 * model.max_radius / units.length;
            let allowed = 0.5 * (closest * list.skin - (1.0 - closest) * reach);
            if far2.sqrt() < SPENT * allowed {
                // Half of it, so that a box that shrinks meanwhile does not use it up.
                list.allowance = 0.5 * (allowed - far2.sqrt());
                return;
            }
        }
        list.skin = match list.served {
            served if served < SERVICE.0 => (1.5 * list.skin).min(SKINS.1),
            served if served > SERVICE.1 => (0.7 * list.skin).max(SKINS.0),
            _ => list.skin,
        };
        list.served = 0;
        list.allowance = 0.25 * list.skin;
        list.made_at.clone_from(&self.position);
        list.made_in = *half;
        let (positions, bounds) = self.in_meters();
        let length = self.units.length;
        neighbours.make(model, &positions, &bounds.into(), self.list.skin * length);
        let units = self.units;
        self.parts.par_iter_mut().for_each(|part| part.list(model, neighbours, &units));
    }

    /// Centres \[m\] and the box.
    fn in_meters(&self) -> (Vec<Vec3>, Bounds) {
        let length = self.units.length;
        let center = self.center;
        let positions =
            self.position.iter().map(|[x, y, z, _]| center + Vec3::new(*x, *y, *z) * length);
        let half = Vec3::from_fn(|axis, _| self.half[axis] * length);
        let bounds = Bounds { min: (center - half).into(), max: (center + half).into() };
        (positions.collect(), bounds)
    }

    /// Leaves the grains and the walls where they are.
    fn leave(&self, model: &Model, state: &mut State) {
        let (positions, bounds) = self.in_meters();
        state.position = positions;
        for axis in 0..3 {
            state.displacement[2 * axis] = bounds.min[axis] - model.start.min[axis];
            state.displacement[2 * axis + 1] = model.start.max[axis] - bounds.max[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pack::{Grain, Pack};
    use crate::scene::{Solver, Walls};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Random points in a box that is much too small for them.
    fn crowd() -> Model {
        let mut rng = Pcg64::seed_from_u64(3);
        let mut draw = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        let bounds = Bounds { min: [1e-4, 0.0, 0.0], max: [9e-4, 9e-4, 1e-3] };
        let grain = |_| Grain {
            position: std::array::from_fn(|axis| draw(bounds.min[axis], bounds.max[axis])),
            radius: draw(0.5e-4, 1.5e-4),
            young: draw(30e9, 90e9),
            poisson: 0.2,
            density: 2420.0,
            friction: 0.0,
            hydrate: false,
        };
        let grains = (0..150).map(grain).collect();
        let pack = Pack { bounds, grains, history: None };
        Model::with(&pack, &Walls::default(), [0.0; 3], Solver::default(), None)
    }

    #[test]
    fn forces_and_stresses_are_those_of_the_balance_in_one_part_or_several() {
        let model = crowd();
        let state = State::new(&model);
        let bounds = state.bounds(&model);
        let mut work = Workspace::new(&model);
        work.evaluate(&model, &state, &bounds);
        let wanted = &work.balance;
        for stride in [150, 60] {
            let mut motion = Motion::new(&model, &state, 1e6, stride);
            motion.refresh(&model, &mut Neighbours::default());
            let sums = motion.press();
            let Units { length, modulus } = motion.units;
            let force = modulus * length.powf(1.5);
            let unlike = |got: f64, wanted: f64| (got / wanted - 1.0).abs();
            assert!(unlike(sums.mean_force() * force, wanted.sums.mean_force()) < 1e-6);
            assert!(unlike(sums.mean_overlap() * length, wanted.sums.mean_overlap()) < 1e-6);
            for axis in 0..3 {
                let virial = sums.virial[axis] * force * length;
                assert!(unlike(virial, wanted.sums.virial[axis]) < 1e-6, "{stride}: {virial}");
            }
            let gradients = motion.parts.iter().flat_map(Part::gradient);
            let far = wanted.largest() * 1e-6;
            for (got, wanted) in gradients.zip(&wanted.gradient) {
                let got = Vec3::new(got[0], got[1], got[2]) * force;
                assert!((got - wanted).norm() < far, "{stride}: {got} {wanted}");
            }
        }
    }

    #[test]
    fn a_pack_cools_to_the_stress_asked_for_and_the_number_of_threads_does_not_enter() {
        let model = crowd();
        let goal = Goal { residual: 1e-2, pressure: 5e6, drag: 5e-3, steps: 50_000 };
        let cooled = |stride: usize, threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let mut state = State::new(&model);
                let mut motion = Motion::new(&model, &state, goal.pressure, stride);
                let status = motion.run(&model, &mut Neighbours::default(), &goal);
                assert_eq!(status, Status::Converged);
                motion.leave(&model, &mut state);
                state
            })
        };
        let one = cooled(60, 1);
        assert!([2, 3].iter().all(|&threads| cooled(60, threads) == one));
        let whole = cooled(150, 1);
        for state in [one, whole] {
            let bounds = state.bounds(&model);
            let mut work = Workspace::new(&model);
            work.evaluate(&model, &state, &bounds);
            for virial in work.balance.sums.virial {
                let stress = virial / bounds.volume();
                // The state is a step further than the one that was looked at.
                assert!((stress / goal.pressure - 1.0).abs() < 1.5e-2, "{stress}");
            }
        }
    }
}

//! Making a pack from a seed: random points, a jammed state, and compaction to an isotropic stress
//! (T 2.7.2, HZ-14, HZ-15).
//!
//! The thesis starts from a settled sediment of another code; here the loose state is random
//! points in a box a little too small for them. They are pushed apart, and then grains and box
//! move under the stress asked for, against a weak drag, until hardly anything moves
//! ([`cool`]). Newton's method ends in the equilibrium.
//!
//! A low stress is come to from above: near jamming nearly every grain is about to rearrange, and
//! a pack that comes to rest there takes long. It cools where its overlaps are two thousandths of
//! a diameter, and is relieved in stages of a factor of eight at most.
//!
//! The slower a pack cools the denser it is. With 2740 grains at 10 MPa its solid fraction is
//! about 0.002 above that of a pack that descends as fast as it can (0.624 against 0.622), its
//! coordination the same, and 3.2 % of its grains float instead of 2.7 %.

mod cylinder;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::Vec3;
use crate::contact::hertz;
use crate::measure::contacts::Contacts;
use crate::measure::{coordination, walls};
use crate::model::{Model, sphere_volume};
use crate::pack::{Grain, Pack, properties};
use crate::relax::{Outcome, Status, Workspace, cool, fire, relax, relax_nearby};
use crate::scene::{Generate, Material, Method, Solver, Walls};
use crate::state::State;
use crate::wall::Bounds;
use cylinder::Cylinder;

/// Solid fraction of frictionless spheres of similar size where they jam, far from walls.
const JAMMED_FRACTION: f64 = 0.64;
/// Layer of lower density at each wall, in mean diameters: from packs of 300 to 5000 grains.
const WALL_LAYER: f64 = 0.095;
/// Overlap strain beyond that of the stress asked for with which the quench starts.
const QUENCH_STRAIN: f64 = 0.006;
/// Least overlap strain at which a pack cools, and what the stress is divided by in each stage of
/// relief, at most.
const COOLING_STRAIN: f64 = 2e-3;
const RELIEF: f64 = 8.0;
/// Drag on the scattered grains: a factor and the power of their number that it goes with, and its
/// bounds. The more grains, the slower they have to cool, or some place of the pack is still
/// rearranging when the rest has come to rest.
const DRAG: (f64, f64) = (0.015, -0.2);
const DRAGS: (f64, f64) = (1e-3, 5e-3);
/// Drag on a pack that is relieved.
const RELIEF_DRAG: f64 = 0.01;
/// Residual of a stage of relief.
const RELIEVED: f64 = 0.03;
/// Residual at which Newton's method is tried first, and the overlap strain from which on it is
/// that; below, it goes with the root of the strain.
const COLD: (f64, f64) = (3e-3, 2e-3);
/// Times that it is tried, with a third of the residual.
const TRIALS: u32 = 5;
/// Residual to which the scattered grains are pushed apart before the box may move.
const APART: f64 = 0.2;
/// Residuals of the descents under pressure, one after the other until the stress is right.
const DESCENTS: [f64; 4] = [1e-3, 3e-4, 1e-4, 3e-5];
/// Most steps of a descent.
const MOST_STEPS: u32 = 100_000;
/// Newton steps before another descent is the better way.
const MOST_NEWTON_STEPS: u32 = 120;
/// Longest Newton step over the mean overlap: the way to the minimum does not matter here.
const BOLD_STEP: f64 = 10.0;
/// Deviation of each normal stress from the one asked for.
const STRESS_TOLERANCE: f64 = 1e-3;
/// Contacts of a stable grain and their least overlap over the mean radius (T 2.7.2).
const STABLE: (usize, f64) = (4, 1e-5);

/// Why a pack could not be made.
#[derive(Debug, thiserror::Error)]
#[error("pack.generate: {0}; try another seed, more grains or a higher confining_stress")]
pub struct GenerateError(#[from] CompactError);

/// Why a pack could not be brought to a stress.
#[derive(Debug, thiserror::Error)]
pub enum CompactError {
    /// Spheres.
    #[error(
        "no equilibrium at {wanted:.4e} Pa: stress {found:.4e} Pa, {status:?}, residual {residual:.1e}"
    )]
    Spheres {
        /// Mean stress asked for \[Pa\].
        wanted: f64,
        /// Mean stress reached \[Pa\].
        found: f64,
        /// How the last relaxation ended.
        status: Status,
        /// Its residual.
        residual: f64,
    },
    /// Discs.
    #[error("no equilibrium of the discs at {wanted:.4e} Pa: {text}")]
    Discs {
        /// Stress asked for \[Pa\].
        wanted: f64,
        /// What was found.
        text: String,
    },
}

/// Makes the pack of `spec`; `friction` is given to every grain, the relaxation is frictionless.
///
/// # Errors
/// When no equilibrium at the stress asked for is found.
pub fn generate(
    spec: &Generate,
    material: &Material,
    walls: &Walls,
    friction: f64,
    solver: Solver,
) -> Result<Pack, GenerateError> {
    let mut rng = Pcg64::seed_from_u64(spec.seed);
    let grains = draw(spec, material, friction, &mut rng);
    let hole = walls.cell.inner();
    let mut press = Press::new(&scatter(spec, material, hole, grains, &mut rng), walls, solver);
    press.quench();
    // What cools does so in a box.
    if hole.is_some() {
        press.jam(spec.confining_stress);
    }
    if hole.is_some() || !press.cool(spec.confining_stress) {
        press.compact(spec.confining_stress)?;
    }
    for _ in 0..spec.expand_floaters {
        if !press.expand_floaters() {
            break;
        }
        press.compact(spec.confining_stress)?;
    }
    Ok(press.pack())
}

/// The grains of `spec`, nowhere as yet.
pub(super) fn draw(
    spec: &Generate,
    material: &Material,
    friction: f64,
    rng: &mut Pcg64,
) -> Vec<Grain> {
    let grain = |_| {
        let radius = properties::radius(spec.radius, rng);
        let (young, poisson) = properties::draw(material, rng);
        let density = material.density;
        Grain { position: [0.0; 3], radius, young, poisson, density, friction, hydrate: false }
    };
    (0..spec.grains).map(grain).collect()
}

/// Brings `pack` to equilibrium with all three normal stresses at `stress` \[Pa\], without
/// friction and without gravity; it comes back without history.
///
/// # Errors
/// When no equilibrium at the stress asked for is found.
pub fn compact(
    pack: &Pack,
    stress: f64,
    walls: &Walls,
    solver: Solver,
) -> Result<Pack, CompactError> {
    let mut press = Press::new(pack, walls, solver);
    press.compact(stress)?;
    Ok(press.pack())
}

/// Random points in a box in which the grains will be jammed, or in a cylinder around one of radius
/// `inner` \[m\].
fn scatter(
    spec: &Generate,
    material: &Material,
    inner: Option<f64>,
    mut grains: Vec<Grain>,
    rng: &mut Pcg64,
) -> Pack {
    let count = grains.len() as f64;
    let solid: f64 = grains.iter().map(|g| sphere_volume(g.radius)).sum();
    let radius = grains.iter().map(|g| g.radius).sum::<f64>() / count;
    let compliance = hertz::compliance(material.young, material.poisson);
    let strain = overlap_strain(spec.confining_stress, radius, compliance) + QUENCH_STRAIN;
    if let Some(inner) = inner {
        let in_fraction =
            |fraction: f64| Cylinder::of(solid / fraction, spec.aspect[2] / spec.aspect[0], inner);
        let layer = WALL_LAYER * 2.0 * radius * in_fraction(JAMMED_FRACTION).walls_over_volume();
        let fraction = JAMMED_FRACTION * (1.0 - layer).max(0.5) * (1.0 + 3.0 * strain);
        return in_fraction(fraction).scatter(grains, rng);
    }
    let side = (solid / JAMMED_FRACTION).cbrt();
    let near_walls = 1.0 - 6.0 * WALL_LAYER * 2.0 * radius / side;
    let fraction = JAMMED_FRACTION * near_walls.max(0.5) * (1.0 + 3.0 * strain);
    let scale = (solid / fraction / spec.aspect.iter().product::<f64>()).cbrt();
    let half = spec.aspect.map(|a| 0.5 * a * scale);
    for grain in &mut grains {
        grain.position = std::array::from_fn(|axis| {
            (2.0 * rng.random::<f64>() - 1.0) * (half[axis] - grain.radius).max(0.0)
        });
    }
    Pack { bounds: Bounds { min: half.map(|h| -h), max: half }, grains, history: None }
}

/// Mean overlap over the diameter in a jammed pack at `stress` \[Pa\], of grains with a mean radius
/// \[m\] and a mean compliance \[1/Pa\].
fn overlap_strain(stress: f64, radius: f64, compliance: f64) -> f64 {
    let modulus = hertz::modulus(0.5 * radius, 2.0 * compliance);
    let force = cool::FORCE_PER_STRESS * stress * radius * radius;
    (force / modulus).powf(2.0 / 3.0) / (2.0 * radius)
}

/// A pack between walls that move at will.
struct Press {
    model: Model,
    state: State,
    work: Workspace,
    walls: Walls,
}

impl Press {
    fn new(pack: &Pack, walls: &Walls, solver: Solver) -> Self {
        // Without gaps, and without what bends with the grains.
        let walls = Walls { open: Vec::new(), membranes: Vec::new(), ..walls.clone() };
        let max_iterations = Some(MOST_NEWTON_STEPS);
        let solver = Solver { method: Method::Newton, max_iterations, ..solver };
        let model = Model::with(pack, &walls, [0.0; 3], solver, None);
        let work = Workspace::new(&model);
        Self { state: State::new(&model), work, walls, model }
    }

    /// Pushes the scattered grains apart.
    fn quench(&mut self) {
        self.descend(APART, None);
        self.resort();
    }

    /// Brings the mean stress to `pressure` \[Pa\], with the proportions that the pack has: what is not
    /// jammed yet has nothing that keeps them.
    fn jam(&mut self, pressure: f64) {
        let (residual, pressure) = (DESCENTS[0], Some(pressure));
        let goal = fire::Goal { residual, pressure, even: true, steps: MOST_STEPS };
        fire::descend(&self.model, &mut self.state, &mut self.work, goal);
    }

    fn descend(&mut self, residual: f64, pressure: Option<f64>) {
        let goal = fire::Goal { residual, pressure, even: false, steps: MOST_STEPS };
        fire::descend(&self.model, &mut self.state, &mut self.work, goal);
    }

    /// Cools with all three normal stresses at `pressure` \[Pa\] until the residual is reached.
    fn go_cold(&mut self, pressure: f64, residual: f64, drag: f64) -> Status {
        let goal = cool::Goal { residual, pressure, drag, steps: MOST_STEPS };
        cool::cool(&self.model, &mut self.state, &mut self.work, goal)
    }

    /// Cools the pack to the equilibrium with all three normal stresses at `target` \[Pa\]; says
    /// whether it came to one.
    fn cool(&mut self, target: f64) -> bool {
        let count = self.model.len() as f64;
        let compliance = self.model.compliance.iter().sum::<f64>() / count;
        let strain = overlap_strain(target, self.model.mean_radius, compliance);
        let mut drag = (DRAG.0 * count.powf(DRAG.1)).clamp(DRAGS.0, DRAGS.1);
        // The stress goes with the strain to the power of 1.5.
        let above = (COOLING_STRAIN / strain).powf(1.5).max(1.0);
        let stages = (above.ln() / RELIEF.ln()).ceil() as i32;
        for stage in 0..stages {
            let pressure = target * above.powf(1.0 - f64::from(stage) / f64::from(stages));
            self.go_cold(pressure, RELIEVED, drag);
            drag = RELIEF_DRAG;
        }
        let mut residual = COLD.0 * (strain / COLD.1).sqrt().min(1.0);
        for _ in 0..TRIALS {
            if self.go_cold(target, residual, drag) != Status::Converged {
                return false;
            }
            self.resort();
            let state = self.state.clone();
            (self.work.step_cap, self.work.follows) = (BOLD_STEP, false);
            let outcome = relax_nearby(&self.model, &mut self.state, &mut self.work);
            if self.is_at(target, &outcome) {
                return true;
            }
            self.state = state;
            residual /= 3.0;
        }
        false
    }

    fn is_at(&self, target: f64, outcome: &Outcome) -> bool {
        let miss = (self.stress() - Vec3::repeat(target)).amax();
        outcome.status == Status::Converged && miss <= STRESS_TOLERANCE * target
    }

    /// Brings the pack to equilibrium with all three normal stresses at `target` \[Pa\].
    fn compact(&mut self, target: f64) -> Result<(), CompactError> {
        let mut outcome = Outcome::NONE;
        for residual in DESCENTS {
            self.descend(residual, Some(target));
            self.resort();
            (self.work.step_cap, self.work.follows) = (BOLD_STEP, false);
            outcome = relax(&self.model, &mut self.state, &mut self.work);
            if self.is_at(target, &outcome) {
                return Ok(());
            }
        }
        let Outcome { status, residual, .. } = outcome;
        let found = self.stress().mean();
        Err(CompactError::Spheres { wanted: target, found, status, residual })
    }

    /// Normal stresses \[Pa\]: of a round pack those of its outer wall and its ends, for an inner wall
    /// stands and carries what it has to.
    fn stress(&self) -> Vec3 {
        let room = self.state.bounds(&self.model);
        if room.is_round() {
            let force = walls::normal_forces(&self.model, &self.state, &self.work.neighbours);
            let on = |w: usize| force[w] / room.area(w);
            return Vec3::new(on(1), on(1), 0.5 * (on(4) + on(5)));
        }
        Vec3::from(self.work.balance.sums.virial) / self.state.bounds(&self.model).volume()
    }

    /// Sorts the solver's order anew: the grains are no longer where they were scattered.
    fn resort(&mut self) {
        let bounds = *self.state.bounds(&self.model);
        let mut pack = Pack { bounds, grains: self.model.grains.clone(), history: None };
        let before = std::mem::take(&mut self.model.order);
        for (grain, at) in pack.grains.iter_mut().zip(&self.state.position) {
            grain.position = (*at).into();
        }
        self.model = Model::with(&pack, &self.walls, [0.0; 3], self.model.solver, None);
        for place in &mut self.model.order {
            *place = before[*place as usize];
        }
        self.state = State::new(&self.model);
        self.work = Workspace::new(&self.model);
    }

    /// Expands grains with fewer than four contacts until they have four (T 2.7.2); says whether
    /// there were any.
    fn expand_floaters(&mut self) -> bool {
        let contacts = Contacts::of(&self.model, &self.state, &self.work.neighbours);
        let numbers = coordination::numbers(&self.model, contacts.counted());
        let bounds = self.state.bounds(&self.model);
        let least = STABLE.1 * self.model.mean_radius;
        let mut grains = self.model.grains.clone();
        let mut any = false;
        for i in (0..self.model.len()).filter(|&i| (numbers[i] as usize) < STABLE.0) {
            let at = self.state.position[i];
            let mut gaps: Vec<f64> = (0..self.model.len())
                .filter(|&j| j != i)
                .map(|j| (at - self.state.position[j]).norm() - self.model.radius[j])
                .chain((0..6).filter(|&w| bounds.has(w)).map(|w| bounds.gap(&at, w)))
                .collect();
            gaps.sort_unstable_by(f64::total_cmp);
            if let Some(&reach) = gaps.get(STABLE.0 - 1) {
                grains[i].radius = grains[i].radius.max(reach + least);
                any = true;
            }
        }
        if any {
            self.model.grains = grains;
            self.resort();
        }
        any
    }

    /// The pack in the order in which its grains were drawn.
    fn pack(&self) -> Pack {
        let mut grains = self.model.grains.clone();
        for (k, &place) in self.model.order.iter().enumerate() {
            let position = self.state.position[k].into();
            grains[place as usize] = Grain { position, ..self.model.grains[k] };
        }
        Pack { bounds: *self.state.bounds(&self.model), grains, history: None }
    }
}

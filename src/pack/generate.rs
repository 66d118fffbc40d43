//! Making a pack from a seed: random points, a quench to a jammed state, and compaction to an
//! isotropic stress (T 2.7.2, HZ-14, HZ-15).
//!
//! The thesis starts from a settled sediment of another code; here the loose state is random
//! points in a box a little too small for them, quenched by an inertial descent. From there the
//! box follows p^(2/3), which is nearly linear in strain, to the stress asked for.

use nalgebra::{Matrix3, Vector3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::Vec3;
use crate::contact::hertz;
use crate::measure::contacts::Contacts;
use crate::measure::{coordination, stress, walls};
use crate::model::{Model, sphere_volume};
use crate::pack::{Grain, Pack, properties};
use crate::relax::{Status, Workspace, fire, relax};
use crate::scene::{Generate, Material, Solver, Walls};
use crate::state::State;
use crate::wall::Bounds;

/// Solid fraction of frictionless spheres of similar size where they jam, far from walls.
const JAMMED_FRACTION: f64 = 0.64;
/// Layer of lower density at each wall, in mean diameters: from packs of 300 to 5000 grains.
const WALL_LAYER: f64 = 0.095;
/// Overlap strain beyond that of the stress asked for with which the quench starts.
const QUENCH_STRAIN: f64 = 0.006;
/// Mean contact force over stress and squared mean radius in a jammed pack.
const FORCE_PER_STRESS: f64 = 3.4;
/// Residual and most steps of the quench.
const QUENCH: (f64, u32) = (1e-2, 20_000);
/// Residual while the box still moves.
const ROUGH: f64 = 1e-5;
/// Deviation of each normal stress from the one asked for.
const STRESS_TOLERANCE: f64 = 1e-3;
/// Moves of the box.
const MOST_MOVES: u32 = 60;
/// Largest change of the overlap strain in one move, as a share of it.
const LARGEST_MOVE: f64 = 0.7;
/// Contacts of a stable grain and their least overlap over the mean radius (T 2.7.2).
const STABLE: (usize, f64) = (4, 1e-5);

/// Why a pack could not be made.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// The box did not come to the stress asked for.
    #[error(
        "pack.generate: after {moves} moves of the box the stress is {found:.4e} Pa instead of \
         {wanted:.4e} Pa; try another seed, more grains or a higher confining_stress"
    )]
    Stress {
        /// Moves of the box.
        moves: u32,
        /// Mean stress reached \[Pa\].
        found: f64,
        /// Mean stress asked for \[Pa\].
        wanted: f64,
    },
    /// The relaxation failed.
    #[error("pack.generate: no equilibrium at {stress:.4e} Pa ({status:?}, residual {residual:.1e})")]
    Relax {
        /// Mean stress \[Pa\].
        stress: f64,
        /// How the relaxation ended.
        status: Status,
        /// Its residual.
        residual: f64,
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
    let grains: Vec<Grain> = (0..spec.grains)
        .map(|_| {
            let radius = properties::radius(spec.radius, &mut rng);
            let (young, poisson) = properties::draw(material, &mut rng);
            let density = material.density;
            Grain { position: [0.0; 3], radius, young, poisson, density, friction }
        })
        .collect();
    let mut press = Press::new(scatter(spec, material, grains, &mut rng), walls, solver);
    press.quench();
    press.compact(spec.confining_stress)?;
    for _ in 0..spec.expand_floaters {
        if !press.expand_floaters() {
            break;
        }
        press.compact(spec.confining_stress)?;
    }
    press.finish(solver)
}

/// Random points in a box in which the grains will be jammed.
fn scatter(spec: &Generate, material: &Material, mut grains: Vec<Grain>, rng: &mut Pcg64) -> Pack {
    let count = grains.len() as f64;
    let solid: f64 = grains.iter().map(|g| sphere_volume(g.radius)).sum();
    let radius = grains.iter().map(|g| g.radius).sum::<f64>() / count;
    let modulus =
        hertz::modulus(0.5 * radius, 2.0 * hertz::compliance(material.young, material.poisson));
    let force = FORCE_PER_STRESS * spec.confining_stress * radius * radius;
    let strain = (force / modulus).powf(2.0 / 3.0) / (2.0 * radius) + QUENCH_STRAIN;
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
    Pack { bounds: Bounds { min: half.map(|h| -h), max: half }, grains }
}

/// A pack between walls that move at will.
struct Press {
    model: Model,
    state: State,
    work: Workspace,
    walls: Walls,
}

impl Press {
    fn new(pack: Pack, walls: &Walls, solver: Solver) -> Self {
        let solver = Solver { tolerance: ROUGH.max(solver.tolerance), ..solver };
        let model = Model::with(&pack, walls, [0.0; 3], solver, None);
        Self { state: State::new(&model), work: Workspace::new(&model), walls: *walls, model }
    }

    /// Descends from wherever the grains are to a rough equilibrium.
    fn quench(&mut self) {
        self.state.carries.fill(true);
        fire::descend(&self.model, &mut self.state, &mut self.work, QUENCH.0, QUENCH.1);
        self.resort();
    }

    /// Sorts the solver's order anew: the grains are no longer where they were scattered.
    fn resort(&mut self) {
        let bounds = self.state.bounds(&self.model);
        let mut pack = Pack { bounds, grains: self.model.grains.clone() };
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

    /// Relaxes; from where Newton's method fails an inertial descent leads on.
    fn relax(&mut self) -> Result<(), GenerateError> {
        let mut outcome = relax(&self.model, &mut self.state, &mut self.work);
        for residual in [1e-2, 1e-3, 1e-4] {
            if outcome.status.is_equilibrium() {
                return Ok(());
            }
            self.state.carries.fill(true);
            fire::descend(&self.model, &mut self.state, &mut self.work, residual, QUENCH.1);
            outcome = relax(&self.model, &mut self.state, &mut self.work);
        }
        if outcome.status.is_equilibrium() {
            return Ok(());
        }
        let crate::relax::Outcome { status, residual, .. } = outcome;
        Err(GenerateError::Relax { stress: self.stress().mean(), status, residual })
    }

    /// Normal stresses \[Pa\] on the walls.
    fn stress(&mut self) -> Vector3<f64> {
        let bounds = self.state.bounds(&self.model);
        self.work.neighbours.refresh(&self.model, &self.state.position, &bounds);
        let contacts = Contacts::of(&self.model, &self.state, &self.work.neighbours);
        let forces = walls::forces(&self.model, &self.state, &contacts.list);
        stress::from_walls(&forces, &bounds).diagonal()
    }

    /// Strains the box, compression positive, and the grains with it.
    fn strain(&mut self, strain: Vec3) -> Result<(), GenerateError> {
        let before = self.state.bounds(&self.model);
        let sides = before.sides();
        let target: [f64; 6] = std::array::from_fn(|w| {
            self.state.displacement[w] + 0.5 * strain[w / 2] * sides[w / 2]
        });
        crate::relax::advance::move_walls(&self.model, &mut self.state, &target, 1.0);
        self.relax()
    }

    /// Brings all three normal stresses to `target` \[Pa\].
    fn compact(&mut self, target: f64) -> Result<(), GenerateError> {
        self.relax()?;
        let mut now = self.stress();
        // p^(2/3) = slope (strain - strain at jamming), so dp/dstrain = 3/2 slope p^(1/3).
        let mut slope: Option<f64> = None;
        let mut moves = 0;
        while (now.mean() / target - 1.0).abs() > 0.02 {
            moves += 1;
            if moves > MOST_MOVES {
                return Err(GenerateError::Stress { moves, found: now.mean(), wanted: target });
            }
            let (root, wanted) = (now.mean().powf(2.0 / 3.0), target.powf(2.0 / 3.0));
            let overlap_strain =
                self.work.balance.sums.mean_overlap() / (2.0 * self.model.mean_radius);
            let move_by = if root == 0.0 {
                QUENCH_STRAIN
            } else {
                let slope = slope.unwrap_or(root / overlap_strain);
                let limit = LARGEST_MOVE * overlap_strain;
                ((wanted - root) / slope).clamp(-limit, (2.0 * limit).max(1e-4))
            };
            self.strain(Vec3::repeat(move_by))?;
            let then = now;
            now = self.stress();
            let risen = now.mean().powf(2.0 / 3.0) - then.mean().powf(2.0 / 3.0);
            let new_slope = risen / move_by;
            slope = (root > 0.0 && new_slope > 0.0).then_some(new_slope);
        }
        self.level(target, now, slope, moves)
    }

    /// Brings each normal stress to `target` by Broyden's method, from an isotropic guess.
    fn level(
        &mut self,
        target: f64,
        mut now: Vector3<f64>,
        slope: Option<f64>,
        mut moves: u32,
    ) -> Result<(), GenerateError> {
        let overlap_strain = self.work.balance.sums.mean_overlap() / (2.0 * self.model.mean_radius);
        let slope = slope.unwrap_or(target.powf(2.0 / 3.0) / overlap_strain);
        // dσ/dε of an isotropic strain is 3K; a frictionless pack has little G.
        let bulk = 0.5 * slope * target.cbrt();
        let shear = 0.2 * bulk;
        let mut stiffness = Matrix3::repeat(bulk - 2.0 / 3.0 * shear)
            + Matrix3::identity() * (2.0 * shear);
        while (now - Vector3::repeat(target)).amax() > STRESS_TOLERANCE * target {
            moves += 1;
            let failed = GenerateError::Stress { moves, found: now.mean(), wanted: target };
            if moves > MOST_MOVES {
                return Err(failed);
            }
            let Some(inverse) = stiffness.try_inverse() else { return Err(failed) };
            let limit = 0.2 * overlap_strain;
            let strain =
                (inverse * (Vector3::repeat(target) - now)).map(|e| e.clamp(-limit, limit));
            self.strain(strain)?;
            let then = now;
            now = self.stress();
            let miss = now - then - stiffness * strain;
            let update = miss * strain.transpose() / strain.norm_squared();
            if update.norm() < 0.5 * stiffness.norm() {
                stiffness += update;
            }
        }
        Ok(())
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
                .chain((0..6).map(|w| crate::contact::neighbours::wall_gap(&at, w, &bounds)))
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

    /// The pack in the order in which its grains were drawn, relaxed to the scene's tolerance.
    fn finish(mut self, solver: Solver) -> Result<Pack, GenerateError> {
        self.model.solver.tolerance = solver.tolerance;
        self.relax()?;
        let mut grains = self.model.grains.clone();
        for (k, &place) in self.model.order.iter().enumerate() {
            let position = self.state.position[k].into();
            grains[place as usize] = Grain { position, ..self.model.grains[k] };
        }
        Ok(Pack { bounds: self.state.bounds(&self.model), grains })
    }
}

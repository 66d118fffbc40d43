//! Grains that their contacts hardly hold. With friction a few of them roll or slide far while the
//! rest of the pack hardly moves, and each would take many steps of Newton's method of its own. So
//! each step ends with bringing them to balance one by one while the others stay (18-19 of van
//! Baars' seed, with the whole tangent), which lowers the same energy.

use nalgebra::{Matrix3, Matrix6, Vector6};

use crate::Vec3;
use crate::contact::hertz;
use crate::heap;
use crate::relax::site::{Adjacency, Grip, Others, Press, Site};

/// Longest step of a grain over the mean overlap.
const LONGEST: f64 = 0.1;
/// Sweeps over the loose grains, and steps of one grain in one of them.
const SWEEPS: u32 = 2;
const STEPS: u32 = 30;
/// Least part of a step that is tried.
const LEAST_FACTOR: f64 = 1.0 / 256.0;
/// First shift where the energy is concave over the mean stiffness of the grain, and its growth.
const FIRST_SHIFT: f64 = 1e-3;
const GROWTH: f64 = 8.0;
const MOST_SHIFTS: u32 = 12;
/// Stiffness of what nothing holds, over the mean, without cement and with it: a grain that hangs on
/// one bond may roll about it.
const NEUTRAL: [f64; 2] = [1e-12, 1e-8];
/// Change of an energy that is rounding, as a share of it.
const ROUNDING: f64 = 1e-14;

/// The loose grains of one search.
#[derive(Clone, Debug, Default)]
pub(super) struct Loose {
    is_loose: Vec<bool>,
    grains: Vec<u32>,
}

/// A step of one grain, displacement and rotation times radius \[m\].
struct Step {
    u: Vec3,
    w: Vec3,
    /// Whether the energy is concave.
    shifted: bool,
}

/// Energy of one grain with its derivatives with respect to (u, w).
struct Local {
    energy: f64,
    gradient: Vector6<f64>,
    hessian: Matrix6<f64>,
    /// Stiffness of what nothing holds, over the mean.
    neutral: f64,
}

impl Loose {
    /// Begins a search in a pack of `n` grains, with none loose.
    pub(super) fn begin(&mut self, n: usize) {
        self.is_loose.clear();
        self.is_loose.resize(n, false);
        self.grains.clear();
    }

    /// Takes grain `i` as loose.
    pub(super) fn add(&mut self, i: usize) {
        if !self.is_loose[i] {
            self.is_loose[i] = true;
            self.grains.push(i as u32);
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.is_loose) + heap::bytes(&self.grains)
    }

    /// Moves the loose grains in `position` and `rotation` to where their unbalanced force is at
    /// most `aim` \[N\], in steps of a share of `overlap` \[m\]. Says whether one of them met a
    /// concave energy. Those that one step balances are no longer loose.
    pub(super) fn settle(
        &mut self,
        others: &Others<'_>,
        adjacency: &mut Adjacency,
        position: &mut [Vec3],
        rotation: &mut [Vec3],
        aim: f64,
        overlap: f64,
    ) -> bool {
        if self.grains.is_empty() {
            return false;
        }
        adjacency.refresh(others);
        let mut bench = Bench { others, adjacency, position, rotation, aim, overlap };
        let mut concave = false;
        let Self { is_loose, grains } = self;
        grains.retain(|&i| {
            let way = bench.balance(i as usize);
            concave |= way.concave;
            is_loose[i as usize] = way.tries > 1;
            is_loose[i as usize]
        });
        for _ in 1..SWEEPS {
            for &i in &*grains {
                concave |= bench.balance(i as usize).concave;
            }
        }
        concave
    }
}

/// Where single grains are brought to balance.
struct Bench<'a> {
    others: &'a Others<'a>,
    adjacency: &'a Adjacency,
    position: &'a mut [Vec3],
    rotation: &'a mut [Vec3],
    aim: f64,
    overlap: f64,
}

/// How a grain came to its balance.
struct Way {
    /// Places tried.
    tries: u32,
    /// Whether the energy was concave on the way.
    concave: bool,
}

impl Bench<'_> {
    fn local(&self, i: usize) -> Local {
        let Self { others, adjacency, position, rotation, .. } = self;
        Local::of(&Site { others, adjacency, position, rotation }, i)
    }

    /// Brings grain `i` to balance, if it carries load.
    fn balance(&mut self, i: usize) -> Way {
        let mut way = Way { tries: 0, concave: false };
        if !self.others.carries[i] {
            return way;
        }
        let potential = self.others.model.has_potential();
        let mut local = self.local(i);
        for _ in 0..STEPS {
            if local.unbalanced() <= self.aim {
                break;
            }
            let Some(step) = local.step(LONGEST * self.overlap) else { break };
            way.concave |= step.shifted;
            let (at, turn) = (self.position[i], self.rotation[i]);
            let mut factor = 1.0;
            local = loop {
                self.position[i] = at + step.u * factor;
                self.rotation[i] = turn + step.w * (factor / self.others.model.radius[i]);
                way.tries += 1;
                let next = self.local(i);
                if next.is_better(&local, potential) {
                    break next;
                }
                factor *= 0.5;
                if factor < LEAST_FACTOR {
                    (self.position[i], self.rotation[i]) = (at, turn);
                    return way;
                }
            };
        }
        way
    }
}

impl Local {
    fn of(site: &Site<'_>, i: usize) -> Self {
        let neutral = NEUTRAL[usize::from(site.others.reference.is_cemented())];
        let (gradient, hessian) = (Vector6::zeros(), Matrix6::zeros());
        let mut local = Self { energy: 0.0, gradient, hessian, neutral };
        let Others { model, bounds, .. } = *site.others;
        let radius = model.radius[i];
        if let Some(weight) = model.weight.get(i) {
            let origin = Vec3::from(bounds.center());
            local.energy -= weight.dot(&(site.position[i] - origin));
            local.add_gradient(&[-weight, Vec3::zeros()]);
        }
        site.presses(i, |press| local.press(&press));
        site.grips(i, |grip| local.grip(&grip, radius));
        local
    }

    fn add_gradient(&mut self, [u, w]: &[Vec3; 2]) {
        let mut part = self.gradient.fixed_rows_mut::<3>(0);
        part += u;
        let mut part = self.gradient.fixed_rows_mut::<3>(3);
        part += w;
    }

    fn press(&mut self, press: &Press) {
        let Press { modulus, overlap, normal, curvature } = *press;
        let force = hertz::force(modulus, overlap);
        let bending = force * curvature;
        self.energy += hertz::energy(force, overlap);
        self.add_gradient(&[-normal * force, Vec3::zeros()]);
        let axial = hertz::stiffness(modulus, overlap) + bending;
        let mut block = self.hessian.fixed_view_mut::<3, 3>(0, 0);
        block += normal * normal.transpose() * axial - Matrix3::identity() * bending;
    }

    fn grip(&mut self, grip: &Grip<'_>, radius: f64) {
        let Grip { traction, pull, second, .. } = grip;
        self.energy += pull.potential;
        self.add_gradient(&grip.gradient(radius));
        let double = |v: [f32; 3]| Vec3::from(v.map(f64::from));
        let (n, e) = (double(traction.normal), double(traction.direction));
        let (across, sliding) = (f64::from(traction.across), f64::from(traction.sliding));
        let lever = pull.arm[usize::from(*second)] / radius;
        let twist = f64::from(traction.torsion) / (radius * radius);
        // The sliding displacement is ±T u + λ n̂ × w, and e·(n̂ × w) = (e × n̂)·w.
        let sign = if *second { -1.0 } else { 1.0 };
        let f = e.cross(&n);
        let plane = Matrix3::identity() - n * n.transpose();
        let (axial, bending) = (f64::from(traction.axial), f64::from(traction.bending));
        let u = plane * across + e * e.transpose() * sliding + n * n.transpose() * axial
            - Matrix3::identity() * bending;
        let uw = (n.cross_matrix() * across + e * f.transpose() * sliding) * (sign * lever);
        let w = (plane * across + f * f.transpose() * sliding) * (lever * lever)
            + n * n.transpose() * twist;
        for (row, column, part) in [(0, 0, u), (0, 3, uw), (3, 0, uw.transpose()), (3, 3, w)] {
            let mut block = self.hessian.fixed_view_mut::<3, 3>(row, column);
            block += part;
        }
    }

    /// Unbalanced force, or moment over radius \[N\].
    fn unbalanced(&self) -> f64 {
        self.gradient.fixed_rows::<3>(0).norm().max(self.gradient.fixed_rows::<3>(3).norm())
    }

    /// Whether this is further down than `before`; where rounding hides it and where the energy is
    /// no `potential` of the forces, whether it is nearer to the balance.
    fn is_better(&self, before: &Self, potential: bool) -> bool {
        let change = self.energy - before.energy;
        let rounding = ROUNDING * before.energy.abs();
        let nearer = self.unbalanced() < before.unbalanced();
        if potential { change < -rounding || (change <= rounding && nearer) } else { nearer }
    }

    /// A step downhill of at most `longest` \[m\].
    fn step(&self, longest: f64) -> Option<Step> {
        let mean = self.hessian.trace() / 6.0;
        let mut shift = 0.0;
        for _ in 0..MOST_SHIFTS {
            // A grain may turn freely about its contacts.
            let diagonal = shift + self.neutral * mean;
            if let Some(factor) = (self.hessian + Matrix6::identity() * diagonal).cholesky() {
                let step = -factor.solve(&self.gradient);
                let [u, w] = [0, 3].map(|k| Vec3::from(step.fixed_rows::<3>(k)));
                let length = u.norm().max(w.norm());
                let cut = if length > longest { longest / length } else { 1.0 };
                return Some(Step { u: u * cut, w: w * cut, shifted: shift > 0.0 });
            }
            shift = (GROWTH * shift).max(FIRST_SHIFT * mean);
        }
        None
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that fails may panic")]
pub(super) mod tests {
    use super::*;
    use crate::pack::generate::generate;
    use crate::relax::Workspace;
    use crate::relax::advance::move_walls;
    use crate::scene::{Coulomb, Friction, Generate, Law, Material, Radius, Scene, Update};
    use crate::state::State;

    /// A pack at 1 MPa whose grains went with the walls since their contacts were taken as the
    /// reference, by so much that some of them slide, and one that was pushed aside.
    pub(in crate::relax) fn strained(aside: usize) -> (crate::model::Model, State, Workspace) {
        let recipe = Generate {
            grains: 40,
            radius: Radius::Uniform([0.07e-3, 0.13e-3]),
            material: "glass".into(),
            seed: 3,
            confining_stress: 1e6,
            aspect: [1.0; 3],
            expand_floaters: 0,
            compaction_friction: 0.0,
        };
        let glass = Material { young: 70e9, poisson: 0.2, density: 2420.0, spread: 0.0 };
        let text = "pack: {file: none.csv, material: glass}";
        let mut scene: Scene = crate::scene::parse(text, "scene.yaml".as_ref()).unwrap();
        let mut pack = generate(&recipe, &glass, &scene.walls, 0.0, scene.solver).unwrap();
        pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
        let coulomb = Coulomb { coefficient: 0.3, law: Law::ReturnMap, update: Update::Frozen };
        scene.contact.friction = Friction::Coulomb(coulomb);
        scene.walls.friction = Some(0.2);
        let model = crate::model::Model::new(&pack, &scene);
        let mut state = State::new(&model);
        let mut work = Workspace::new(&model);
        work.begin(&model, &state);
        let side = model.start.sides()[2];
        move_walls(&model, &mut state, &[0.0, 0.0, 0.0, 0.0, 0.0, 5e-4 * side], 1.0);
        state.position[aside] += Vec3::new(2e-8, -3e-8, 1e-8);
        state.rotation[aside] += Vec3::new(1e-4, 2e-4, -1e-4);
        let bounds = state.bounds(&model);
        work.evaluate(&model, &state, &bounds);
        (model, state, work)
    }

    fn others<'a>(
        model: &'a crate::model::Model,
        state: &'a State,
        work: &'a Workspace,
        bounds: &'a crate::wall::Room,
    ) -> Others<'a> {
        let Workspace { neighbours, reference, .. } = work;
        Others { model, neighbours, reference, carries: &state.carries, bounds }
    }

    #[test]
    fn gradient_and_hessian_of_one_grain_are_those_of_its_energy() {
        let (model, state, work) = strained(7);
        let bounds = state.bounds(&model);
        let others = others(&model, &state, &work, &bounds);
        let mut adjacency = Adjacency::default();
        adjacency.refresh(&others);
        let mut slides = 0;
        for i in (0..model.len()).filter(|&i| state.carries[i]) {
            let at = |k: usize, by: f64| {
                let (mut position, mut rotation) = (state.position.clone(), state.rotation.clone());
                match k {
                    0..3 => position[i][k] += by,
                    _ => rotation[i][k - 3] += by / model.radius[i],
                }
                let (position, rotation) = (&position[..], &rotation[..]);
                let site = Site { others: &others, adjacency: &adjacency, position, rotation };
                site.grips(i, |grip| slides += u32::from(grip.traction.slides));
                Local::of(&site, i)
            };
            let mut at = at;
            let here = at(0, 0.0);
            let (force, stiffness) = (here.gradient.amax(), here.hessian.amax());
            if stiffness == 0.0 {
                // It floats.
                continue;
            }
            let by = 1e-12;
            for k in 0..6 {
                let (up, down) = (at(k, by), at(k, -by));
                let slope = (up.energy - down.energy) / (2.0 * by);
                // The potential of the shear follows its forces up to the strain.
                assert!((slope - here.gradient[k]).abs() < 2e-3 * force, "grain {i}, {k}");
                let column = (up.gradient - down.gradient) / (2.0 * by);
                // Terms of the order Q/r against the stiffnesses are left out.
                let off = (column - here.hessian.column(k)).amax();
                assert!(off < 1e-3 * stiffness, "grain {i}, {k}: {off} of {stiffness}");
            }
        }
        assert!(slides > 0);
    }

    #[test]
    fn a_grain_pushed_aside_finds_its_balance_and_leaves_the_others_alone() {
        let aside = 7;
        let (model, mut state, mut work) = strained(aside);
        let bounds = state.bounds(&model);
        let force = crate::relax::newton::mean_square(&work.balance).sqrt();
        let overlap = work.balance.sums.mean_overlap();
        let off = |work: &Workspace| {
            let (force, moment) = (work.balance.gradient[aside], work.balance.moment[aside]);
            force.norm().max(moment.norm())
        };
        assert!(state.carries[aside] && off(&work) > 0.1 * force);
        let before = (state.clone(), work.balance.potential());
        let mut loose = Loose::default();
        loose.begin(model.len());
        loose.add(aside);
        let (mut position, mut rotation) = (state.position.clone(), state.rotation.clone());
        let mut adjacency = Adjacency::default();
        let others = others(&model, &state, &work, &bounds);
        let aim = 1e-2 * force;
        loose.settle(&others, &mut adjacency, &mut position, &mut rotation, aim, overlap);
        (state.position, state.rotation) = (position, rotation);
        // The balance of the whole pack, taken by other code, says so too.
        work.evaluate(&model, &state, &bounds);
        assert!(off(&work) <= 1.001 * aim, "{} of {force}", off(&work));
        assert!(work.balance.potential() < before.1);
        for i in (0..model.len()).filter(|&i| i != aside) {
            assert_eq!(state.position[i], before.0.position[i]);
            assert_eq!(state.rotation[i], before.0.rotation[i]);
        }
    }
}

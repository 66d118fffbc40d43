//! The balance of a frictional pack, taken anew from the thesis' formulas, and its linearisation.

use std::f64::consts::PI;
use std::sync::OnceLock;

use graintwin::Vec3;
use graintwin::contact::Other;
use graintwin::model::Model;
use graintwin::pack::{ContactMemory, History, Pack, wall_of};
use graintwin::relax::Workspace;
use graintwin::relax::linear::Inner;
use graintwin::report::PackState;
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::state::{Memory, State};
use graintwin::wall;
use proptest::prelude::*;

use crate::packs::{Rig, by_strain, made, scene_to, state};

/// Coefficient between grains, and at the walls.
const MU: f64 = 0.3;
const MU_WALL: f64 = 0.2;
const GRAINS: usize = 40;

fn scene() -> Scene {
    let mut scene = scene_to(1e-11);
    let coulomb = Coulomb { coefficient: MU, law: Law::ReturnMap, update: Update::Frozen };
    scene.contact.friction = Friction::Coulomb(coulomb);
    scene.walls.friction = Some(MU_WALL);
    scene
}

/// A pack in equilibrium that was strained until a good part of its contacts slid.
fn loaded() -> &'static Pack {
    &loading().0
}

/// The pack of [`loaded`], and the friction defect of its last increment.
fn loading() -> &'static (Pack, f64) {
    static PACK: OnceLock<(Pack, f64)> = OnceLock::new();
    PACK.get_or_init(|| {
        let mut pack = made(GRAINS, 1e7, 1);
        for (k, grain) in pack.grains.iter_mut().enumerate() {
            grain.friction = if k % 5 == 0 { 0.1 } else { MU };
        }
        let (mut rig, _) = Rig::start(&scene(), &pack);
        let mut last = None;
        for k in 1..=8 {
            let strain = [-1e-4, 0.0, 3e-4].map(|strain| strain * f64::from(k));
            last = Some(state(&rig.go(by_strain(&pack.bounds, strain))));
        }
        let PackState { sliding_ratio, friction_defect, .. } = last.unwrap();
        assert!((0.02..0.7).contains(&sliding_ratio), "{sliding_ratio}");
        (rig.twin.pack(), friction_defect)
    })
}

/// Where the grains are, in the order of the pack file.
#[derive(Clone)]
struct Pose {
    position: Vec<Vec3>,
    /// Since the reference \[rad\].
    turned: Vec<Vec3>,
}

/// One contact's constants, by the formulas of the thesis.
struct Constants {
    /// Hertz' M \[N/m^1.5\].
    modulus: f64,
    /// R* \[m\].
    radius: f64,
    /// Σ (2-ν)/G and Σ 1/G \[1/Pa\].
    shear: f64,
    torsion: f64,
    friction: f64,
}

/// Elastic constants of a body, E and ν.
type Elastic = (f64, f64);

const WALL: Elastic = (7e12, 0.495);

impl Constants {
    fn new(bodies: [Elastic; 2], radius: f64, friction: f64) -> Self {
        let sum = |f: fn(Elastic) -> f64| bodies.into_iter().map(f).sum::<f64>();
        Self {
            modulus: 4.0 / 3.0 * radius.sqrt() / sum(|(e, nu)| (1.0 - nu * nu) / e),
            radius,
            shear: sum(|(e, nu)| (2.0 - nu) * 2.0 * (1.0 + nu) / e),
            torsion: sum(|(e, nu)| 2.0 * (1.0 + nu) / e),
            friction,
        }
    }
}

/// Force and moment over radius on each grain, by (2.2)-(2.4) and (3.1)-(3.12) with the radial
/// return, from `reference` at rest to `pose`. Written for reading, not for speed.
fn forces(reference: &Pack, pose: &Pose) -> (Vec<Vec3>, Vec<Vec3>) {
    let n = reference.grains.len();
    let (mut force, mut moment) = (vec![Vec3::zeros(); n], vec![Vec3::zeros(); n]);
    let history = reference.history.as_ref().unwrap();
    let remembered = |first: usize, second: u32| {
        history.contacts.iter().find(|c| (c.first as usize, c.second) == (first, second))
    };
    let rest: Vec<Vec3> = reference.grains.iter().map(|g| Vec3::from(g.position)).collect();
    for i in 0..n {
        let gi = &reference.grains[i];
        for j in i + 1..n {
            let gj = &reference.grains[j];
            let star = 1.0 / (1.0 / gi.radius + 1.0 / gj.radius);
            let elastic = [(gi.young, gi.poisson), (gj.young, gj.poisson)];
            let constants = Constants::new(elastic, star, gi.friction.min(gj.friction));
            let r0 = rest[i] - rest[j];
            let r = pose.position[i] - pose.position[j];
            let normal = r / r.norm();
            let reach = gi.radius + gj.radius;
            // (2.16): the disc of the lens that two spheres have in common.
            let d = r.norm();
            let cut = (d * d + gi.radius.powi(2) - gj.radius.powi(2)) / (2.0 * d);
            let disc = gi.radius.powi(2) - cut * cut;
            let arm_i = -normal * (gi.radius.powi(2) - disc).sqrt();
            let arm_j = normal * (gj.radius.powi(2) - disc).sqrt();
            let moved = (pose.position[i] - rest[i]) - (pose.position[j] - rest[j]);
            let slid = moved - normal * normal.dot(&moved) + pose.turned[i].cross(&arm_i)
                - pose.turned[j].cross(&arm_j);
            let twist = (pose.turned[i] - pose.turned[j]).dot(&normal);
            let loads = Loads::new(
                &constants,
                [reach - r0.norm(), reach - d],
                &normal,
                remembered(i, j as u32),
                (&slid, twist),
            );
            force[i] += loads.push + loads.shear;
            force[j] -= loads.push + loads.shear;
            moment[i] += (arm_i.cross(&loads.shear) + loads.couple) / gi.radius;
            moment[j] += (arm_j.cross(&-loads.shear) - loads.couple) / gj.radius;
        }
        for w in 0..wall::COUNT {
            let elastic = [(gi.young, gi.poisson), WALL];
            let constants = Constants::new(elastic, gi.radius, MU_WALL);
            let mut normal = Vec3::zeros();
            normal[wall::axis(w)] = wall::inward(w);
            let plane = normal * reference.bounds.position(w) * wall::inward(w);
            let overlap = |at: &Vec3| gi.radius - (at - plane).dot(&normal);
            let overlaps = [overlap(&rest[i]), overlap(&pose.position[i])];
            let arm = -normal * (gi.radius - overlaps[1]);
            let moved = pose.position[i] - rest[i];
            let slid = moved - normal * normal.dot(&moved) + pose.turned[i].cross(&arm);
            let twist = pose.turned[i].dot(&normal);
            let memory = history.contacts.iter().find(|c| {
                c.first as usize == i
                    && wall_of(c.second).is_some_and(|wall| usize::from(wall) == w)
            });
            let loads = Loads::new(&constants, overlaps, &normal, memory, (&slid, twist));
            force[i] += loads.push + loads.shear;
            moment[i] += (arm.cross(&loads.shear) + loads.couple) / gi.radius;
        }
    }
    (force, moment)
}

/// What one contact does to its first grain.
struct Loads {
    push: Vec3,
    shear: Vec3,
    couple: Vec3,
}

impl Loads {
    fn new(
        constants: &Constants,
        [before, now]: [f64; 2],
        normal: &Vec3,
        memory: Option<&ContactMemory>,
        (slid, twist): (&Vec3, f64),
    ) -> Self {
        let Constants { modulus, radius, shear, torsion, friction } = constants;
        let push = normal * (modulus * now.max(0.0).powf(1.5));
        if before <= 0.0 {
            return Self { push, shear: Vec3::zeros(), couple: Vec3::zeros() };
        }
        let a = (radius * before).sqrt();
        let most = friction * modulus * before.powf(1.5);
        // (3.1) with the carried force turned into the plane.
        let carried = memory.map_or(Vec3::zeros(), |memory| Vec3::from(memory.shear));
        let flat = carried - normal * normal.dot(&carried);
        let turned = if flat.norm() > 0.0 { flat.normalize() * carried.norm() } else { flat };
        let trial = turned - slid * (8.0 * a / shear);
        let share = (most / trial.norm()).min(1.0);
        let couple =
            memory.map_or(0.0, |memory| memory.torsion) - twist * 16.0 / 3.0 * a.powi(3) / torsion;
        let largest = 3.0 * PI / 16.0 * a * most;
        Self { push, shear: trial * share, couple: normal * couple.clamp(-largest, largest) }
    }
}

/// The program's balance at `pose`, in the order of the pack file, with what its linear system
/// needs.
struct Program {
    model: Model,
    state: State,
    work: Workspace,
}

impl Program {
    fn at_reference() -> Self {
        let pack = loaded();
        let model = Model::new(pack, &scene());
        let mut state = State::new(&model);
        state.recall(&model, pack.history.as_ref().unwrap());
        let mut work = Workspace::new(&model);
        work.begin(&model, &state);
        Self { model, state, work }
    }

    /// Force and moment over radius on each grain.
    fn forces(&mut self, pose: &Pose) -> (Vec<Vec3>, Vec<Vec3>) {
        let history: &History = loaded().history.as_ref().unwrap();
        for (k, &grain) in self.model.order.iter().enumerate() {
            let grain = grain as usize;
            self.state.position[k] = pose.position[grain];
            self.state.rotation[k] = Vec3::from(history.rotation[grain]) + pose.turned[grain];
        }
        self.work.evaluate(&self.model, &self.state, &self.model.start.into());
        let unsort = |from: &[Vec3]| {
            let mut to = vec![Vec3::zeros(); from.len()];
            for (k, &grain) in self.model.order.iter().enumerate() {
                to[grain as usize] = -from[k];
            }
            to
        };
        (unsort(&self.work.balance.gradient), unsort(&self.work.balance.moment))
    }
}

/// The grains pushed about by up to `push` and turned by up to `turn` over their radius \[m\].
fn moved(seed: u64, push: f64, turn: f64) -> Pose {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mut vector = |size: f64| Vec3::new(next(), next(), next()) * size;
    let grains = &loaded().grains;
    Pose {
        position: grains.iter().map(|g| Vec3::from(g.position) + vector(push)).collect(),
        turned: grains.iter().map(|g| vector(turn / g.radius)).collect(),
    }
}

fn largest(vectors: &[Vec3]) -> f64 {
    vectors.iter().map(Vec3::norm).fold(0.0, f64::max)
}

/// Mean overlap \[m\] and mean normal force \[N\] at the reference.
fn scales() -> (f64, f64) {
    let mut program = Program::at_reference();
    program.forces(&moved(1, 0.0, 0.0));
    let sums = program.work.balance.sums;
    (sums.mean_overlap(), sums.mean_force())
}

#[test]
fn the_loaded_pack_is_in_equilibrium_by_the_formulas_written_out() {
    let (_, mean) = scales();
    let (force, moment) = forces(loaded(), &moved(1, 0.0, 0.0));
    // What the contacts carried was within the limit of the normal force before the increment; the
    // formulas take that of the present one. A grain has some ten contacts.
    let defect = loading().1;
    let worst = largest(&force).max(largest(&moment));
    assert!(worst <= (10.0 * defect + 1e-10) * mean, "{worst:e} {mean:e} {defect:e}");
    assert!(defect < 1e-2, "{defect}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn forces_and_moments_are_those_of_the_formulas_written_out(
        seed: u64, push in 0.0..1.0f64, turn in 0.0..1.0f64
    ) {
        let (overlap, mean) = scales();
        let pose = moved(seed, push * overlap, turn * overlap);
        let mut program = Program::at_reference();
        let found = program.forces(&pose);
        let want = forces(loaded(), &pose);
        // An overlap of 1e-2 R is known to 1e-14 of itself, and a grain has ten contacts.
        for (found, want) in [(found.0, want.0), (found.1, want.1)] {
            for (k, (found, want)) in found.iter().zip(&want).enumerate() {
                prop_assert!((found - want).norm() <= 1e-11 * mean, "grain {k}: {found} {want}");
            }
        }
        let sliding = program.work.balance.tractions.iter().filter(|t| t.slides).count();
        prop_assert!(sliding > 0);
    }
}

/// g(x + t s) - g(x - t s) over 2t for the step s.
fn along(pose: &Pose, step: &[[Vec3; 2]], t: f64) -> (Vec<Vec3>, Vec<Vec3>) {
    let grains = &loaded().grains;
    let shifted = |t: f64| {
        let mut pose = pose.clone();
        for (k, [u, w]) in step.iter().enumerate() {
            pose.position[k] += u * t;
            pose.turned[k] += w * (t / grains[k].radius);
        }
        forces(loaded(), &pose)
    };
    let (after, before) = (shifted(t), shifted(-t));
    let slope = |a: &[Vec3], b: &[Vec3]| -> Vec<Vec3> {
        a.iter().zip(b).map(|(a, b)| (a - b) / (2.0 * t)).collect()
    };
    (slope(&after.0, &before.0), slope(&after.1, &before.1))
}

/// Largest sum of |Q|/R over the contacts of a grain \[N/m\].
fn most_shear(memory: &Memory, radius: &[f64]) -> f64 {
    let mut sum = vec![0.0; radius.len()];
    for contact in &memory.contacts {
        let force = contact.shear.norm();
        sum[contact.first as usize] += force / radius[contact.first as usize];
        if let Other::Grain(j) = contact.second {
            sum[j as usize] += force / radius[j as usize];
        }
    }
    sum.into_iter().fold(0.0, f64::max)
}

/// The linear system answers to the balance with a step s, H s = -g. Along it the forces written
/// out must change by as much as they are off zero.
#[test]
fn the_linear_system_takes_the_forces_back_to_zero() {
    let (overlap, _) = scales();
    for push in [1e-3, 3e-3, 1e-2] {
        for seed in 1..=5 {
            let pose = moved(seed, push * overlap, push * overlap);
            let mut program = Program::at_reference();
            let (force, moment) = program.forces(&pose);
            let unit = largest(&force).max(largest(&moment));
            let Program { model, state, work } = &mut program;
            let stiffness = work.reference_stiffness;
            work.coupled.assemble(
                &work.balance,
                &work.neighbours,
                &work.reference,
                &model.radius,
                stiffness,
            );
            work.coupled.factorise(&vec![0.0; model.len()]);
            let balance = &work.balance;
            let inner = work.coupled.solve(&balance.gradient, &balance.moment, unit, 1e-4, 4000);
            assert_eq!(inner, Inner::Step, "{push} {seed}");
            let mut step = vec![[Vec3::zeros(); 2]; GRAINS];
            for (k, &grain) in model.order.iter().enumerate() {
                step[grain as usize] = work.coupled.step(k, unit / stiffness);
            }
            let longest = step.iter().flatten().map(Vec3::norm).fold(0.0, f64::max);
            let (df, dm) = along(&pose, &step, 1e-5 * overlap / longest);
            let mut carried = state.clone();
            work.commit(model, &mut carried);
            let balance = &work.balance;
            let left = (0..GRAINS)
                .map(|k| (df[k] + force[k]).norm().max((dm[k] + moment[k]).norm()))
                .fold(0.0, f64::max);
            // The solve itself, and the terms of order Q/r that the system leaves out: a normal
            // that turns by |d|/r takes Q with it and turns its lever, and the arm changes by
            // up to |d|, with |d| twice the longest step and r = 2R.
            let allowed = 1e-3 * unit + 3.0 * longest * most_shear(&carried.memory, &model.radius);
            assert!(left <= allowed, "{push} {seed}: {left:e} {allowed:e}");
            assert!(allowed < 0.05 * unit, "{push} {seed}: {allowed:e} {unit:e}");
            let sliding = balance.tractions.iter().filter(|t| t.slides).count();
            assert!(sliding > 0 && sliding < balance.tractions.len());
        }
    }
}

//! The balance of a cemented pack, taken anew from the thesis' formulas, and the work of its loads.

use std::f64::consts::PI;

use graintwin::Vec3;
use graintwin::model::Model;
use graintwin::pack::{BondMemory, ContactMemory, Grain, Kept, Pack, wall_of};
use graintwin::relax::Workspace;
use graintwin::scene::{Cement, CementLaw, Scene};
use graintwin::state::State;
use graintwin::wall;

use crate::cemented::{self, LAWS, cement, loaded};

const GRAINS: usize = 40;

/// Where the grains are, in the order of the pack file.
#[derive(Clone)]
struct Pose {
    position: Vec<Vec3>,
    /// Since the reference \[rad\].
    turned: Vec<Vec3>,
}

/// Elastic constants of a body, E and ν.
type Elastic = (f64, f64);

const WALL: Elastic = (7e12, 0.495);

/// One bond with its bodies at the reference and now.
struct Pair<'a> {
    bond: &'a BondMemory,
    bodies: [Elastic; 2],
    /// R*.
    radius: f64,
    /// Way of the two cementing points or centres: from the other body to grain i.
    branch: [Vec3; 2],
    /// Ways from the centres to the contact \[m\].
    arm: [Vec3; 2],
    moved: Vec3,
    turned: [Vec3; 2],
    memory: Option<&'a ContactMemory>,
}

/// Force on grain i, and moments on both bodies.
struct Load {
    force: Vec3,
    moment: [Vec3; 2],
}

impl Pair<'_> {
    fn sum(&self, of: fn(Elastic) -> f64) -> f64 {
        self.bodies.into_iter().map(of).sum()
    }

    /// a* at the distance `r` (4.10-4.13).
    fn contact_radius(&self, cement: &Cement, r: f64) -> f64 {
        let BondMemory { distance, overlap, radius, .. } = *self.bond;
        let strain = (distance - r) / distance;
        match cement.law {
            CementLaw::Fixed => radius,
            CementLaw::LinearElastic => {
                let grains = (self.radius * (overlap + distance - r).max(0.0)).sqrt();
                grains + cement.kappa * radius / (1.0 + cement.kappa)
            }
            CementLaw::Exponential(law) => radius * (law.gamma * strain).exp(),
            CementLaw::Power(law) => radius * (1.0 + law.eta * strain).max(0.0).powf(law.omega),
            CementLaw::Parallel(_) => unreachable!("has no effective radius"),
        }
    }

    /// Normal force, and stiffnesses in shear and torsion, of an effective law.
    fn effective(&self, cement: &Cement, before: f64, now: f64) -> (f64, f64, f64) {
        // (4.1-4.3): the sum of the increments, in many small ones by Simpson's rule.
        let steps = 400;
        let step = (self.bond.distance - now) / f64::from(steps);
        let stiffness = 2.0 / self.sum(|(e, nu)| (1.0 - nu * nu) / e);
        let radius = |k: f64| self.contact_radius(cement, self.bond.distance - step * k);
        let push: f64 = (0..steps)
            .map(f64::from)
            .map(|k| (radius(k) + 4.0 * radius(k + 0.5) + radius(k + 1.0)) / 6.0)
            .map(|radius| stiffness * radius * step)
            .sum();
        // (4.5-4.8) with the radius at the reference.
        let a = self.contact_radius(cement, before);
        let compliance = self.sum(|(e, nu)| (2.0 - nu) * 2.0 * (1.0 + nu) / e);
        let torsion = 16.0 / 3.0 * a.powi(3) / self.sum(|(e, nu)| 2.0 * (1.0 + nu) / e);
        (push, cement.partial_slip * 8.0 * a / compliance, torsion)
    }

    fn load(&self, cement: &Cement) -> Load {
        let [before, now] = self.branch.map(|branch| branch.norm());
        let normal = self.branch[1] / now;
        let carried = self.memory.map_or(0.0, |memory| memory.torsion);
        let twist = (self.turned[0] - self.turned[1]).dot(&normal);
        let (push, shear, torsion) = match cement.law {
            CementLaw::Parallel(law) => {
                // (4.20-4.21), the way between the cementing points along the normal and across it.
                let (r, l) = (law.radius_ratio * self.radius, law.length_ratio * self.radius);
                let k = PI * r * r * law.young / l;
                (k * (self.bond.distance - now), k, 0.5 * PI * r.powi(4) * law.shear / l)
            }
            _ => self.effective(cement, before, now),
        };
        let carried_shear = self.memory.map_or(Vec3::zeros(), |memory| Vec3::from(memory.shear));
        let flat = carried_shear - normal * normal.dot(&carried_shear);
        let turned = if flat.norm() > 0.0 { flat.normalize() * carried_shear.norm() } else { flat };
        let [arm_i, arm_j] = self.arm;
        let slid = self.moved - normal * normal.dot(&self.moved) + self.turned[0].cross(&arm_i)
            - self.turned[1].cross(&arm_j);
        let q = turned - slid * shear;
        let couple = normal * (carried - torsion * twist);
        Load {
            force: normal * push + q,
            moment: [arm_i.cross(&q) + couple, arm_j.cross(&-q) - couple],
        }
    }
}

/// Force and moment over radius on each grain, by the bonds alone and, beside parallel ones, Hertz.
fn forces(reference: &Pack, cement: &Cement, pose: &Pose) -> (Vec<Vec3>, Vec<Vec3>) {
    let grains = &reference.grains;
    let (mut force, mut moment) = (vec![Vec3::zeros(); grains.len()], vec![]);
    moment.clone_from(&force);
    let history = reference.history.as_ref().unwrap();
    let elastic = |grain: &Grain| (grain.young, grain.poisson);
    for bond in history.bonds.iter().filter(|bond| bond.condition == Kept::Intact) {
        let i = bond.first as usize;
        let gi = &grains[i];
        let rest = Vec3::from(gi.position);
        let memory = history
            .contacts
            .iter()
            .find(|contact| (contact.first, contact.second) == (bond.first, bond.second));
        let pair = match wall_of(bond.second) {
            None => {
                let j = bond.second as usize;
                let gj = &grains[j];
                let r0 = rest - Vec3::from(gj.position);
                let r = pose.position[i] - pose.position[j];
                // (2.16)
                let d = r.norm();
                let cut = (d * d + gi.radius.powi(2) - gj.radius.powi(2)) / (2.0 * d);
                Pair {
                    bond,
                    bodies: [elastic(gi), elastic(gj)],
                    radius: gi.radius * gj.radius / (gi.radius + gj.radius),
                    branch: [r0, r],
                    arm: [-r / d * cut, r / d * (d - cut)],
                    moved: r - r0,
                    turned: [pose.turned[i], pose.turned[j]],
                    memory,
                }
            }
            Some(w) => {
                let w = usize::from(w);
                let mut normal = Vec3::zeros();
                normal[wall::axis(w)] = wall::inward(w);
                let plane = normal * reference.bounds.position(w) * wall::inward(w);
                let away = |at: &Vec3| normal * (at - plane).dot(&normal);
                let branch = away(&pose.position[i]);
                Pair {
                    bond,
                    bodies: [elastic(gi), WALL],
                    radius: gi.radius,
                    branch: [away(&rest), branch],
                    arm: [-branch, Vec3::zeros()],
                    moved: pose.position[i] - rest,
                    turned: [pose.turned[i], Vec3::zeros()],
                    memory,
                }
            }
        };
        let load = pair.load(cement);
        force[i] += load.force;
        moment[i] += load.moment[0] / gi.radius;
        if wall_of(bond.second).is_none() {
            let j = bond.second as usize;
            force[j] -= load.force;
            moment[j] += load.moment[1] / grains[j].radius;
        }
    }
    if let CementLaw::Parallel(_) = cement.law {
        add_hertz(reference, pose, &mut force);
    }
    (force, moment)
}

/// T (2.2) between all that touch.
fn add_hertz(reference: &Pack, pose: &Pose, force: &mut [Vec3]) {
    let grains = &reference.grains;
    let flex = |(e, nu): Elastic| (1.0 - nu * nu) / e;
    for (i, gi) in grains.iter().enumerate() {
        for (j, gj) in grains.iter().enumerate().skip(i + 1) {
            let r = pose.position[i] - pose.position[j];
            let overlap = (gi.radius + gj.radius - r.norm()).max(0.0);
            let star = gi.radius * gj.radius / (gi.radius + gj.radius);
            let e = 1.0 / (flex((gi.young, gi.poisson)) + flex((gj.young, gj.poisson)));
            let push = r / r.norm() * (4.0 / 3.0 * e * (star * overlap.powi(3)).sqrt());
            force[i] += push;
            force[j] -= push;
        }
        for w in 0..wall::COUNT {
            let axis = wall::axis(w);
            let gap = (pose.position[i][axis] - reference.bounds.position(w)) * wall::inward(w);
            let overlap = (gi.radius - gap).max(0.0);
            let e = 1.0 / (flex((gi.young, gi.poisson)) + flex(WALL));
            let push = 4.0 / 3.0 * e * (gi.radius * overlap.powi(3)).sqrt();
            force[i][axis] += push * wall::inward(w);
        }
    }
}

/// The solver's state of the pack at `pose`, with the pack as the reference.
fn taken(scene: &Scene, pack: &Pack, pose: &Pose) -> (Model, State, Workspace) {
    let model = Model::new(pack, scene);
    let mut state = State::new(&model);
    state.recall(&model, pack.history.as_ref().unwrap());
    let mut work = Workspace::new(&model);
    work.begin(&model, &state);
    for (k, &grain) in model.order.iter().enumerate() {
        state.position[k] = pose.position[grain as usize];
        state.rotation[k] += pose.turned[grain as usize];
    }
    let bounds = state.bounds(&model);
    work.evaluate(&model, &state, &bounds);
    (model, state, work)
}

fn moved(pack: &Pack, by: &[[f64; 6]], size: f64) -> Pose {
    let vector = |d: &[f64]| Vec3::new(d[0], d[1], d[2]) * size;
    let position = pack.grains.iter().zip(by);
    Pose {
        position: position.map(|(g, d)| Vec3::from(g.position) + vector(&d[..3])).collect(),
        turned: by.iter().map(|d| vector(&d[3..]) / 1e-4).collect(),
    }
}

/// Numbers between -1 and 1 that nobody chose.
fn noise(seed: u64) -> Vec<[f64; 6]> {
    let mut state = seed;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..GRAINS).map(|_| std::array::from_fn(|_| next())).collect()
}

#[test]
fn the_balance_is_that_of_the_thesis_formulas() {
    for law in LAWS {
        let cement = cement(law);
        let scene = cemented::scene(cement, 1e-11);
        let pack = loaded(&scene, GRAINS, 1);
        for seed in 1..=3 {
            let pose = moved(&pack, &noise(seed), 2e-8);
            let (force, moment) = forces(&pack, &cement, &pose);
            let (model, _, work) = taken(&scene, &pack, &pose);
            let scale = force.iter().map(Vec3::norm).fold(f64::NAN, f64::max);
            for (k, &grain) in model.order.iter().enumerate() {
                let grain = grain as usize;
                let off = (work.balance.gradient[k] + force[grain]).norm() / scale;
                assert!(off < 1e-9, "{law:?}, grain {grain}: force off by {off:e}");
                let off = (work.balance.moment[k] + moment[grain]).norm() / scale;
                assert!(off < 1e-9, "{law:?}, grain {grain}: moment off by {off:e}");
            }
        }
    }
}

/// Of the normal forces and of a parallel bond's springs the work is a potential; the tangential
/// loads of the effective laws have one up to the strain of the increment, since their planes turn.
#[test]
fn the_work_of_the_loads_is_the_change_of_the_potential() {
    for law in LAWS {
        let scene = cemented::scene(cement(law), 1e-11);
        let pack = loaded(&scene, GRAINS, 1);
        let by = noise(7);
        // Boole's rule on the way from the reference.
        let ends = [0.0, 0.25, 0.5, 0.75, 1.0]
            .map(|share| taken(&scene, &pack, &moved(&pack, &by, 1e-8 * share)));
        let slope = |(model, _, work): &(Model, State, Workspace)| -> f64 {
            let along = |(k, &grain): (usize, &u32)| {
                let [x, y, z, a, b, c] = by[grain as usize];
                let turn = Vec3::new(a, b, c) * (model.radius[k] / 1e-4);
                work.balance.gradient[k].dot(&Vec3::new(x, y, z))
                    + work.balance.moment[k].dot(&turn)
            };
            model.order.iter().enumerate().map(along).sum::<f64>() * 1e-8
        };
        let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
        let work: f64 = ends.iter().zip(weights).map(|(end, w)| slope(end) * w / 90.0).sum();
        let change = ends[4].2.balance.potential() - ends[0].2.balance.potential();
        let off = (work - change).abs() / change.abs();
        assert!(off < 1e-5, "{law:?}: {work:e} against {change:e}");
    }
}

//! What holds of every equilibrium, whatever the pack: balance, frames, scale, energy, and that an
//! increment's answer does not depend on how it was found. Bounds follow from the residual that
//! the twin reports.
#![allow(clippy::needless_range_loop, reason = "walls and axes index several arrays alike")]

use std::sync::OnceLock;

use graintwin::Vec3;
use graintwin::measure::contacts::Contacts;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::advance::move_walls;
use graintwin::relax::{Status, Workspace, fire, relax};
use graintwin::report::Measures;
use graintwin::scene::Scene;
use graintwin::state::State;
use graintwin::wall::{self, Bounds};
use proptest::prelude::*;

use crate::packs::{self, Rig, by_strain, close, made, scene_to, state};

/// Floor of the residual at 10 MPa is about 1e-12 (numerics.md).
const TIGHT: f64 = 1e-11;

/// A pack at 10 MPa.
fn pack() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(120, 1e7, 5))
}

fn tight() -> Scene {
    scene_to(TIGHT)
}

/// The strain that most tests go to.
const STRAIN: [f64; 3] = [1e-5, -2e-5, 8e-5];

/// Relaxes `pack`, then strains it.
fn strained(scene: &Scene, pack: &Pack, strain: [f64; 3]) -> Measures {
    let (mut rig, _) = Rig::start(scene, pack);
    rig.go_quietly(by_strain(&pack.bounds, strain))
}

fn mean_force(measures: &Measures) -> f64 {
    let forces = &measures.network.as_ref().unwrap().normal_force;
    forces.iter().sum::<f64>() / forces.len() as f64
}

/// Sum of all unbalanced forces: at most the residual of each grain.
fn unbalanced(measures: &Measures) -> f64 {
    120.0 * TIGHT * mean_force(measures)
}

fn half_diagonal(bounds: &Bounds) -> f64 {
    0.5 * Vec3::from(bounds.sides()).norm()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn wall_stress_is_contact_stress_and_walls_balance(
        strain in prop::array::uniform3(-4e-5..8e-5f64),
    ) {
        let scene = tight();
        let (mut rig, _) = Rig::start(&scene, pack());
        let measures = rig.go(by_strain(&pack().bounds, strain));
        let (state, bounds) = (state(&measures), rig.twin.pack().bounds);
        prop_assert!(state.residual <= TIGHT);
        // σ_walls - σ_contacts = Σ F x / V over the unbalanced forces F.
        let allowed = unbalanced(&measures) * half_diagonal(&bounds) / bounds.volume();
        let rounding = 1e-13 * state.confining_stress;
        let walls = &measures.walls;
        for k in 0..9 {
            let (a, b) = (k / 3, k % 3);
            // Smooth walls have no shear stress, but their forces have arms, and f_a x_b is a
            // part of the moment about the third axis: the contacts' shear stress is that.
            let want = if a == b {
                state.stress_walls[k]
            } else {
                let moment = walls.moment[2 * a][3 - a - b] + walls.moment[2 * a + 1][3 - a - b];
                if b == (a + 1) % 3 { -moment / bounds.volume() } else { moment / bounds.volume() }
            };
            let off = (state.stress_contacts[k] - want).abs();
            prop_assert!(off <= allowed + rounding, "{k}: {off} {allowed}");
        }
        let rounding = 1e-13 * walls.normal_force[0];
        let sum: Vec3 = walls.force.iter().map(|f| Vec3::from(*f)).sum();
        prop_assert!(sum.norm() <= unbalanced(&measures) + rounding, "{}", sum.norm());
        for axis in 0..3 {
            let [low, high] = [2 * axis, 2 * axis + 1].map(|w| walls.normal_force[w]);
            prop_assert!((low - high).abs() <= unbalanced(&measures) + rounding);
            prop_assert_eq!(walls.force[2 * axis][axis], -low);
            prop_assert_eq!(walls.force[2 * axis + 1][axis], high);
        }
        let moment: Vec3 = walls.moment.iter().map(|m| Vec3::from(*m)).sum();
        let arm = half_diagonal(&bounds);
        prop_assert!(moment.norm() <= arm * (unbalanced(&measures) + rounding), "{}", moment.norm());
        // The network acts and reacts: grain by grain the contact forces cancel.
        let network = measures.network.as_ref().unwrap();
        let mut force = vec![Vec3::zeros(); 120];
        for (k, (&first, &second)) in network.first.iter().zip(&network.second).enumerate() {
            let normal = Vec3::from_column_slice(&network.normal[3 * k..3 * k + 3]);
            force[first as usize] += normal * network.normal_force[k];
            if let Some(other) = force.get_mut(second as usize) {
                *other -= normal * network.normal_force[k];
            }
        }
        let largest = force.iter().map(Vec3::norm).fold(0.0, f64::max);
        // Contacts that do not count (1e-6 of the mean) may add a little.
        prop_assert!(largest <= 1e-5 * mean_force(&measures), "{largest}");
    }

    #[test]
    fn a_translated_pack_gives_the_same_forces(shift in prop::array::uniform3(-5e-3..5e-3f64)) {
        let mut moved = pack().clone();
        for axis in 0..3 {
            moved.bounds.min[axis] += shift[axis];
            moved.bounds.max[axis] += shift[axis];
            moved.grains.iter_mut().for_each(|g| g.position[axis] += shift[axis]);
        }
        // Positions at 5 mm are rounded ten times more coarsely than around the origin.
        let scene = scene_to(1e-10);
        let (here, there) = (strained(&scene, pack(), STRAIN), strained(&scene, &moved, STRAIN));
        for w in 0..wall::COUNT {
            close("wall", there.walls.normal_force[w], here.walls.normal_force[w], 1e-8);
        }
    }
}

#[test]
fn a_mirrored_pack_gives_mirrored_forces() {
    let here = strained(&tight(), pack(), STRAIN).walls.normal_force;
    for axis in 0..3 {
        let mut mirrored = pack().clone();
        mirrored.bounds.min[axis] = -pack().bounds.max[axis];
        mirrored.bounds.max[axis] = -pack().bounds.min[axis];
        mirrored.grains.iter_mut().for_each(|g| g.position[axis] = -g.position[axis]);
        let there = strained(&tight(), &mirrored, STRAIN).walls.normal_force;
        for w in 0..wall::COUNT {
            let twin = if wall::axis(w) == axis { w ^ 1 } else { w };
            close(wall::NAMES[w], there[twin], here[w], 1e-9);
        }
    }
}

#[test]
fn permuted_grains_give_the_same_forces_and_contacts() {
    let here = strained(&tight(), pack(), STRAIN);
    let n = pack().grains.len();
    // 7 and 120 have no common divisor.
    let place = |k: usize| (7 * k + 3) % n;
    let grains = (0..n).map(|k| pack().grains[place(k)]).collect();
    let there = strained(&tight(), &Pack { grains, ..pack().clone() }, STRAIN);
    for w in 0..wall::COUNT {
        close(wall::NAMES[w], there.walls.normal_force[w], here.walls.normal_force[w], 1e-9);
    }
    let contacts = |measures: &Measures, place: &dyn Fn(usize) -> usize| {
        let network = measures.network.as_ref().unwrap();
        let name = |g: u32| if (g as usize) < n { place(g as usize) } else { g as usize };
        let mut pairs: Vec<_> = (network.first.iter().zip(&network.second))
            .map(|(&a, &b)| (name(a).min(name(b)), name(a).max(name(b))))
            .collect();
        pairs.sort_unstable();
        pairs
    };
    assert_eq!(contacts(&here, &|k| k), contacts(&there, &place));
}

#[test]
fn a_pack_with_rotated_axes_gives_rotated_forces() {
    let here = strained(&tight(), pack(), STRAIN).walls.normal_force;
    let turn = |v: [f64; 3]| [v[2], v[0], v[1]];
    let mut turned = pack().clone();
    turned.bounds = Bounds { min: turn(pack().bounds.min), max: turn(pack().bounds.max) };
    turned.grains.iter_mut().for_each(|g| g.position = turn(g.position));
    let there = strained(&tight(), &turned, turn(STRAIN)).walls.normal_force;
    for w in 0..wall::COUNT {
        close(wall::NAMES[w], there[(w + 2) % 6], here[w], 1e-9);
    }
}

#[test]
fn forces_grow_with_the_square_of_the_size() {
    let here = strained(&tight(), pack(), STRAIN);
    for scale in [1e-2, std::f64::consts::PI, 1e3] {
        let mut scaled = pack().clone();
        for axis in 0..3 {
            scaled.bounds.min[axis] *= scale;
            scaled.bounds.max[axis] *= scale;
        }
        for grain in &mut scaled.grains {
            grain.position = grain.position.map(|x| scale * x);
            grain.radius *= scale;
        }
        let there = strained(&tight(), &scaled, STRAIN);
        for w in 0..wall::COUNT {
            let want = scale * scale * here.walls.normal_force[w];
            close(wall::NAMES[w], there.walls.normal_force[w], want, 1e-9);
        }
        let (a, b) = (state(&here), state(&there));
        close("stress", b.confining_stress, a.confining_stress, 1e-9);
        close("porosity", b.porosity, a.porosity, 1e-9);
        close("energy", b.stored_energy, scale.powi(3) * a.stored_energy, 1e-9);
        assert_eq!((a.contacts, a.rattlers), (b.contacts, b.rattlers));
    }
}

fn wall_forces(model: &Model, state: &State) -> [f64; wall::COUNT] {
    let mut work = Workspace::new(model);
    work.neighbours.refresh(model, &state.position, &state.bounds(model));
    let contacts = Contacts::of(model, state, &work.neighbours);
    walls::forces(model, state, &contacts.list).normal_force
}

#[test]
fn an_increment_has_the_same_answer_however_it_was_solved() {
    let target = by_strain(&pack().bounds, STRAIN);
    let want = strained(&tight(), pack(), STRAIN).walls.normal_force;
    let agrees = |how: &str, found: [f64; wall::COUNT]| {
        for w in 0..wall::COUNT {
            close(how, found[w], want[w], 1e-9);
        }
    };

    let mut fine = tight();
    fine.solver.max_strain_increment = 2e-6;
    let (mut rig, _) = Rig::start(&fine, pack());
    let report = rig.send(target);
    assert!(report.substeps >= 40, "{}", report.substeps);
    assert_eq!(report.text, "");
    agrees("40 sub-increments", report.measures.unwrap().walls.normal_force);

    let model = Model::new(pack(), &tight());
    let start = || {
        let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
        assert_eq!(relax(&model, &mut state, &mut work).status, Status::Converged);
        (state, work)
    };
    let (mut state, mut work) = start();
    move_walls(&model, &mut state, &target, 1.0);
    assert_eq!(relax(&model, &mut state, &mut work).status, Status::Converged);
    agrees("affine start, one step", wall_forces(&model, &state));

    let (mut state, mut work) = start();
    state.displacement = target;
    assert_eq!(relax(&model, &mut state, &mut work).status, Status::Converged);
    agrees("unmoved start, one step", wall_forces(&model, &state));

    let (mut state, mut work) = start();
    for share in 1..=10 {
        state.displacement = target.map(|d| d * f64::from(share) / 10.0);
        assert_eq!(relax(&model, &mut state, &mut work).status, Status::Converged);
    }
    agrees("unmoved start, ten steps", wall_forces(&model, &state));

    let (mut state, mut work) = start();
    move_walls(&model, &mut state, &target, 1.0);
    let goal = fire::Goal { residual: 1e-6, pressure: None, even: false, steps: 200_000 };
    assert_eq!(fire::descend(&model, &mut state, &mut work, goal), Status::Converged);
    assert_eq!(relax(&model, &mut state, &mut work).status, Status::Converged);
    agrees("inertial descent, then Newton", wall_forces(&model, &state));
}

#[test]
fn a_closed_loop_of_small_strains_returns_to_its_start() {
    let (mut rig, report) = Rig::start(&tight(), pack());
    let start = report.measures.unwrap();
    let (before, grains) = (start.walls.normal_force, rig.twin.pack().grains);
    let corners =
        [[1e-5, 0.0, 0.0], [1e-5, 0.0, 2e-5], [-1e-5, 1e-5, 2e-5], [-1e-5, 1e-5, 0.0], [0.0; 3]];
    let mut widest = 0.0_f64;
    let mut end = None;
    for strain in corners {
        let measures = rig.go_quietly(by_strain(&pack().bounds, strain));
        widest = widest.max(packs::off(measures.walls.normal_force[4], before[4]));
        end = Some(measures);
    }
    let end = end.unwrap();
    assert!(widest > 1e-3, "the loop did something: {widest}");
    for w in 0..wall::COUNT {
        close(wall::NAMES[w], end.walls.normal_force[w], before[w], 1e-8);
    }
    close("energy", state(&end).stored_energy, state(&start).stored_energy, 1e-8);
    let carries: std::collections::BTreeSet<u32> =
        end.network.as_ref().unwrap().first.iter().copied().collect();
    for (i, (then, now)) in grains.iter().zip(rig.twin.pack().grains).enumerate() {
        if carries.contains(&(i as u32)) {
            let moved = (Vec3::from(then.position) - Vec3::from(now.position)).norm();
            assert!(moved <= 1e-8 * now.radius, "grain {i} moved by {moved:e} m");
        }
    }
    // Nothing was lost but the error of the trapezoids.
    let turnover = before[4] * 2e-5 * pack().bounds.sides()[2];
    assert!(state(&end).wall_work.abs() < 1e-3 * turnover, "{}", state(&end).wall_work);
}

#[test]
fn work_of_the_walls_is_the_change_of_energy_up_to_the_trapezoid_rule() {
    // The error of one trapezoid falls with the cube of its width, the sum with its square.
    let errors: Vec<f64> = [1, 2, 4, 8]
        .into_iter()
        .map(|parts| {
            let mut scene = tight();
            scene.solver.max_strain_increment = 1e-2;
            scene.solver.max_overlap_share = 100.0;
            let (mut rig, _) = Rig::start(&scene, pack());
            let mut missing = 0.0;
            for k in 1..=parts {
                let share = f64::from(k) / f64::from(parts);
                let report = rig.send(by_strain(&pack().bounds, STRAIN.map(|e| share * e)));
                assert_eq!((report.substeps, report.text.as_str()), (1, ""));
                missing = state(&report.measures.unwrap()).dissipated_energy;
            }
            missing
        })
        .collect();
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.7..2.3).contains(&order), "order {order} of {errors:?}");
    }
}

//! Packs with friction: from several starts, the stress by two ways, and where the energy goes.

use graintwin::Vec3;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::{self, Pack};
use graintwin::relax::advance::move_walls;
use graintwin::relax::{Status, Workspace, relax};
use graintwin::report::PackState;
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::state::State;
use graintwin::wall;

use crate::packs::{Rig, by_strain, close, made, scene_to, state};

/// Beads of coefficient `mu`, without tangential load.
fn rough(grains: usize, stress: f64, seed: u64, mu: f64) -> Pack {
    let mut pack = made(grains, stress, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = mu);
    pack
}

fn frictional(tolerance: f64, coefficient: f64, law: Law, update: Update) -> Scene {
    let mut scene = scene_to(tolerance);
    scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
    scene
}

/// Walls, positions and rotations of the next equilibrium after `strain`, with the grains started
/// where `start` puts them.
fn next_from(
    scene: &Scene,
    pack: &Pack,
    strain: f64,
    start: impl Fn(&mut State, &[Vec3]),
) -> (Vec<f64>, State) {
    let model = Model::new(pack, scene);
    let mut state = State::new(&model);
    state.recall(&model, pack.history.as_ref().unwrap());
    let mut work = Workspace::new(&model);
    work.begin(&model, &state);
    let before = state.position.clone();
    move_walls(&model, &mut state, &by_strain(&pack.bounds, [0.0, 0.0, strain]), 1.0);
    start(&mut state, &before);
    let outcome = relax(&model, &mut state, &mut work);
    assert_eq!(outcome.status, Status::Converged);
    let forces = walls::normal_forces(&model, &state, &work.neighbours);
    (forces.to_vec(), state)
}

#[test]
fn an_increment_ends_in_the_same_equilibrium_from_three_starts() {
    // A pack that has slid already: contacts stick, slide and turn back.
    let scene = frictional(1e-11, 0.3, Law::ReturnMap, Update::Frozen);
    let pack = rough(150, 1e7, 5, 0.3);
    let (mut rig, _) = Rig::start(&scene, &pack);
    for strain in [2e-4, 4e-4, 6e-4] {
        rig.go_quietly(by_strain(&pack.bounds, [0.0, 0.0, strain]));
    }
    let pack = rig.twin.pack();
    let sliding = pack.history.as_ref().unwrap().contacts.iter().filter(|c| c.sliding).count();
    assert!(sliding > 5, "{sliding} contacts slide");
    for strain in [1e-4, -1e-4] {
        let (affine, end) = next_from(&scene, &pack, strain, |_, _| {});
        let unmoved = next_from(&scene, &pack, strain, |state, before| {
            state.position.copy_from_slice(before);
        });
        let shaken = next_from(&scene, &pack, strain, |state, _| {
            for (k, (at, turn)) in state.position.iter_mut().zip(&mut state.rotation).enumerate() {
                let wave = |phase: f64| (12.9898 * k as f64 + phase).sin();
                // A tenth of an overlap, and as much at the surface.
                *at += Vec3::new(wave(0.0), wave(1.0), wave(2.0)) * 1e-8;
                *turn += Vec3::new(wave(3.0), wave(4.0), wave(5.0)) * 1e-4;
            }
        });
        for (forces, state) in [unmoved, shaken] {
            for w in 0..wall::COUNT {
                close(wall::NAMES[w], forces[w], affine[w], 1e-10);
            }
            let off = (state.position.iter().zip(&end.position))
                .zip(&end.carries)
                .filter(|(_, carries)| **carries)
                .map(|((a, b), _)| (a - b).norm())
                .fold(0.0, f64::max);
            assert!(off < 1e-10 * 1e-4, "a grain is {off:e} m off");
        }
    }
}

#[test]
fn a_vanishing_coefficient_gives_the_frictionless_answer() {
    let path = [[0.0, 0.0, 2e-5], [1e-5, 0.0, 4e-5], [0.0, 0.0, 1e-5]];
    let smooth = made(150, 1e7, 5);
    let mut pack = smooth.clone();
    pack.grains.iter_mut().for_each(|grain| grain.friction = 1e-30);
    let scene = frictional(1e-12, 1e-30, Law::ReturnMap, Update::Frozen);
    let (mut without, _) = Rig::start(&scene_to(1e-12), &smooth);
    let (mut with, _) = Rig::start(&scene, &pack);
    for strain in path {
        let to = by_strain(&smooth.bounds, strain);
        let (want, got) = (without.go_quietly(to), with.go_quietly(to));
        for w in 0..wall::COUNT {
            close(wall::NAMES[w], got.walls.normal_force[w], want.walls.normal_force[w], 1e-12);
        }
        close("energy", state(&got).stored_energy, state(&want).stored_energy, 1e-12);
        assert!(state(&got).mean_tangential_force <= 1.01e-30 * state(&got).mean_normal_force);
    }
}

#[test]
fn without_friction_nothing_turns_and_nothing_is_remembered() {
    for (mu, walls) in [(0.0, None), (0.3, Some(0.0))] {
        let mut scene = frictional(1e-8, mu, Law::ReturnMap, Update::Frozen);
        scene.walls.friction = walls;
        // All coefficients are zero: the model has no friction at all.
        let pack = made(60, 1e7, 5);
        let model = Model::new(&pack, &Scene { walls: scene.walls.clone(), ..scene.clone() });
        assert_eq!(model.friction.is_none(), walls.is_some() || mu == 0.0);
        let (rig, _) = Rig::start(&scene, &pack);
        assert_eq!(rig.twin.pack().history, None);
    }
}

#[test]
fn the_contact_stress_is_the_moment_of_the_wall_loads() {
    // Σ F⊗r over all contacts is Σ F⊗x over the loads of the walls for a pack in equilibrium; the
    // wall stress leaves out the shear of the side walls, which carries load too.
    let scene = frictional(1e-11, 0.3, Law::ReturnMap, Update::Frozen);
    let pack = rough(150, 1e7, 5, 0.3);
    let (mut rig, _) = Rig::start(&scene, &pack);
    rig.go_quietly(by_strain(&pack.bounds, [0.0, 0.0, 5e-4]));
    let measures = rig.go_quietly(by_strain(&pack.bounds, [0.0, 0.0, 1e-3]));
    let now = rig.twin.pack();
    let network = measures.network.clone().unwrap();
    let mut stress = nalgebra::Matrix3::zeros();
    for (k, (&first, &second)) in network.first.iter().zip(&network.second).enumerate() {
        if pack::wall_of(second).is_some() {
            let row = |of: &[f64]| Vec3::new(of[3 * k], of[3 * k + 1], of[3 * k + 2]);
            let normal = row(&network.normal);
            let grain = &now.grains[first as usize];
            let arm = grain.radius - network.overlap[k];
            let at = Vec3::from(grain.position) - normal * arm;
            let on_pack = normal * network.normal_force[k] + row(&network.tangential_force);
            // Compression is positive: the load points inwards.
            stress -= on_pack * at.transpose();
        }
    }
    stress /= now.bounds.volume();
    let state = state(&measures);
    for (k, want) in stress.transpose().iter().enumerate() {
        let off = (state.stress_contacts[k] - want).abs() / state.confining_stress;
        assert!(off <= 1e-10, "entry {k}: off by {off:e}");
    }
    assert!(state.stress_contacts[8] < 0.99 * state.stress_walls[8]);
}

/// Runs `strains` and returns the states, the initial one first.
fn states(scene: &Scene, pack: &Pack, strains: impl Iterator<Item = f64>) -> Vec<PackState> {
    let (mut rig, report) = Rig::start(scene, pack);
    let mut states = vec![state(&report.measures.unwrap())];
    for strain in strains {
        states.push(state(&rig.go(by_strain(&pack.bounds, [0.0, 0.0, strain]))));
    }
    states
}

#[test]
fn the_work_of_the_walls_is_stored_or_lost_in_every_increment() {
    let pack = rough(150, 1e7, 5, 0.3);
    for law in [Law::ReturnMap, Law::Secant, Law::MindlinDeresiewicz] {
        for update in [Update::Frozen, Update::Current] {
            // Ten increments up and five down, of 1e-4 and then of 1e-5.
            let remainders = [1e-5, 1e-6].map(|increment: f64| {
                let strains = (1..=10).chain((5..10).rev()).map(|k| increment * f64::from(k));
                let scene = frictional(1e-10, 0.3, law, update);
                let states = states(&scene, &pack, strains);
                let mut worst: f64 = 0.0;
                for pair in states.windows(2) {
                    let change = |of: fn(&PackState) -> f64| of(&pair[1]) - of(&pair[0]);
                    let work = change(|s| s.wall_work);
                    let lost = change(|s| s.slip_energy) + change(|s| s.renewal_energy);
                    let rest = work - change(|s| s.stored_energy) - lost;
                    assert!(change(|s| s.slip_energy) >= 0.0);
                    worst = worst.max((rest / work).abs());
                }
                worst
            });
            // What is left is of second order: the trapezoidal rule for the work, and the balance
            // in current geometry against the potential of the reference plane.
            let [coarse, fine] = remainders;
            assert!(coarse <= 1e-5 && fine <= 2e-8, "{law:?} {update:?} {coarse:e} {fine:e}");
        }
    }
}

#[test]
fn a_thousand_cyclic_increments_neither_gain_nor_lose_energy_but_by_slip() {
    // Fifty cycles of ten increments up and ten down; the energy at their ends must stay.
    let amplitude = 2e-4;
    let strains = || {
        (1..=1000).map(move |k| {
            let phase = f64::from(k % 20) / 10.0;
            amplitude * if phase <= 1.0 { phase } else { 2.0 - phase }
        })
    };
    // With the stiffness of the increment's start, loading is softer than unloading: the shear
    // creeps. The mean stiffness of `current` closes the path.
    for (mu, update, drift) in [
        (0.3, Update::Frozen, 2e-4),
        (0.3, Update::Current, 2e-6),
        (f64::INFINITY, Update::Current, 2e-8),
    ] {
        let pack = rough(100, 1e7, 23, mu);
        let scene = frictional(1e-8, mu, Law::ReturnMap, update);
        let states = states(&scene, &pack, strains());
        let swing = states[10].stored_energy - states[0].stored_energy;
        let ends: Vec<&PackState> = states.iter().skip(20).step_by(20).collect();
        assert_eq!(ends.len(), 50);
        let (first, last) = (ends[0], ends[49]);
        let moved = (last.stored_energy - first.stored_energy).abs();
        assert!(moved <= drift * swing, "{moved:e} of {swing:e}");
        // What the walls put in goes into slip, the same in each cycle.
        let slip = |k: usize| ends[k].slip_energy - ends[k - 1].slip_energy;
        let work = last.wall_work - first.wall_work;
        if mu.is_finite() {
            close("slip of a cycle", slip(49), slip(2), 0.02);
            close("work", work, last.slip_energy - first.slip_energy, 0.1);
        } else {
            assert_eq!(last.slip_energy, 0.0);
            assert!(work.abs() <= 1e-5 * swing, "{work:e} of {swing:e}");
        }
    }
}

#[test]
fn a_pack_is_decompressed_far_and_compressed_again() {
    // Grains that hardly touch anything are dragged by friction alone on the way.
    for (law, update) in [
        (Law::ReturnMap, Update::Frozen),
        (Law::ReturnMap, Update::Current),
        (Law::MindlinDeresiewicz, Update::Frozen),
    ] {
        let pack = rough(150, 1e7, 5, 0.3);
        let scene = frictional(1e-8, 0.3, law, update);
        let (mut rig, _) = Rig::start(&scene, &pack);
        let mut least = f64::INFINITY;
        let strain = |axial: f64, all: f64| by_strain(&pack.bounds, [all, all, axial + all]);
        for k in 1..=5 {
            rig.go(strain(4e-4 * f64::from(k), 0.0));
        }
        for k in (1..=20).chain((0..20).rev()) {
            let measures = rig.go(strain(2e-3, -3e-4 * f64::from(k)));
            least = least.min(measures.walls.normal_force[5]);
        }
        let end = rig.go(strain(2e-3, 0.0)).walls.normal_force;
        assert!(least < 0.3 * end[5], "{law:?}: {least} of {}", end[5]);
    }
}

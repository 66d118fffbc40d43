//! The methods of relaxation, one against the other: the same equilibria, the same bits on any
//! number of threads, and an end where they do not arrive. The closed forms are in
//! `closed_forms.rs`.

use graintwin::Vec3;
use graintwin::command::Disposition;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::advance::{Advance, advance};
use graintwin::relax::{Effort, Status, Workspace, relax};
use graintwin::report::Demand;
use graintwin::scene::{Coulomb, Friction, Law, Method, Scene, Update};
use graintwin::state::State;
use graintwin::twin::Twin;
use graintwin::wall::{self, standing};

use crate::packs::{Rig, absolute, bits, by_strain, close, made, scene_to, state};

/// The methods of the seeds.
const OTHERS: [Method; 3] = [Method::ConjugateGradient, Method::GaussSeidel, Method::Dynamic];

/// Increments without an event: Newton's method reports none.
const PATH: [[f64; 3]; 3] = [[0.0, 0.0, 2e-5], [1e-5, 0.0, 4e-5], [1e-5, -1e-5, 2e-5]];

fn by(method: Method, tolerance: f64) -> Scene {
    let mut scene = scene_to(tolerance);
    scene.solver.method = method;
    scene
}

fn rough(mut scene: Scene) -> Scene {
    let (coefficient, law, update) = (0.3, Law::ReturnMap, Update::Frozen);
    scene.contact.friction = Friction::Coulomb(Coulomb { coefficient, law, update });
    scene
}

/// What a method came to after one increment.
struct Reached {
    walls: [f64; wall::COUNT],
    state: State,
    advance: Advance,
    effort: Effort,
}

/// Takes `pack` along `path` by the scene's method.
fn along(scene: &Scene, pack: &Pack, path: &[[f64; 3]]) -> Vec<Reached> {
    let mut pack = pack.clone();
    if let Friction::Coulomb(coulomb) = scene.contact.friction {
        pack.grains.iter_mut().for_each(|grain| grain.friction = coulomb.coefficient);
    }
    let model = Model::new(&pack, scene);
    let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
    work.start(&model, &state);
    let mut here = relax(&model, &mut state, &mut work);
    assert!(here.status.is_equilibrium());
    work.commit(&model, &mut state);
    let mut reached = Vec::new();
    for strain in path {
        let before = work.effort();
        let target = by_strain(&pack.bounds, *strain);
        let advance = advance(&model, &mut state, &mut work, &standing(&target), here);
        here = advance.outcome;
        let now = work.effort();
        reached.push(Reached {
            walls: walls::normal_forces(&model, &state, &work.neighbours),
            state: state.clone(),
            advance,
            effort: Effort {
                gradients: now.gradients - before.gradients,
                products: now.products - before.products,
            },
        });
    }
    reached
}

/// Largest distance of a grain that carries load from where it is in `other`, over the mean radius.
fn apart(state: &State, other: &State) -> f64 {
    let positions = state.position.iter().zip(&other.position).zip(&other.carries);
    let far = positions.filter(|(_, carries)| **carries).map(|((a, b), _)| (a - b).norm());
    let turns = state.rotation.iter().zip(&other.rotation).zip(&other.carries);
    let turned = turns.filter(|(_, carries)| **carries).map(|((a, b), _)| 1e-4 * (a - b).norm());
    far.chain(turned).fold(0.0, f64::max) / 1e-4
}

/// Compares every method with Newton's on a smooth path.
///
/// All end at the residual 1e-9. The mean force is the stiffness of a contact times about 2e-3 of a
/// radius, and the softest modes of such packs are 1e4 to 1e5 times softer than a contact: a
/// position is known to some 1e-9 * 2e-3 * 1e5 = 2e-7 of a radius at worst. The walls feel those
/// modes little, so that their forces are known to a few times the residual.
fn agree(dress: fn(Scene) -> Scene) {
    let pack = made(300, 1e7, 11);
    let mut newton = dress(by(Method::Newton, 1e-11));
    newton.solver.max_strain_increment = 1e-5;
    let want = along(&newton, &pack, &PATH);
    assert!(want.iter().all(|reached| reached.advance.descents == 0), "the path has an event");
    for method in OTHERS {
        let mut scene = dress(by(method, 1e-9));
        scene.solver.max_strain_increment = 1e-5;
        for (k, (got, want)) in along(&scene, &pack, &PATH).iter().zip(&want).enumerate() {
            let outcome = got.advance.outcome;
            assert_eq!(outcome.status, Status::Converged, "{method:?} {k}");
            assert!(outcome.residual <= 1e-9, "{method:?} {k}: {}", outcome.residual);
            assert_eq!(got.state.carries, want.state.carries, "{method:?} {k}");
            for w in 0..wall::COUNT {
                close(&format!("{method:?} {k} {w}"), got.walls[w], want.walls[w], 2e-8);
            }
            let off = apart(&got.state, &want.state);
            assert!(off <= 2e-7, "{method:?} {k}: a grain is {off:e} R off");
            // The work is counted, and none of it is Newton's: the estimate of the error alone takes
            // products.
            assert!(got.advance.iterations > 0);
            assert!(got.effort.gradients >= u64::from(got.advance.iterations), "{method:?} {k}");
            assert!(got.effort.products <= 20, "{method:?} {k}");
        }
    }
}

#[test]
fn every_method_comes_to_the_equilibria_of_newtons_without_friction() {
    agree(|scene| scene);
}

#[test]
fn every_method_comes_to_the_equilibria_of_newtons_with_friction() {
    agree(rough);
}

#[test]
fn a_long_shear_with_friction_ends_the_same_way_by_every_method() {
    // A tenth of the contacts slides on the way. The methods stop at other places within the
    // residual of each increment, and what slid remembers it.
    let pack = made(150, 1e7, 5);
    let path: Vec<[f64; 3]> = (1..=6).map(|k| [0.0, 0.0, 1e-4 * f64::from(k)]).collect();
    let want = along(&rough(by(Method::Newton, 1e-10)), &pack, &path);
    let sliding = want[5].state.memory.contacts.iter().filter(|c| c.slides).count();
    assert!(sliding > 5, "{sliding} contacts slide");
    for method in OTHERS {
        let got = along(&rough(by(method, 1e-9)), &pack, &path);
        for w in 0..wall::COUNT {
            close(&format!("{method:?} {w}"), got[5].walls[w], want[5].walls[w], 1e-7);
        }
    }
}

#[test]
fn every_method_gives_the_same_bits_on_one_thread_and_on_three() {
    // More grains and contacts than one task takes.
    let mut pack = made(600, 1e7, 2);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let run = |scene: &Scene, threads: usize| {
        let mut twin = Twin::new(scene, &pack, threads).unwrap();
        twin.start(Demand::ALL);
        let mut said = Vec::new();
        for (sequence, strain) in (1..).zip(&PATH[..2]) {
            let command = absolute(sequence, by_strain(&pack.bounds, *strain));
            let report = twin.apply(&command, Demand::ALL);
            assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
            let measures = report.measures.unwrap();
            said.push(format!("{:?} {:?}", measures.state, measures.walls.normal_force));
        }
        (said, bits(&twin.pack()))
    };
    for method in OTHERS {
        for scene in [by(method, 1e-6), rough(by(method, 1e-6))] {
            assert!(run(&scene, 1) == run(&scene, 3), "{method:?}");
        }
    }
}

#[test]
fn too_few_iterations_end_every_method_and_leave_the_state() {
    let pack = made(60, 1e7, 3);
    for method in OTHERS {
        let mut scene = by(method, 1e-8);
        scene.solver.max_iterations = Some(3);
        let (mut rig, _) = Rig::start(&scene, &pack);
        let before = bits(&rig.twin.pack());
        let report = rig.send(by_strain(&pack.bounds, [0.0, 0.0, 5e-3]));
        assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
        assert!(report.text.contains("no equilibrium in 3 iterations"), "{}", report.text);
        assert!(bits(&rig.twin.pack()) == before, "{method:?}");
    }
}

#[test]
fn every_method_notices_that_a_pack_carries_no_load_any_more() {
    // In the second pack motion that is too fast finds another jammed state, under more stress.
    let others = OTHERS.map(|method| (1, method)).into_iter();
    for (seed, method) in others.chain([(3, Method::Dynamic)]) {
        let pack = made(60, 1e6, seed);
        let (mut rig, _) = Rig::start(&by(method, 1e-6), &pack);
        let mut last = rig.go(by_strain(&pack.bounds, [0.0; 3]));
        let full: f64 = last.walls.normal_force.iter().sum();
        for k in 1..=20 {
            last = rig.go(by_strain(&pack.bounds, [-2e-4 * f64::from(k); 3]));
            assert!(last.walls.normal_force.iter().sum::<f64>() < full, "{method:?} {seed} {k}");
        }
        assert_eq!(last.walls.normal_force, [0.0; wall::COUNT], "{method:?} {seed}");
        assert_eq!(state(&last).contacts, 0, "{method:?} {seed}");
        assert_eq!(state(&last).residual, 0.0, "{method:?} {seed}");
    }
}

#[test]
fn more_damping_takes_another_way_to_the_same_equilibrium() {
    let pack = made(100, 1e7, 7);
    let want = along(&by(Method::Newton, 1e-11), &pack, &PATH[..1]);
    let mut steps = Vec::new();
    for damping in [0.2, 0.7, 0.95] {
        let mut scene = by(Method::Dynamic, 1e-9);
        scene.solver.damping = damping;
        let got = along(&scene, &pack, &PATH[..1]);
        for w in 0..wall::COUNT {
            close(&format!("{damping} {w}"), got[0].walls[w], want[0].walls[w], 2e-8);
        }
        steps.push(got[0].advance.iterations);
    }
    assert!(steps[0] != steps[1] && steps[1] != steps[2], "{steps:?}");
}

#[test]
fn no_grain_goes_further_in_one_step_than_the_scene_allows() {
    // A single step, on the way back to places a third of an overlap away.
    let pack = made(100, 1e7, 7);
    for method in OTHERS {
        let mut scene = by(method, 1e-9);
        scene.solver.max_iterations = Some(1);
        scene.solver.step_cap = 1e-4;
        let model = Model::new(&pack, &scene);
        let (mut state, mut work) = (State::new(&model), Workspace::new(&model));
        for (k, at) in state.position.iter_mut().enumerate() {
            let wave = |phase: f64| (12.9898 * k as f64 + phase).sin();
            *at += Vec3::new(wave(0.0), wave(1.0), wave(2.0)) * 1e-7;
        }
        let from = state.position.clone();
        assert_eq!(relax(&model, &mut state, &mut work).status, Status::MaxIterations);
        let share = |((a, b), radius): ((&Vec3, &Vec3), &f64)| (a - b).norm() / radius;
        let moves = state.position.iter().zip(&from).zip(&model.radius).map(share);
        let longest = moves.fold(0.0, f64::max);
        assert!((1e-5..=1e-4 * (1.0 + 1e-9)).contains(&longest), "{method:?}: {longest:e}");
    }
}

//! The tangent stiffness against differences of equilibria, and what must hold of it.

use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::tangent::{Stiffness, tangent};
use graintwin::relax::{Outcome, Status, Workspace};
use graintwin::scene::{Coulomb, Friction, Law, Scene, Update};
use graintwin::state::State;
use graintwin::wall;
use nalgebra::{Matrix3, Matrix6, SymmetricEigen, Vector6};

use crate::increments::Increment;
use crate::packs::{self, Rig, made, scene_to};

/// Largest difference of two matrices over the largest entry.
fn off6(a: &Matrix6<f64>, b: &Matrix6<f64>) -> f64 {
    (a - b).amax() / b.amax()
}

fn off3(a: &Matrix3<f64>, b: &Matrix3<f64>) -> f64 {
    (a - b).amax() / b.amax()
}

/// Smallest eigenvalue of the symmetric part over the largest of all.
fn least(of: &Matrix6<f64>) -> f64 {
    let values = SymmetricEigen::new(0.5 * (of + of.transpose())).eigenvalues;
    values.min() / values.amax()
}

fn frictional(law: Law, torsion: bool) -> Scene {
    let mut scene = scene_to(1e-12);
    let coulomb = Coulomb { coefficient: 0.3, law, update: Update::Frozen };
    scene.contact.friction = Friction::Coulomb(coulomb);
    scene.contact.torsion = torsion;
    scene
}

/// A pack that was sheared until contacts slide.
fn sheared(scene: &Scene, grains: usize, seed: u64) -> Pack {
    let mut pack = made(grains, 1e7, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let (mut rig, _) = Rig::start(scene, &pack);
    for strain in [2e-4, 4e-4, 6e-4] {
        rig.go(packs::by_strain(&pack.bounds, [0.0, 0.0, strain]));
    }
    let pack = rig.twin.pack();
    let contacts = &pack.history.as_ref().unwrap().contacts;
    assert!(contacts.iter().filter(|contact| contact.sliding).count() > 5);
    pack
}

/// dσ_l/dε_m of walls with this stiffness, by the definition: the mean force of a pair over the
/// area, both walls of a pair moving by half, and the area of the others shrinking.
fn moduli(increment: &Increment, walls: &Matrix6<f64>) -> Matrix3<f64> {
    let sides = increment.bounds().sides();
    let force = increment.forces([0.0; wall::COUNT]);
    Matrix3::from_fn(|l, m| {
        let area = sides[(l + 1) % 3] * sides[(l + 2) % 3];
        let mean = |of: &Vector6<f64>| 0.5 * (of[2 * l] + of[2 * l + 1]);
        let mut motion = Vector6::zeros();
        motion[2 * m] = 0.5 * sides[m];
        motion[2 * m + 1] = 0.5 * sides[m];
        let rise = mean(&(walls * motion)) / area;
        rise + if l == m { 0.0 } else { mean(&force) / area }
    })
}

/// Against differences over `step` \[m\], which is so short that no contact begins or ends to slide.
fn check(what: &str, increment: &Increment, found: &Stiffness, step: f64) {
    let want = increment.differences(step);
    let off = off6(&found.walls, &want);
    assert!(off < 1e-7, "{what}: off by {off:e}, error {:e}", found.error);
    let off = off3(&found.relaxed, &moduli(increment, &want));
    assert!(off < 1e-7, "{what}: moduli off by {off:e}");
    assert!(found.error < 1e-9, "{what}: {:e}", found.error);
}

#[test]
fn frictionless_stiffness_is_that_of_re_equilibrated_walls() {
    for (grains, stress, seed) in [(120, 1e7, 5), (306, 1e7, 1), (120, 1e6, 3)] {
        let increment = Increment::new(&scene_to(1e-12), &made(grains, stress, seed), [0.0; 3]);
        let what = format!("{grains} grains at {stress:e} Pa");
        check(&what, &increment, &increment.tangent().stands.unwrap(), 3e-10);
    }
}

#[test]
fn weights_are_no_obstacle() {
    let mut scene = scene_to(1e-12);
    scene.gravity = [2e3, -4e3, -1e4];
    let increment = Increment::new(&scene, &made(120, 1e7, 5), [0.0; 3]).settled();
    check("gravity", &increment, &increment.tangent().stands.unwrap(), 3e-10);
}

#[test]
fn frictional_stiffness_is_that_of_re_equilibrated_walls() {
    for (law, step) in
        [(Law::ReturnMap, 3e-11), (Law::Secant, 3e-11), (Law::MindlinDeresiewicz, 1e-11)]
    {
        for torsion in [false, true] {
            let scene = frictional(law, torsion);
            let pack = sheared(&scene, 120, 1);
            let increment = Increment::new(&scene, &pack, [0.0, 0.0, 1e-5]);
            let what = format!("{law:?}, torsion {torsion}");
            let tangent = increment.tangent();
            check(&what, &increment, &tangent.stands.unwrap(), step);
            let sticking = increment.sticking();
            check(&format!("{what}, all stick"), &sticking, &tangent.sticks.unwrap(), 3e-10);
        }
    }
}

#[test]
fn smooth_walls_feel_strain_only_and_a_stable_pack_resists() {
    let increment = Increment::new(&scene_to(1e-10), &made(200, 5e6, 7), [0.0; 3]);
    let Stiffness { walls, relaxed, affine, .. } = increment.tangent().stands.unwrap();
    assert!(off6(&walls, &walls.transpose()) < 1e-9);
    for axis in 0..3 {
        let mut shift = Vector6::zeros();
        (shift[2 * axis], shift[2 * axis + 1]) = (1.0, -1.0);
        assert!((walls * shift).amax() < 1e-9 * walls.amax());
    }
    assert!(least(&walls) > -1e-9);
    // What the grains do beside the affine motion can only make the pack softer.
    let given_in = affine - relaxed;
    let values = SymmetricEigen::new(0.5 * (given_in + given_in.transpose())).eigenvalues;
    assert!(values.min() > 0.0);
    // The energy's second derivative is symmetric; the stresses are those of the walls.
    let stress = |l: usize, m: usize| relaxed[(l, m)] - relaxed[(m, l)];
    let force = increment.forces([0.0; wall::COUNT]);
    let bounds = increment.bounds();
    for (l, m) in [(0, 1), (1, 2), (2, 0)] {
        let of = |axis: usize| force[2 * axis] / bounds.area(2 * axis);
        assert!((stress(l, m) - (of(l) - of(m))).abs() < 1e-9 * relaxed.amax());
    }
}

#[test]
fn shear_at_the_contacts_stiffens_and_sliding_softens() {
    let mut pack = made(150, 1e7, 5);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let smooth = Increment::new(&scene_to(1e-11), &made(150, 1e7, 5), [0.0; 3]);
    let smooth = smooth.tangent().stands.unwrap();
    let scene = frictional(Law::ReturnMap, true);
    // No contact carries shear as yet: the energy gains squares only.
    let rough = Increment::new(&scene, &pack, [0.0; 3]).tangent();
    let (stands, sticks) = (rough.stands.unwrap(), rough.sticks.unwrap());
    assert!(off6(&stands.walls, &sticks.walls) < 1e-9);
    assert!(least(&(sticks.walls - smooth.walls)) > -1e-9);
    assert!(off3(&sticks.affine, &smooth.affine) > 1e-2);
    // After sliding both count from the same place, but for the turning of forces at the limit.
    let after = Increment::new(&scene, &sheared(&scene, 150, 5), [0.0; 3]).tangent();
    let (stands, sticks) = (after.stands.unwrap(), after.sticks.unwrap());
    assert!(least(&(sticks.walls - stands.walls)) > -1e-3);
    assert!(off6(&stands.walls, &sticks.walls) > 1e-2);
    for k in 0..3 {
        assert!(stands.relaxed[(k, k)] < sticks.relaxed[(k, k)]);
    }
}

#[test]
fn a_column_about_to_buckle_has_no_moduli() {
    // Three beads between two walls, the middle one a little beside: pressed, it goes further.
    let (r, short) = (1e-4, 1e-6);
    let side = 6.0 * r - 4.0 * short;
    let at = |k: i32| [if k == 0 { 1e-7 } else { 0.0 }, 0.0, f64::from(k) * (2.0 * r - short)];
    let grains = [-1, 0, 1].map(|k| packs::bead(at(k), r)).to_vec();
    let bounds = packs::centered([4.0 * r, 4.0 * r, side]);
    let model = Model::new(&Pack { bounds, grains, history: None }, &scene_to(1e-8));
    let state = State::new(&model);
    let mut work = Workspace::new(&model);
    work.begin(&model, &state);
    let here = Outcome { status: Status::Converged, ..Outcome::NONE };
    let found = tangent(&model, &state, &work, &here);
    assert!(found.stands.is_none() && found.sticks.is_none());
}

#[test]
fn moduli_know_neither_size_nor_names_nor_hands() {
    let pack = made(150, 1e7, 9);
    let scene = scene_to(1e-12);
    let want = Increment::new(&scene, &pack, [0.0; 3]).tangent().stands.unwrap();
    let mut other = pack.clone();
    other.grains.reverse();
    for grain in &mut other.grains {
        grain.position = grain.position.map(|x| 3.0 * x);
        grain.radius *= 3.0;
        grain.position[1] *= -1.0;
        grain.position.swap(0, 2);
    }
    for axis in 0..3 {
        other.bounds.min[axis] *= 3.0;
        other.bounds.max[axis] *= 3.0;
    }
    (other.bounds.min[1], other.bounds.max[1]) = (-other.bounds.max[1], -other.bounds.min[1]);
    other.bounds.min.swap(0, 2);
    other.bounds.max.swap(0, 2);
    let found = Increment::new(&scene, &other, [0.0; 3]).tangent().stands.unwrap();
    let turned = |of: &Matrix3<f64>| Matrix3::from_fn(|l, m| of[(2 - l, 2 - m)]);
    assert!(off3(&found.relaxed, &turned(&want.relaxed)) < 1e-8);
    assert!(off3(&found.affine, &turned(&want.affine)) < 1e-8);
}

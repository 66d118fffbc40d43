//! Packs of another size or another stiffness (B table 5).
//!
//! The expected numbers are those of dimensional analysis: forces, lengths and what they make.

use std::path::Path;

use graintwin::command::Disposition;
use graintwin::pack::prepare::prepare;
use graintwin::pack::{Kept, Pack, rescale};
use graintwin::report::Measures;
use graintwin::scene::prepare::{Rescale, Step};
use graintwin::scene::{self, CementLaw, CementStrength, Normal, Scene};
use graintwin::wall;

use crate::cemented;
use crate::cemented::{LAWS, breakable, loaded};
use crate::packs::{Rig, by_strain, close, made, state};

/// A factor of lengths, or of forces, and what stresses and energies are multiplied by.
const STEPS: [(Rescale, [f64; 4]); 4] = [
    (Rescale::Lengths(10.0), [10.0, 1.0, 0.01, 10.0]),
    (Rescale::Lengths(0.3), [0.3, 1.0, 1.0 / 0.09, 0.3]),
    (Rescale::Forces(7.0), [1.0, 7.0, 7.0, 7.0]),
    (Rescale::Forces(1e-3), [1.0, 1e-3, 1e-3, 1e-3]),
];

/// Beads with shear, torsion, sliding contacts and weight, in equilibrium, and their scene.
fn rough(law: &str) -> (Scene, Pack) {
    let text = format!(
        "pack: {{file: none.csv}}\ngravity: [0.0, 0.0, -1.0e4]\nsolver: {{tolerance: 1.0e-10}}\n\
         contact: {{friction: {{coefficient: 0.2, law: {law}}}}}"
    );
    let scene = scene::parse(&text, Path::new("scene.yaml")).unwrap();
    let mut pack = made(100, 4e6, 5);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.2);
    (scene.clone(), walked(&scene, &pack, 4))
}

/// Where a pack is after some increments.
fn walked(scene: &Scene, pack: &Pack, increments: u32) -> Pack {
    let (mut rig, report) = Rig::start(scene, pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    for k in 1..=increments {
        rig.go(course(pack, k));
    }
    rig.twin.pack()
}

fn course(pack: &Pack, k: u32) -> [f64; wall::COUNT] {
    by_strain(&pack.bounds, [-0.3, -0.2, 1.0].map(|share| share * 3e-4 * f64::from(k)))
}

/// The walls and cement of `scene` times a factor of stress.
fn stiffer(scene: &Scene, stress: f64) -> Scene {
    let mut scene = scene.clone();
    scene.walls.young *= stress;
    if let Normal::Cement(cement) = &mut scene.contact.normal {
        if let CementLaw::Parallel(parallel) = &mut cement.law {
            parallel.young *= stress;
            parallel.shear *= stress;
        }
        if let Some(CementStrength { tension, shear }) = &mut cement.strength {
            *tension *= stress;
            *shear *= stress;
        }
    }
    scene
}

/// Measures of `after` are those of `before` times the factors.
fn scaled(before: &Measures, after: &Measures, factors: [f64; 4], tolerance: f64) {
    let [length, force, stress, energy] = factors;
    let (walls, then) = (&after.walls, &before.walls);
    let largest = then.normal_force.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
    for (now, then) in walls.force.as_flattened().iter().zip(then.force.as_flattened()) {
        assert!((now / force - then).abs() <= tolerance * largest, "{now} {then}");
    }
    let (now, then) = (state(after), state(before));
    close("stress", now.confining_stress, then.confining_stress * stress, tolerance);
    close("stored", now.stored_energy, then.stored_energy * energy, tolerance);
    assert_eq!(now.sliding_ratio, then.sliding_ratio);
    let (now, then) = (after.network.as_ref().unwrap(), before.network.as_ref().unwrap());
    assert_eq!((&now.first, &now.second, &now.state), (&then.first, &then.second, &then.state));
    for (k, (overlap, before)) in now.overlap.iter().zip(&then.overlap).enumerate() {
        // Where no force acts a loose grain may float.
        if then.normal_force[k] != 0.0 {
            assert!((overlap / length - before).abs() <= tolerance * 1e-6, "{overlap} {before}");
        }
    }
    for (now, then) in now.tangential_force.iter().zip(&then.tangential_force) {
        assert!((now / force - then).abs() <= tolerance * largest, "{now} {then}");
    }
}

/// A rescaled pack starts in equilibrium with the same loads, and goes the same way.
fn agrees(scene: &Scene, pack: &Pack, increments: u32) {
    let (mut original, before) = Rig::start(scene, pack);
    assert_eq!(before.text, "");
    let mut course_of: Vec<Measures> = vec![before.measures.unwrap()];
    course_of.extend((1..=increments).map(|k| original.go(course(pack, k))));
    for (step, factors) in STEPS {
        let other = rescale(pack, step);
        let (mut rig, after) = Rig::start(&stiffer(scene, factors[2]), &other);
        assert_eq!((after.disposition, after.text.as_str()), (Disposition::Applied, ""));
        scaled(&course_of[0], &after.measures.unwrap(), factors, 1e-9);
        for k in 1..=increments {
            let after = rig.go(course(&other, k));
            scaled(&course_of[k as usize], &after, factors, 1e-7);
        }
    }
}

#[test]
fn a_rescaled_pack_with_friction_and_weight_stays_in_equilibrium_and_goes_the_same_way() {
    for law in ["return_map", "mindlin_deresiewicz"] {
        let (scene, pack) = rough(law);
        assert!(pack.history.as_ref().unwrap().contacts.len() > 200);
        agrees(&scene, &pack, 3);
    }
}

#[test]
fn rescaled_cement_holds_and_breaks_at_the_same_strain() {
    for law in LAWS {
        let scene = cemented::scene(breakable(law, 3e8, 3e8), 1e-10);
        let pack = loaded(&scene, 80, 5);
        assert!(!pack.history.as_ref().unwrap().bonds.is_empty());
        agrees(&scene, &pack, 2);
        let bonds = walked(&scene, &pack, 2).history.unwrap().bonds;
        let broken = bonds.iter().filter(|bond| bond.condition != Kept::Intact).count();
        assert!(broken > 2 && broken < bonds.len(), "{law:?}: {broken} broke");
    }
}

/// Steps before and after a rescaling see the same walls, relative to the grains.
#[test]
fn it_does_not_matter_when_a_pack_is_rescaled() {
    let mut pack = made(60, 4e6, 6);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let step = |text: &str| {
        let yaml = format!(
            "pack: {{file: none.csv, prepare: [{text}]}}\nwalls: {{young: 3.0e11}}\n\
             solver: {{tolerance: 1.0e-10}}\ncontact: {{friction: {{}}}}"
        );
        scene::parse(&yaml, Path::new("scene.yaml")).unwrap()
    };
    let strained = "uniaxial: {strain: 3.0e-4}";
    let (forces, lengths) = ("rescale: {forces: 0.1}", "rescale: {lengths: 2.0}");
    let orders = [
        format!("{strained}, {forces}, {lengths}"),
        format!("{forces}, {strained}, {lengths}"),
        format!("{lengths}, {forces}, {strained}"),
    ];
    let packs = orders.map(|order| prepare(&step(&order), pack.clone(), &mut |_| ()).unwrap());
    for other in &packs[1..] {
        for (a, b) in packs[0].grains.iter().zip(&other.grains) {
            close("radius", b.radius, a.radius, 1e-14);
            close("young", b.young, a.young, 1e-14);
            close("density", b.density, a.density, 1e-14);
            for axis in 0..3 {
                assert!((a.position[axis] - b.position[axis]).abs() < 1e-12 * a.radius);
            }
        }
        let [a, b] = [&packs[0], other].map(|pack| pack.history.as_ref().unwrap());
        assert_eq!(a.contacts.len(), b.contacts.len());
        for (a, b) in a.contacts.iter().zip(&b.contacts) {
            for axis in 0..3 {
                assert!((a.shear[axis] - b.shear[axis]).abs() < 1e-9, "{a:?} {b:?}");
            }
        }
    }
}

#[test]
fn a_factor_out_of_range_is_named() {
    for (step, text) in [
        ("lengths: 0", "pack.prepare[0].rescale.lengths: 0.0 is outside 1e-6 <= lengths <= 1e6"),
        ("forces: .nan", "pack.prepare[0].rescale.forces: NaN is not a finite number"),
        ("areas: 2", "pack.prepare[0].rescale"),
    ] {
        let yaml = format!("pack: {{file: a.csv, prepare: [rescale: {{{step}}}]}}");
        let said = scene::parse(&yaml, Path::new("scene.yaml")).unwrap_err().to_string();
        assert!(said.contains(text), "{said}");
    }
    let yaml = "pack: {file: a.csv, prepare: [rescale: {lengths: 2}]}";
    let scene = scene::parse(yaml, Path::new("scene.yaml")).unwrap();
    assert_eq!(scene.pack.prepare, [Step::Rescale(Rescale::Lengths(2.0))]);
}

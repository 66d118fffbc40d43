//! Cemented packs: what must hold of them whatever the law, and what happens when cement breaks.

use std::f64::consts::PI;

use graintwin::Vec3;
use graintwin::command::Disposition;
use graintwin::pack::{BondMemory, ContactMemory, Kept, Pack, wall_of};
use graintwin::report::{ContactState, Measures};
use graintwin::scene::{Cement, CementLaw, CementStrength, Coulomb, Friction, Method, Scene};
use graintwin::wall::{self, WallTarget};

use crate::cemented::{EXPONENTIAL, LAWS, PARALLEL, breakable, cement, loaded, scene};
use crate::packs::{self, Rig, bits, by_strain, close, made, off, state};

fn start(scene: &Scene, pack: &Pack) -> Rig {
    let (rig, report) = Rig::start(scene, pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    rig
}

/// The thesis' uniaxial stress path (T 4.8.1): the sides give way by a quarter.
fn uniaxial(strain: f64) -> [f64; 3] {
    [-0.25 * strain, -0.25 * strain, strain]
}

fn largest(forces: &[f64]) -> f64 {
    forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()))
}

#[test]
fn cement_is_deposited_without_stress_and_a_parallel_bond_beside_it() {
    let pack = made(150, 1e7, 2);
    for law in LAWS {
        let (_, report) = Rig::start(&scene(cement(law), 1e-9), &pack);
        let measures = report.measures.unwrap();
        let forces = measures.walls.normal_force;
        let network = measures.network.unwrap();
        let bonded = network.state.iter().all(|&state| state == ContactState::Bonded as u8);
        assert!(bonded && network.first.len() > 350, "{law:?}: {}", network.first.len());
        // Cement bridges gaps of a tenth of the radii but where it is a share of the contact.
        let bridges = network.overlap.iter().any(|&overlap| overlap < 0.0);
        // What a parallel bond carries across a gap is nothing as yet, and does not count.
        let counts = !matches!(law, CementLaw::LinearElastic | CementLaw::Parallel(_));
        assert_eq!(bridges, counts, "{law:?}");
        let (_, plain) = Rig::start(&packs::scene_to(1e-9), &pack);
        let before = plain.measures.unwrap().walls.normal_force;
        match law {
            CementLaw::Parallel(_) => {
                for (force, before) in forces.iter().zip(before) {
                    close("parallel", *force, before, 1e-8);
                }
            }
            _ => assert!(largest(&forces) < 1e-9 * largest(&before), "{law:?}: {forces:?}"),
        }
    }
}

#[test]
fn the_work_of_the_walls_is_stored() {
    let pack = made(120, 1e7, 3);
    for law in LAWS {
        let mut left = Vec::new();
        for increments in [10, 40] {
            let mut rig = start(&scene(cement(law), 1e-10), &pack);
            let mut last = None;
            for k in 1..=increments {
                let strain = uniaxial(4e-4 * f64::from(k) / f64::from(increments));
                last = Some(state(&rig.go(by_strain(&pack.bounds, strain))));
            }
            let last = last.unwrap();
            left.push(last.dissipated_energy / last.wall_work);
        }
        // Nothing slides and nothing breaks: what the trapezoids of the path leave falls with the
        // square of the increment, and the turning of frozen stiffnesses with the increment.
        assert!(left[1].abs() < 2e-4, "{law:?}: {left:?}");
        assert!(left[1].abs() < 0.5 * left[0].abs() + 1e-7, "{law:?}: {left:?}");
    }
}

#[test]
fn parallel_bonds_forget_the_way() {
    let pack = made(120, 1e7, 4);
    let mut rig = start(&scene(cement(PARALLEL), 1e-11), &pack);
    let first = rig.go(by_strain(&pack.bounds, [0.0, 0.0, 1e-5]));
    for strain in [[1e-5, 0.0, 5e-5], [1e-5, -4e-5, 8e-5], [-2e-5, 0.0, 4e-5]] {
        rig.go(by_strain(&pack.bounds, strain));
    }
    let again = rig.go(by_strain(&pack.bounds, [0.0, 0.0, 1e-5]));
    for (a, b) in again.walls.normal_force.iter().zip(first.walls.normal_force) {
        // The turning of the contact planes is all that remembers the way.
        close("normal force", *a, b, 1e-7);
    }
    let [a, b] = [&again, &first].map(|measures| state(measures).stored_energy);
    close("stored energy", a, b, 1e-8);
}

#[test]
fn fixed_stiffness_makes_a_linear_material() {
    let pack = made(200, 1e7, 5);
    let forces = |strain: f64| {
        let mut rig = start(&scene(cement(CementLaw::Fixed), 1e-9), &pack);
        let walls = rig.go(by_strain(&pack.bounds, uniaxial(strain))).walls;
        walls.normal_force.map(|force| force / strain)
    };
    let want = forces(1e-7);
    for strain in [1e-6, -1e-6, 1e-5, -1e-4] {
        for (got, want) in forces(strain).into_iter().zip(want) {
            // The geometry is the only thing that is not linear.
            let off = (got - want).abs() / largest(&forces(1e-7));
            assert!(off < 20.0 * strain.abs() + 1e-6, "{strain}: {got:e} against {want:e}");
        }
    }
}

#[test]
fn the_methods_find_the_same_equilibria() {
    let pack = made(100, 1e7, 6);
    for law in [EXPONENTIAL, PARALLEL] {
        let run = |method: Method| {
            let mut scene = scene(cement(law), 1e-9);
            scene.solver.method = method;
            let mut rig = start(&scene, &pack);
            for k in 1..=2 {
                rig.go(by_strain(&pack.bounds, uniaxial(5e-5 * f64::from(k))));
            }
            let walls = rig.go(by_strain(&pack.bounds, uniaxial(1.5e-4))).walls;
            walls.normal_force
        };
        let want = run(Method::Newton);
        for method in [Method::ConjugateGradient, Method::GaussSeidel, Method::Dynamic] {
            for (got, want) in run(method).into_iter().zip(want) {
                close(&format!("{law:?} by {method:?}"), got, want, 1e-6);
            }
        }
    }
}

/// Where [`broken`] ends.
const LAST: [f64; 3] = [-1.25e-4, -1.25e-4, 5e-4];

/// Measures after a path of tension, shear and cracks.
fn broken(scene: &Scene, pack: &Pack, threads: usize) -> (Rig, Measures) {
    let (mut rig, _) = Rig::start_on(scene, pack, threads);
    let mut last = None;
    for strain in [uniaxial(2e-4), uniaxial(3.5e-4), LAST] {
        last = Some(rig.go(by_strain(&pack.bounds, strain)));
    }
    (rig, last.unwrap())
}

/// A scene and a pack whose cement breaks and leaves rough contacts.
fn rough(cement: Cement, pack: &Pack, tolerance: f64) -> (Scene, Pack) {
    let mut scene = scene(cement, tolerance);
    scene.contact.friction = Friction::Coulomb(Coulomb::default());
    let mut pack = pack.clone();
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    (scene, pack)
}

fn strong(law: CementLaw) -> Cement {
    let at = match law {
        // Of a cross-section as small as the thesis has it.
        CementLaw::Parallel(_) => 4e10,
        _ => 1.5e8,
    };
    breakable(law, at, 2.0 * at)
}

#[test]
fn bits_depend_neither_on_threads_nor_on_a_pack_stored_on_the_way() {
    let pack = made(300, 1e7, 7);
    for law in LAWS {
        let (scene, pack) = rough(strong(law), &pack, 1e-8);
        let (one, _) = broken(&scene, &pack, 1);
        let (seven, _) = broken(&scene, &pack, 7);
        assert_eq!(bits(&one.twin.pack()), bits(&seven.twin.pack()), "{law:?}");
        let history = |rig: &Rig| rig.twin.pack().history.unwrap();
        assert!(history(&one) == history(&seven), "{law:?}");
        let bonds = history(&one).bonds;
        let cracked = bonds.iter().filter(|bond| bond.condition != Kept::Intact).count();
        assert!(cracked > 2, "{law:?} did not crack");
        // Stored and read again it goes on as if it had not been.
        let stored = one.twin.pack();
        let mut again = start(&scene, &stored);
        let mut one = one;
        let more = uniaxial(5.5e-4);
        let want = one.go(by_strain(&pack.bounds, more));
        let further = std::array::from_fn(|w| {
            by_strain(&pack.bounds, more)[w] - by_strain(&pack.bounds, LAST)[w]
        });
        let got = again.go(further);
        for (got, want) in got.walls.normal_force.iter().zip(want.walls.normal_force) {
            assert!((got - want).abs() < 1e-6 * want.abs().max(1e-2), "{law:?}: {got} {want}");
        }
        assert_eq!(
            again.twin.pack().history.unwrap().bonds.len(),
            stored.history.unwrap().bonds.len()
        );
    }
}

/// Stresses of a parallel bond of a pack, from nothing but its file: (tension, shear) \[Pa\].
fn stresses(pack: &Pack, bond: &BondMemory, law: &graintwin::scene::Parallel) -> (f64, f64) {
    let grain = &pack.grains[bond.first as usize];
    let at = Vec3::from(grain.position);
    let (star, distance) = match wall_of(bond.second) {
        None => {
            let other = &pack.grains[bond.second as usize];
            let star = grain.radius * other.radius / (grain.radius + other.radius);
            (star, (at - Vec3::from(other.position)).norm())
        }
        Some(w) => {
            let w = usize::from(w);
            let gap = (at[wall::axis(w)] - pack.bounds.position(w)) * wall::inward(w);
            (grain.radius, gap)
        }
    };
    let (radius, length) = (law.radius_ratio * star, law.length_ratio * star);
    let area = PI * radius * radius;
    let contacts = &pack.history.as_ref().unwrap().contacts;
    let own = |c: &&ContactMemory| (c.first, c.second) == (bond.first, bond.second);
    let (shear, torsion) = contacts
        .iter()
        .find(own)
        .map_or((0.0, 0.0), |c| (Vec3::from(c.shear).norm(), c.torsion.abs()));
    let tension = law.young / length * (distance - bond.distance);
    (tension, shear / area + 2.0 * torsion / (area * radius))
}

#[test]
fn no_bond_is_left_that_is_overloaded_and_what_broke_is_lost() {
    let pack = made(200, 1e7, 8);
    let CementLaw::Parallel(law) = PARALLEL else { unreachable!() };
    let cement = strong(PARALLEL);
    let CementStrength { tension, shear } = cement.strength.unwrap();
    let (rough_scene, pack) = rough(cement, &pack, 1e-8);
    let (rig, last) = broken(&rough_scene, &pack, 1);
    let after = rig.twin.pack();
    let bonds = &after.history.as_ref().unwrap().bonds;
    let modes = |kept: Kept| bonds.iter().filter(|bond| bond.condition == kept).count();
    let (pulled, sheared) = (modes(Kept::Tension), modes(Kept::Shear));
    assert!(pulled + sheared > 10 && sheared > 0, "{pulled} {sheared}");
    let mut nearest = 0.0_f64;
    for bond in bonds.iter().filter(|bond| bond.condition == Kept::Intact) {
        let (sigma, tau) = stresses(&after, bond, &law);
        nearest = nearest.max(sigma / tension).max(tau / shear);
    }
    assert!((0.3..1.0).contains(&nearest), "{nearest}");
    // What broke is in the network, and its energy is not stored any more.
    let network = last.network.as_ref().unwrap();
    let marked =
        |state: ContactState| network.state.iter().filter(|&&one| one == state as u8).count();
    let seen = [ContactState::Broken, ContactState::Bonded].map(marked);
    // Grains that nothing holds take no part, nor do bonds that carry nothing.
    assert!(seen[0] <= pulled + sheared && 2 * seen[0] > pulled + sheared, "{seen:?}");
    assert!(seen[1] <= bonds.len() - pulled - sheared && seen[1] > 100, "{seen:?}");
    assert!(state(&last).dissipated_energy > 0.0);
    // The same strengths in another unit break nothing.
    let unbreakable = Cement { strength: None, ..cement };
    let (rough_scene, pack) = rough(unbreakable, &pack, 1e-8);
    let (rig, _) = broken(&rough_scene, &pack, 1);
    let bonds = rig.twin.pack().history.unwrap().bonds;
    assert!(bonds.iter().all(|bond| bond.condition == Kept::Intact));
}

#[test]
fn cement_that_breaks_at_once_leaves_grains_that_only_press() {
    let pack = made(150, 1e7, 9);
    for law in [CementLaw::Fixed, PARALLEL] {
        let weak = breakable(law, 1e-3, 1e-3);
        let mut rig = start(&scene(weak, 1e-8), &pack);
        let last = rig.go(by_strain(&pack.bounds, [2e-4; 3]));
        let network = last.network.unwrap();
        // Compressed contacts of an effective law carry no tension and little shear: some stay.
        let open = network.state.iter().zip(&network.normal_force);
        assert!(open.filter(|(state, _)| **state == 3).all(|(_, &force)| force >= 0.0));
        assert!(last.walls.normal_force.iter().all(|&force| force > 0.0), "{law:?}");
    }
}

#[test]
fn cement_holds_what_is_pulled_and_walls_without_it_let_go() {
    let pack = made(150, 1e7, 10);
    for law in LAWS {
        let mut rig = start(&scene(cement(law), 1e-8), &pack);
        let before = state(&rig.go([0.0; 6])).confining_stress;
        let pulled = rig.go(by_strain(&pack.bounds, [-1e-4; 3]));
        assert!(state(&pulled).confining_stress < before - 1e5, "{law:?}");
        if law == PARALLEL {
            // The grains go on pressing on the walls.
            continue;
        }
        let bare = Cement { walls: false, ..cement(law) };
        let mut rig = start(&scene(bare, 1e-8), &pack);
        let report = rig.send(by_strain(&pack.bounds, [-1e-4; 3]));
        assert_eq!(report.disposition, Disposition::Applied, "{law:?}: {}", report.text);
        let forces = report.measures.unwrap().walls.normal_force;
        assert!(largest(&forces) < 1e-9, "{law:?}: {forces:?}");
    }
}

#[test]
fn a_cemented_block_carries_its_weight() {
    let pack = made(120, 1e6, 11);
    let mut scene = scene(Cement { walls: true, ..cement(EXPONENTIAL) }, 1e-9);
    scene.gravity = [0.0, 0.0, -9.81e3];
    let mut plain = packs::scene_to(1e-9);
    plain.gravity = scene.gravity;
    let (_, report) = Rig::start(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let walls = report.measures.unwrap().walls;
    let mass: f64 = pack.grains.iter().map(|g| 4.0 / 3.0 * PI * g.radius.powi(3) * g.density).sum();
    let down: f64 = walls.force.iter().map(|force| force[2]).sum();
    close("weight", down, -9.81e3 * mass, 1e-7);
}

#[test]
fn loads_are_kept_while_bonds_break() {
    let pack = made(200, 1e7, 12);
    let (scene, pack) = rough(strong(PARALLEL), &pack, 1e-8);
    let mut rig = start(&scene, &pack);
    let bounds = pack.bounds;
    let mut cracked = 0;
    for k in 1..=4 {
        rig.sequence += 1;
        let mut command = packs::absolute(rig.sequence, [0.0; 6]);
        let way = by_strain(&bounds, [0.0, 0.0, 1.5e-4 * f64::from(k)]);
        command.ask = graintwin::command::Ask::Targets(std::array::from_fn(|w| match w {
            4 | 5 => WallTarget::Displacement(way[w]),
            _ => WallTarget::Stress(9.0e6),
        }));
        let report = rig.twin.apply(&command, graintwin::report::Demand::ALL);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let measures = report.measures.unwrap();
        let stress = state(&measures).stress_walls;
        for axis in [0, 1] {
            assert!(off(stress[4 * axis], 9.0e6) < 1e-6, "{}", stress[4 * axis]);
        }
        let network = measures.network.unwrap();
        cracked = network.state.iter().filter(|&&state| state == 3).count();
    }
    assert!(cracked > 3, "{cracked}");
}

#[test]
fn a_pack_counted_otherwise_answers_the_same() {
    let pack = made(120, 1e7, 13);
    let mut other = pack.clone();
    other.grains.reverse();
    other.grains.swap(3, 77);
    for law in LAWS {
        let (scene, pack) = rough(strong(law), &pack, 1e-9);
        let (_, other) = rough(strong(law), &other, 1e-9);
        let (one, a) = broken(&scene, &pack, 1);
        let (two, b) = broken(&scene, &other, 1);
        for (a, b) in a.walls.normal_force.iter().zip(b.walls.normal_force) {
            assert!((a - b).abs() < 1e-6 * largest(&[1e-3, *a, b]), "{law:?}: {a} {b}");
        }
        let count = |rig: &Rig| {
            let bonds = rig.twin.pack().history.unwrap().bonds;
            bonds.iter().filter(|bond| bond.condition != Kept::Intact).count()
        };
        assert_eq!(count(&one), count(&two), "{law:?}");
    }
}

#[test]
fn packs_with_wrong_bonds_are_refused() {
    let scene = scene(cement(EXPONENTIAL), 1e-8);
    let pack = loaded(&scene, 40, 1);
    let refused = |change: fn(&mut BondMemory), text: &str| {
        let mut pack = pack.clone();
        change(&mut pack.history.as_mut().unwrap().bonds[3]);
        let error = graintwin::twin::Twin::new(&scene, &pack, 1).unwrap_err().to_string();
        assert!(error.contains("bonds[3]") && error.contains(text), "{error}");
    };
    refused(|bond| bond.distance = 0.0, ".distance: 0.0; allowed: a finite number above 0 m");
    refused(|bond| bond.radius = f64::NAN, ".radius: NaN; allowed: a finite number above 0 m");
    refused(|bond| bond.share = 1.5, ".share: 1.5; allowed: 0 to 1");
    refused(|bond| bond.work = f64::INFINITY, ".work: inf; allowed: a finite number");
    refused(|bond| bond.first = 4000, ".first: 4000; allowed: a grain, 0 to 39");
}

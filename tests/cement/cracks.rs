//! Bonds and cracks as the twin reports them: the strains at which small specimens break, by hand; the
//! ledger of energy; the order of cracks.

use std::f64::consts::PI;
use std::path::Path;

use graintwin::pack::generate::generate;
use graintwin::pack::{Grain, Pack, wall_index};
use graintwin::report::{BondCondition, Cracks, EventKind, Measures};
use graintwin::scene::{self, Material, Scene, Solver, Walls};
use graintwin::wall::Bounds;

use crate::packs::{self, Rig, bead, by_strain, off, recipe, state};

const E: f64 = 70e9;
const NU: f64 = 0.2;
const R: f64 = 1e-3;
const KAPPA: f64 = 0.01;
const SLIP: f64 = 0.1;

/// Walls of the glass of the grains, so that all contacts have one E*.
fn scene(cement: &str) -> Scene {
    let text = format!(
        "pack: {{file: none.csv, material: glass}}\n\
         walls: {{young: {E:e}, poisson: {NU}}}\n\
         contact: {{normal: {{cement: {cement}}}}}\n"
    );
    scene::parse(&text, Path::new("scene.yaml")).unwrap()
}

/// E*.
fn modulus() -> f64 {
    E / (2.0 * (1.0 - NU * NU))
}

/// h of two surfaces of the effective radius that carry `force` \[m\] (T 2.2).
fn overlap(effective_radius: f64, force: f64) -> f64 {
    (0.75 * force / (modulus() * effective_radius.sqrt())).powf(2.0 / 3.0)
}

/// a*⁽ᶜ⁾ \[m\] (T 4.4).
fn radius(effective_radius: f64, overlap: f64) -> f64 {
    (1.0 + KAPPA) * (effective_radius * overlap).sqrt()
}

fn cracks(measures: &Measures) -> &Cracks {
    measures.cracks.as_ref().unwrap()
}

/// Two beads on top of each other between z_min and z_max, pressed by 0.1 N when they are cemented.
/// The chain of three springs 2E*a* is pulled: the bond with the smallest section, that of the beads,
/// has the largest stress, since all carry one force.
#[test]
fn a_column_that_is_pulled_breaks_by_tension_between_its_grains_at_the_strain_of_three_springs() {
    let strength = 5e6;
    let (inner, outer) = (overlap(0.5 * R, 0.1), overlap(R, 0.1));
    let half = R - 0.5 * inner;
    let top = half + R - outer;
    let side = 1.3 * R;
    let grains = vec![bead([0.0, 0.0, -half], R), bead([0.0, 0.0, half], R)];
    let bounds = Bounds { min: [-side, -side, -top], max: [side, side, top] };
    let pack = Pack { bounds, grains, history: None };
    let cement = format!(
        "{{law: fixed, kappa: {KAPPA}, partial_slip: {SLIP}, strength: {{tension: {strength:e}, shear: .inf}}}}"
    );
    let sections = [radius(0.5 * R, inner), radius(R, outer)];
    let [k, k_wall] = sections.map(|a| 2.0 * modulus() * a);
    let force = strength * PI * sections[0] * sections[0];
    let stretch = force * (1.0 / k + 2.0 / k_wall);
    let (mut rig, first) = Rig::start(&scene(&cement), &pack);
    let bonds = first.measures.unwrap().bonds.unwrap();
    assert_eq!((bonds.first, bonds.second), (vec![0, 0, 1], vec![1, wall_index(4), wall_index(5)]));
    assert!(off(bonds.radius[0], sections[0]) < 1e-9 && off(bonds.radius[1], sections[1]) < 1e-9);

    let before = rig.go([0.0, 0.0, 0.0, 0.0, 0.0, -0.999 * stretch]);
    assert!(cracks(&before).list.is_empty() && cracks(&before).intact == 3);
    let bonds = before.bonds.as_ref().unwrap();
    assert!((bonds.strength_use[0] - 0.999).abs() < 1e-6, "{bonds:?}");
    assert!(off(bonds.normal_force[0], -0.999 * force) < 1e-6);
    assert!(off(before.walls.normal_force[5], -0.999 * force) < 1e-6);

    let after = rig.go([0.0, 0.0, 0.0, 0.0, 0.0, -1.001 * stretch]);
    let Cracks { intact, tension, shear, list } = cracks(&after);
    assert_eq!((*intact, *tension, *shear, list.len()), (2, 1, 0, 1));
    let crack = &list[0];
    assert_eq!((crack.first, crack.second), (0, 1));
    assert_eq!(crack.mode, BondCondition::Tension);
    assert!((crack.overload - 1.001).abs() < 1e-6, "{crack:?}");
    assert!(off(crack.normal_force, -1.001 * force) < 1e-6 && crack.tangential_force < 1e-9);
    // Halfway between the walls, the upper of which has moved.
    let middle = 0.5 * 1.001 * stretch;
    assert!((crack.position[2] - middle).abs() < 1e-9, "{crack:?}");
    assert!(crack.position[0].abs() + crack.position[1].abs() < 1e-9);
    assert_eq!(crack.normal.map(f64::round), [0.0, 0.0, -1.0]);
    // All that the three springs stored.
    let energy = 0.5 * 1.001 * 1.001 * force * stretch;
    assert!(off(crack.energy_released, energy) < 1e-6, "{crack:?}");
    assert!(off(state(&after).broken_energy, energy) < 1e-6);
    assert!(off(state(&after).dissipated_energy, energy) < 1e-6);
    // The wall is free, and the crack is an event of both bodies.
    assert!(after.walls.normal_force[5].abs() < 1e-6 * force);
    assert_eq!(after.events.len(), 1);
    let event = &after.events[0];
    assert_eq!((event.kind, &event.grains), (EventKind::ContactBreak, &vec![0, 1]));
    assert!(
        event.stress_before < 0.0 && event.stress_after.abs() < 1e-6 * event.stress_before.abs()
    );
    // Each bead went back to its wall by the stretch of the bond there.
    for way in &event.displacement {
        assert!(off(*way, 1.001 * force / k_wall) < 1e-6, "{way}");
    }
    assert_eq!(after.rearrangements[0].lost, [[0, 1]]);
    // Broken and open: in the network with force 0.
    let network = after.network.as_ref().unwrap();
    assert_eq!((network.state[0], network.normal_force[0]), (3, 0.0));
    let bonds = after.bonds.unwrap();
    assert_eq!(bonds.condition, [1, 0, 0]);
    assert_eq!((bonds.normal_force[0], bonds.strength_use[0]), (0.0, 0.0));
}

/// A bead between four walls of a pair each along x and z; those across x move to one side by s. The
/// bonds at z resist by Q = k_t u each (T 4.6), those at x push by k_n (s - u) each, and nothing
/// turns: s = u (1 + k_t/k_n).
#[test]
fn a_bead_that_is_dragged_along_two_walls_breaks_by_shear_at_them() {
    let strength = 1e6;
    let pressed = overlap(R, 0.1);
    let (near, far) = (R - pressed, 1.3 * R);
    let bounds = Bounds { min: [-near, -far, -near], max: [near, far, near] };
    let pack = Pack { bounds, grains: vec![bead([0.0; 3], R)], history: None };
    let cement = format!(
        "{{law: fixed, kappa: {KAPPA}, partial_slip: {SLIP}, strength: {{tension: .inf, shear: {strength:e}}}}}"
    );
    let section = radius(R, pressed);
    let shear_modulus = E / (2.0 * (1.0 + NU));
    let along = SLIP * 8.0 * section / (2.0 * (2.0 - NU) / shear_modulus);
    let across = 2.0 * modulus() * section;
    let force = strength * PI * section * section;
    let travel = force / along * (1.0 + along / across);
    let drag = |s: f64| [s, -s, 0.0, 0.0, 0.0, 0.0];
    let (mut rig, _) = Rig::start(&scene(&cement), &pack);
    let before = rig.go(drag(0.999 * travel));
    assert!(cracks(&before).list.is_empty() && cracks(&before).intact == 4);
    let after = rig.go(drag(1.001 * travel));
    let Cracks { intact, tension, shear, list } = cracks(&after);
    assert_eq!((*intact, *tension, *shear, list.len()), (3, 0, 1, 1));
    let first = list[0];
    assert!((first.overload - 1.001).abs() < 1e-5, "{first:?}");
    assert!(off(first.tangential_force, 1.001 * force) < 1e-5);

    // Held at one side only the bead turns: by θ R = Q/(2 k_t), where the bonds at x resist along z with
    // k_t each. So Q = k_t (u - θ R) and s = Q/k_t + Q/(2 k_t) + Q/(2 k_n).
    let second = force / along * (1.5 + 0.5 * along / across);
    assert!(second > 1.4 * travel);
    let between = rig.go(drag(0.999 * second));
    assert!(cracks(&between).list.is_empty());
    let after = rig.go(drag(1.001 * second));
    assert_eq!((cracks(&after).intact, cracks(&after).shear), (2, 2));
    let second = cracks(&after).list[0];
    assert!((second.overload - 1.001).abs() < 1e-5, "{second:?}");
    let mut walls = [first.second, second.second];
    walls.sort_unstable();
    assert_eq!(walls, [wall_index(5), wall_index(4)]);
    for crack in [first, second] {
        assert_eq!(crack.mode, BondCondition::Shear);
        assert!((crack.position[2].abs() - near).abs() < 1e-9, "{crack:?}");
        assert!((crack.normal_force / force).abs() < 1e-3);
    }
    assert!(off(state(&after).broken_energy, state(&after).dissipated_energy) < 1e-6);
}

/// Quartz with parallel bonds that break both ways.
fn specimen() -> (Scene, Pack) {
    let quartz = Material { young: 90e9, poisson: 0.08, density: 2650.0, spread: 0.0 };
    let walls = Walls { young: E, poisson: NU, ..Walls::default() };
    let pack = generate(&recipe(80, 10e6, 3), &quartz, &walls, 0.0, Solver::default()).unwrap();
    let mut scene = scene(
        "{law: {parallel: {young: 10.0e9, shear: 4.0e9, radius_ratio: 0.5, length_ratio: 2.0}}, \
         strength: {tension: 8.0e6, shear: 30.0e6}}",
    );
    scene.solver.tolerance = 1e-10;
    (scene, pack)
}

/// Three increments of a triaxial path.
fn path(pack: &Pack) -> [[f64; 6]; 3] {
    [1.0, 2.0, 3.0].map(|k| by_strain(&pack.bounds, [-1e-4 * k, -1e-4 * k, 4e-4 * k]))
}

#[test]
fn cracks_come_in_the_same_order_however_grains_are_numbered() {
    let (scene, pack) = specimen();
    let run = |pack: &Pack| -> Vec<Measures> {
        let (mut rig, _) = Rig::start(&scene, pack);
        path(pack).into_iter().map(|walls| rig.go(walls)).collect()
    };
    let n = pack.grains.len() as u32;
    // Grain k of the other pack is grain 37 k + 11 mod n of this one.
    let named = |k: u32| if k < n { (37 * k + 11) % n } else { k };
    let grains: Vec<Grain> = (0..n).map(|k| pack.grains[named(k) as usize]).collect();
    let other = Pack { grains, ..pack.clone() };
    let (mut all, mut modes) = (0, [0, 0]);
    for (one, other) in run(&pack).iter().zip(run(&other)) {
        let (one, other) = (cracks(one), cracks(&other));
        assert_eq!(
            (one.intact, one.tension, one.shear),
            (other.intact, other.tension, other.shear)
        );
        assert_eq!(one.list.len(), other.list.len());
        for (a, b) in one.list.iter().zip(&other.list) {
            let bodies = [named(b.first), named(b.second)];
            let bodies = [bodies[0].min(bodies[1]), bodies[0].max(bodies[1])];
            assert_eq!(([a.first, a.second], a.mode), (bodies, b.mode));
            assert!(off(a.overload, b.overload) < 1e-5, "{a:?} {b:?}");
        }
        all += one.list.len();
        modes = [one.tension, one.shear];
    }
    assert!(all > 10 && modes[0] > 0 && modes[1] > 0, "{all} {modes:?}");
}

#[test]
fn what_is_told_of_cracks_bonds_events_and_energy_agrees() {
    let (scene, pack) = specimen();
    let (mut rig, first) = Rig::start(&scene, &pack);
    let bonds = cracks(&first.measures.unwrap()).intact;
    let (mut broken, mut released, mut at_the_end) = (0, 0.0, 0);
    for walls in path(&pack) {
        let report = rig.send(walls);
        let measures = report.measures.unwrap();
        let told = cracks(&measures);
        broken += told.list.len() as u32;
        assert_eq!(told.tension + told.shear, broken);
        assert_eq!(told.bonds(), bonds);
        let list = measures.bonds.as_ref().unwrap();
        for (condition, count) in [(0, told.intact), (1, told.tension), (2, told.shear)] {
            let found = list.condition.iter().filter(|one| **one == condition).count();
            assert_eq!(found as u32, count);
        }
        assert!(list.strength_use.iter().all(|used| *used < 1.0), "an overloaded bond holds");
        // Cracks are events in their order, each in full; other events are stress drops.
        let breaks: Vec<_> =
            measures.events.iter().filter(|e| e.kind == EventKind::ContactBreak).collect();
        assert_eq!(breaks.len(), told.list.len());
        for (event, crack) in breaks.iter().zip(&told.list) {
            assert_eq!(event.grains, [crack.first, crack.second]);
            assert_eq!(event.energy_released, crack.energy_released);
            assert_eq!(event.stress_before, crack.stress_before);
            assert_eq!(event.stress_after, crack.stress_after);
            assert!(crack.overload >= 1.0);
        }
        assert_eq!(measures.rearrangements.len(), measures.events.len());
        released += told.list.iter().map(|crack| crack.energy_released).sum::<f64>();
        let said = format!("{} bonds broke", told.list.len());
        assert!(told.list.len() < 2 || report.text.contains(&said), "{}", report.text);
        let now = measures.state.unwrap();
        assert!((now.broken_energy - released).abs() <= 1e-9 * released.abs());
        // A last crack at the end left the pack with the stress that it has now.
        let last = told.list.last().filter(|crack| crack.substep == report.substeps);
        if let (Some(last), true) = (last, measures.events.len() == breaks.len()) {
            let stress = now.stress_contacts;
            let mean = (stress[0] + stress[4] + stress[8]) / 3.0;
            assert!(off(last.stress_after, mean) < 1e-12);
            at_the_end += 1;
        }
    }
    assert!(at_the_end > 0);
    assert!(broken > 10);
}

#[test]
fn without_cement_there_are_neither_bonds_nor_cracks() {
    let (_, pack) = specimen();
    let (_, first) = Rig::start(&packs::scene(), &pack);
    let measures = first.measures.unwrap();
    assert!(measures.bonds.is_none() && measures.cracks.is_none());
}

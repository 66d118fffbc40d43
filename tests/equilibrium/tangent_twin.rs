//! Tangent moduli as the twin answers them: closed forms, secants that close in, nothing else
//! changed by asking, and packs that are at the end of their strength.

use std::f64::consts::PI;

use graintwin::pack::Pack;
use graintwin::report::{Demand, Measures, Tangent, TangentModuli};
use graintwin::scene::{Coulomb, Friction, Law, ModuliKind, Scene, Update};
use graintwin::twin::Twin;
use graintwin::wall;

use crate::packs::{
    self, E_GRAINS, E_WALL, Rig, absolute, bead, by_strain, centered, close, made, scene_to,
};

/// Radius of the beads \[m\].
const R: f64 = 1e-4;

fn asking(kind: ModuliKind, tolerance: f64) -> Scene {
    let mut scene = scene_to(tolerance);
    scene.outputs.moduli = kind;
    scene
}

fn frictional(scene: Scene) -> Scene {
    let coulomb = Coulomb { coefficient: 0.3, law: Law::ReturnMap, update: Update::Frozen };
    let mut scene = scene;
    scene.contact.friction = Friction::Coulomb(coulomb);
    scene.contact.torsion = true;
    scene
}

fn rough(mut pack: Pack) -> Pack {
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
}

fn start(scene: &Scene, pack: &Pack) -> Tangent {
    Rig::start(scene, pack).1.measures.unwrap().tangent.unwrap()
}

/// A block of n³ beads in a box with these sides.
fn block(n: usize, sides: [f64; 3]) -> Pack {
    let mut grains = Vec::new();
    for cell in 0..n.pow(3) {
        let cell = [cell % n, cell / n % n, cell / n / n];
        let at = |axis: usize| sides[axis] * ((cell[axis] as f64 + 0.5) / n as f64 - 0.5);
        grains.push(bead([at(0), at(1), at(2)], R));
    }
    Pack { bounds: centered(sides), grains, history: None }
}

/// Every entry of `found` against `want`, of the largest.
#[track_caller]
fn close_all(what: &str, found: &[f64], want: &[f64]) {
    let largest = want.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    for (k, (found, want)) in found.iter().zip(want).enumerate() {
        assert!((found - want).abs() < 1e-9 * largest, "{what} {k}: {found:e}, not {want:e}");
    }
}

#[test]
fn blocks_are_as_stiff_as_their_rows() {
    // A row of n beads in series between two walls: its overlaps h share one force F, and
    // dF/ds = 1/(Σ 1/kn) with kn = 3/2 F/h.
    for (n, strains) in [(1, [1e-3, 2e-3, 4e-3]), (3, [1e-3, 2e-3, 3e-3])] {
        let sides = strains.map(|strain| 2.0 * R * n as f64 * (1.0 - strain));
        let wall = 4.0 / 3.0 * E_WALL * R.sqrt();
        let grain = 4.0 / 3.0 * E_GRAINS * (0.5 * R).sqrt();
        let rows = (n * n) as f64;
        let ratio = (wall / grain).powf(2.0 / 3.0);
        let row = |axis: usize| {
            let short = 2.0 * R * n as f64 - sides[axis];
            let overlap = short / (2.0 + (n - 1) as f64 * ratio);
            let force = wall * overlap.powf(1.5);
            let soft = 2.0 * overlap / (1.5 * force);
            (force, 1.0 / (soft + (n - 1) as f64 * ratio * overlap / (1.5 * force)))
        };
        let area = |axis: usize| sides[(axis + 1) % 3] * sides[(axis + 2) % 3];
        let stress = |axis: usize| rows * row(axis).0 / area(axis);
        let relaxed: Vec<f64> = (0..9)
            .map(|k| match (k / 3, k % 3) {
                (l, m) if l == m => rows * row(l).1 * sides[l] / area(l),
                (l, _) => stress(l),
            })
            .collect();
        let found = start(&asking(ModuliKind::Tangent, 1e-12), &block(n, sides)).stands;
        assert!(found.valid && found.error < 1e-9);
        close_all(&format!("{n} beads a side"), &found.relaxed, &relaxed);
        for v in 0..wall::COUNT {
            let want: Vec<f64> = (0..wall::COUNT)
                .map(|w| if v / 2 == w / 2 { rows * row(v / 2).1 } else { 0.0 })
                .collect();
            close_all(wall::NAMES[v], &found.wall_stiffness[v], &want);
        }
        let pair = |l: usize, m: usize| {
            0.25 * (relaxed[4 * l] + relaxed[4 * m] - relaxed[3 * l + m] - relaxed[3 * m + l])
        };
        close_all("G", &found.shear_pairs, &[pair(0, 1), pair(1, 2), pair(2, 0)]);
        close("K", found.bulk, relaxed.iter().sum::<f64>() / 9.0, 1e-9);
    }
}

#[test]
fn a_wall_that_moves_alone_takes_a_bead_along_that_the_other_walls_hold() {
    // Both x walls move by 1 the same way, the bead by u: the four other walls hold it at their
    // contacts with ks each, 2 kn (1 - u) = 4 ks u; it does not turn. With all walls at the same
    // overlap one wall alone is half of that and half of both closing in.
    let overlap = 1e-3 * R;
    let pack = rough(block(1, [2.0 * (R - overlap); 3]));
    let mut scene = frictional(asking(ModuliKind::Tangent, 1e-12));
    scene.walls.friction = Some(0.3);
    let found = start(&scene, &pack);
    let kn = 2.0 * E_WALL * R.sqrt() * overlap.sqrt();
    // (2-ν)/G of glass (70 GPa, 0.2) and of the wall (7 TPa, 0.495).
    let compliance = 1.8 * 2.4 / 70e9 + 1.505 * 2.99 / 7e12;
    let ks = 8.0 * (R * overlap).sqrt() / compliance;
    let u = 2.0 * kn / (2.0 * kn + 4.0 * ks);
    for of in [found.stands, found.sticks] {
        let stiffness = &of.wall_stiffness;
        close("itself", stiffness[0][0], kn * (1.0 - 0.5 * u), 1e-10);
        close("opposite", stiffness[1][0], kn * 0.5 * u, 1e-10);
        assert!(stiffness[2][0].abs() < 1e-10 * kn);
    }
}

#[test]
fn secants_close_in_on_the_tangent_in_proportion_to_the_increment() {
    let smooth = (asking(ModuliKind::Both, 1e-12), made(200, 1e7, 5));
    let rough = (frictional(asking(ModuliKind::Both, 1e-12)), rough(made(200, 1e7, 5)));
    for (scene, pack) in [smooth, rough] {
        for direction in [[0.0, 0.0, 1.0], [1.0; 3], [1.0, 0.0, -1.0]] {
            let off = |size: f64| {
                let (mut rig, report) = Rig::start(&scene, &pack);
                let before = report.measures.unwrap();
                let tangent = before.tangent.unwrap().stands.relaxed;
                let after = rig.go(by_strain(&pack.bounds, direction.map(|strain| strain * size)));
                let stress = |of: &Measures, l: usize| packs::state(of).stress_walls[4 * l];
                let off = (0..3).map(|l| {
                    let secant = (stress(&after, l) - stress(&before, l)) / size;
                    let want: f64 = (0..3).map(|m| tangent[3 * l + m] * direction[m]).sum();
                    (secant - want).abs() / tangent[0]
                });
                off.fold(0.0, f64::max)
            };
            let off = [1e-5, 1e-6, 1e-7].map(off);
            assert!(off[0] < 0.05, "{direction:?}: {off:?}");
            // Contacts that form and slide on the way make it more than proportional.
            for pair in off.windows(2) {
                assert!((4.0..25.0).contains(&(pair[0] / pair[1])), "{direction:?}: {off:?}");
            }
        }
    }
}

#[test]
fn a_run_has_the_same_bits_with_tangent_moduli_and_without() {
    for (make, pack) in [
        (asking as fn(ModuliKind, f64) -> Scene, made(120, 1e6, 5)),
        (|kind, tolerance| frictional(asking(kind, tolerance)), rough(made(120, 1e6, 5))),
    ] {
        let run = |kind| {
            let (mut rig, _) = Rig::start(&make(kind, 1e-8), &pack);
            let path = [[0.0, 0.0, 3e-4], [1e-4, 0.0, 4e-4], [-1e-4, 0.0, 0.0]];
            let digests = path.map(|strain| {
                rig.send(by_strain(&pack.bounds, strain));
                rig.twin.digest()
            });
            (digests, rig.twin.effort().gradients)
        };
        assert_eq!(run(ModuliKind::Secant), run(ModuliKind::Both));
    }
}

#[test]
fn the_bits_of_the_tangent_do_not_depend_on_the_threads() {
    // So large that the linear system is cut into two parts.
    let large = (asking(ModuliKind::Tangent, 1e-8), made(10_000, 1e7, 2));
    let small = (frictional(asking(ModuliKind::Tangent, 1e-8)), rough(made(306, 1e7, 2)));
    for (scene, pack) in [large, small] {
        let bits = |threads| {
            let (_, report) = Rig::start_on(&scene, &pack, threads);
            let Tangent { products, stands, sticks, .. } =
                report.measures.unwrap().tangent.unwrap();
            assert!(stands.valid && sticks.valid);
            (products, [stands, sticks].map(|of| numbers(&of).map(f64::to_bits)))
        };
        let want = bits(1);
        for threads in [2, 7] {
            assert!(bits(threads) == want, "{threads} threads");
        }
    }
}

/// Some numbers of it.
fn numbers(of: &TangentModuli) -> [f64; 18] {
    std::array::from_fn(|k| if k < 9 { of.relaxed[k] } else { of.affine[k - 9] })
}

#[test]
fn what_is_asked_for_is_what_comes() {
    let pack = made(60, 1e7, 5);
    let served = |kind, demand| {
        let mut twin = Twin::new(&asking(kind, 1e-8), &pack, 1).unwrap();
        twin.start(demand);
        let strain = by_strain(&pack.bounds, [0.0, 0.0, 1e-5]);
        twin.apply(&absolute(1, strain), demand).measures.unwrap()
    };
    let secant = served(ModuliKind::Secant, Demand::ALL);
    assert!(secant.tangent.is_none() && secant.moduli.unwrap().tangent[0].is_nan());
    let both = served(ModuliKind::Both, Demand::ALL);
    let tangent = served(ModuliKind::Tangent, Demand::ALL);
    let found = tangent.tangent.unwrap();
    assert_eq!(both.tangent, Some(found));
    let (of_both, of_tangent) = (both.moduli.unwrap(), tangent.moduli.unwrap());
    assert_eq!(of_both.bulk, secant.moduli.unwrap().bulk);
    assert_eq!((of_both.tangent, of_tangent.tangent), (found.stands.relaxed, found.stands.relaxed));
    assert_eq!((of_tangent.bulk, of_tangent.shear), (found.stands.bulk, found.stands.shear));
    // Without friction all contacts are the same.
    assert_eq!(found.stands, found.sticks);
    let alone = served(ModuliKind::Both, Demand { tangent: true, ..Demand::default() });
    assert!(alone.moduli.is_none() && alone.tangent == Some(found));
    let moduli = served(ModuliKind::Both, Demand { moduli: true, ..Demand::default() });
    assert!(moduli.tangent.is_none() && moduli.moduli.unwrap().tangent == of_both.tangent);
    // Waves: ρ v² is the modulus.
    let mass: f64 = pack.grains.iter().map(|g| g.density * 4.0 / 3.0 * PI * g.radius.powi(3)).sum();
    let volume = pack.bounds.volume() * (1.0 - 1e-5);
    close("density", found.density, mass / volume, 1e-12);
    for axis in 0..3 {
        let modulus = found.density * found.sticks.p_speed[axis].powi(2);
        close("P", modulus, found.sticks.relaxed[4 * axis], 1e-12);
    }
}

#[test]
fn a_pack_that_carries_nothing_has_no_stiffness() {
    let pack = Pack {
        bounds: centered([4.0 * R; 3]),
        grains: vec![bead([0.0; 3], R), bead([1.5 * R, 0.0, 0.0], 0.3 * R)],
        history: None,
    };
    for scene in [asking(ModuliKind::Both, 1e-8), frictional(asking(ModuliKind::Both, 1e-8))] {
        let Tangent { stands, sticks, products, .. } = start(&scene, &rough(pack.clone()));
        for of in [stands, sticks] {
            assert!(of.valid && products == 0);
            assert_eq!((of.relaxed, of.affine, of.bulk), ([0.0; 9], [0.0; 9], 0.0));
        }
    }
}

#[test]
fn a_bead_between_two_walls_has_their_stiffness() {
    for share in [1e-3, 1e-2] {
        let sides = [4.0 * R, 4.0 * R, (2.0 - share) * R];
        let pack = Pack { bounds: centered(sides), grains: vec![bead([0.0; 3], R)], history: None };
        let found = start(&asking(ModuliKind::Both, 1e-12), &pack).stands;
        let kn = 2.0 * E_WALL * R.sqrt() * (0.5 * share * R).sqrt();
        assert!(found.valid);
        close("zz", found.relaxed[8], 0.5 * kn * sides[2] / (sides[0] * sides[1]), 1e-9);
        assert_eq!(found.relaxed[..3], [0.0; 3]);
    }
}

#[test]
fn packs_at_the_end_of_their_strength_get_numbers_or_none() {
    for (scene, pack) in [
        (asking(ModuliKind::Both, 1e-8), made(150, 2e4, 3)),
        (frictional(asking(ModuliKind::Both, 1e-8)), rough(made(60, 2e4, 3))),
    ] {
        let (mut rig, report) = Rig::start(&scene, &pack);
        let mut all = vec![report];
        for strain in [-4e-5, -8e-5] {
            all.push(rig.send(by_strain(&pack.bounds, [strain; 3])));
            all.push(rig.send(by_strain(&pack.bounds, [0.0, 0.0, -2.0 * strain])));
        }
        let known: Vec<_> = all
            .iter()
            .filter_map(|report| report.measures.as_ref()?.tangent)
            .flat_map(|tangent| [tangent.stands, tangent.sticks])
            .collect();
        assert!(known.len() >= 8);
        for of in known {
            assert_eq!(of.valid, numbers(&of).iter().all(|number| number.is_finite()));
            assert_eq!(of.valid, of.error <= 1e-6);
            assert!(!of.valid || of.bulk >= 0.0, "{of:?}");
        }
    }
}

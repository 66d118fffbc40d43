//! Statistics of the force network: closed forms, invariances, and what another way of counting
//! gives. Those of the chains are in `fabric_chains.rs`.

use std::path::Path;

use graintwin::Vec3;
use graintwin::contact::Other;
use graintwin::measure::contacts::Contact;
use graintwin::measure::fabric::{angle, tensor};
use graintwin::measure::stress;
use graintwin::pack::Pack;
use graintwin::report::{ContactNetwork, Demand, Fabric, Measures};
use graintwin::scene::{self, Scene};
use graintwin::twin::Twin;
use graintwin::wall::Bounds;
use nalgebra::Matrix3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::packs::{
    E_GRAINS, E_WALL, Rig, bead, by_strain, centered, close, made, scene_to, state,
};

/// Radius of the beads \[m\].
const R: f64 = 1e-4;
const THIRD: f64 = 1.0 / 3.0;

/// A contact between two grains.
fn contact(normal: Vec3, force: f64, shear: Vec3, distance: f64) -> Contact {
    Contact {
        first: 0,
        second: Other::Grain(1),
        normal,
        force,
        overlap: 0.0,
        shear,
        torsion: 0.0,
        slides: false,
        slipped: false,
        distance,
        cement: None,
    }
}

/// A direction, all of them alike.
fn direction(random: &mut Pcg64) -> Vec3 {
    loop {
        let at = Vec3::from_fn(|_, _| random.random_range(-1.0..1.0));
        if (1e-3..1.0).contains(&at.norm()) {
            return at.normalize();
        }
    }
}

/// The six axes of an icosahedron: the means of products of two and of four components are those
/// of all directions alike.
fn icosahedron() -> Vec<Vec3> {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let corner = |a: f64, b: f64, c: f64| Vec3::new(a, b, c).normalize();
    let pairs = [1.0, -1.0].map(|sign| {
        [
            corner(0.0, 1.0, sign * golden),
            corner(1.0, sign * golden, 0.0),
            corner(sign * golden, 0.0, 1.0),
        ]
    });
    pairs.concat()
}

/// The 3x3 numbers of a tensor that is row major.
fn matrix(values: &[f64; 9]) -> Matrix3<f64> {
    Matrix3::from_row_slice(values)
}

#[track_caller]
fn near(what: &str, got: &Matrix3<f64>, want: &Matrix3<f64>, tolerance: f64) {
    let off = (got - want).abs().max();
    assert!(off <= tolerance, "{what}: off by {off:.1e}\n{got}{want}");
}

fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
    Matrix3::from_diagonal(&Vec3::new(x, y, z))
}

fn refs(contacts: &[Contact]) -> Vec<&Contact> {
    contacts.iter().collect()
}

#[test]
fn directions_that_are_all_alike_have_the_fabric_and_the_cones_of_a_sphere() {
    let mut random = Pcg64::seed_from_u64(5);
    let count = 200_000;
    let contacts: Vec<Contact> =
        (0..count).map(|_| contact(direction(&mut random), 1.0, Vec3::zeros(), R)).collect();
    let found = tensor::directions(&refs(&contacts), 0.0);
    // Solid angle of a double cone of 45°: 1 - cos 45° of all.
    let share = 1.0 - 0.5f64.sqrt();
    let error = (share * (1.0 - share) / f64::from(count)).sqrt();
    for cone in found.cone_all {
        assert!((cone - share).abs() < 4.0 * error, "{cone}");
    }
    // Variance of n_z² is 4/45.
    let error = (4.0 / 45.0 / f64::from(count)).sqrt();
    near("fabric", &matrix(&found.fabric), &diagonal(THIRD, THIRD, THIRD), 4.0 * error);
    assert!(found.contact_anisotropy.abs() < 4.0 * 7.5 * 1.5 * error);
    let angle = angle::by_angle(&refs(&contacts), angle::predicted(&[], &Matrix3::zeros()));
    let bin = f64::from(count) / angle::BINS as f64;
    for &inside in &angle.count {
        assert!((f64::from(inside) - bin).abs() < 4.0 * bin.sqrt(), "{:?}", angle.count);
    }
}

#[test]
fn crystals_have_the_fabric_of_their_lattice() {
    let [x, y, z] = [Vec3::x(), Vec3::y(), Vec3::z()];
    let diagonals = [x + y, x - y, y + z, y - z, z + x, z - x];
    let of = |normals: &[Vec3]| {
        let contacts: Vec<Contact> =
            normals.iter().map(|n| contact(n.normalize(), 2.0, Vec3::zeros(), R)).collect();
        tensor::directions(&refs(&contacts), 2.0)
    };
    let isotropic = diagonal(THIRD, THIRD, THIRD);
    let [cubic, face_centred, column] = [of(&[x, y, z]), of(&diagonals), of(&[z, -z])];
    near("simple cubic", &matrix(&cubic.fabric), &isotropic, 1e-15);
    near("face-centred cubic", &matrix(&face_centred.fabric), &isotropic, 1e-15);
    near("column", &matrix(&column.force_fabric), &diagonal(0.0, 0.0, 1.0), 0.0);
    assert_eq!(cubic.cone_all, [THIRD; 3]);
    // Four of the six are at 45° to each axis: on the edge, and in.
    assert_eq!(face_centred.cone_largest, [2.0 * THIRD; 3]);
    assert_eq!((column.cone_all, column.contact_anisotropy), ([0.0, 0.0, 1.0], 7.5));
}

#[test]
fn a_force_field_of_b_a73_is_found_again_and_is_what_its_stress_predicts() {
    let bounds = centered([1e-3, 2e-3, 3e-3]);
    // Lateral and axial stress over their mean, and a force [N].
    for (lateral, axial, force) in [(1.0, 1.0, 0.3), (0.7, 1.6, 2.0), (1.2, 0.6, 5e-4)] {
        let ratio = diagonal(lateral, lateral, axial);
        let obeying = |n: Vec3| {
            let traction = ratio * n * force;
            let normal = traction.dot(&n);
            contact(n, normal, traction - n * normal, 2.0 * R)
        };
        let contacts: Vec<Contact> = icosahedron().into_iter().map(obeying).collect();
        let stress = stress::from_contacts(&contacts, &bounds);
        let form = angle::by_angle(&refs(&contacts), angle::predicted(&refs(&contacts), &stress));
        for form in [form.fitted, form.predicted] {
            close("lateral", form.lateral, lateral * force, 1e-13);
            close("axial", form.axial, axial * force, 1e-13);
            assert!((form.shear - (axial - lateral) * force).abs() < 1e-13 * force);
        }
        // Also where the directions are not all alike and the contact is seen from the other grain.
        let mut random = Pcg64::seed_from_u64(6);
        let some = (0..40).map(|_| obeying(direction(&mut random) + 0.8 * Vec3::x()));
        let some: Vec<Contact> = some
            .map(|one| {
                let seen = obeying(one.normal.normalize());
                let flip = if one.normal.y > 0.0 { 1.0 } else { -1.0 };
                contact(flip * seen.normal, seen.force, flip * seen.shear, 2.0 * R)
            })
            .collect();
        let found = angle::by_angle(&refs(&some), form.predicted);
        close("lateral", found.fitted.lateral, lateral * force, 1e-12);
        close("axial", found.fitted.axial, axial * force, 1e-12);
        assert!((found.fitted.shear - (axial - lateral) * force).abs() < 1e-12 * force);
        // Every bin holds the mean of what the form says of its members.
        for bin in 0..angle::BINS {
            let cosine = |one: &&Contact| ((one.normal.z.abs() * 10.0) as usize).min(9) == bin;
            let members: Vec<&Contact> = some.iter().filter(cosine).collect();
            if members.is_empty() {
                assert!(found.normal[bin].is_nan() && found.count[bin] == 0);
                continue;
            }
            let form = |one: &&Contact| {
                let theta = one.normal.z.abs().acos();
                let normal = lateral * theta.sin().powi(2) + axial * theta.cos().powi(2);
                [normal * force, (axial - lateral) * force * theta.sin() * theta.cos()]
            };
            let mean = |k: usize| {
                members.iter().map(|one| form(one)[k]).sum::<f64>() / members.len() as f64
            };
            close("P", found.normal[bin], mean(0), 1e-12);
            assert!((found.shear[bin] - mean(1)).abs() < 1e-12 * force);
            assert!((found.tangential[bin] - mean(1).abs()).abs() < 1e-12 * force);
        }
    }
}

#[test]
fn without_friction_normal_forces_take_five_halves_of_the_deviator() {
    let bounds = centered([1e-3; 3]);
    let deviator = diagonal(-0.1, -0.1, 0.2);
    let obeying =
        |n: Vec3| contact(n, 0.3 * (1.0 + 2.5 * n.dot(&(deviator * n))), Vec3::zeros(), 2.0 * R);
    let contacts: Vec<Contact> = icosahedron().into_iter().map(obeying).collect();
    let stress = stress::from_contacts(&contacts, &bounds);
    near("σ/p", &(stress * 3.0 / stress.trace()), &diagonal(0.9, 0.9, 1.2), 1e-14);
    let form = angle::by_angle(&refs(&contacts), angle::predicted(&refs(&contacts), &stress));
    let [fitted, predicted] = [form.fitted, form.predicted].map(|form| form.axial - form.lateral);
    close("deviator", fitted, 2.5 * predicted, 1e-12);
    close("mean", 2.0 * form.fitted.lateral + form.fitted.axial, 0.9, 1e-13);
}

#[test]
fn the_anisotropies_add_up_to_the_stress_ratio() {
    let mut random = Pcg64::seed_from_u64(7);
    let mut some = |count: usize| -> Vec<Contact> {
        let one = |random: &mut Pcg64| {
            let n = (direction(random) + 0.5 * Vec3::z()).normalize();
            let across = n.cross(&direction(random));
            contact(n, random.random_range(0.1..3.0), across * 0.4, 2.0 * R)
        };
        (0..count).map(|_| one(&mut random)).collect()
    };
    for contacts in [some(1), some(3), some(500)] {
        let found = tensor::directions(&refs(&contacts), f64::INFINITY);
        let stress = stress::from_contacts(&contacts, &centered([1e-3; 3]));
        let q = stress[(2, 2)] - 0.5 * (stress[(0, 0)] + stress[(1, 1)]);
        let sum =
            found.contact_anisotropy + found.normal_anisotropy + 1.5 * found.tangential_anisotropy;
        close("q/p", 0.4 * sum, 3.0 * q / stress.trace(), 1e-11);
        let parts = matrix(&found.force_fabric) + matrix(&found.shear_fabric);
        near("σ/3p", &parts, &(stress / stress.trace()), 1e-14);
        assert!(found.cone_largest.iter().all(|share| share.is_nan()), "no force is that large");
    }
}

/// A block of `n` beads a side under a strain.
fn block(n: usize) -> Pack {
    let side = 2.0 * R * n as f64 * (1.0 - 1e-3);
    let at = |k: usize| side * ((k as f64 + 0.5) / n as f64 - 0.5);
    let cells = (0..n * n * n).map(|k| [k / (n * n), k / n % n, k % n]);
    let grains = cells.map(|cell| bead(cell.map(at), R)).collect();
    Pack { bounds: centered([side; 3]), grains, history: None }
}

fn fabric(measures: &Measures) -> &Fabric {
    measures.fabric.as_ref().unwrap()
}

#[test]
fn a_cubic_block_is_isotropic_with_a_chain_a_row() {
    let (_, report) = Rig::start(&scene_to(1e-10), &block(4));
    let measures = report.measures.unwrap();
    let found = fabric(&measures);
    // 3 x 16 rows of three contacts between grains and two with walls.
    assert_eq!((found.contacts, found.grain_contacts), (240, 144));
    near("fabric", &matrix(&found.directions.fabric), &diagonal(THIRD, THIRD, THIRD), 1e-9);
    near("forces", &matrix(&found.directions.force_fabric), &diagonal(THIRD, THIRD, THIRD), 1e-9);
    assert_eq!(found.directions.cone_all, [THIRD; 3]);
    // Interior: further than 2R from every wall, the inner 2 x 2 x 2 at 3R.
    assert_eq!(found.coordination.all, [0, 0, 0, 0, 0, 0, 64]);
    assert_eq!(found.coordination.interior, [0, 0, 0, 0, 0, 0, 8]);
    assert!(found.mobilised_histogram.is_empty());
    let mut all_at_the_mean = [0; 50];
    for (bin, count) in found.force_histogram.iter().enumerate() {
        // A rounding puts each of these equal forces on either side of the mean.
        all_at_the_mean[if bin == 3 { 4 } else { bin }] += count;
    }
    assert_eq!(all_at_the_mean[4], 240);
}

#[test]
fn a_column_with_a_rattler_is_one_chain_along_its_axis() {
    let height = 6.0 * R * (1.0 - 1e-3);
    let column = (0..3).map(|k| bead([0.0, 0.0, height * ((f64::from(k) + 0.5) / 3.0 - 0.5)], R));
    let loose = bead([5.0 * R, 5.0 * R, 0.0], R);
    let pack = Pack {
        bounds: centered([20.0 * R, 20.0 * R, height]),
        grains: column.chain([loose]).collect(),
        history: None,
    };
    let mut scene = scene_to(1e-10);
    scene.outputs.chain_share = 1.0;
    let (_, report) = Rig::start(&scene, &pack);
    let measures = report.measures.unwrap();
    let found = fabric(&measures);
    // One force in all contacts: h_grain = c h_wall, and 2 h_wall + 2 h_grain is the shortening.
    let ratio = (E_WALL * R.sqrt() / (E_GRAINS * (0.5 * R).sqrt())).powf(2.0 / 3.0);
    let overlap = 6e-3 * R / (2.0 + 2.0 * ratio);
    let force = 4.0 / 3.0 * E_WALL * R.sqrt() * overlap.powf(1.5);
    assert_eq!((found.contacts, found.grain_contacts), (4, 2));
    close("mean", found.mean_normal_force, force, 1e-9);
    near("fabric", &matrix(&found.directions.fabric), &diagonal(0.0, 0.0, 1.0), 1e-12);
    assert_eq!(found.directions.cone_largest, [0.0, 0.0, 1.0]);
    let chains = &found.chains;
    assert_eq!((chains.contacts, chains.grains, chains.count, chains.largest), (4, 3, 1, 3));
    assert_eq!(
        (chains.spans, chains.strongest_path[..2].to_vec()),
        ([false, false, true], vec![0.0; 2])
    );
    close("path", chains.strongest_path[2], force, 1e-9);
    assert_eq!(chains.load, 1.0);
    assert_eq!(found.coordination.all, [1, 0, 3]);
    // One angle tells no two numbers.
    assert!(found.angle.fitted.lateral.is_nan() && found.angle.fitted.shear.is_nan());
}

#[test]
fn a_pack_without_contacts_has_statistics_of_nothing() {
    let pack = Pack { bounds: centered([1.0; 3]), grains: vec![bead([0.0; 3], R)], history: None };
    let (_, report) = Rig::start(&scene_to(1e-8), &pack);
    let measures = report.measures.unwrap();
    let found = fabric(&measures);
    assert_eq!((found.contacts, found.chains.contacts, found.chains.count), (0, 0, 0));
    assert_eq!((found.mean_normal_force, found.chains.spans), (0.0, [false; 3]));
    assert!(found.directions.fabric.iter().chain(&found.directions.cone_all).all(|n| n.is_nan()));
    assert_eq!(found.coordination.all, [1]);
}

#[test]
fn statistics_that_nobody_asked_for_are_not_there() {
    let mut twin = Twin::new(&scene_to(1e-8), &block(2), 1).unwrap();
    let report = twin.start(Demand { fabric: false, ..Demand::ALL });
    assert_eq!(report.measures.unwrap().fabric, None);
}

/// A scene with friction, also at the walls.
fn frictional() -> Scene {
    let text = "pack: {file: none.csv, material: glass}\n\
                contact: {friction: {coefficient: 0.3, update: current}}\n\
                outputs: {chain_share: 0.2}\n";
    scene::parse(text, Path::new("scene.yaml")).unwrap()
}

/// A pack that was sheared with friction.
fn sheared() -> Measures {
    let mut pack = made(300, 5e6, 3);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    let (mut rig, _) = Rig::start(&frictional(), &pack);
    rig.go(by_strain(&pack.bounds, [0.0, 0.0, 2e-3]));
    rig.go(by_strain(&pack.bounds, [-1e-3, -1e-3, 4e-3]))
}

/// A contact of a network as it is published.
struct Edge {
    second: u32,
    normal: [f64; 3],
    force: f64,
    shear: [f64; 3],
}

fn edges(network: &ContactNetwork) -> Vec<Edge> {
    let triple = |values: &[f64], k: usize| std::array::from_fn(|i| values[3 * k + i]);
    (0..network.first.len())
        .map(|k| Edge {
            second: network.second[k],
            normal: triple(&network.normal, k),
            force: network.normal_force[k],
            shear: triple(&network.tangential_force, k),
        })
        .collect()
}

#[test]
fn the_published_network_tells_the_same() {
    let measures = sheared();
    let found = fabric(&measures);
    let all = edges(measures.network.as_ref().unwrap());
    let inner: Vec<&Edge> = all.iter().filter(|one| one.second < u32::MAX - 5).collect();
    assert_eq!(found.contacts as usize, all.len());
    assert_eq!(found.contacts, state(&measures).contacts);
    assert_eq!(found.grain_contacts as usize, inner.len());

    let size = |of: [f64; 3]| of.iter().map(|x| x * x).sum::<f64>().sqrt();
    let total: f64 = all.iter().map(|one| one.force).sum();
    let mean = total / all.len() as f64;
    close("P", found.mean_normal_force, mean, 1e-13);
    let shear = all.iter().map(|one| size(one.shear)).sum::<f64>() / all.len() as f64;
    close("Q", found.mean_tangential_force, shear, 1e-13);

    let load: f64 = inner.iter().map(|one| one.force).sum();
    let directions = &found.directions;
    for (k, (i, j)) in (0..9).map(|k| (k, (k / 3, k % 3))) {
        let sum = |of: &dyn Fn(&Edge) -> f64| inner.iter().map(|one| of(one)).sum::<f64>();
        let count = inner.len() as f64;
        let off = [
            directions.fabric[k] - sum(&|one| one.normal[i] * one.normal[j]) / count,
            directions.force_fabric[k]
                - sum(&|one| one.force * one.normal[i] * one.normal[j]) / load,
            directions.shear_fabric[k] - sum(&|one| one.shear[i] * one.normal[j]) / load,
        ];
        assert!(off.iter().all(|off| off.abs() < 1e-14), "{i} {j} {off:?}");
    }

    let mut forces: Vec<f64> = all.iter().map(|one| one.force).collect();
    forces.sort_by(|a, b| b.total_cmp(a));
    let members = (0.2 * forces.len() as f64).round() as usize;
    assert_eq!(
        (found.chains.contacts as usize, found.chains.threshold),
        (members, forces[members - 1])
    );
    close("load", found.chains.load, forces[..members].iter().sum::<f64>() / total, 1e-13);
    let cone = |axis: usize, least: f64| {
        let of: Vec<&&Edge> = inner.iter().filter(|one| one.force >= least).collect();
        let inside = of.iter().filter(|one| one.normal[axis].abs().acos().to_degrees() <= 45.0);
        inside.count() as f64 / of.len() as f64
    };
    for axis in 0..3 {
        assert_eq!(directions.cone_all[axis], cone(axis, 0.0));
        assert_eq!(directions.cone_largest[axis], cone(axis, found.chains.threshold));
    }

    for (bin, &count) in found.force_histogram.iter().enumerate() {
        let (from, to) = (0.25 * bin as f64, 0.25 * (bin + 1) as f64);
        let inside = |force: f64| from * mean <= force && force < to * mean;
        assert_eq!(count as usize, forces.iter().filter(|force| inside(**force)).count());
    }
    // Grains and walls have the same coefficient.
    let mobilised: Vec<f64> = all.iter().map(|one| size(one.shear) / (0.3 * one.force)).collect();
    for (bin, &count) in found.mobilised_histogram.iter().enumerate() {
        let last = bin + 1 == found.mobilised_histogram.len();
        let inside = |of: f64| 0.05 * bin as f64 <= of && (last || of < 0.05 * (bin + 1) as f64);
        assert_eq!(count as usize, mobilised.iter().filter(|of| inside(**of)).count());
    }
    assert_eq!(found.mobilised_histogram.iter().sum::<u32>(), found.contacts);
    assert_eq!(found.force_histogram.iter().sum::<u32>(), found.contacts);
    assert_eq!(found.angle.count.iter().sum::<u32>(), found.grain_contacts);
    let sum: f64 = found
        .angle
        .count
        .iter()
        .zip(&found.angle.normal)
        .map(|(&count, mean)| if count > 0 { f64::from(count) * mean } else { 0.0 })
        .sum();
    close("ΣP", sum, load, 1e-13);
}

#[test]
fn coordination_is_that_of_the_network_and_the_places() {
    let measures = sheared();
    let network = measures.network.as_ref().unwrap();
    let grains = measures.grains.as_ref().unwrap();
    let mut contacts = vec![0_usize; grains.radius.len()];
    for &body in network.first.iter().chain(&network.second) {
        if let Some(count) = contacts.get_mut(body as usize) {
            *count += 1;
        }
    }
    let diameter = 2.0 * grains.radius.iter().copied().fold(0.0, f64::max);
    let walls = measures.walls.position;
    let is_interior = |at: &[f64; 3]| {
        (0..3).all(|k| at[k] - walls[2 * k] > diameter && walls[2 * k + 1] - at[k] > diameter)
    };
    let found = &fabric(&measures).coordination;
    for (k, &count) in found.all.iter().enumerate() {
        assert_eq!(count as usize, contacts.iter().filter(|own| **own == k).count());
    }
    assert_eq!(found.all.iter().sum::<u32>() as usize, contacts.len());
    let interior: Vec<usize> = grains
        .position
        .iter()
        .zip(&contacts)
        .filter(|(at, _)| is_interior(at))
        .map(|(_, count)| *count)
        .collect();
    assert!(!interior.is_empty());
    for (k, &count) in found.interior.iter().enumerate() {
        assert_eq!(count as usize, interior.iter().filter(|own| **own == k).count());
    }
    assert_eq!(found.interior.iter().sum::<u32>() as usize, interior.len());
}

/// The pack with its axes turned, mirrored and its grains in another order.
fn changed(pack: &Pack, turn: usize, mirror: f64, stride: usize) -> Pack {
    let turned = |of: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| of[(k + turn) % 3]) };
    let flip = |mut of: [f64; 3]| {
        of[0] *= mirror;
        of
    };
    let corners = [flip(turned(pack.bounds.min)), flip(turned(pack.bounds.max))];
    let pick =
        |better: fn(f64, f64) -> f64| std::array::from_fn(|k| better(corners[0][k], corners[1][k]));
    let count = pack.grains.len();
    let grains = (0..count).map(|k| {
        let mut grain = pack.grains[k * stride % count];
        grain.position = flip(turned(grain.position));
        grain
    });
    let bounds = Bounds { min: pick(f64::min), max: pick(f64::max) };
    Pack { bounds, grains: grains.collect(), history: None }
}

#[test]
fn turning_mirroring_and_renumbering_a_pack_changes_nothing_else() {
    let pack = made(301, 5e6, 11);
    // The pack as given is in equilibrium by far, whatever the order of its sums.
    let of = |pack: &Pack| {
        let (_, report) = Rig::start(&scene_to(1e-6), pack);
        assert_eq!(report.substeps, 0);
        report.measures.unwrap().fabric.unwrap()
    };
    let plain = of(&pack);
    for (turn, mirror, stride) in [(0, 1.0, 10), (0, -1.0, 1), (1, 1.0, 1), (2, -1.0, 100)] {
        let other = of(&changed(&pack, turn, mirror, stride));
        assert_eq!(other.force_histogram, plain.force_histogram);
        assert_eq!(other.coordination, plain.coordination);
        let [one, two] = [&other.chains, &plain.chains];
        let counts = |chains: &graintwin::report::Chains| {
            [chains.contacts, chains.grains, chains.count, chains.largest]
        };
        assert_eq!(counts(one), counts(two));
        close("threshold", one.threshold, two.threshold, 1e-9);
        for axis in 0..3 {
            let from = (axis + turn) % 3;
            assert_eq!(one.spans[axis], two.spans[from]);
            close("path", one.strongest_path[axis], two.strongest_path[from], 1e-9);
            let [one, two] = [&other.directions, &plain.directions];
            assert_eq!(one.cone_all[axis], two.cone_all[from]);
            assert_eq!(one.cone_largest[axis], two.cone_largest[from]);
            for column in 0..3 {
                let sign = if (axis == 0) != (column == 0) { mirror } else { 1.0 };
                let [k, l] = [3 * axis + column, 3 * from + (column + turn) % 3];
                assert!((one.fabric[k] - sign * two.fabric[l]).abs() < 1e-12);
                assert!((one.force_fabric[k] - sign * two.force_fabric[l]).abs() < 1e-9);
            }
        }
        if turn == 0 {
            assert_eq!(other.angle.count, plain.angle.count);
            close("axial", other.angle.fitted.axial, plain.angle.fitted.axial, 1e-9);
            close("axial", other.angle.predicted.axial, plain.angle.predicted.axial, 1e-9);
        }
    }
}

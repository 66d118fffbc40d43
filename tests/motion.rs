//! Displacement and rotation fields: local deformation against closed forms and against every pair
//! of grains looked at, their frames, what they add up to, and that looking changes nothing.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/packs.rs"]
mod packs;
#[path = "common/rough.rs"]
mod rough;

use graintwin::Vec3;
use graintwin::command::{Disposition, Mode};
use graintwin::measure::motion::band;
use graintwin::measure::motion::local::{Deformation, GAP, Grains, deformations};
use graintwin::measure::motion::localisation::{participation, share_of_largest};
use graintwin::pack::{Grain, Pack};
use graintwin::report::{Band, Demand, GrainMotion, Localisation, Measures};
use graintwin::scene::{Law, Scene, Update, When};
use graintwin::twin::Twin;
use graintwin::wall::{self, Bounds};
use nalgebra::{DMatrix, Matrix3, Rotation3};
use packs::{Rig, absolute, centered, made, scene};
use proptest::prelude::*;
use rough::{MU, frictional};

/// Splitmix64, uniform from 0 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)) as f64 / u64::MAX as f64
    }

    /// Components within ±`half`.
    fn vector(&mut self, half: f64) -> Vec3 {
        Vec3::from_fn(|_, _| (2.0 * self.next() - 1.0) * half)
    }
}

/// Grains and how they move.
#[derive(Clone)]
struct Cluster {
    position: Vec<Vec3>,
    displacement: Vec<Vec3>,
    radius: Vec<f64>,
    carries: Vec<bool>,
}

impl Cluster {
    /// `count` grains of radius 0.8 to 1.2 on a cubic lattice that was shaken, at rest.
    fn shaken(side: usize, seed: u64) -> Self {
        let mut random = Random(seed);
        let sites = (0..side.pow(3)).map(|k| [k % side, k / side % side, k / side / side]);
        let position: Vec<Vec3> = sites
            .map(|site| Vec3::from(site.map(|at| 2.0 * at as f64)) + random.vector(0.3))
            .collect();
        let radius = position.iter().map(|_| 0.8 + 0.4 * random.next()).collect();
        let count = position.len();
        Self {
            position,
            displacement: vec![Vec3::zeros(); count],
            radius,
            carries: vec![true; count],
        }
    }

    fn moved(mut self, to: impl Fn(&Vec3) -> Vec3) -> Self {
        self.displacement = self.position.iter().map(|at| to(at) - at).collect();
        self
    }

    fn deformations(&self) -> Vec<Deformation> {
        let Self { position, displacement, radius, carries } = self;
        deformations(&Grains { position, displacement, radius, carries })
    }

    /// Those of grains with enough neighbours, which all but some at corners have.
    fn known(&self) -> Vec<Deformation> {
        let mut known = self.deformations();
        known.retain(|found| !found.d2min.is_nan());
        assert!(known.len() >= self.position.len() - 8);
        known
    }
}

/// √(½ e:e) of the Green-Lagrange strain and 1 - det F, from the stretches of `gradient`.
fn strains(gradient: &Matrix3<f64>) -> [f64; 2] {
    let stretch = gradient.singular_values();
    let principal = stretch.map(|s| 0.5 * (s * s - 1.0));
    let [a, b, c] = principal.into();
    let shear = (((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2)) / 6.0).sqrt();
    [shear, 1.0 - gradient.determinant()]
}

fn matrix(entries: [f64; 9]) -> Matrix3<f64> {
    Matrix3::from_row_slice(&entries)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn an_affine_motion_leaves_nothing_and_its_strain_is_that_of_its_stretches(
        entries in prop::array::uniform9(-0.2..0.2f64),
        size in -8.0..0.0f64,
        shift in prop::array::uniform3(-1.0..1.0f64),
        seed in any::<u64>(),
    ) {
        let gradient = Matrix3::identity() + matrix(entries) * 10f64.powf(size);
        let moved = Cluster::shaken(4, seed).moved(|at| gradient * at + Vec3::from(shift));
        let [shear, loss] = strains(&gradient);
        for found in moved.known() {
            prop_assert!(found.d2min <= 1e-14f64.powi(2) * 100.0, "{found:?}");
            prop_assert!((found.shear_strain - shear).abs() <= 1e-13, "{found:?} {shear:e}");
            prop_assert!((found.volumetric_strain - loss).abs() <= 1e-13, "{found:?} {loss:e}");
        }
    }

    #[test]
    fn a_rigid_motion_however_large_is_no_strain(
        axis_angle in prop::array::uniform3(-3.0..3.0f64),
        shift in prop::array::uniform3(-10.0..10.0f64),
        seed in any::<u64>(),
    ) {
        let turn = Rotation3::from_scaled_axis(Vec3::from(axis_angle));
        let moved = Cluster::shaken(4, seed).moved(|at| turn * at + Vec3::from(shift));
        for found in moved.known() {
            let Deformation { d2min, shear_strain, volumetric_strain } = found;
            prop_assert!(d2min <= 1e-13f64.powi(2), "{found:?}");
            prop_assert!(shear_strain.max(volumetric_strain.abs()) <= 1e-13, "{found:?}");
        }
    }

    #[test]
    fn turning_mirroring_and_shifting_everything_changes_no_invariant(
        axis_angle in prop::array::uniform3(-3.0..3.0f64),
        mirror in any::<bool>(),
        shift in prop::array::uniform3(-10.0..10.0f64),
        seed in any::<u64>(),
    ) {
        let mut random = Random(seed);
        let mut cluster = Cluster::shaken(4, seed);
        for (moved, carries) in cluster.displacement.iter_mut().zip(&mut cluster.carries) {
            *moved = random.vector(1e-3);
            *carries = random.next() < 0.9;
        }
        let turn = *Rotation3::from_scaled_axis(Vec3::from(axis_angle)).matrix();
        let frame = turn * if mirror { -1.0 } else { 1.0 };
        let mut other = cluster.clone();
        other.position.iter_mut().for_each(|at| *at = frame * *at + Vec3::from(shift));
        other.displacement.iter_mut().for_each(|moved| *moved = frame * *moved);
        for (one, other) in cluster.known().iter().zip(other.known()) {
            prop_assert!((one.d2min / other.d2min - 1.0).abs() <= 1e-10);
            prop_assert!((one.shear_strain - other.shear_strain).abs() <= 1e-15);
            prop_assert!((one.volumetric_strain - other.volumetric_strain).abs() <= 1e-15);
        }
    }
}

#[test]
fn one_grain_that_leaves_its_place_in_a_cubic_lattice() {
    // Equal grains that touch, 2 R = a. Closer than 3 R are the 6 neighbours at a and the 12 at √2 a,
    // so that Y = Σ r rᵀ = (2 + 8) a² 1.
    let (side, a, delta) = (5, 2.0, 0.03);
    let site = |k: usize| [k % side, k / side % side, k / side / side];
    let index = |x: usize, y: usize, z: usize| (z * side + y) * side + x;
    let position: Vec<Vec3> =
        (0..side.pow(3)).map(|k| Vec3::from(site(k).map(|at| a * at as f64))).collect();
    let count = position.len();
    let mut cluster = Cluster {
        displacement: vec![Vec3::zeros(); count],
        radius: vec![1.0; count],
        carries: vec![true; count],
        position,
    };
    cluster.displacement[index(2, 2, 2)] = Vec3::x() * delta;
    let found = cluster.deformations();
    // It sees all 18 go the other way: X Y⁻¹ = 0, and each leaves δ².
    let middle = found[index(2, 2, 2)];
    assert!((middle.d2min / delta.powi(2) - 1.0).abs() < 1e-14);
    assert!(middle.shear_strain.max(middle.volumetric_strain.abs()) < 1e-15);
    // A neighbour along x sees it at -a x̂ go by δ x̂: G = -δ/(10 a) x̂x̂ explains a tenth of δ².
    let stretch = delta / (10.0 * a);
    let near = found[index(3, 2, 2)];
    assert!((near.d2min / (0.9 * delta.powi(2) / 18.0) - 1.0).abs() < 1e-13);
    assert!((near.volumetric_strain / stretch - 1.0).abs() < 1e-13);
    let uniaxial = (stretch - 0.5 * stretch * stretch) / 3f64.sqrt();
    assert!((near.shear_strain / uniaxial - 1.0).abs() < 1e-13);
    // One across a face at -a (x̂ + ŷ): G = -δ/(10 a) x̂(x̂ + ŷ) explains two tenths.
    let across = found[index(3, 3, 2)];
    assert!((across.d2min / (0.8 * delta.powi(2) / 18.0) - 1.0).abs() < 1e-13);
    assert!((across.volumetric_strain / stretch - 1.0).abs() < 1e-13);
    // Those further away see nothing move.
    let far = found[index(4, 2, 2)];
    assert_eq!([far.d2min, far.shear_strain, far.volumetric_strain], [0.0; 3]);
}

#[test]
fn neighbours_that_do_not_span_the_space_tell_nothing() {
    let at = |points: &[[f64; 3]]| Cluster {
        position: points.iter().map(|&point| point.into()).collect(),
        displacement: points.iter().map(|_| Vec3::x()).collect(),
        radius: vec![1.0; points.len()],
        carries: vec![true; points.len()],
    };
    let plane = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 1e-3]];
    for points in [&plane[..1], &plane[..2], &plane[..3], &plane[..]] {
        let found = at(points).deformations();
        assert!(found.iter().all(|found| found.d2min.is_nan()
            && found.shear_strain.is_nan()
            && found.volumetric_strain.is_nan()));
    }
    // Three that do fix the gradient, which leaves nothing whatever they do; a fourth tells.
    let corner = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [-2.0, 0.0, 0.0]];
    assert!(at(&corner[..4]).deformations()[0].d2min.is_nan());
    let mut corner = at(&corner);
    assert!(corner.deformations()[0].d2min == 0.0);
    // A grain that floats is no neighbour.
    corner.carries[1] = false;
    assert!(corner.deformations()[0].d2min.is_nan());
    assert!(at(&[]).deformations().is_empty());
}

#[test]
fn participation_and_shares_of_known_fields() {
    for scale in [1e-170, 1.0, 1e150] {
        assert_eq!(participation(&[scale; 8]), 1.0);
        let mut one = vec![0.0; 10];
        one[3] = scale;
        assert_eq!(participation(&one), 0.1);
        one[7] = scale;
        assert_eq!(participation(&one), 0.2);
        // Squares 1 and 4: (1 + 4)² / (2 (1 + 16)).
        assert!((participation(&[scale, 4.0 * scale]) / (25.0 / 34.0) - 1.0).abs() < 1e-15);
    }
    assert!(participation(&[0.0; 4]).is_nan() && participation(&[]).is_nan());
    assert_eq!(share_of_largest(&[2.0; 50], 0.1), 0.1);
    assert_eq!(share_of_largest(&[2.0; 50], 0.01), 0.02);
    let mut values: Vec<f64> = vec![1.0; 99];
    values.push(101.0);
    assert_eq!([0.01, 0.1].map(|part| share_of_largest(&values, part)), [0.505, 0.55]);
    assert!(share_of_largest(&[0.0; 4], 0.1).is_nan());
}

/// A motion of which only the shear strain matters.
fn sheared(shear_strain: Vec<f64>) -> GrainMotion {
    let count = shear_strain.len();
    let (nothing, number) = (vec![[0.0; 3]; count], f64::NAN);
    GrainMotion {
        displacement: nothing.clone(),
        non_affine: nothing,
        rotation: Vec::new(),
        total_rotation: Vec::new(),
        d2min: vec![0.0; count],
        volumetric_strain: vec![0.0; count],
        carries: vec![true; count],
        shear_strain,
        localisation: Localisation {
            affine_rms: number,
            non_affine_rms: number,
            non_affine_ratio: number,
            rotation_rms: number,
            participation: number,
            rotation_participation: number,
            d2min_top_1: number,
            d2min_top_10: number,
            band: Band::UNKNOWN,
        },
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_band_of_two_layers_of_twenty_is_found_in_a_lattice_of_any_shape(
        entries in prop::array::uniform9(-1.0..1.0f64),
        shift in prop::array::uniform3(-10.0..10.0f64),
        layer in 0..19u32,
    ) {
        let shape = Matrix3::identity() * 1.5 + matrix(entries) * 0.7;
        prop_assume!(shape.determinant() > 0.2);
        let sites: Vec<[u32; 3]> =
            (0..6 * 8 * 20).map(|k| [k % 6, k / 6 % 8, k / 48]).collect();
        let place = |site: &[f64; 3]| shape * Vec3::from(*site) + Vec3::from(shift);
        let position: Vec<[f64; 3]> =
            sites.iter().map(|site| place(&site.map(f64::from)).into()).collect();
        let strain = |site: &[u32; 3]| if site[2] == layer || site[2] == layer + 1 { 1.0 } else { 0.1 };
        let motion = sheared(sites.iter().map(strain).collect());
        let found = band::of(&motion, &position);
        // Planes of equal z become planes whose normal goes as A⁻ᵀ does, 1/|A⁻ᵀ ẑ| apart.
        let normal = shape.try_inverse().unwrap().transpose() * Vec3::z();
        let apart = 1.0 / normal.norm();
        let normal = normal.normalize();
        let cosine = normal.dot(&Vec3::from(found.normal));
        prop_assert!((cosine.abs() - 1.0).abs() < 1e-12, "{found:?} {normal:?}");
        prop_assert!(found.normal[Vec3::from(found.normal).iamax()] > 0.0);
        // Half a spacing to either side, in a pack of (20² - 1)/12 spacings squared; along the layers
        // they spread as all do.
        prop_assert!((found.thickness / (3f64.sqrt() * apart) - 1.0).abs() < 1e-9, "{found:?}");
        let [across, along, other] = found.spread;
        prop_assert!((across / (0.25 / (399.0 / 12.0f64)).sqrt() - 1.0).abs() < 1e-9);
        prop_assert!((along - 1.0).abs().max((other - 1.0).abs()) < 1e-9);
        let centre = place(&[2.5, 3.5, f64::from(layer) + 0.5]);
        prop_assert!((Vec3::from(found.center) - centre).norm() < 1e-11);
    }
}

#[test]
fn strain_that_lies_anywhere_is_no_band_in_a_flat_box() {
    let mut random = Random(5);
    let count = 20_000;
    let position: Vec<[f64; 3]> =
        (0..count).map(|_| [random.next(), 4.0 * random.next(), 0.2 * random.next()]).collect();
    let found = band::of(&sheared((0..count).map(|_| random.next()).collect()), &position);
    // 2000 of them: their moments are known to about 1/√2000.
    assert!(found.spread.iter().all(|spread| (spread - 1.0).abs() < 0.06), "{found:?}");
    let unknown = |strains: Vec<f64>| {
        let position: Vec<[f64; 3]> = position[..strains.len()].to_vec();
        band::of(&sheared(strains), &position).thickness.is_nan()
    };
    assert!(unknown(vec![0.0; 100]), "nothing was sheared");
    assert!(unknown(vec![1.0; 30]), "three grains lie in a plane");
    assert!(!unknown(vec![1.0; 31]));
    assert!(unknown(Vec::new()));
}

/// The walls after `step` steps of uneven squeezing.
fn squeezed(bounds: &Bounds, step: u32) -> [f64; wall::COUNT] {
    let strain = 2e-5 * f64::from(step);
    let [x, y, z] = bounds.sides();
    [0.0, -0.3 * x, 0.1 * y, 0.2 * y, 0.7 * z, 0.4 * z].map(|side| strain * side)
}

fn frictional_scene() -> Scene {
    frictional(1e-10, MU, Law::ReturnMap, Update::Frozen)
}

fn rough_pack(grains: usize, seed: u64) -> Pack {
    let mut pack = made(grains, 2e6, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = MU);
    pack
}

fn motion(measures: &Measures) -> &GrainMotion {
    measures.motion.as_ref().unwrap()
}

/// D²min of every grain from all pairs, G from the singular values of the neighbours' places.
#[test]
fn in_a_pack_every_pair_looked_at_gives_the_same_local_deformation() {
    let pack = rough_pack(220, 3);
    let (mut rig, _) = Rig::start(&frictional_scene(), &pack);
    let mut floating = 0;
    for step in 1..=3 {
        let before = rig.twin.pack();
        let measures = rig.go(squeezed(&pack.bounds, step));
        let after = rig.twin.pack();
        let found = motion(&measures);
        let mean = pack.grains.iter().map(|g| g.radius).sum::<f64>() / pack.grains.len() as f64;
        floating = found.carries.iter().filter(|carries| !**carries).count();
        assert_eq!(floating, measures.state.unwrap().rattlers as usize);
        let moved: Vec<Vec3> = before
            .grains
            .iter()
            .zip(&after.grains)
            .map(|(from, to)| Vec3::from(to.position) - Vec3::from(from.position))
            .collect();
        for (i, grain) in before.grains.iter().enumerate() {
            assert_eq!(Vec3::from(found.displacement[i]), moved[i]);
            let rows: Vec<(Vec3, Vec3)> = (0..pack.grains.len())
                .filter(|&j| j != i && found.carries[j])
                .map(|j| (Vec3::from(before.grains[j].position) - Vec3::from(grain.position), j))
                .filter(|(from, j)| {
                    from.norm() < grain.radius + before.grains[*j].radius + GAP * mean
                })
                .map(|(from, j)| (from, moved[j] - moved[i]))
                .collect();
            assert_eq!(rows.len() < 4, found.d2min[i].is_nan(), "{i}");
            if rows.len() < 4 {
                continue;
            }
            let from = DMatrix::from_fn(rows.len(), 3, |row, axis| rows[row].0[axis]);
            let to = DMatrix::from_fn(rows.len(), 3, |row, axis| rows[row].1[axis]);
            let solved = from.clone().svd(true, true).solve(&to, 0.0).unwrap();
            let left = (&to - &from * &solved).norm_squared() / rows.len() as f64;
            assert!((found.d2min[i] / left - 1.0).abs() < 1e-9, "{i}: {left:e}");
            let gradient = Matrix3::from_fn(|k, l| solved[(l, k)]);
            let [shear, loss] = strains(&(Matrix3::identity() + gradient));
            // The stretches hold strains of 1e-5 to eleven digits.
            assert!((found.shear_strain[i] - shear).abs() < 1e-13, "{i}: {shear:e}");
            assert!((found.volumetric_strain[i] - loss).abs() < 1e-13, "{i}: {loss:e}");
            assert!((1e-7..1e-2).contains(&shear), "{i}: {shear:e}");
        }
    }
    assert!(floating > 0, "a pack without rattlers does not show how they are treated");
}

/// u less what the box takes along, and the numbers of the whole, written out from their definitions.
#[test]
fn the_parts_of_the_displacement_and_the_numbers_of_the_whole_are_what_they_are_defined_as() {
    let pack = rough_pack(220, 3);
    let (mut rig, _) = Rig::start(&frictional_scene(), &pack);
    let before = rig.twin.pack();
    let measures = rig.go(squeezed(&pack.bounds, 1));
    let (found, bounds) = (motion(&measures), rig.twin.pack().bounds);
    let ([from, to], low) = ([before.bounds.sides(), bounds.sides()], before.bounds.min);
    let size = pack.bounds.sides()[0];
    let (mut affine, mut non_affine, mut fourth, mut carriers) = (0.0, 0.0, 0.0, 0.0);
    let (mut turned, mut turned_fourth) = (0.0, 0.0);
    for (i, grain) in before.grains.iter().enumerate() {
        let at = grain.position;
        let carried: [f64; 3] =
            std::array::from_fn(|k| bounds.min[k] + (at[k] - low[k]) / from[k] * to[k] - at[k]);
        let rest: [f64; 3] = std::array::from_fn(|k| found.displacement[i][k] - carried[k]);
        for k in 0..3 {
            assert!((found.non_affine[i][k] - rest[k]).abs() < 1e-15 * size);
        }
        if found.carries[i] {
            let middle: [f64; 3] = std::array::from_fn(|k| low[k] + 0.5 * from[k]);
            let stretched: f64 =
                (0..3).map(|k| ((to[k] / from[k] - 1.0) * (at[k] - middle[k])).powi(2)).sum();
            let squared = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
            carriers += 1.0;
            affine += stretched;
            non_affine += squared(rest);
            fourth += squared(rest).powi(2);
            turned += squared(found.rotation[i]);
            turned_fourth += squared(found.rotation[i]).powi(2);
        }
    }
    let close = |one: f64, other: f64| (one / other - 1.0).abs() < 1e-8;
    let Localisation { affine_rms, non_affine_rms, non_affine_ratio, .. } = found.localisation;
    assert!(close(affine_rms, (affine / carriers).sqrt()));
    assert!(close(non_affine_rms, (non_affine / carriers).sqrt()));
    assert!(close(non_affine_ratio, (non_affine / affine).sqrt()));
    let Localisation { rotation_rms, participation, rotation_participation, .. } =
        found.localisation;
    assert!(close(rotation_rms, (turned / carriers).sqrt()));
    assert!(close(participation, non_affine * non_affine / (carriers * fourth)));
    assert!(close(rotation_participation, turned * turned / (carriers * turned_fourth)));
    let mut d2min: Vec<f64> =
        (0..pack.grains.len()).filter(|&i| found.carries[i]).map(|i| found.d2min[i]).collect();
    d2min.retain(|d2min| !d2min.is_nan());
    d2min.sort_by(f64::total_cmp);
    let share =
        |count: usize| d2min.iter().rev().take(count).sum::<f64>() / d2min.iter().sum::<f64>();
    assert!(close(found.localisation.d2min_top_1, share(d2min.len().div_ceil(100))));
    assert!(close(found.localisation.d2min_top_10, share(d2min.len().div_ceil(10))));
}

#[test]
fn the_motions_of_all_increments_add_up_to_the_whole_way_whatever_was_refused_between() {
    let pack = rough_pack(160, 8);
    let mut scene = frictional_scene();
    scene.node.limits.clamp = true;
    scene.node.limits.strain = 5e-5;
    let (mut rig, first) = Rig::start(&scene, &pack);
    let count = pack.grains.len();
    let (mut way, mut turn) = (vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]);
    let mut measures = first.measures.unwrap();
    let mut seen = Vec::new();
    for step in 1..=5 {
        let found = motion(&measures);
        for i in 0..count {
            way[i] += Vec3::from(found.displacement[i]);
            turn[i] += Vec3::from(found.rotation[i]);
        }
        let grains = measures.grains.as_ref().unwrap();
        let size = pack.bounds.sides()[0];
        for i in 0..count {
            assert!((way[i] - Vec3::from(grains.displacement[i])).norm() < 1e-15 * size);
            assert!((turn[i] - Vec3::from(found.total_rotation[i])).norm() < 1e-17, "{i}");
        }
        // A command that is none, one on hold, and one served before change nothing.
        let held = rig.twin.motion();
        rig.sequence += 1;
        let mut none = absolute(rig.sequence, squeezed(&pack.bounds, step));
        none.mode = Mode::Unknown(7);
        assert_eq!(rig.twin.apply(&none, Demand::ALL).disposition, Disposition::Invalid);
        let [held, again] = [held, rig.twin.motion()].map(|motion| bits(&motion.unwrap()));
        assert!(again == held && held == bits(found));
        let report = rig.send(squeezed(&pack.bounds, step));
        seen.push(report.disposition);
        measures = report.measures.unwrap();
    }
    assert!(seen.contains(&Disposition::Clamped) && seen.contains(&Disposition::Applied));
    assert!(turn.iter().any(|turn| turn.norm() > 1e-6), "nothing turned");
}

#[test]
fn a_command_that_finds_no_equilibrium_leaves_the_motion_as_it_was() {
    let pack = made(120, 2e6, 4);
    let mut scene = scene();
    let (mut rig, _) = Rig::start(&scene, &pack);
    rig.go(squeezed(&pack.bounds, 1));
    let before = bits(&rig.twin.motion().unwrap());
    let mut settings = graintwin::twin::Settings::of(&scene);
    settings.tolerance = 1e-30;
    rig.twin.set(&settings);
    assert_eq!(rig.send(squeezed(&pack.bounds, 2)).disposition, Disposition::NotConverged);
    assert!(bits(&rig.twin.motion().unwrap()) == before);
    // After a reset it is that of the start.
    scene.solver.tolerance = 1e-8;
    rig.twin.set(&graintwin::twin::Settings::of(&scene));
    let again = rig.twin.reset(Demand::ALL);
    let (_, first) = Rig::start(&scene, &pack);
    let [again, first] = [again, first].map(|report| bits(motion(&report.measures.unwrap())));
    assert!(again == first);
}

/// A rubber ball between two plates of which gravity, at 45° to them, pulls it: it sinks, and rolls on
/// what is sunk more.
#[test]
fn a_ball_between_plates_turns_as_the_moments_of_its_contacts_ask() {
    let (radius, overlap, density, gravity) = (0.01, 1e-4, 1100.0, 100.0);
    let mut scene = frictional(1e-13, MU, Law::ReturnMap, Update::Frozen);
    let pull = gravity * 0.5f64.sqrt();
    scene.gravity = [pull, 0.0, -pull];
    let (young, poisson) = (1e7, 0.3);
    let ball = Grain { position: [0.0; 3], radius, young, poisson, density, friction: MU };
    let half = [3.0 * radius, 3.0 * radius, radius - overlap];
    let pack = Pack { bounds: centered(half.map(|h| 2.0 * h)), grains: vec![ball], history: None };
    let (_, report) = Rig::start(&scene, &pack);
    let measures = report.measures.unwrap();
    let found = motion(&measures);
    let [x, y, z] = found.displacement[0];
    // Q_l + Q_u = W sin 45° with equal moments about the centre; each contact gave way by Q/k_s,
    // k_s = 8 a / (Σ (2 - ν)/G) of the given overlap, where x - A_l Ω and x + A_u Ω are that way.
    let [low, high] = [radius - overlap + z, radius - overlap - z];
    let along = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3) * density * pull;
    let compliance = 1.7 / (young / 2.6) + 1.505 / (7e12 / 2.99);
    let stiffness = 8.0 * (radius * overlap).sqrt() / compliance;
    let [slid_low, slid_high] = [high, low].map(|arm| along * arm / (low + high) / stiffness);
    let spin = (slid_high - slid_low) / (low + high);
    assert!(z < -1e-3 * overlap && y == 0.0);
    assert!((x - (slid_low + low * spin)).abs() < 1e-11 * overlap);
    let [about_x, about_y, about_z] = found.rotation[0];
    assert!((about_y - spin).abs() * radius < 1e-11 * overlap, "{about_y:e} {spin:e}");
    assert!(spin.abs() * radius > 1e-5 * overlap, "{spin:e}");
    assert_eq!([about_x, about_z], [0.0; 2]);
    assert_eq!(found.total_rotation, found.rotation);
    // Nothing stretched the box, and one grain has no neighbour.
    assert_eq!(found.non_affine, found.displacement);
    assert_eq!(found.localisation.affine_rms, 0.0);
    assert_eq!(found.localisation.participation, 1.0);
    assert!(found.localisation.non_affine_ratio.is_nan() && found.d2min[0].is_nan());
}

/// Every number of a motion.
fn bits(motion: &GrainMotion) -> Vec<u64> {
    let vectors = [&motion.displacement, &motion.non_affine, &motion.rotation]
        .into_iter()
        .chain([&motion.total_rotation]);
    let scalars = [&motion.d2min, &motion.shear_strain, &motion.volumetric_strain];
    let whole = serde_json::to_string(&motion.localisation).unwrap();
    vectors
        .flatten()
        .flatten()
        .chain(scalars.into_iter().flatten())
        .map(|number| number.to_bits())
        .chain(motion.carries.iter().map(|&carries| carries.into()))
        .chain(whole.bytes().map(u64::from))
        .collect()
}

#[test]
fn the_bits_are_the_same_on_any_number_of_threads_and_whoever_looked_before() {
    let pack = rough_pack(600, 6);
    let run = |threads: usize, looks: &[u32]| {
        let mut twin = Twin::new(&frictional_scene(), &pack, threads).unwrap();
        let demand = |step| Demand { grain_motion: looks.contains(&step), ..Demand::NONE };
        assert_eq!(twin.start(demand(0)).measures.unwrap().motion.is_some(), looks.contains(&0));
        let mut last = None;
        for step in 1..=3 {
            let command = absolute(u64::from(step), squeezed(&pack.bounds, step));
            last = twin.apply(&command, demand(step)).measures.unwrap().motion;
            assert_eq!(last.is_some(), looks.contains(&step));
        }
        (bits(&last.unwrap()), twin.digest())
    };
    let want = run(1, &[3]);
    for (threads, looks) in [(2, &[0, 1, 2, 3][..]), (7, &[3]), (1, &[1, 3])] {
        assert!(run(threads, looks) == want, "{threads} {looks:?}");
    }
}

#[test]
fn a_scene_that_forbids_it_has_no_motion_and_the_same_state() {
    let pack = rough_pack(120, 2);
    let run = |when| {
        let mut scene = frictional_scene();
        scene.outputs.grain_motion = when;
        let (mut rig, first) = Rig::start(&scene, &pack);
        let measures = rig.go(squeezed(&pack.bounds, 2));
        let both = [first.measures.unwrap(), measures];
        (both.map(|measures| measures.motion.is_some()), rig.twin.digest(), rig.twin.bytes())
    };
    let [(kept, with, more), (none, without, less)] = [When::OnDemand, When::Never].map(run);
    assert_eq!((kept, none), ([true; 2], [false; 2]));
    assert_eq!(with, without);
    // Twice a place and a rotation a grain.
    assert_eq!(more - less, 2 * 2 * 24 * pack.grains.len());
}

#[test]
fn grains_in_another_order_move_the_same() {
    let pack = rough_pack(160, 8);
    let count = pack.grains.len();
    // 7 and 160 have no common divisor.
    let place = |i: usize| (7 * i + 5) % count;
    let mut other = pack.clone();
    (0..count).for_each(|i| other.grains[place(i)] = pack.grains[i]);
    let run = |pack: &Pack| {
        let (mut rig, _) = Rig::start(&frictional_scene(), pack);
        rig.go(squeezed(&pack.bounds, 1)).motion.unwrap()
    };
    let [one, other] = [&pack, &other].map(run);
    for i in 0..count {
        let j = place(i);
        for (one, other) in [
            (&one.displacement, &other.displacement),
            (&one.non_affine, &other.non_affine),
            (&one.rotation, &other.rotation),
        ] {
            let [one, other] = [one[i], other[j]].map(Vec3::from);
            assert!((one - other).norm() <= 1e-6 * one.norm().max(1e-12), "{i}");
        }
        if !one.d2min[i].is_nan() {
            assert!((one.d2min[i] / other.d2min[j] - 1.0).abs() < 1e-5);
            assert!((one.shear_strain[i] / other.shear_strain[j] - 1.0).abs() < 1e-5);
        }
        assert_eq!(one.carries[i], other.carries[j]);
    }
    let [one, other] = [one, other].map(|motion| motion.localisation);
    for (one, other) in [
        (one.participation, other.participation),
        (one.d2min_top_10, other.d2min_top_10),
        (one.band.thickness, other.band.thickness),
    ] {
        assert!((one / other - 1.0).abs() < 1e-5);
    }
}

/// A run of the program in `folder`, recorded into `bag` there; its summary.
#[cfg(feature = "mcap")]
fn recorded(folder: &std::path::Path, scene: &str) -> serde_json::Value {
    std::fs::write(folder.join("scene.yaml"), scene).unwrap();
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .current_dir(folder)
        .args(["run", "scene.yaml", "--record", "bag", "--json", "--threads", "1"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[cfg(feature = "mcap")]
#[path = "common/python.rs"]
mod python;

/// The same from the recording alone, by another program; and a replay gives it again.
#[cfg(feature = "mcap")]
#[test]
fn numpy_finds_the_same_in_a_recording() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "pack: {generate: {grains: 400, radius: {uniform: [0.7e-3, 1.3e-3]}, \
         material: glass, confining_stress: 2.0e6}}\n\
         contact: {friction: {coefficient: 0.3}}\n\
         load_path: [uniaxial: {axis: z, strain: 1.0e-3, increments: 6}]\n";
    let summary = recorded(folder.path(), scene);
    let end = &summary["grain_motion"];
    assert!(end["participation"].as_f64().is_some_and(|part| part > 0.0 && part < 1.0), "{end}");
    assert!(end["band"]["thickness"].as_f64().is_some_and(|thickness| thickness > 0.0), "{end}");
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .args(["replay", "--verify"])
        .arg(folder.path().join("bag"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let Some(said) = python::run("motion.py", &[&folder.path().join("bag")], "") else { return };
    let said: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!((&said["increments"], &said["grains"]), (&6.into(), &400.into()), "{said}");
    assert!(said["floating"].as_u64().is_some_and(|floating| floating > 0), "{said}");
}

/// `never`: neither computed nor recorded nor in the summary, and the run is the same.
#[cfg(feature = "mcap")]
#[test]
fn a_recording_without_the_motion_verifies_and_is_of_the_same_run() {
    let scene = |more: &str| {
        format!(
            "pack: {{generate: {{grains: 60, radius: {{uniform: [0.7e-3, 1.3e-3]}}, \
             material: glass, confining_stress: 2.0e6}}}}\n\
             load_path: [uniaxial: {{axis: z, strain: 1.0e-3, increments: 3}}]\n{more}"
        )
    };
    let mut digests = Vec::new();
    for (more, messages, known) in [
        ("", 4, true),
        ("outputs: {grain_motion: never}\n", 0, false),
        ("record: {exclude: [grain_motion]}\n", 0, true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let summary = recorded(folder.path(), &scene(more));
        assert_eq!(summary["grain_motion"].is_object(), known, "{more}");
        let bag = folder.path().join("bag");
        let survey = graintwin::record::reader::Bag::open(&bag).unwrap().survey().unwrap();
        let found = survey.topics.get("/graintwin/grain_motion").map_or(0, |topic| topic.messages);
        assert_eq!(found, messages, "{more}");
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .args(["replay", "--verify", "--json"])
            .arg(&bag)
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let verdict: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        digests.push(verdict["compared"]["state"].clone());
    }
    assert!(digests[0].is_string() && digests.iter().all(|one| *one == digests[0]), "{digests:?}");
}

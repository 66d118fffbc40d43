//! Local deformation, localisation and shear bands of made-up motions: closed forms, frames, and what
//! cannot be told.

use graintwin::Vec3;
use graintwin::measure::motion::band;
use graintwin::measure::motion::local::{Deformation, Grains, deformations};
use graintwin::measure::motion::localisation::{participation, share_of_largest};
use graintwin::report::{Band, GrainMotion, Localisation};
use nalgebra::{Matrix3, Rotation3};
use proptest::prelude::*;

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
        deformations(&Grains { position, displacement, radius, carries, plane: false })
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
            // The shift rounds positions of 10 to 1e-15; neighbours that lie almost in a plane take a
            // grain's strain, and what rounding does to it, up by the same factor.
            let strain = one.shear_strain.max(one.volumetric_strain.abs());
            prop_assert!((one.d2min / other.d2min - 1.0).abs() <= 1e-10);
            prop_assert!((one.shear_strain - other.shear_strain).abs() <= 1e-12 * strain);
            prop_assert!(
                (one.volumetric_strain - other.volumetric_strain).abs() <= 1e-12 * strain
            );
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
        let found = band::of(&motion, &position, false);
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
    let found = band::of(&sheared((0..count).map(|_| random.next()).collect()), &position, false);
    // 2000 of them: their moments are known to about 1/√2000.
    assert!(found.spread.iter().all(|spread| (spread - 1.0).abs() < 0.06), "{found:?}");
    let unknown = |strains: Vec<f64>| {
        let position: Vec<[f64; 3]> = position[..strains.len()].to_vec();
        band::of(&sheared(strains), &position, false).thickness.is_nan()
    };
    assert!(unknown(vec![0.0; 100]), "nothing was sheared");
    assert!(unknown(vec![1.0; 30]), "three grains lie in a plane");
    assert!(!unknown(vec![1.0; 31]));
    assert!(unknown(Vec::new()));
}

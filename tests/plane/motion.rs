//! Motion of discs: local deformation in the plane, what the box takes along as it leans, bands.

use graintwin::Vec3;
use graintwin::command::{Ask, Shear};
use graintwin::measure::motion::band;
use graintwin::measure::motion::local::{Deformation, GAP, Grains, deformations};
use graintwin::report::{GrainMotion, Localisation};
use graintwin::scene::{Scene, When};
use graintwin::wall::WallTarget;
use nalgebra::{DMatrix, Matrix2, Rotation2, Vector2};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::discs::*;

type Vec2 = Vector2<f64>;

/// Discs of radius 0.8 to 1.2 on a square lattice that was shaken, moved by `to`.
fn shaken(side: usize, seed: u64, to: impl Fn(Vec2) -> Vec2) -> Vec<Deformation> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut off = |half: f64| (2.0 * rng.random::<f64>() - 1.0) * half;
    let at: Vec<Vec2> = (0..side * side)
        .map(|k| {
            let [x, y] = [k % side, k / side].map(|at| 2.0 * at as f64);
            Vec2::new(x + off(0.3), y + off(0.3))
        })
        .collect();
    let radius: Vec<f64> = at.iter().map(|_| 1.0 + off(0.2)).collect();
    let flat = |v: Vec2| Vec3::new(v.x, v.y, 0.0);
    let position: Vec<Vec3> = at.iter().map(|at| flat(*at)).collect();
    let displacement: Vec<Vec3> = at.iter().map(|at| flat(to(*at) - at)).collect();
    let carries = vec![true; at.len()];
    let mut known = deformations(&Grains {
        position: &position,
        displacement: &displacement,
        radius: &radius,
        carries: &carries,
        plane: true,
    });
    // At corners there may be two neighbours.
    known.retain(|found| !found.d2min.is_nan());
    assert!(known.len() >= at.len() - 4);
    known
}

/// √(½ e:e) of the Green-Lagrange strain and 1 - det F in the plane, from the stretches of `gradient`.
fn strains(gradient: &Matrix2<f64>) -> [f64; 2] {
    let [a, b] = gradient.singular_values().map(|s| 0.5 * (s * s - 1.0)).into();
    [0.5 * (a - b).abs(), 1.0 - gradient.determinant()]
}

#[test]
fn affine_motions_have_the_strains_of_their_stretches_and_rigid_ones_none() {
    let mut rng = Pcg64::seed_from_u64(1);
    for seed in 0..40 {
        let size = 10f64.powf(-8.0 * rng.random::<f64>());
        let gradient = Matrix2::identity()
            + Matrix2::from_fn(|_, _| 0.2 * (2.0 * rng.random::<f64>() - 1.0)) * size;
        let [shear, loss] = strains(&gradient);
        for found in shaken(6, seed, |at| gradient * at + Vec2::new(0.3, -0.7)) {
            assert!(found.d2min < 1e-26, "{found:?}");
            assert!((found.shear_strain - shear).abs() < 1e-13, "{found:?} {shear:e}");
            assert!((found.volumetric_strain - loss).abs() < 1e-13, "{found:?} {loss:e}");
        }
        let turn = Rotation2::new(6.0 * rng.random::<f64>());
        for found in shaken(6, seed, |at| turn * at + Vec2::new(5.0, 3.0)) {
            assert!(found.d2min < 1e-26, "{found:?}");
            assert!(found.shear_strain.max(found.volumetric_strain.abs()) < 1e-13, "{found:?}");
        }
    }
}

#[test]
fn three_neighbours_around_tell_and_two_or_a_row_do_not() {
    let known = |at: &[[f64; 2]]| {
        let position: Vec<Vec3> = at.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect();
        let displacement = vec![Vec3::zeros(); at.len()];
        let (radius, carries) = (vec![1.0; at.len()], vec![true; at.len()]);
        let (position, displacement, radius, carries) =
            (&*position, &*displacement, &*radius, &*carries);
        let found = deformations(&Grains { position, displacement, radius, carries, plane: true });
        !found[0].d2min.is_nan()
    };
    assert!(known(&[[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [0.0, 2.0]]));
    assert!(!known(&[[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]));
    assert!(!known(&[[0.0, 0.0], [2.0, 0.0], [-2.0, 0.0], [2.5, 0.0], [-2.5, 0.0]]));
}

/// A motion that sheared grains by these strains.
fn sheared(strains: Vec<f64>) -> GrainMotion {
    let count = strains.len();
    GrainMotion {
        displacement: vec![[0.0; 3]; count],
        non_affine: vec![[0.0; 3]; count],
        rotation: Vec::new(),
        total_rotation: Vec::new(),
        d2min: vec![0.0; count],
        volumetric_strain: vec![0.0; count],
        shear_strain: strains,
        carries: vec![true; count],
        localisation: Localisation {
            affine_rms: 0.0,
            non_affine_rms: 0.0,
            non_affine_ratio: 0.0,
            rotation_rms: 0.0,
            participation: 0.0,
            rotation_participation: 0.0,
            d2min_top_1: 0.0,
            d2min_top_10: 0.0,
            band: graintwin::report::Band::UNKNOWN,
        },
    }
}

#[test]
fn a_band_of_four_rows_is_found_with_its_normal_and_thickness() {
    // 40 by 40 places, turned; four rows of them are a tenth.
    for degrees in [0.0_f64, 35.0, 62.0] {
        let turn = Rotation2::new(degrees.to_radians());
        let places: Vec<Vec2> =
            (0..1600).map(|k| Vec2::new((k % 40) as f64, (k / 40) as f64)).collect();
        let strains = places.iter().map(|at| if (18.0..22.0).contains(&at.y) { 1.0 } else { 1e-3 });
        let motion = sheared(strains.collect());
        let position: Vec<[f64; 3]> =
            places.iter().map(|at| turn * at).map(|at| [at.x, at.y, 0.0]).collect();
        let found = band::of(&motion, &position, true);
        let want = turn * Vec2::y();
        let sign = if want.x.abs() > want.y.abs() { want.x.signum() } else { want.y.signum() };
        assert!((found.normal[0] - sign * want.x).abs() < 1e-12, "{found:?}");
        assert!((found.normal[1] - sign * want.y).abs() < 1e-12 && found.normal[2] == 0.0);
        // Rows 0 to 3 have the variance (4² - 1)/12, all have (40² - 1)/12.
        assert!((found.thickness - 15f64.sqrt()).abs() < 1e-12, "{found:?}");
        assert!((found.spread[0] - (15.0 / 1599.0_f64).sqrt()).abs() < 1e-12);
        assert!((found.spread[1] - 1.0).abs() < 1e-12 && found.spread[2].is_nan());
        let middle = turn * Vec2::new(19.5, 19.5);
        assert!((found.center[0] - middle.x).abs() < 1e-12 && found.center[2] == 0.0);
    }
    assert!(band::of(&sheared(vec![1.0; 20]), &[[0.0; 3]; 20], true).thickness.is_nan());
}

fn moving(walls: &str, when: When) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\n\
         contact: {{friction: {{coefficient: 0.4}}}}\nsolver: {{tolerance: 1.0e-10}}\n"
    );
    let mut scene = graintwin::scene::parse(&text, "motion.yaml".as_ref()).unwrap();
    scene.outputs.grain_motion = when;
    scene
}

fn leant(at: [f64; 4], tilt: f64) -> Ask {
    let [a, b, c, d] = at.map(WallTarget::Displacement);
    Ask::Shear(Shear { tilt, targets: [a, b, c, d, WallTarget::Keep, WallTarget::Keep] })
}

fn close(found: f64, want: f64, what: &str) {
    assert!((found / want - 1.0).abs() < 1e-9, "{what}: {found:e} {want:e}");
}

#[test]
fn in_a_box_that_leans_every_pair_looked_at_again_gives_the_same() {
    let pack = dense(9, 10, 4, 1e5, 0.4);
    let (mut rig, _) = Rig::new(&moving("friction: .inf", When::OnDemand), &pack);
    let (mut before, mut tilt) = (rig.twin.pack(), 0.0);
    let hinge = pack.bounds.center()[1];
    let mut sum = vec![Vec3::zeros(); pack.grains.len()];
    for step in 1..=4_i32 {
        let ways = [1e-8, 2e-8, -1e-8, 3e-8].map(|way| way * f64::from(step));
        let next = 4e-4 * f64::from(step * step);
        let measures = rig.go(leant(ways, next));
        let after = rig.twin.pack();
        let found = measures.motion.as_ref().unwrap();
        check(found, (&before, &after), (tilt, next), hinge);
        for (sum, u) in sum.iter_mut().zip(&found.displacement) {
            *sum += Vec3::from(*u);
        }
        (before, tilt) = (after, next);
    }
    for ((sum, from), to) in sum.iter().zip(&pack.grains).zip(&before.grains) {
        assert!((sum - Vec3::from(to.position) + Vec3::from(from.position)).norm() < 1e-18);
    }
}

/// `found` against what the packs before and after tell.
fn check(
    found: &GrainMotion,
    (before, after): (&graintwin::pack::Pack, &graintwin::pack::Pack),
    (tilt, next): (f64, f64),
    hinge: f64,
) {
    let count = before.grains.len();
    let at = |pack: &graintwin::pack::Pack, i: usize| {
        let [x, y, _] = pack.grains[i].position;
        Vec2::new(x, y)
    };
    let moved: Vec<Vec2> = (0..count).map(|i| at(after, i) - at(before, i)).collect();
    let mean = before.grains.iter().map(|grain| grain.radius).sum::<f64>() / count as f64;
    // Corners of the box as it leans: what is at the share (a, b) of it.
    let place = |pack: &graintwin::pack::Pack, tilt: f64, [a, b]: [f64; 2]| {
        let ([w, h, _], [x, y, _]) = (pack.bounds.sides(), pack.bounds.min);
        let height = y + b * h;
        Vec2::new(x + a * w + tilt * (height - hinge), height)
    };
    let share = |at: Vec2| {
        let ([w, h, _], [x, y, _]) = (before.bounds.sides(), before.bounds.min);
        [(at.x - tilt * (at.y - hinge) - x) / w, (at.y - y) / h]
    };
    let middles = [place(before, tilt, [0.5; 2]), place(after, next, [0.5; 2])];
    let (mut affine, mut left, mut turned, mut carriers) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..count {
        assert!((Vec3::from(found.displacement[i]).xy() - moved[i]).norm() == 0.0);
        assert_eq!([found.displacement[i][2], found.non_affine[i][2]], [0.0; 2]);
        assert_eq!(found.rotation[i][..2], [0.0; 2]);
        let taken = place(after, next, share(at(before, i)));
        let non_affine = Vec3::from(found.non_affine[i]).xy();
        assert!((non_affine - (at(after, i) - taken)).norm() < 1e-17, "{i}");
        if found.carries[i] {
            carriers += 1.0;
            affine += (taken - middles[1] - (at(before, i) - middles[0])).norm_squared();
            left += (at(after, i) - taken).norm_squared();
            turned += found.rotation[i][2].powi(2);
        }
        let rows: Vec<(Vec2, Vec2)> = (0..count)
            .filter(|&j| j != i && found.carries[j])
            .map(|j| (at(before, j) - at(before, i), moved[j] - moved[i], j))
            .filter(|(from, _, j)| {
                from.norm() < before.grains[i].radius + before.grains[*j].radius + GAP * mean
            })
            .map(|(from, to, _)| (from, to))
            .collect();
        assert_eq!(rows.len() < 3, found.d2min[i].is_nan(), "{i}");
        if rows.len() < 3 {
            continue;
        }
        let from = DMatrix::from_fn(rows.len(), 2, |row, axis| rows[row].0[axis]);
        let to = DMatrix::from_fn(rows.len(), 2, |row, axis| rows[row].1[axis]);
        let solved = from.clone().svd(true, true).solve(&to, 0.0).unwrap();
        let remains = (&to - &from * &solved).norm_squared() / rows.len() as f64;
        assert!((found.d2min[i] - remains).abs() <= 1e-9 * remains + 1e-36, "{i}: {remains:e}");
        let gradient = Matrix2::from_fn(|k, l| solved[(l, k)]);
        let [shear, loss] = strains(&(Matrix2::identity() + gradient));
        assert!((found.shear_strain[i] - shear).abs() < 1e-12, "{i}: {shear:e}");
        assert!((found.volumetric_strain[i] - loss).abs() < 1e-12, "{i}: {loss:e}");
    }
    let root = |sum: f64| (sum / carriers).sqrt();
    let Localisation { affine_rms, non_affine_rms, non_affine_ratio, rotation_rms, band, .. } =
        found.localisation;
    close(affine_rms, root(affine), "affine");
    close(non_affine_rms, root(left), "non-affine");
    close(non_affine_ratio, root(left) / root(affine), "ratio");
    close(rotation_rms, root(turned), "rotation");
    assert!(band.spread[2].is_nan() && band.normal[2] == 0.0);
}

#[test]
fn an_even_strain_of_the_box_is_that_of_the_grains_on_average() {
    let pack = dense(20, 20, 5, 1e5, 0.4);
    let (mut rig, _) = Rig::new(&moving("friction: .inf", When::OnDemand), &pack);
    let tilt = 1e-4;
    let found = rig.go(leant([0.0; 4], tilt)).motion.unwrap();
    let mean = |of: &[f64]| {
        let known = of.iter().filter(|x| x.is_finite());
        known.clone().sum::<f64>() / known.count() as f64
    };
    // Half of the engineering shear, and more where it is uneven.
    let shear = mean(&found.shear_strain);
    assert!((0.45 * tilt..1.0 * tilt).contains(&shear), "{shear:e}");
    assert!(mean(&found.volumetric_strain).abs() < 0.2 * tilt);
    let turned: Vec<f64> = found.rotation.iter().map(|turn| turn[2]).collect();
    assert!((mean(&turned) / (-0.5 * tilt) - 1.0).abs() < 0.3, "{:e}", mean(&turned));
    assert!(found.localisation.non_affine_ratio < 0.5);
}

#[test]
fn nobody_looks_unless_the_scene_lets_them_and_looking_changes_nothing() {
    let pack = dense(7, 7, 4, 1e5, 0.4);
    let run = |when| {
        let (mut rig, report) = Rig::new(&moving("friction: 0.2", when), &pack);
        let start = report.measures.unwrap();
        let measures = rig.go(leant([1e-8, 1e-8, 0.0, 0.0], 2e-4));
        let known =
            [start.motion.is_some(), measures.motion.is_some(), rig.twin.motion().is_some()];
        (known, rig.twin.digest(), measures.plane.unwrap().network_strain)
    };
    let (never, demanded) = (run(When::Never), run(When::OnDemand));
    assert_eq!((never.0, demanded.0), ([false; 3], [true; 3]));
    assert_eq!((never.1, never.2), (demanded.1, demanded.2));
}

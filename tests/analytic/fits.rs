//! Fits give back what curves and fields were made of.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use graintwin::analytic::fit::band::shear_band;
use graintwin::analytic::fit::directions::{between, directions};
use graintwin::analytic::fit::{line, record, strength};
use graintwin::analytic::flow;
use graintwin::analytic::hooke::Hooke;
use graintwin::analytic::model::Bilinear;
use graintwin::analytic::strength::MohrCoulomb;
use graintwin::analytic::tensor::Tensor;

use crate::{close, near};

/// Numbers from 0 to 1 without a pattern, the same at every call.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn strength_from_failures() {
    let rock = MohrCoulomb { friction: 0.38, cohesion: 9.3e6 };
    let tests: Vec<[f64; 2]> =
        [0.0, 1e6, 5e6, 1e7].iter().map(|&minor| [minor, rock.major(minor)]).collect();
    let fitted = strength::cohesive(&tests).unwrap();
    close(fitted.strength.friction, 0.38, 1e-12);
    close(fitted.strength.cohesion, 9.3e6, 1e-12);
    assert!(fitted.residual < 1e-6);
    // Table 3: one φ' for four pressures lies among those of each.
    let angles = [30.2_f64, 31.6, 31.4, 31.6].map(f64::to_radians);
    let sand = |friction: f64| MohrCoulomb { friction, cohesion: 0.0 };
    let failures: Vec<[f64; 2]> = (1..)
        .zip(angles)
        .map(|(bar, angle)| [f64::from(bar) * 1e5, sand(angle).major(f64::from(bar) * 1e5)])
        .collect();
    let together = strength::sand(&failures).unwrap().strength;
    assert!(together.friction > angles[0] && together.friction < angles[1]);
    assert_eq!(together.cohesion, 0.0);
    let [minor, major] = failures[2];
    close(strength::mobilised(major, minor).unwrap(), angles[2], 1e-14);
    // What tells nothing.
    assert_eq!(strength::cohesive(&failures[..1]), None);
    assert_eq!(strength::cohesive(&[[0.0, 2.0], [1.0, 1.0]]), None);
    assert_eq!(strength::sand(&[]), None);
    assert_eq!(strength::sand(&[[f64::NAN, 1.0]]), None);
    assert_eq!(strength::mobilised(1.0, 0.0), None);
}

#[test]
fn least_squares_leave_what_no_line_explains() {
    let mut number = noise();
    let points: Vec<[f64; 2]> = (0..50).map(|x| [f64::from(x), number()]).collect();
    let fitted = line::line(&points).unwrap();
    let left = |[x, y]: [f64; 2]| y - fitted.intercept - fitted.slope * x;
    near(points.iter().map(|&point| left(point)).sum::<f64>(), 0.0, 1e-12);
    near(points.iter().map(|&point| left(point) * point[0]).sum::<f64>(), 0.0, 1e-10);
    let origin = line::through_origin(&points).unwrap().slope;
    near(points.iter().map(|[x, y]| (y - origin * x) * x).sum::<f64>(), 0.0, 1e-9);
}

#[test]
fn a_biaxial_record_gives_back_its_material() {
    let material = Bilinear {
        elastic: Hooke { young: 48e6, poisson: 0.17 },
        strength: MohrCoulomb { friction: 0.53, cohesion: 0.0 },
        dilatancy: 0.25,
    };
    let axial: Vec<f64> = (0..1000).map(|step| 4e-5 * f64::from(step)).collect();
    let states: Vec<_> = axial.iter().map(|&strain| material.biaxial(1e5, strain)).collect();
    let deviator: Vec<f64> = states.iter().map(|state| state.major - 1e5).collect();
    let area: Vec<f64> = states.iter().map(|state| state.area_strain).collect();
    let peak = record::peak(&deviator).unwrap();
    near(axial[peak], material.failure_strain(1e5), 4e-5);
    close(strength::mobilised(deviator[peak] + 1e5, 1e5).unwrap(), 0.53, 1e-12);
    close(record::secant_50(&axial, &deviator).unwrap(), 48e6, 1e-10);
    let begin = record::begin(&deviator).unwrap();
    close(record::poisson(&axial, &area, begin).unwrap(), 0.17, 1e-10);
    close(record::dilatancy(&axial, &area, peak + 1..1000).unwrap(), 0.25, 1e-10);
    let plastic = record::plastic(&axial, &deviator).unwrap();
    assert!(plastic.start.abs_diff(peak) <= 1 && plastic.end == 1000, "{plastic:?}");
    // A test that ends while it is elastic shows no plastic branch.
    assert_eq!(record::plastic(&axial[..peak], &deviator[..peak]), None);
}

#[test]
fn half_of_the_peak_lies_between_two_places() {
    // A parabola q = q_p (2 e - e²) reaches half at e = 1 - √½.
    let strain: Vec<f64> = (0..=1000).map(|step| 1e-3 * f64::from(step)).collect();
    let stress: Vec<f64> = strain.iter().map(|e| 7.0 * (2.0 * e - e * e)).collect();
    let half = 1.0 - 0.5_f64.sqrt();
    close(record::secant_50(&strain, &stress).unwrap(), 3.5 / half, 1e-6);
    // The same of a shear test that starts under stress.
    let raised: Vec<f64> = stress.iter().map(|q| q + 2.0).collect();
    close(record::secant_50(&strain, &raised).unwrap(), 3.5 / half, 1e-6);
    assert_eq!(record::secant_50(&strain, &vec![1.0; 1001]), None);
    assert_eq!(record::secant_50(&[], &[]), None);
    assert_eq!(record::peak(&[f64::NAN]), None);
    assert_eq!(record::slope(&strain, &stress, 5..2000), None);
}

#[test]
fn a_compression_test_gives_back_hooke() {
    let hooke = Hooke { young: 4e9, poisson: 0.12 };
    let strain: Vec<f64> = (0..50).map(|step| 1e-5 * f64::from(step)).collect();
    let stress: Vec<Tensor> =
        strain.iter().map(|&yy| hooke.stress(&Tensor { xx: 0.0, yy, xy: 0.0 })).collect();
    let [minor, major] = [|s: &Tensor| s.xx, |s: &Tensor| s.yy]
        .map(|of| stress.iter().map(of).collect::<Vec<f64>>());
    let lateral = record::slope(&major, &minor, 0..50).unwrap();
    close(lateral, 0.12, 1e-10);
    let young = (1.0 - lateral * lateral) * record::slope(&strain, &major, 0..50).unwrap();
    close(young, 4e9, 1e-10);
}

#[test]
fn directions_of_histories() {
    // The stress turns; plastic strain follows it.
    let angles: Vec<f64> = (0..20).map(|step| 1.5 + 0.01 * f64::from(step)).collect();
    let stress: Vec<Tensor> =
        angles.iter().map(|&angle| Tensor::of_principal(3e5, 1e5, angle)).collect();
    let mut strain = vec![Tensor { xx: 1e-3, yy: 1e-3, xy: 0.0 }];
    for &angle in &angles[1..] {
        let step = flow::plastic(1e-4, 0.2, angle);
        let last = strain[strain.len() - 1];
        let next = Tensor { xx: last.xx + step.xx, yy: last.yy + step.yy, xy: last.xy + step.xy };
        strain.push(next);
    }
    let found = directions(&stress, &strain);
    assert_eq!(found[0].non_coaxiality(), None);
    assert_eq!(found[0].strain, None);
    for (found, angle) in found.iter().zip(&angles).skip(1) {
        near(found.non_coaxiality().unwrap(), 0.0, 1e-9);
        near(between(found.stress.unwrap(), *angle), 0.0, 1e-12);
        // A Mohr circle that only turns: its increment lies 45° ahead.
        near(between(found.stress.unwrap(), found.stress_increment.unwrap()), FRAC_PI_4, 6e-3);
        // All strain lags behind.
        assert!(between(found.strain.unwrap(), found.stress.unwrap()) >= 0.0);
    }
    near(between(-FRAC_PI_2 + 0.1, FRAC_PI_2 - 0.1), -0.2, 1e-15);
    near(between(0.2, 0.2 + PI), 0.0, 1e-15);
}

/// Grains at random in a box of 1 by 2.5 that move with a strain and a band at `angle`.
struct Banded {
    position: Vec<[f64; 2]>,
    displacement: Vec<[f64; 2]>,
}

impl Banded {
    fn new(angle: f64, center: [f64; 2], thickness: f64, jump: [f64; 2], scatter: f64) -> Self {
        let mut number = noise();
        let position: Vec<[f64; 2]> = (0..4000).map(|_| [number(), 2.5 * number()]).collect();
        let (s, c) = angle.sin_cos();
        let moved = |[x, y]: &[f64; 2]| {
            let along = (y - center[1]) * c - (x - center[0]) * s;
            let ramp = (along / thickness).clamp(-0.5, 0.5);
            // Slip along the band, opening along its normal (-s, c).
            let [slip, opening] = jump.map(|part| part * ramp);
            [
                0.01 * x + 0.003 * y + slip * c - opening * s + scatter * (number() - 0.5),
                0.02 - 0.03 * y + slip * s + opening * c + scatter * (number() - 0.5),
            ]
        };
        let displacement = position.iter().map(moved).collect();
        Self { position, displacement }
    }
}

#[test]
fn a_shear_band_is_found() {
    for (angle, center, thickness) in [
        (52.0, [0.5, 1.2], 0.12),
        (-52.0, [0.45, 1.4], 0.2),
        (40.0, [0.5, 0.8], 0.08),
        (5.0, [0.5, 0.5], 0.1),
        (88.0, [0.3, 1.2], 0.15),
    ] {
        let degrees = f64::to_radians(angle);
        let exact = Banded::new(degrees, center, thickness, [0.05, 0.012], 0.0);
        let band = shear_band(&exact.position, &exact.displacement).unwrap();
        near(between(band.angle, degrees), 0.0, 2e-3);
        close(band.thickness, thickness, 0.01);
        close(band.slip, 0.05, 0.01);
        close(band.opening.abs(), 0.012, 0.01);
        assert!(band.opening > 0.0 && band.explained > 0.9999, "{band:?}");
        let (s, c) = degrees.sin_cos();
        near((band.center[1] - center[1]) * c - (band.center[0] - center[0]) * s, 0.0, 2e-3);
        // Grains that scatter by a fifth of the slip.
        let rough = Banded::new(degrees, center, thickness, [0.05, 0.012], 0.01);
        let band = shear_band(&rough.position, &rough.displacement).unwrap();
        near(between(band.angle, degrees), 0.0, 0.02);
        close(band.thickness, thickness, 0.15);
    }
}

#[test]
fn the_band_turns_and_shifts_with_the_pack() {
    let Banded { position, displacement } = Banded::new(0.9, [0.5, 1.2], 0.12, [0.05, 0.0], 0.002);
    let one = shear_band(&position, &displacement).unwrap();
    let turn = |v: &[f64; 2]| {
        let (s, c) = 0.3_f64.sin_cos();
        [c * v[0] - s * v[1], s * v[0] + c * v[1]]
    };
    let turned: Vec<[f64; 2]> =
        position.iter().map(turn).map(|[x, y]| [x + 3.0, y - 1.0]).collect();
    let moved: Vec<[f64; 2]> = displacement.iter().map(turn).collect();
    let other = shear_band(&turned, &moved).unwrap();
    near(between(one.angle, other.angle), 0.3, 2e-3);
    close(one.thickness, other.thickness, 0.02);
    close(one.explained, other.explained, 1e-4);
}

#[test]
fn no_band_where_there_is_none() {
    let Banded { position, displacement } = Banded::new(0.9, [0.5, 1.2], 0.12, [0.0, 0.0], 0.0);
    assert_eq!(shear_band(&position, &displacement), None);
    assert_eq!(shear_band(&position[..5], &displacement[..5]), None);
    assert_eq!(shear_band(&position, &displacement[1..]), None);
    let flat: Vec<[f64; 2]> = position.iter().map(|at| [at[0], 0.0]).collect();
    assert_eq!(shear_band(&flat, &displacement), None);
    let nowhere = vec![[f64::NAN; 2]; 20];
    assert_eq!(shear_band(&nowhere, &nowhere), None);
}

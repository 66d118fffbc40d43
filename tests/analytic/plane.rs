//! Tensors, Hooke's law, strength and sliding in the plane.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use graintwin::analytic::flow;
use graintwin::analytic::hooke::Hooke;
use graintwin::analytic::sliding::Slides;
use graintwin::analytic::strength::{self, Mechanism, MohrCoulomb};
use graintwin::analytic::tensor::Tensor;
use nalgebra::{Matrix2, SymmetricEigen};

use crate::{TENSORS, close, near};

const ROCK: MohrCoulomb = MohrCoulomb { friction: 0.4, cohesion: 9e6 };
const SAND: MohrCoulomb = MohrCoulomb { friction: 0.5, cohesion: 0.0 };

fn matrix(tensor: &Tensor) -> Matrix2<f64> {
    Matrix2::new(tensor.xx, tensor.xy, tensor.xy, tensor.yy)
}

#[test]
fn principal_values_are_eigenvalues() {
    for tensor in TENSORS {
        let eigen = SymmetricEigen::new(matrix(&tensor));
        close(tensor.major(), eigen.eigenvalues.max(), 1e-14);
        near(tensor.minor(), eigen.eigenvalues.min(), 1e-14);
        let beta = tensor.direction().unwrap();
        let vector = eigen.eigenvectors.column(eigen.eigenvalues.imax()).into_owned();
        near(vector[0] * beta.sin() - vector[1] * beta.cos(), 0.0, 1e-14);
        let back = Tensor::of_principal(tensor.major(), tensor.minor(), beta);
        near((matrix(&back) - matrix(&tensor)).norm(), 0.0, 1e-14);
    }
    assert_eq!(Tensor { xx: 1.0, yy: 1.0, xy: 0.0 }.direction(), None);
}

#[test]
fn hooke_is_isotropic_and_has_an_inverse() {
    let hooke = Hooke { young: 4.1e9, poisson: 0.13 };
    for stress in TENSORS {
        let strain = hooke.strain(&stress);
        near((matrix(&hooke.stress(&strain)) - matrix(&stress)).norm(), 0.0, 1e-14);
        near(strain.direction().unwrap(), stress.direction().unwrap(), 1e-14); // A.12
        close(strain.radius(), (1.0 + 0.13) / 4.1e9 * stress.radius(), 1e-14); // below A.9
        close(strain.mean(), (1.0 - 0.13) / 4.1e9 * stress.mean(), 1e-14);
    }
    let again = Hooke::of_moduli(hooke.bulk_modulus(), hooke.shear_modulus());
    close(again.young, hooke.young, 1e-14);
    close(again.poisson, hooke.poisson, 1e-14);
    let compressed = hooke.stress(&Tensor { xx: 0.0, yy: 1e-3, xy: 0.0 });
    close(compressed.xx / compressed.yy, 0.13, 1e-14); // A.22
    close(compressed.yy / 1e-3, hooke.compression_modulus(), 1e-14);
}

/// The most that a plane's shear stress exceeds friction by \[Pa\], over all planes.
fn worst(strength: &MohrCoulomb, stress: &Tensor) -> f64 {
    let planes = (0..20_000).map(|number| PI * f64::from(number) / 20_000.0);
    let shear = planes.map(|angle| {
        let [x, y] = stress.along(angle);
        let (s, c) = angle.sin_cos();
        (s * x - c * y).abs() - (c * x + s * y) * strength.friction.tan()
    });
    shear.fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn failure_is_when_a_plane_cannot_hold() {
    for minor in [-1e6, 0.0, 1e6, 5e6] {
        let stress = Tensor::of_principal(ROCK.major(minor), minor, 0.3);
        close(worst(&ROCK, &stress), ROCK.cohesion, 1e-6);
        near(ROCK.excess(&stress), 0.0, 1e-7);
    }
    near(ROCK.major(-ROCK.tension()), 0.0, 1e-7);
    for [xx, yy] in [[1e6, 1e6], [2e6, 5e6]] {
        let stress = Tensor { xx, yy, xy: ROCK.shear(xx, yy).unwrap() };
        close(worst(&ROCK, &stress), ROCK.cohesion, 1e-6);
    }
    assert_eq!(SAND.shear(1.0, 10.0), None);
}

#[test]
fn the_plane_that_slides_is_the_worst() {
    // Its normal is turned from σ1 by as much as the plane is from that of σ1.
    let stress = Tensor::of_principal(SAND.ratio(), 1.0, 0.0);
    let [x, y] = stress.along(SAND.plane());
    let (s, c) = SAND.plane().sin_cos();
    close((s * x - c * y) / (c * x + s * y), SAND.friction.tan(), 1e-14);
}

#[test]
fn shear_boxes_slide_on_their_own_planes() {
    let lateral = |mechanism: Mechanism| mechanism.lateral_stress(SAND.friction);
    let xx = lateral(Mechanism::Horizontal).unwrap();
    close(SAND.shear(xx, 1.0).unwrap(), SAND.friction.tan(), 1e-14);
    let xx = lateral(Mechanism::Vertical).unwrap();
    close(SAND.shear(xx, 1.0).unwrap(), xx * SAND.friction.tan(), 1e-14);
    assert_eq!(lateral(Mechanism::Lateral), None);
}

#[test]
fn caquot_by_limits() {
    let count = 1000;
    let angles = (0..count).map(|number| PI * (f64::from(number) + 0.5) / f64::from(count));
    let mean = angles.map(|angle| angle.cos().abs() / f64::from(count)).sum::<f64>();
    close(strength::caquot_plane(0.3).tan(), 0.3 / mean, 1e-5);
    // Little friction: the first two agree.
    let small = [strength::caquot_triaxial(1e-6), strength::caquot_halfway(1e-6)];
    close(small[0].unwrap(), small[1].unwrap(), 1e-6);
    assert_eq!(strength::caquot_halfway(0.7), None);
    assert_eq!(strength::caquot_triaxial(10.0 / 12.0 + 1e-12), None);
}

#[test]
fn plastic_strain_grows_along_the_stress() {
    let (psi, beta) = (14.2_f64.to_radians(), 1.1);
    let strain = flow::plastic(1e-3, psi, beta);
    close(strain.major(), 1e-3, 1e-14);
    close(strain.direction().unwrap(), beta, 1e-14);
    close(flow::dilatancy(strain.major(), strain.minor()).unwrap(), psi, 1e-13);
    // A.17, with α from the y-axis.
    let (s, c) = (2.0 * (FRAC_PI_2 - beta)).sin_cos();
    close(strain.xx / strain.yy, (psi.sin() + c) / (psi.sin() - c), 1e-13);
    close(strain.yy / strain.xy, (psi.sin() - c) / -s, 1e-13);
    // Without dilatancy the area stays, and no shear has no angle.
    near(flow::plastic(1e-3, 0.0, beta).mean(), 0.0, 1e-18);
    assert_eq!(flow::dilatancy(1.0, 1.0), None);
    assert_eq!(flow::dilatancy(1.0, 0.1), None);
    assert_eq!(flow::dilatancy(f64::NAN, 0.0), None);
    // A band is as long as before: no strain along it, with σ3 along x.
    let strain = flow::plastic(1e-3, psi, FRAC_PI_2);
    let (s, c) = flow::band(psi).sin_cos();
    let [x, y] = strain.along(flow::band(psi));
    near(c * x + s * y, 0.0, 1e-18);
}

/// How a point moves when a block slides to the left and right by small shears along its planes.
fn slid(slides: &Slides, [x, y]: [f64; 2]) -> [f64; 2] {
    let (s, c) = slides.plane.sin_cos();
    // Planes along (c, s) and (-c, s), where what is above goes down.
    let [left, right] = [slides.left * (c * y - s * x), slides.right * (c * y + s * x)];
    [-left * c + right * c, -left * s - right * s]
}

#[test]
fn sliding_blocks_strain_and_turn() {
    for (left, right) in [(1e-6, 1e-6), (2e-6, 5e-7), (1e-6, 0.0), (0.0, 1e-6)] {
        let slides = Slides::of(&SAND, left, right);
        let [lateral, axial] = [[1.0, 0.0], [0.0, 1.0]].map(|line| slid(&slides, line));
        // Compression is positive.
        let strain = slides.strain();
        near(strain.xx, -lateral[0], 1e-20);
        near(strain.yy, -axial[1], 1e-20);
        near(strain.xy, -0.5 * (lateral[1] + axial[0]), 1e-20);
        let rotations = slides.rotations();
        near(rotations[0], (-axial[0]).atan2(1.0 + axial[1]), 1e-11);
        near(rotations[1], lateral[1].atan2(1.0 + lateral[0]), 1e-11);
        // i is from σ1 along y towards x: the eigenvector says so, and A.37.
        let odd = (left - right) / (left + right);
        let turned = slides.non_coaxiality().unwrap();
        let eigen = strain.direction().unwrap();
        near((2.0 * (eigen - FRAC_PI_2) + 2.0 * turned).sin(), 0.0, 1e-9);
        close(1.0 + (2.0 * turned).tan(), 1.0 - odd * SAND.friction.tan(), 1e-12);
        assert!(turned.abs() <= 0.5 * SAND.friction + 1e-12); // A.38
    }
    assert_eq!(Slides { left: 0.0, right: 0.0, plane: FRAC_PI_4 }.non_coaxiality(), None);
}

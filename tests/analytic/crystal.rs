//! The crystal, against the sum over the six contacts of a grain that strains evenly.

use graintwin::analytic::cemented;
use graintwin::analytic::crystal::{CONTACT_DENSITY, Crystal};
use graintwin::analytic::tensor::Tensor;
use std::f64::consts::FRAC_PI_3;

use crate::close;

const CRYSTAL: Crystal = Crystal { radius: 1e-4, kappa: 1.37 };

/// Forces of the contacts along the row and at 60° under a strain, per kn.
fn strained(strain: &Tensor) -> [[f64; 2]; 2] {
    [0.0, FRAC_PI_3].map(|angle| {
        let (s, c) = angle.sin_cos();
        let [x, y] = strain.along(angle).map(|part| 2.0 * CRYSTAL.radius * part);
        // A.42: the force is (c F_n + s F_s, s F_n - c F_s).
        [c * x + s * y, CRYSTAL.kappa * (s * x - c * y)]
    })
}

/// Stress of a grain (A.40): each contact counts half, with its whole length.
fn stress(strain: &Tensor) -> Tensor {
    let volume = 4.0 * 3.0_f64.sqrt() * CRYSTAL.radius.powi(3);
    let mut sum = Tensor::default();
    for number in 0..6 {
        let (s, c) = (FRAC_PI_3 * f64::from(number)).sin_cos();
        let [x, y] = strain.along(FRAC_PI_3 * f64::from(number));
        let [x, y] = [x, y].map(|part| 2.0 * CRYSTAL.radius * part);
        let (normal, shear) = (c * x + s * y, CRYSTAL.kappa * (s * x - c * y));
        let force = [c * normal + s * shear, s * normal - c * shear];
        sum.xx += CRYSTAL.radius * c * force[0] / volume;
        sum.yy += CRYSTAL.radius * s * force[1] / volume;
        sum.xy += CRYSTAL.radius * c * force[1] / volume;
    }
    sum
}

#[test]
fn forces_are_those_of_an_even_strain() {
    for strain in [
        Tensor { xx: 1e-4, yy: 1e-4, xy: 0.0 },
        Tensor { xx: -2e-5, yy: 1e-3, xy: 0.0 },
        Tensor { xx: 3e-4, yy: -1e-4, xy: 0.0 },
    ] {
        let stress = stress(&strain);
        assert!(stress.xy.abs() < 1e-12 * stress.radius().max(stress.mean().abs()));
        let [row, inclined] = strained(&strain);
        let found = CRYSTAL.forces(stress.xx, stress.yy);
        let scale = row[0].abs() + inclined[0].abs();
        assert!((found.row - row[0]).abs() < 1e-13 * scale);
        assert!((found.inclined - inclined[0]).abs() < 1e-13 * scale);
        // Contact 3 of table A.4, at 60°, has -F_s.
        assert!((found.shear + inclined[1]).abs() < 1e-13 * scale);
    }
}

#[test]
fn isotropic_stress_makes_all_forces_alike() {
    // A.123, which the printed A.127 misses.
    let forces = CRYSTAL.forces(1e6, 1e6);
    close(forces.inclined, 1e6 / (3.0 * CRYSTAL.per_area()), 1e-14);
    close(forces.row, forces.inclined, 1e-14);
    assert_eq!(forces.shear, 0.0);
}

#[test]
fn a_plane_between_rows_carries_the_load() {
    // A.121: two inclined contacts on the area 2r times 2r, and A.117 along the rows.
    let (xx, yy) = (1e6, 50e6);
    let forces = CRYSTAL.forces(xx, yy);
    let carried = 3.0_f64.sqrt() * forces.inclined + forces.shear;
    close(carried, yy * 4.0 * CRYSTAL.radius.powi(2), 1e-14);
    // A plane across the rows: a contact of every second row, and two inclined ones.
    let across = 2.0 * forces.row + forces.inclined - 3.0_f64.sqrt() * forces.shear;
    close(across, xx * 4.0 * 3.0_f64.sqrt() * CRYSTAL.radius.powi(2), 1e-13);
}

#[test]
fn the_crystal_is_the_uniform_strain() {
    close(CONTACT_DENSITY, 2.0 * 3.0_f64.sqrt(), 1e-15);
    let elastic = CRYSTAL.elasticity(1e6);
    let uniform = cemented::uniform(CONTACT_DENSITY, 1e6, 2.0 * CRYSTAL.radius, CRYSTAL.kappa);
    close(elastic.young, uniform.young, 1e-14);
    close(elastic.poisson, uniform.poisson, 1e-14);
    for strain in [Tensor { xx: 1e-4, yy: 3e-4, xy: 0.0 }, Tensor { xx: 1e-4, yy: 0.0, xy: 2e-4 }] {
        let (one, other) = (stress(&strain), elastic.stress(&strain));
        close(1e6 * one.xx, other.xx, 1e-13);
        close(1.0 + 1e6 * one.yy, 1.0 + other.yy, 1e-9);
        close(1.0 + 1e6 * one.xy, 1.0 + other.xy, 1e-9);
    }
    // Without shear forces: the triangular net of springs, E = 2 kn/√3 over its thickness.
    let springs = Crystal { kappa: 0.0, ..CRYSTAL }.elasticity(1e6);
    close(springs.young * 2.0 * CRYSTAL.radius, 2e6 / 3.0_f64.sqrt(), 1e-14);
    close(springs.poisson, 1.0 / 3.0, 1e-14);
}

#[test]
fn rows_are_never_in_tension_and_crack_in_shear() {
    // κ > 1: F_t > 0 at any σ1 (chapter 5).
    assert!(CRYSTAL.forces(1e6, 1e12).row > 0.0);
    assert!(Crystal { kappa: 0.9, ..CRYSTAL }.forces(1e6, 1e12).row < 0.0);
    let strength = 100e6 * CRYSTAL.radius.powi(2);
    let failing = CRYSTAL.shear_failure(1e6, 0.6, strength).unwrap();
    let forces = CRYSTAL.forces(1e6, failing);
    close(forces.shear, 0.6 * forces.inclined + strength, 1e-12);
    // Above the 417 MPa of figure 52, where the walls concentrate the stress.
    assert!(failing > 417e6);
    assert_eq!(CRYSTAL.shear_failure(1e6, 1.0, strength), None);
}

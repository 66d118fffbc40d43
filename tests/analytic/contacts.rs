//! From contacts to stresses and moduli, against sums over contacts.

use graintwin::analytic::hooke::Hooke;
use graintwin::analytic::tensor::Tensor;
use graintwin::analytic::{cemented, contact, forces, sand};
use graintwin::contact::hertz;

use crate::{TENSORS, close, summed};

/// G, ν, r_i and r_j of some grains.
const GRAINS: [[f64; 4]; 2] = [[1e9, 0.16, 1e-4, 1e-4], [34e9, 0.3, 5e-5, 3e-4]];

#[test]
fn discs_touch_by_the_law_of_spheres() {
    for [shear, poisson, ri, rj] in GRAINS {
        let mean = 2.0 * ri * rj / (ri + rj);
        let compliance = hertz::compliance(2.0 * shear * (1.0 + poisson), poisson);
        let sphere = hertz::modulus(hertz::effective_radius(ri, rj), 2.0 * compliance);
        let modulus = contact::hertz_modulus(shear, poisson, mean);
        close(modulus, sphere, 1e-14);
        let (overlap, force) = (1e-7, hertz::force(sphere, 1e-7));
        let secant = contact::secant_stiffness(modulus, force);
        close(secant * overlap, force, 1e-14);
        // Mindlin's 8 a G/2(2-ν) with the contact radius a = √(R* n).
        let radius = (hertz::effective_radius(ri, rj) * overlap).sqrt();
        let mindlin = 4.0 * radius * shear / (2.0 - poisson);
        close(contact::shear_stiffness(shear, poisson, mean, force), mindlin, 1e-14);
        close(contact::stiffness_ratio(poisson) * secant, mindlin, 1e-14);
        // The tangent is 3/2 of the secant.
        close(hertz::stiffness(sphere, overlap), 1.5 * secant, 1e-14);
    }
}

#[test]
fn mean_forces_carry_the_stress() {
    let (diameter, density) = (2e-4, 1.9);
    for stress in TENSORS {
        let mean = summed(|angle| forces::mean(&stress, diameter, density, angle));
        // A.41 with n_c contacts of length d̄: n_c d̄/V is n_c/v/d̄².
        let scale = density / diameter.powi(2);
        close(scale * mean[0][0], stress.xx, 1e-14);
        close(scale * mean[1][1], stress.yy, 1e-14);
        for shear in [mean[0][1], mean[1][0]] {
            assert!((scale * shear - stress.xy).abs() < 1e-14);
        }
    }
}

#[test]
fn lateral_contacts_keep_their_force() {
    let before = forces::isotropic(1e5, 2e-4, 1.9);
    for ratio in [1.0, 2.0, 3.0] {
        let stress = Tensor { xx: 1e5, yy: ratio * 1e5, xy: 0.0 };
        close(forces::mean(&stress, 2e-4, 1.9, 0.0)[0], before, 1e-15);
        let [_, shear] = forces::mean(&stress, 2e-4, 1.9, 0.7);
        assert!(shear <= 0.0); // the first quadrant of figure A.10
    }
}

#[test]
fn a_uniform_strain_gives_the_uniform_moduli() {
    let (density, kn, diameter, kappa) = (1.8, 1e6, 2e-4, 1.37);
    let hooke = cemented::uniform(density, kn, diameter, kappa);
    for strain in TENSORS {
        let mean = summed(|angle| {
            let (s, c) = angle.sin_cos();
            let [x, y] = strain.along(angle).map(|part| part * diameter);
            [kn * (c * x + s * y), kappa * kn * (s * x - c * y)]
        });
        let scale = density / diameter.powi(2);
        let stress = hooke.stress(&strain);
        close(scale * mean[0][0], stress.xx, 1e-13);
        close(scale * mean[1][1], stress.yy, 1e-13);
        assert!((scale * mean[0][1] - stress.xy).abs() < 1e-13 * stress.yy.abs());
    }
}

#[test]
fn both_estimates_of_cemented_stiffness_have_the_same_isotropic_part() {
    for kappa in [1.0, 1.2, 1.37, 1.5] {
        let [averaged, uniform] =
            [cemented::averaged, cemented::uniform].map(|estimate| estimate(1.8, 1e6, 2e-4, kappa));
        close(averaged.bulk_modulus(), uniform.bulk_modulus(), 1e-14);
        // A.80 exceeds the upper bound of G for every Poisson's ratio of the grains.
        assert!(averaged.shear_modulus() >= uniform.shear_modulus() * (1.0 - 1e-14));
        let Hooke { young, poisson } = uniform;
        close(cemented::young_of_poisson(1.8, 1e6, 2e-4, poisson), young, 1e-14);
    }
}

#[test]
fn sand_is_cemented_sand_with_the_stiffness_of_its_mean_force() {
    let (shear, poisson, density, diameter) = (1e9, 0.16, 1.9, 2e-4);
    let reference = sand::reference_modulus(shear, poisson, density);
    for stress in [1e5, 4e5] {
        let force = forces::isotropic(stress, diameter, density);
        let hertz = contact::hertz_modulus(shear, poisson, 0.5 * diameter);
        let kn = contact::secant_stiffness(hertz, force);
        let kappa = contact::stiffness_ratio(poisson);
        let young = cemented::averaged(density, kn, diameter, kappa).young;
        close(sand::young(reference, stress), young, 1e-13);
    }
}

#[test]
fn compression_follows_its_tangent() {
    let (reference, poisson, start) = (44.4e6, 0.18, 1e4);
    let stress = |strain: f64| sand::compression(reference, poisson, start, strain);
    close(stress(0.0), start, 1e-14);
    for strain in [1e-3, 5e-3, 2e-2] {
        let slope = (stress(strain + 1e-6) - stress(strain - 1e-6)) / 2e-6;
        let young = sand::young(reference, 0.5 * (1.0 + poisson) * stress(strain));
        close(slope, Hooke { young, poisson }.compression_modulus(), 1e-6);
    }
}

#[test]
fn the_first_strain_of_sand_meets_the_tangents_of_its_contacts() {
    // Contacts in all directions alike carry F = 2 σ d̄²/n_c/v each under the isotropic stress σ.
    let (shear, poisson, density, stress, diameter) = (1e9, 0.16, 2.1, 3e5, 2e-4);
    let force = 2.0 * stress * diameter * diameter / density;
    let modulus = contact::hertz_modulus(shear, poisson, 0.5 * diameter);
    let across = 1.5 * modulus.powf(2.0 / 3.0) * force.cbrt();
    let along = contact::shear_stiffness(shear, poisson, 0.5 * diameter, force);
    let found = sand::first(shear, poisson, density, stress);
    let bulk = density * across / (4.0 * diameter);
    let slope = density * (across + along) / (8.0 * diameter);
    assert!((found.bulk_modulus() / bulk - 1.0).abs() < 1e-12, "{found:?} {bulk:e}");
    assert!((found.shear_modulus() / slope - 1.0).abs() < 1e-12, "{found:?} {slope:e}");
}

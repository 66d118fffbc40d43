//! The crystal of 635 discs (B chapter 5).

use graintwin::analytic::contact::stiffness_ratio;
use graintwin::analytic::crystal::Crystal;
use graintwin::analytic::fit::record;

use super::rig::{Rig, made, scene};
use super::{POISSON, found};

/// k_n \[N/m\] and c_μ \[Pa\] (B table 8).
const STIFFNESS: f64 = 1e6;
const COHESION: f64 = 1e8;
const RADIUS: f64 = 1e-4;
/// σ3 \[Pa\].
const PRESSURE: f64 = 1e6;
/// B figure 52 \[Pa\].
const BOOK: f64 = 417e6;

/// Runs and prints the test.
pub(crate) fn run() {
    println!("\nCrystal of 635 discs, σ3 = 1 MPa (B figure 52):\n");
    println!(
        "| cut-off | σ1 at failure [MPa] | ε1 there [%] | bonds broken there | first crack at σ1 [MPa] | by tension, of all | E [GPa] | ν |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- |");
    for tension in [true, false] {
        let contact = format!(
            "{{normal: {{linear: {{stiffness: {STIFFNESS:e}, bond: {{cohesion: {COHESION:e}, \
             tension: {tension}}}}}}}, friction: {{coefficient: 0.6}}}}"
        );
        let loaded = scene(
            "  crystal: {rows: 41, columns: [15, 16], radius: 0.1e-3, material: sand}",
            &contact,
            "max_overlap_share: 100.0, max_strain_increment: 1.0e-3",
        );
        let mut rig = Rig::new(&loaded.scene, &made(&loaded));
        rig.isotropic(PRESSURE);
        let course = rig.press(Some(PRESSURE), |course| {
            course.strain() >= 0.12 || course.pressed() < 0.7 * course.major[course.peak()]
        });
        let peak = course.peak();
        let first = course.broken.iter().position(|&count| count > 0).unwrap_or(0);
        let small = 0..20.min(course.axial.len());
        println!(
            "| {tension} | {:.0} | {:.2} | {} | {:.0} | {:.2} | {:.2} | {:.3} |",
            course.major[peak] / 1e6,
            1e2 * course.axial[peak],
            course.broken[peak],
            course.major[first] / 1e6,
            course.tension_share(true),
            found(record::slope(&course.axial, &course.major, small.clone())) / 1e9,
            found(record::poisson(&course.axial, &course.area, small)),
        );
    }
    let crystal = Crystal { radius: RADIUS, kappa: stiffness_ratio(POISSON) };
    let elastic = crystal.elasticity(STIFFNESS);
    let failure = crystal.shear_failure(PRESSURE, 0.6, COHESION * RADIUS * RADIUS);
    println!(
        "\nB {:.0} MPa; A.127 and (11): {:.0} MPa; E {:.2} GPa, ν {:.3}",
        BOOK / 1e6,
        found(failure) / 1e6,
        elastic.young / 1e9,
        elastic.poisson
    );
}

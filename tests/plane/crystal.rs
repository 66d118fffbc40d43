//! The crystal of equal discs (B chapter 5 and appendix 9).

use graintwin::command::{Ask, Disposition};
use graintwin::pack::Pack;
use graintwin::report::{ContactNetwork, Grains};
use graintwin::wall::WallTarget;

use crate::discs::*;

/// As B fig. 51: rows of 15 and 16 discs in turn, just touching; 41 rows are his 635 discs.
fn crystal(rows: u32) -> Pack {
    let rise = 3.0_f64.sqrt() * RADIUS;
    let mut grains = Vec::new();
    for row in 0..rows {
        let (count, from) = if row % 2 == 0 { (15, 2.0) } else { (16, 1.0) };
        for k in 0..count {
            let x = (from + 2.0 * f64::from(k)) * RADIUS;
            grains.push(disc(x, RADIUS + rise * f64::from(row), RADIUS, 0.6));
        }
    }
    let bounds = boxed([0.0; 2], [32.0 * RADIUS, 2.0 * RADIUS + rise * f64::from(rows - 1)]);
    Pack { bounds, grains, history: None }
}

/// Forces F_n, F_s and F_t' of the contacts around one grain, and its stresses along x and y (A.42-A.43).
fn around(grain: u32, network: &ContactNetwork, grains: &Grains) -> ([f64; 3], [f64; 2]) {
    let volume = 4.0 * 3.0_f64.sqrt() * RADIUS.powi(3);
    let (mut force, mut count, mut stress) = ([0.0; 3], [0.0; 2], [0.0; 2]);
    for k in 0..network.first.len() {
        let ends = [network.first[k], network.second[k]];
        if !ends.contains(&grain) || ends.iter().any(|&end| end as usize >= grains.position.len()) {
            continue;
        }
        let normal = [network.normal[3 * k], network.normal[3 * k + 1]];
        let pressed = network.normal_force[k];
        let rubbed = [network.tangential_force[3 * k], network.tangential_force[3 * k + 1]];
        for axis in 0..2 {
            let along = pressed * normal[axis] + rubbed[axis];
            stress[axis] += RADIUS * normal[axis] * along / volume;
        }
        if normal[1].abs() < 0.1 {
            force[2] += pressed;
            count[1] += 1.0;
        } else {
            force[0] += pressed;
            force[1] += rubbed[0].hypot(rubbed[1]);
            count[0] += 1.0;
        }
    }
    assert_eq!(count, [4.0, 2.0]);
    ([force[0] / 4.0, force[1] / 4.0, force[2] / 2.0], stress)
}

#[test]
fn three_contact_forces_are_those_of_the_closed_form() {
    let kappa = 3.0 * (1.0 - POISSON) / (2.0 - POISSON);
    let scene = scene(
        "{friction: {coefficient: 0.6}, normal: {linear: {stiffness: 1.0e6, \
         bond: {cohesion: .inf}}}}",
        "solver: {tolerance: 1.0e-10, max_strain_increment: 1.0e-2, max_overlap_share: 100.0}",
    );
    // So tall that what the platens do has died away in the middle.
    let pack = crystal(201);
    let (mut rig, report) = Rig::new(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    // Small, so that the geometry is that of the closed form.
    let (lateral, axial) = (1e3, 3e3);
    rig.stress([lateral; 2]);
    let targets = [lateral, lateral, axial, axial].map(WallTarget::Stress);
    let [a, b, c, d] = targets;
    let measures = rig.go(Ask::Targets([a, b, c, d, WallTarget::Keep, WallTarget::Keep]));
    let (network, grains) = (measures.network.unwrap(), measures.grains.unwrap());
    let middle = (0..grains.position.len() as u32).filter(|&grain| {
        let [x, y, _] = grains.position[grain as usize];
        let sides = pack.bounds.sides();
        (x / sides[0] - 0.5).abs() < 0.1 && (y / sides[1] - 0.5).abs() < 0.02
    });
    let mut seen = 0;
    for grain in middle {
        let ([normal, shear, across], [s3, s1]) = around(grain, &network, &grains);
        // 15 grains a row carry what 16 diameters of the platens do.
        assert!((s1 / axial - 16.0 / 15.0).abs() < 0.02, "{s1:e} {s3:e}");
        // A.125 solved anew: A.126 has this sign of κσ3 in F_n, A.127 the wrong one.
        let unit = 4.0 * 3.0_f64.sqrt() * RADIUS * RADIUS / 6.0 / (kappa + 1.0);
        for (got, want) in [
            (normal, unit * ((kappa + 2.0) * s1 + kappa * s3)),
            (shear, unit * kappa * (s1 - s3) * 3.0_f64.sqrt()),
            (across, unit * ((kappa - 1.0) * s1 + (kappa + 3.0) * s3)),
        ] {
            assert!((got / want - 1.0).abs() < 1e-6, "{grain}: {got:e} {want:e}");
        }
        seen += 1;
    }
    assert!(seen > 5, "{seen}");
}

//! Bonds of cohesive discs: when and how they break.

use graintwin::command::{Ask, Disposition};
use graintwin::pack::Pack;
use graintwin::report::BondCondition;
use graintwin::scene::{Normal, Rotation, Scene};
use graintwin::wall::WallTarget;

use crate::discs::*;

const COHESION: f64 = 100e6;

/// Sandstone of B table 8 with these keys of its bonds besides the cohesion.
fn sandstone(keys: &str, friction: f64) -> Scene {
    scene(
        &format!(
            "{{friction: {{coefficient: {friction}}}, normal: {{linear: {{stiffness: 1.0e6, \
             bond: {{cohesion: {COHESION:e}{keys}}}}}}}}}"
        ),
        "",
    )
}

/// Two discs side by side on the floor and a third on them (half of B fig. A.17).
fn triangle() -> Pack {
    let rise = 3.0_f64.sqrt() * RADIUS;
    let at = [[-RADIUS, RADIUS], [RADIUS, RADIUS], [0.0, rise + RADIUS]];
    let grains = at.map(|[x, y]| disc(x, y, RADIUS, 0.0)).to_vec();
    let wide = 3.0 * RADIUS;
    Pack { bounds: boxed([-wide, 0.0], [wide, rise + 2.0 * RADIUS]), grains, history: None }
}

/// Load on the top at which the first bond of the triangle breaks \[N\], and how.
fn breaking_load(keys: &str, rotation: Rotation, shear_ratio: f64) -> (f64, BondCondition) {
    let mut scene = sandstone(keys, 0.0);
    scene.contact.rotation = rotation;
    if let Normal::Linear(linear) = &mut scene.contact.normal {
        linear.shear_ratio = Some(shear_ratio);
    }
    let (mut rig, report) = Rig::new(&scene, &triangle());
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    for k in 1..4000 {
        let load = 0.01 * f64::from(k);
        let keep = WallTarget::Keep;
        let top = WallTarget::Force(load);
        let report = rig.ask(Ask::Targets([keep, keep, keep, top, keep, keep]));
        let measures = report.measures.unwrap_or_else(|| panic!("{}", report.text));
        if let Some(crack) = measures.cracks.unwrap().list.first() {
            return (load, crack.mode);
        }
    }
    panic!("no bond broke");
}

#[test]
fn two_discs_that_a_third_drives_apart_break_by_tension() {
    // Discs that roll carry no shear: their bond is pulled by √3/6 of the load (A.115).
    let strength = COHESION * RADIUS * RADIUS;
    let want = strength * 6.0 / 3.0_f64.sqrt();
    let (load, mode) = breaking_load("", Rotation::Free, 1.4);
    assert_eq!(mode, BondCondition::Tension);
    // Loads come in steps of 0.01 N, and 3 N take the discs 1 % of their size together.
    assert!((load / want - 1.0).abs() < 0.02, "{load} {want}");
    // Half as strong along x.
    let (weak, _) = breaking_load(", along_x: 0.5", Rotation::Free, 1.4);
    assert!((weak / (0.5 * want) - 1.0).abs() < 0.02, "{weak} {want}");
}

#[test]
fn without_a_cut_off_bonds_break_by_shear_alone() {
    // Locked discs: the top one comes down by 1, the others go apart by w each. Their contact with it
    // closes by √3/2 - w/2 and slides by 1/2 + √3/2 w, and w is where they are in balance.
    let (kappa, root) = (1.5, 3.0_f64.sqrt());
    let w = root * (1.0 - kappa) / (9.0 + 3.0 * kappa);
    let (normal, shear) = (root / 2.0 - w / 2.0, kappa * (0.5 + root / 2.0 * w));
    let want = COHESION * RADIUS * RADIUS * (root * normal + shear) / shear;
    let (load, mode) = breaking_load(", tension: false", Rotation::Locked, kappa);
    assert_eq!(mode, BondCondition::Shear);
    assert!((load / want - 1.0).abs() < 0.03, "{load} {want}");
}

#[test]
fn both_forms_of_the_strength_are_those_of_the_radii() {
    let strength = |form: &str| {
        let scene = sandstone(&format!(", form: {form}"), 0.6);
        let mut pack = triangle();
        pack.grains[1].radius = 0.5 * RADIUS;
        pack.grains[1].position = [0.5 * RADIUS, RADIUS, 0.0];
        pack.grains.truncate(2);
        let (_, report) = Rig::new(&scene, &pack);
        let bonds = report.measures.unwrap().bonds.unwrap();
        (bonds.first.len(), bonds.radius[0])
    };
    let (count, mean) = strength("mean");
    assert_eq!(count, 1);
    assert!((mean / (2.0 / 3.0 * RADIUS) - 1.0).abs() < 1e-12);
    let (_, product) = strength("product");
    assert!((product / (0.5_f64.sqrt() * RADIUS) - 1.0).abs() < 1e-12);
}

#[test]
fn a_sandstone_cracks_across_its_sides_and_no_bond_is_left_overloaded() {
    let (mut pulled, mut flat, mut all) = (0, 0, 0);
    for seed in 7..12 {
        let pack = {
            let smooth = scene("{normal: {linear: {stiffness: 1.0e6}}}", "");
            let (mut rig, _) = Rig::new(&smooth, &loose(7, 14, seed, 0.0));
            rig.stress([1e6; 2]);
            let mut pack = rig.twin.pack();
            pack.grains.iter_mut().for_each(|grain| grain.friction = 0.6);
            pack
        };
        let (mut rig, report) = Rig::new(&sandstone("", 0.6), &pack);
        let start = report.measures.unwrap();
        let bonded = start.cracks.unwrap().intact;
        assert_eq!(bonded as usize, start.bonds.unwrap().first.len());
        let height = pack.bounds.sides()[1];
        let (before, mut peak) = (all, 0.0_f64);
        for k in 1..=150 {
            let measures = rig.biaxial(1e6, 0.5e-4 * f64::from(k) * height);
            peak = peak.max(measures.state.unwrap().stress_walls[4]);
            let bonds = measures.bonds.unwrap();
            assert!(bonds.strength_use.iter().all(|&used| used <= 1.0));
            for crack in measures.cracks.unwrap().list {
                assert!(crack.overload > 1.0);
                all += 1;
                pulled += u32::from(crack.normal_force < 0.0);
                flat += u32::from(crack.normal[0].abs() > crack.normal[1].abs());
            }
            if all - before > bonded / 8 {
                break;
            }
        }
        assert!(all > before && peak > 10e6, "{seed}: {peak:e}");
    }
    // B 4.2.4: what breaks are lateral contacts, while they are pulled. Of the bonds as they are half would
    // be lateral, and none is pulled.
    assert!(all > 30 && 20 * pulled >= 17 * all && 4 * flat >= 3 * all, "{pulled} {flat} of {all}");
}

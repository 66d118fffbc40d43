//! The benchmark pack that other codes were compared on: 2740 glass beads at 10 MPa. Its wall
//! forces and counts, and those of ten uniaxial increments, come from an independent code (Python
//! with numba and scipy's sparse LU, residual 3e-12; see `tests/data/README.md`).
#![allow(clippy::needless_range_loop, reason = "walls and axes index several arrays alike")]

use std::path::{Path, PathBuf};

use graintwin::command::Disposition;
use graintwin::pack::{self, Pack};
use graintwin::scene::{self, Loaded, Scene};
use graintwin::wall;

use crate::packs::{E_GRAINS, E_WALL, Rig, by_strain, close, state};

const SCENE: &str = "
materials: {bead: {young: 70.0e9, poisson: 0.2, density: 2420.0}}
walls: {young: 7.0e12, poisson: 0.495}
pack: {file: g2740_10MPa.csv, material: bead}
";

fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

fn benchmark() -> (Scene, Pack) {
    let file = data().join("scene.yaml");
    let scene = scene::parse(SCENE, &file).unwrap();
    let pack = pack::build(&Loaded { scene: scene.clone(), file }).unwrap();
    (scene, pack)
}

#[test]
fn the_pack_is_found_in_equilibrium_with_the_forces_of_the_independent_code() {
    let (scene, pack) = benchmark();
    assert_eq!(pack.grains.len(), 2740);
    let (rig, report) = Rig::start(&scene, &pack);
    assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
    assert_eq!(report.substeps, 0);
    let measures = report.measures.unwrap();
    let state = state(&measures);
    assert_eq!(state.iterations, 0);
    // `residual` of the independent code: 2.96e-12.
    assert!(state.residual < 1e-10, "{}", state.residual);
    assert_eq!(rig.twin.pack().bounds, pack.bounds);

    let want = [
        74.027_119_975_072_68,
        74.027_119_975_073_75,
        74.015_987_234_046_53,
        74.015_987_234_045_07,
        74.061_522_068_596_99,
        74.061_522_068_597_36,
    ];
    for w in 0..wall::COUNT {
        close(wall::NAMES[w], measures.walls.normal_force[w], want[w], 1e-9);
    }
    let stress = [9_992_403.215_224_333, 10_009_418.407_896_858, 9_997_399.026_716_134];
    for (axis, want) in stress.into_iter().enumerate() {
        close("stress", state.stress_walls[4 * axis], want, 1e-9);
        close("stress", state.stress_contacts[4 * axis], want, 1e-9);
    }
    // 8171 contacts between beads and 895 with walls.
    assert_eq!(state.rattlers, 61);
    // The independent code counts every overlap, 8171 between beads and 895 with walls: a
    // coordination of 6.29. The contract leaves out those below 1e-6 of the mean force.
    let all = every_contact(&pack);
    let grains = all.iter().filter(|contact| contact.0).count();
    assert_eq!((grains, all.len() - grains), (8171, 895));
    let mean = all.iter().map(|contact| contact.1).sum::<f64>() / all.len() as f64;
    close("mean force", mean, 0.343_322_892_956_476_9, 1e-9);
    let coordination = |least: f64| {
        let counted = all.iter().filter(|contact| contact.1 >= least);
        counted.map(|contact| if contact.0 { 2.0 } else { 1.0 }).sum::<f64>() / 2740.0
    };
    close("coordination of all", coordination(0.0), 6.290_875_912_408_759, 1e-14);
    assert_eq!(state.coordination_number, coordination(1e-6 * mean));
    assert_eq!(all.len() - state.contacts as usize, 11);
    let total = measures.network.unwrap().normal_force.iter().sum::<f64>();
    close("sum of the forces", total, mean * all.len() as f64, 1e-9);
}

/// Every overlap of the pack by brute force: whether it is one of two grains, and its force.
fn every_contact(pack: &Pack) -> Vec<(bool, f64)> {
    let mut contacts = Vec::new();
    for (i, a) in pack.grains.iter().enumerate() {
        for b in &pack.grains[..i] {
            let square: f64 = (0..3).map(|k| (a.position[k] - b.position[k]).powi(2)).sum();
            let overlap = a.radius + b.radius - square.sqrt();
            if overlap > 0.0 {
                let radius = 1.0 / (1.0 / a.radius + 1.0 / b.radius);
                let force = 4.0 / 3.0 * E_GRAINS * radius.sqrt() * overlap.powf(1.5);
                contacts.push((true, force));
            }
        }
        for w in 0..wall::COUNT {
            let gap = (a.position[wall::axis(w)] - pack.bounds.position(w)).abs();
            if gap < a.radius {
                let force = 4.0 / 3.0 * E_WALL * a.radius.sqrt() * (a.radius - gap).powf(1.5);
                contacts.push((false, force));
            }
        }
    }
    contacts
}

#[test]
fn ten_uniaxial_increments_agree_with_the_independent_code() {
    let text = std::fs::read_to_string(data().join("g2740_10MPa_reference.json")).unwrap();
    let reference: serde_json::Value = serde_json::from_str(&text).unwrap();
    let increments = reference["increments"].as_array().unwrap();
    assert_eq!(increments.len(), 10);

    let (scene, pack) = benchmark();
    let (mut rig, _) = Rig::start(&scene, &pack);
    for (k, want) in (1..).zip(increments) {
        let strain = 1e-4 * f64::from(k);
        // Two of the ten pass an instability, which the twin reports; it ends where the other does.
        let measures = rig.go(by_strain(&pack.bounds, [0.0, 0.0, strain]));
        let forces: Vec<f64> =
            want["wall_forces"].as_array().unwrap().iter().map(|f| f.as_f64().unwrap()).collect();
        for w in 0..wall::COUNT {
            let off = (measures.walls.normal_force[w] - forces[w]).abs() / forces[4];
            assert!(off <= 1e-7, "increment {k}, {}: off by {off:.1e}", wall::NAMES[w]);
        }
        close("energy", state(&measures).stored_energy, want["U"].as_f64().unwrap(), 1e-7);
        close("strain", state(&measures).strain[2], strain, 1e-10);
    }
}

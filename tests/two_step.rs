//! Increments of cemented packs in two linear steps (T A.2.2) against the same laws solved in the
//! geometry at the end.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/packs.rs"]
mod packs;

use std::path::Path;

use graintwin::pack::Pack;
use graintwin::scene::{self, Scene};
use graintwin::wall;
use packs::{Rig, bits, by_strain, made, state};

/// Laws of the contacts.
const LAWS: [&str; 4] = [
    "fixed",
    "linear_elastic",
    "{exponential: {gamma: 3000}}",
    "{power: {eta: 1111, omega: 1}}",
];

/// Axial, then lateral strain of the thesis' uniaxial test: Poisson's expansion of 0.25 (T 4.8.1).
fn uniaxial(strain: f64) -> [f64; 3] {
    [-0.25 * strain, -0.25 * strain, strain]
}

/// Cement of the law `law`, with increments that are never cut.
fn cemented(law: &str, solution: &str) -> Scene {
    let text = format!(
        "pack: {{file: none.csv, material: glass}}\n\
         contact: {{normal: {{cement: {{law: {law}, solution: {solution}}}}}}}\n\
         solver: {{tolerance: 1e-9, max_strain_increment: 0.05, max_overlap_share: 100}}"
    );
    scene::parse(&text, Path::new("scene.yaml")).unwrap()
}

/// Normal forces on the walls after increments to the axial strains `strains` \[N\].
fn forces(scene: &Scene, pack: &Pack, strains: &[f64]) -> [f64; wall::COUNT] {
    let (mut rig, _) = Rig::start(scene, pack);
    let last = strains.iter().map(|&strain| rig.go(by_strain(&pack.bounds, uniaxial(strain)))).last();
    last.unwrap().walls.normal_force
}

/// Largest difference of the wall forces over the largest of them.
fn difference(a: &[f64; wall::COUNT], b: &[f64; wall::COUNT]) -> f64 {
    let largest = b.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
}

#[test]
fn explore() {
    let pack = made(200, 1e7, 3);
    for law in LAWS {
        for d in [2.5e-5, 5e-5, 1e-4, 2e-4, 4e-4] {
            let [a, b] = ["two_step", "nonlinear"].map(|s| {
                let (mut rig, r) = Rig::start(&cemented(law, s), &pack);
 println!("{:?} {}", r.disposition, r.text);
                let m = rig.go(by_strain(&pack.bounds, uniaxial(d)));
                (state(&m), m.walls.normal_force, m.wall_force_error, rig.twin.effort())
            });
            println!("{law} {d:e} diff {:.3e} res {:.2e} {:.2e} it {} {} err {:.2e} diss {:.3e} {:.3e} work {:.3e} {:?} {:?}", difference(&a.1, &b.1), a.0.residual, b.0.residual, a.0.iterations, b.0.iterations, a.2/a.1[4], a.0.dissipated_energy, b.0.dissipated_energy, b.0.wall_work, a.3, b.3);
        }
    }
    let _ = (forces(&cemented("fixed", "two_step"), &pack, &[1e-4]), bits(&pack));
}

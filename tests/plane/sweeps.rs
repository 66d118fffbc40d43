//! Increments that end with so many sweeps over the grains (B 2.3, table 1) and no equilibrium.

use graintwin::report::PackState;
use graintwin::scene::{Method, Scene};

use crate::discs::*;

const STEP: f64 = 4e-5;

fn sweeping(sweeps: u32) -> Scene {
    let solver = format!("solver: {{method: gauss_seidel, sweeps: {sweeps}}}");
    scene("{friction: {coefficient: 0.6, update: current}}", &solver)
}

/// The pack strained by `increments` of [`STEP`] along y, with 1 bar on the sides.
fn pressed(scene: &Scene, seed: u64, increments: u32) -> PackState {
    let pack = dense(8, 16, seed, 1e5, 0.6);
    let height = pack.bounds.sides()[1];
    let (mut rig, report) = Rig::new(scene, &pack);
    let mut state = report.measures.unwrap().state.unwrap();
    for k in 1..=increments {
        state = rig.biaxial(1e5, 0.5 * STEP * f64::from(k) * height).state.unwrap();
    }
    state
}

#[test]
fn many_sweeps_end_in_the_equilibrium() {
    let equilibrium = scene("{friction: {coefficient: 0.6, update: current}}", "");
    let here = pressed(&equilibrium, 3, 3).stress_walls;
    let state = pressed(&sweeping(20_000), 3, 3);
    assert!(state.residual < 1e-9, "{}", state.residual);
    for (there, here) in [0, 4].map(|k| (state.stress_walls[k], here[k])) {
        assert!((there / here - 1.0).abs() < 1e-4, "{there} {here}");
    }
}

#[test]
fn few_sweeps_leave_the_platens_too_far_ahead() {
    let equilibrium = scene("{friction: {coefficient: 0.6, update: current}}", "");
    for seed in [3, 4, 5] {
        let here = pressed(&equilibrium, seed, 20).stress_walls[4];
        let excess = [5, 20, 80].map(|sweeps| {
            let state = pressed(&sweeping(sweeps), seed, 20);
            assert_eq!(state.iterations, sweeps);
            assert!(state.residual > 1e-8, "{sweeps} {}", state.residual);
            state.stress_walls[4] / here - 1.0
        });
        // The grains inside have not heard of the walls yet: stress is too high, the less so the more
        // sweeps there are. Slip on other ways leaves a scatter of some thousandths.
        let [few, some, many] = excess;
        assert!(0.02 < few && 0.0 < some && some < 0.2 * few, "{excess:?}");
        assert!(many.abs() < some, "{excess:?}");
    }
}

#[test]
fn only_sweeps_over_discs_are_counted() {
    let of = |text: &str| graintwin::scene::parse(text, "sweeps.yaml".as_ref());
    let pack = "pack: {file: none.csv}\n";
    let counted = of(&format!("dimension: 2\n{pack}solver: {{method: gauss_seidel, sweeps: 20}}"));
    let solver = counted.unwrap().solver;
    assert_eq!((solver.method, solver.sweeps), (Method::GaussSeidel, Some(20)));
    for (text, why) in [
        ("dimension: 2\n{pack}solver: {sweeps: 20}", "counts the sweeps of another method"),
        ("dimension: 2\n{pack}solver: {method: gauss_seidel, sweeps: 0}", "solver.sweeps"),
        ("{pack}solver: {method: gauss_seidel, sweeps: 20}", "spheres are brought to equilibrium"),
    ] {
        let refused = of(&text.replace("{pack}", pack)).unwrap_err().to_string();
        assert!(refused.contains(why), "{refused}");
    }
}

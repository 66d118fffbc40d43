//! Increments of cemented packs in two linear steps (T A.2.2) against the same laws solved in the
//! geometry at the end.

use std::path::Path;

use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::pack::{Kept, Pack};
use graintwin::report::Demand;
use graintwin::scene::{self, Scene};
use graintwin::wall::{self, WallTarget};

use crate::packs::{Rig, bits, by_strain, close, made, state};

/// Laws of the contacts.
const LAWS: [&str; 4] =
    ["fixed", "linear_elastic", "{exponential: {gamma: 3000}}", "{power: {eta: 1111, omega: 1}}"];

/// Strains of the thesis' uniaxial test: Poisson's expansion of 0.25 (T 4.8.1).
fn uniaxial(strain: f64) -> [f64; 3] {
    [-0.25 * strain, -0.25 * strain, strain]
}

/// A scene of the cement `cement`, with increments that are never cut.
fn with_cement(cement: &str, friction: &str) -> Scene {
    let text = format!(
        "pack: {{file: none.csv, material: glass}}\n\
         contact: {{normal: {{cement: {{{cement}}}}}, friction: {friction}}}\n\
         solver: {{tolerance: 1e-9, max_strain_increment: 0.05, max_overlap_share: 100}}"
    );
    scene::parse(&text, Path::new("scene.yaml")).unwrap()
}

fn cemented(law: &str, solution: &str) -> Scene {
    with_cement(&format!("law: {law}, solution: {solution}"), "none")
}

/// Wall forces of `pack` after increments to the axial strains `strains`, and the pack there.
fn walk(scene: &Scene, pack: &Pack, strains: &[f64]) -> ([f64; wall::COUNT], Pack) {
    let (mut rig, _) = Rig::start(scene, pack);
    let mut forces = [0.0; wall::COUNT];
    for &strain in strains {
        let measures = rig.go(by_strain(&pack.bounds, uniaxial(strain)));
        forces = measures.walls.normal_force;
    }
    (forces, rig.twin.pack())
}

/// Largest difference of two lists of forces \[N\].
fn apart(a: &[f64; wall::COUNT], b: &[f64; wall::COUNT]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// One increment from the same equilibrium: the solutions differ by a term of second order.
#[test]
fn the_solutions_of_an_increment_differ_to_second_order() {
    let pack = made(200, 1e7, 3);
    for law in LAWS {
        let (forces, begun) = walk(&cemented(law, "nonlinear"), &pack, &[1e-4, 2e-4]);
        let difference = |strain: f64| {
            let [two, one] = ["two_step", "nonlinear"]
                .map(|solution| walk(&cemented(law, solution), &begun, &[strain]).0);
            apart(&two, &one)
        };
        let [small, large] = [2e-5, 4e-5].map(difference);
        let order = (large / small).log2();
        assert!((1.9..2.1).contains(&order), "{law}: {order}");
        let largest = forces.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        assert!(large < 0.01 * largest, "{law}: {large:e} of {largest:e}");
    }
}

/// Along a path of a fixed strain what is left of the increments is of first order.
#[test]
fn paths_in_smaller_increments_come_closer() {
    let pack = made(120, 1e7, 4);
    let path = |count: u32| -> Vec<f64> {
        (1..=count).map(|k| 4e-4 * f64::from(k) / f64::from(count)).collect()
    };
    let (exact, _) = walk(&cemented(LAWS[2], "nonlinear"), &pack, &path(16));
    let off =
        |count: u32| apart(&walk(&cemented(LAWS[2], "two_step"), &pack, &path(count)).0, &exact);
    let [coarse, fine] = [8, 16].map(off);
    assert!((1.8..2.2).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
}

/// γ = 0 and directions that hardly change: a linear material.
#[test]
fn fixed_stiffness_answers_in_proportion() {
    let pack = made(120, 1e7, 5);
    let scene = cemented("{exponential: {gamma: 0}}", "two_step");
    let [one, three] = [1e-7, 3e-7].map(|strain| walk(&scene, &pack, &[strain]).0);
    for ((name, three), one) in wall::NAMES.iter().zip(three).zip(one) {
        close(name, three, 3.0 * one, 3e-6);
    }
    // And the other way round.
    let back = walk(&scene, &pack, &[-1e-7]).0;
    close("tension", back[5], -one[5], 1e-6);
}

/// The residual is that of the forces that are reported, in the geometry that is.
#[test]
fn the_residual_is_that_of_what_is_reported() {
    let pack = made(120, 1e7, 6);
    let (mut rig, _) = Rig::start(&cemented(LAWS[2], "two_step"), &pack);
    let measures = rig.go(by_strain(&pack.bounds, uniaxial(3e-4)));
    let reported = state(&measures).residual;
    let network = measures.network.as_ref().unwrap();
    let mut force = vec![graintwin::Vec3::zeros(); pack.grains.len()];
    for k in 0..network.first.len() {
        let three = |list: &[f64]| graintwin::Vec3::from_column_slice(&list[3 * k..3 * k + 3]);
        let on_first =
            three(&network.normal) * network.normal_force[k] + three(&network.tangential_force);
        force[network.first[k] as usize] += on_first;
        if let Some(other) = force.get_mut(network.second[k] as usize) {
            *other -= on_first;
        }
    }
    let mean = state(&measures).mean_normal_force;
    let found = force.iter().map(|f| f.norm()).fold(0.0, f64::max) / mean;
    assert!(found > 1e-9 && found < 1.01 * reported, "{found:e} {reported:e}");
    // Walls do what the contacts store.
    let state = state(&measures);
    assert!(state.dissipated_energy.abs() < 1e-3 * state.wall_work, "{state:?}");
}

/// A second increment without a motion of the walls carries the balance on.
#[test]
fn walls_that_stand_let_the_residual_fall() {
    let pack = made(120, 1e7, 6);
    let (mut rig, _) = Rig::start(&cemented(LAWS[2], "two_step"), &pack);
    let there = by_strain(&pack.bounds, uniaxial(3e-4));
    let residuals = [0; 2].map(|_| state(&rig.go(there)).residual);
    assert!(residuals[1] < 1e-3 * residuals[0], "{residuals:?}");
}

#[test]
fn threads_leave_the_bits_alone() {
    let pack = made(700, 1e7, 7);
    let scene = cemented(LAWS[2], "two_step");
    let digests = [1, 2, 3].map(|threads| {
        let (mut rig, _) = Rig::start_on(&scene, &pack, threads);
        rig.go(by_strain(&pack.bounds, uniaxial(2e-4)));
        rig.go(by_strain(&pack.bounds, uniaxial(3e-4)));
        rig.twin.digest()
    });
    assert!(digests[0] == digests[1] && digests[0] == digests[2]);
}

/// Walls whose places are sums without rounding, so that a saved box is the same box.
#[test]
fn a_saved_pack_goes_on_with_the_same_bits() {
    let pack = made(60, 1e7, 8);
    let scene = cemented(LAWS[2], "two_step");
    let unit = 2.0_f64.powi(-40);
    let step = [-20.0, -16.0, -12.0, -24.0, 80.0, 72.0].map(|k| k * 1e3 * unit);
    let times = |factor: f64| step.map(|d| d * factor);
    let (mut whole, _) = Rig::start(&scene, &pack);
    whole.go(times(1.0));
    let saved = whole.twin.pack();
    whole.go(times(2.0));
    let (mut again, report) = Rig::start(&scene, &saved);
    assert_eq!(report.text, "");
    assert_eq!(bits(&again.twin.pack()), bits(&saved));
    again.go(times(1.0));
    let [one, other] = [&whole, &again].map(|rig| rig.twin.pack());
    assert_eq!(bits(&one), bits(&other));
    assert_eq!(one.history, other.history);
}

/// A pack of one solution is taken up by the other: forces of the law, or as they were.
#[test]
fn solutions_take_up_the_packs_of_the_other() {
    let pack = made(120, 1e7, 9);
    let (forces, cemented_pack) = walk(&cemented(LAWS[2], "nonlinear"), &pack, &[2e-4]);
    let (rig, report) = Rig::start(&cemented(LAWS[2], "two_step"), &cemented_pack);
    let measures = report.measures.unwrap();
    for (w, want) in forces.iter().enumerate() {
        close(wall::NAMES[w], measures.walls.normal_force[w], *want, 1e-9);
    }
    let history = rig.twin.pack().history.unwrap();
    assert!(history.bonds.iter().all(|bond| bond.normal_force.is_some()));
    let (back, _) = Rig::start(&cemented(LAWS[2], "nonlinear"), &rig.twin.pack());
    let history = back.twin.pack().history.unwrap();
    assert!(history.bonds.iter().all(|bond| bond.normal_force.is_none()));
}

/// Walls under loads: lateral stress stays what it was while the pack is pressed along z.
#[test]
fn walls_under_loads_carry_them() {
    let pack = made(120, 1e7, 10);
    let results = ["two_step", "nonlinear"].map(|solution| {
        let (mut rig, _) = Rig::start(&cemented(LAWS[2], solution), &pack);
        let travel = by_strain(&pack.bounds, [0.0, 0.0, 2e-4]);
        let targets = std::array::from_fn(|w| match w {
            0..4 => WallTarget::Stress(1e5),
            _ => WallTarget::Displacement(travel[w]),
        });
        let command = Command {
            stamp: Stamp::default(),
            session: "test".into(),
            sequence: 1,
            mode: Mode::Absolute,
            ask: Ask::Targets(targets),
            age: None,
        };
        let report = rig.twin.apply(&command, Demand::ALL);
        let measures = report.measures.unwrap_or_else(|| panic!("{}", report.text));
        (measures.walls.normal_force, rig.twin.pack().bounds)
    });
    let (forces, bounds) = &results[0];
    for axis in 0..2 {
        let mean = 0.5 * (forces[2 * axis] + forces[2 * axis + 1]);
        // The second step balances the loads on the areas where the first one ended.
        close("lateral", mean / bounds.area(2 * axis), 1e5, 1e-3);
    }
    let [two, one] = [0, 1].map(|k| results[k].0[5]);
    close("axial", two, one, 0.2);
}

/// Bonds break one by one under two steps too, and what they stored is accounted for.
#[test]
fn bonds_break_under_two_steps_too() {
    let pack = made(120, 1e7, 11);
    let cement = "law: fixed, solution: two_step, strength: {tension: 2e7, shear: .inf}";
    let (mut rig, _) = Rig::start(&with_cement(cement, "{coefficient: 0.3}"), &pack);
    let mut last = None;
    for k in 1..=6 {
        let strain = [-1e-4, -1e-4, 1e-4].map(|e| e * f64::from(k));
        last = Some(rig.go(by_strain(&pack.bounds, strain)));
    }
    let history = rig.twin.pack().history.unwrap();
    let broken = history.bonds.iter().filter(|bond| bond.condition == Kept::Tension).count();
    assert!(broken > 3, "{broken}");
    let state = state(&last.unwrap());
    assert!(state.dissipated_energy > 0.0 && state.dissipated_energy < state.wall_work);
}

#[test]
fn scenes_that_the_two_steps_cannot_serve_are_refused() {
    let parse = |normal: &str, friction: &str| {
        let text = format!(
            "pack: {{file: none.csv, material: glass}}\n\
             contact: {{normal: {{cement: {{{normal}, solution: two_step}}}}, friction: {friction}}}"
        );
        scene::parse(&text, Path::new("scene.yaml")).map_err(|fault| fault.to_string())
    };
    let parallel =
        "law: {parallel: {young: 7e7, shear: 3e7, radius_ratio: 0.003, length_ratio: 0.001}}";
    let text = parse(parallel, "none").unwrap_err();
    assert!(text.contains("contact.normal.cement.solution"), "{text}");
    let text = parse("law: fixed", "{law: secant}").unwrap_err();
    assert!(text.contains("contact.friction.law"), "{text}");
    assert!(parse("law: fixed", "{coefficient: 0.4}").is_ok());
}

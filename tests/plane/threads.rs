//! The number of threads changes not one bit.

use graintwin::command::{Ask, Command, Disposition, Mode, Stamp};
use graintwin::report::{Demand, Report};
use graintwin::scene::Scene;
use graintwin::twin::Twin;
use graintwin::wall::WallTarget;

use crate::discs::*;

/// What two runs must have in common: forces and displacements of the walls, effort and places and turns
/// of all grains, as bits.
fn bits(report: &Report) -> Vec<u64> {
    let measures = report.measures.as_ref().unwrap();
    let (walls, state) = (&measures.walls, measures.state.unwrap());
    let network = measures.network.as_ref().unwrap();
    let positions = measures.grains.as_ref().unwrap().position.as_flattened();
    let floats = (walls.normal_force.iter().chain(&walls.displacement))
        .chain(&state.stress_contacts)
        .chain(&network.normal_force)
        .chain(&network.tangential_force)
        .chain(positions)
        .chain([&state.residual, &state.dissipated_energy, &state.event_energy]);
    let counts = [state.iterations, state.contacts, state.rattlers].map(u64::from);
    floats.map(|value| value.to_bits()).chain(counts).collect()
}

/// A biaxial test past the first events, on `threads` threads.
pub(crate) fn test(scene: &Scene, threads: usize, increments: u32) -> Vec<Vec<u64>> {
    let pack = dense(12, 20, 3, 1e5, 0.6);
    let height = pack.bounds.sides()[1];
    let mut twin = Twin::new(scene, &pack, threads).unwrap();
    let mut course = vec![bits(&twin.start(Demand::ALL))];
    for k in 1..=increments {
        let [side, keep] = [WallTarget::Stress(1e5), WallTarget::Keep];
        let platen = WallTarget::Displacement(0.5 * 4e-4 * f64::from(k) * height);
        let command = Command {
            stamp: Stamp::default(),
            session: "test".into(),
            sequence: u64::from(k),
            mode: Mode::Absolute,
            ask: Ask::Targets([side, side, platen, platen, keep, keep]),
            age: None,
        };
        let report = twin.apply(&command, Demand::ALL);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        course.push(bits(&report));
    }
    course
}

#[test]
fn a_biaxial_test_is_the_same_on_any_number_of_threads() {
    let scene = sand("0.6");
    let one = test(&scene, 1, 15);
    for threads in [2, 7] {
        assert!(test(&scene, threads, 15) == one, "{threads} threads");
    }
}

#[test]
fn sweeps_over_the_grains_are_the_same_on_any_number_of_threads() {
    let solver = "solver: {method: gauss_seidel, tolerance: 1.0e-5}";
    let scene = scene("{friction: {coefficient: 0.6}}", solver);
    let one = test(&scene, 1, 2);
    assert!(test(&scene, 7, 2) == one);
}

//! The bits of an answer depend neither on the number of threads nor on the time of day: the same
//! positions, wall forces, contacts and reports at 1, 2 and 7 threads and on repetition.

use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::report::{Demand, Report};
use graintwin::scene::{Coulomb, Friction, Law, Material, Scene, Solver, Update, Walls};
use graintwin::twin::Twin;
use graintwin::wall::Bounds;
use rayon::ThreadPoolBuilder;

use crate::packs::{GLASS, absolute, bead, bits, by_strain, recipe, scene};

/// Load, unload and shear.
const PATH: [[f64; 3]; 4] =
    [[0.0, 0.0, 2e-4], [1e-4, 1e-4, 2e-4], [1e-4, -1e-4, 3e-4], [0.0, 0.0, 1e-4]];

/// A pack of grains that all differ, made by `threads` threads.
fn made_by(threads: usize, grains: usize) -> Pack {
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let material = Material { spread: 0.1, ..GLASS };
    let recipe = recipe(grains, 10e6, 42);
    pool.install(|| generate(&recipe, &material, &Walls::default(), 0.0, Solver::default()))
        .unwrap()
}

/// Everything that a report says, floats by their bits.
fn said(report: &Report) -> String {
    let measures = report.measures.as_ref().unwrap();
    let network = measures.network.as_ref().unwrap();
    let walls = &measures.walls;
    let floats = (walls.normal_force.iter())
        .chain(walls.displacement.iter())
        .chain(walls.position.iter())
        .chain(walls.force.iter().flatten())
        .chain(walls.moment.iter().flatten())
        .chain(&network.normal)
        .chain(&network.normal_force)
        .chain(&network.tangential_force)
        .chain(&network.overlap);
    let bits: Vec<u64> = floats.map(|value| value.to_bits()).collect();
    // `{:?}` of a float is its shortest form that reads back to the same bits.
    format!(
        "{:?} {} {} {} {:?} {:?} {:?} {:?} {:?} {bits:?}",
        report.disposition,
        report.increment,
        report.substeps,
        report.text,
        measures.state,
        measures.moduli,
        measures.fabric,
        network.first,
        network.second,
    )
}

/// All that a twin says on the way, and the pack that it ends with.
fn run(threads: usize, pack: &Pack, path: &[[f64; 3]]) -> (Vec<String>, Vec<u64>) {
    run_in(&scene(), threads, pack, path)
}

fn run_in(
    scene: &Scene,
    threads: usize,
    pack: &Pack,
    path: &[[f64; 3]],
) -> (Vec<String>, Vec<u64>) {
    let mut twin = Twin::new(scene, pack, threads).unwrap();
    assert_eq!(twin.threads(), threads);
    let mut reports = vec![said(&twin.start(Demand::ALL))];
    for (sequence, strain) in (1..).zip(path) {
        let command = absolute(sequence, by_strain(&pack.bounds, *strain));
        reports.push(said(&twin.apply(&command, Demand::ALL)));
    }
    (reports, bits(&twin.pack()))
}

#[test]
fn three_hundred_grains_give_the_same_bits_at_any_number_of_threads() {
    let pack = made_by(1, 306);
    let want = run(1, &pack, &PATH);
    // It is no trivial path: the walls moved and the grains with them.
    assert_ne!(want.1, bits(&pack));
    assert_eq!(want.0.len(), 1 + PATH.len());
    for threads in [1, 2, 7] {
        assert!(bits(&made_by(threads, 306)) == bits(&pack), "made by {threads} threads");
        assert!(run(threads, &pack, &PATH) == want, "{threads} threads");
    }
}

#[test]
fn grains_with_friction_give_the_same_bits_at_any_number_of_threads() {
    let mut pack = made_by(1, 500);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    for (law, update) in [
        (Law::ReturnMap, Update::Frozen),
        (Law::Secant, Update::Frozen),
        (Law::MindlinDeresiewicz, Update::Current),
    ] {
        let mut scene = scene();
        scene.contact.friction = Friction::Coulomb(Coulomb { coefficient: 0.3, law, update });
        let want = run_in(&scene, 1, &pack, &PATH);
        for threads in [2, 7] {
            assert!(run_in(&scene, threads, &pack, &PATH) == want, "{law:?}, {threads} threads");
        }
    }
}

#[test]
fn three_thousand_grains_give_the_same_bits_at_any_number_of_threads() {
    let pack = made_by(1, 2740);
    for threads in [2, 7] {
        assert!(bits(&made_by(threads, 2740)) == bits(&pack), "made by {threads} threads");
    }
    let want = run(1, &pack, &PATH[..2]);
    for threads in [2, 7] {
        assert!(run(threads, &pack, &PATH[..2]) == want, "{threads} threads");
    }
}

/// A face-centred crystal of `4 cells³` beads of 0.1 mm with radii that differ by up to 0.4 %,
/// pressed together by 1 %.
fn crystal(cells: usize, friction: f64) -> Pack {
    const RADIUS: f64 = 1e-4;
    let edge = 0.99 * 2.0 * RADIUS * 2.0_f64.sqrt();
    let corners = [[0.0, 0.0, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]];
    let mut grains = Vec::new();
    for cell in 0..cells.pow(3) {
        let cell = [cell / cells / cells, cell / cells % cells, cell % cells];
        for corner in corners {
            let at = |axis: usize| (cell[axis] as f64 + corner[axis]) * edge + 0.99 * RADIUS;
            let spread = (grains.len() as f64 * 0.7).sin() * 0.004;
            let mut grain = bead([0, 1, 2].map(at), RADIUS * (1.0 + spread));
            grain.friction = friction;
            grains.push(grain);
        }
    }
    let side = (cells as f64 - 0.5) * edge + 2.0 * 0.99 * RADIUS;
    Pack { bounds: Bounds { min: [0.0; 3], max: [side; 3] }, grains, history: None }
}

#[test]
fn packs_that_are_cut_into_parts_give_the_same_bits_at_any_number_of_threads() {
    for friction in [0.0, 0.3] {
        let pack = crystal(14, friction);
        assert!(graintwin::model::parts(pack.grains.len()) > 1);
        let mut scene = scene();
        if friction > 0.0 {
            let (law, update) = (Law::ReturnMap, Update::Frozen);
            scene.contact.friction =
                Friction::Coulomb(Coulomb { coefficient: friction, law, update });
        }
        let want = run_in(&scene, 1, &pack, &PATH[..1]);
        for threads in [2, 7] {
            assert!(run_in(&scene, threads, &pack, &PATH[..1]) == want, "{threads} threads");
        }
    }
}

#[test]
fn twins_on_different_threads_agree_after_every_command_whatever_the_others_do() {
    // The twins take turns in a changing order, one of them asked for less than the others.
    let pack = made_by(2, 306);
    let counts = [1, 2, 7, 3];
    let mut twins = counts.map(|threads| Twin::new(&scene(), &pack, threads).unwrap());
    let demand = |k: usize| if k == 3 { Demand::NONE } else { Demand::ALL };
    for (k, twin) in twins.iter_mut().enumerate() {
        twin.start(demand(k));
    }
    for (round, strain) in PATH.into_iter().enumerate() {
        let command = absolute(round as u64 + 1, by_strain(&pack.bounds, strain));
        let mut answers = vec![None; counts.len()];
        for turn in 0..counts.len() {
            let k = (3 * turn + round) % counts.len();
            let report = twins[k].apply(&command, demand(k));
            answers[k] = Some(report.measures.unwrap().walls.normal_force.map(f64::to_bits));
        }
        assert!(answers.iter().all(|answer| *answer == answers[0]), "command {round}");
        assert!(twins.iter().all(|twin| bits(&twin.pack()) == bits(&twins[0].pack())));
    }
}

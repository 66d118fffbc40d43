//! Walls under loads: their positions are unknowns of the equilibrium.

use graintwin::command::{Ask, Command, Disposition, Mode};
use graintwin::pack::{Grain, Pack};
use graintwin::report::{Demand, Measures, Report};
use graintwin::scene::{self, Scene};
use graintwin::twin::Twin;
use graintwin::wall::{self, Bounds, WallTarget};

use crate::packs::{Rig, absolute, bits, by_strain, close, made, scene, scene_to, state};

const KEEP: WallTarget = WallTarget::Keep;
const FRICTION: &str = "contact: {friction: {coefficient: 0.3}}";

/// Beads with friction, without tangential load.
fn rough(grains: usize, stress: f64, seed: u64) -> Pack {
    let mut pack = made(grains, stress, seed);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
}

fn targets(sequence: u64, targets: [WallTarget; wall::COUNT]) -> Command {
    Command { ask: Ask::Targets(targets), ..absolute(sequence, [0.0; wall::COUNT]) }
}

/// Asks for targets, which must be reached.
fn go(rig: &mut Rig, asked: [WallTarget; wall::COUNT]) -> Measures {
    let report = ask(rig, asked);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    report.measures.unwrap()
}

fn ask(rig: &mut Rig, asked: [WallTarget; wall::COUNT]) -> Report {
    rig.sequence += 1;
    rig.twin.apply(&targets(rig.sequence, asked), Demand::ALL)
}

fn with(text: &str) -> Scene {
    scene::parse(&format!("pack: {{file: none.csv}}\n{text}"), "loads.yaml".as_ref()).unwrap()
}

/// Both walls of a pair carry the stress.
fn pair(axis: usize, stress: f64) -> [WallTarget; wall::COUNT] {
    let mut targets = [KEEP; wall::COUNT];
    targets[2 * axis..2 * axis + 2].fill(WallTarget::Stress(stress));
    targets
}

/// A sphere of radius 1 mm in a box that just touches it.
fn ball() -> Pack {
    let grain = Grain {
        position: [0.0; 3],
        radius: 1e-3,
        young: 70e9,
        poisson: 0.2,
        density: 2.5e3,
        friction: 0.0,
        hydrate: false,
    };
    let bounds = Bounds { min: [-1e-3; 3], max: [1e-3; 3] };
    Pack { bounds, grains: vec![grain], history: None }
}

/// Overlap of that sphere with a wall that carries `force` (Hertz) \[m\].
fn hertz(force: f64) -> f64 {
    let compliance = (1.0 - 0.2f64.powi(2)) / 70e9 + (1.0 - 0.495f64.powi(2)) / 7e12;
    (0.75 * force * compliance / 1e-3f64.sqrt()).powf(2.0 / 3.0)
}

#[test]
fn a_force_presses_a_sphere_as_far_as_hertz_says() {
    let (mut rig, _) = Rig::start(&scene_to(1e-12), &ball());
    // Something to hold it on all sides.
    rig.go([1e-6; 6]);
    for force in [0.5, 5.0, 0.8] {
        let target = WallTarget::Force(force);
        let measures = go(&mut rig, [KEEP, KEEP, KEEP, KEEP, target, target]);
        let walls = measures.walls;
        for w in [4, 5] {
            close("force", walls.normal_force[w], force, 1e-8);
            close("displacement", walls.displacement[w], hertz(force), 1e-8);
        }
        assert_eq!(walls.displacement[..4], [1e-6; 4]);
    }
    // One wall alone: the other one stands, and the sphere lies between them.
    let measures = go(
        &mut rig,
        [KEEP, KEEP, KEEP, KEEP, WallTarget::Displacement(1e-6), WallTarget::Force(2.0)],
    );
    assert_eq!(measures.walls.displacement[4], 1e-6);
    let way = measures.walls.displacement[4] + measures.walls.displacement[5];
    close("way", way, 2.0 * hertz(2.0), 1e-8);
}

#[test]
fn a_stress_is_the_force_over_the_area_that_the_wall_has_in_the_end() {
    // The walls are smooth: what one of a pair carries the other one carries too.
    let walls = "walls: {friction: 0.0}\nsolver: {tolerance: 1.0e-10}";
    let (mut rig, _) = Rig::start(&with(&format!("{FRICTION}\n{walls}")), &rough(150, 4e6, 11));
    let asked = [[6e6, 4e6, 5e6], [3e6, 3.5e6, 4.5e6], [8e6; 3]];
    for stresses in asked {
        let all = std::array::from_fn(|w| WallTarget::Stress(stresses[w / 2]));
        let measures = go(&mut rig, all);
        let bounds = rig.twin.pack().bounds;
        for w in 0..wall::COUNT {
            let stress = measures.walls.normal_force[w] / bounds.area(w);
            close(wall::NAMES[w], stress, stresses[w / 2], 1e-8);
        }
    }
}

/// The forces of a twin whose walls are sent where the loads took those of another.
fn forces_at_the_same_walls(scene: &Scene, pack: &Pack, steps: &[[WallTarget; 6]]) {
    let (mut loaded, _) = Rig::start(scene, &pack.clone());
    let (mut moved, _) = Rig::start(scene, &pack.clone());
    for &step in steps {
        let report = ask(&mut loaded, step);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        assert!(report.text.is_empty() && report.substeps == 1, "not smooth: {}", report.text);
        let by_load = report.measures.unwrap();
        let by_way = moved.go(by_load.walls.displacement);
        let allowed = by_load.wall_force_error + by_way.wall_force_error;
        for w in 0..wall::COUNT {
            let forces = [by_load.walls.normal_force[w], by_way.walls.normal_force[w]];
            close(wall::NAMES[w], forces[0], forces[1], 2.0 * allowed / forces[1] + 2e-8);
        }
    }
}

#[test]
fn loads_find_the_equilibrium_that_displacements_find() {
    let steps: Vec<_> = (1..=4)
        .map(|k| {
            let share = f64::from(k);
            let mut step = pair(0, 1e7 * (1.0 + 0.004 * share));
            step[3] = WallTarget::Stress(1e7 * (1.0 - 0.003 * share));
            step[5] = WallTarget::Displacement(3e-8 * share);
            step
        })
        .collect();
    forces_at_the_same_walls(&scene(), &made(120, 1e7, 5), &steps);
}

#[test]
fn loads_find_the_equilibrium_that_displacements_find_under_gravity() {
    let scene = with("gravity: [0.0, 0.0, -9.81]\nsolver: {tolerance: 1.0e-9}");
    let steps: Vec<_> = (1..=3)
        .map(|k| {
            let mut step = pair(2, 1e7 * (1.0 + 0.004 * f64::from(k)));
            step[4] = WallTarget::Displacement(0.0);
            step
        })
        .collect();
    forces_at_the_same_walls(&scene, &made(120, 1e7, 5), &steps);
}

#[test]
fn energy_is_the_work_of_walls_that_carry_loads() {
    let (mut rig, report) = Rig::start(&scene(), &made(120, 1e7, 5));
    let before = state(&report.measures.unwrap()).stored_energy;
    let mut last = 1e7;
    for k in 1..=8 {
        last = 1e7 * (1.0 + 0.002 * f64::from(k));
        let measures = go(&mut rig, [WallTarget::Stress(last); 6]);
        let state = state(&measures);
        let stored = state.stored_energy - before;
        // The trapezoidal rule leaves the cube of the increment.
        close("energy", state.wall_work, stored, 1e-5);
    }
    assert!(last > 1e7);
}

#[test]
fn a_triaxial_test_keeps_its_lateral_stress_while_the_axis_is_strained() {
    let pack = rough(150, 4e6, 11);
    let side = pack.bounds.sides()[2];
    let (mut rig, _) = Rig::start(&with(FRICTION), &pack);
    let mut last = 0.0;
    for k in 1..=20 {
        let mut step = pair(0, 4e6);
        step[2..4].fill(WallTarget::Stress(4e6));
        step[4..].fill(WallTarget::Displacement(0.5e-4 * f64::from(k) * side));
        let measures = go(&mut rig, step);
        let state = state(&measures);
        close("strain", state.strain[2], 1e-4 * f64::from(k), 1e-9);
        for axis in [0, 1] {
            close("lateral", state.stress_walls[4 * axis], 4e6, 1e-8);
            assert!(state.strain[axis] < 0.0, "it grows sideways");
        }
        last = state.deviatoric_stress;
    }
    assert!(last > 1e6, "{last}");
}

#[test]
fn a_pack_that_yields_ends_where_the_loads_are_carried() {
    // Without friction a pack carries little deviator: the walls yield and it rearranges.
    let pack = made(300, 1e6, 1);
    let side = pack.bounds.sides()[2];
    let (mut rig, _) = Rig::start(&scene(), &pack);
    let mut yielded = 0;
    for k in 1..=12 {
        let mut step = pair(0, 1e6);
        step[2..4].fill(WallTarget::Stress(1e6));
        step[4..].fill(WallTarget::Displacement(0.5e-4 * f64::from(k) * side));
        let report = ask(&mut rig, step);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        yielded += u32::from(report.text.contains("yielded"));
        let measures = report.measures.unwrap();
        let loaded = state(&measures);
        for axis in [0, 1] {
            close("lateral", loaded.stress_walls[4 * axis], 1e6, 1e-8);
        }
        // The pack as it is now is in equilibrium for a twin that knows nothing of loads.
        let (_, again) = Rig::start(&scene(), &rig.twin.pack());
        let again = state(&again.measures.unwrap());
        assert_eq!(again.iterations, 0);
        close("stress", again.stress_walls[0], loaded.stress_walls[0], 1e-7);
    }
    assert!(yielded > 0, "this pack was to yield");
}

#[test]
fn a_wall_that_touches_nothing_comes_in_until_it_carries_its_load() {
    let (mut rig, _) = Rig::start(&scene_to(1e-12), &ball());
    rig.go([1e-6, 1e-6, 1e-6, -1e-5, 1e-6, 1e-6]);
    let measures = go(&mut rig, [KEEP, KEEP, KEEP, WallTarget::Force(2.0), KEEP, KEEP]);
    close("force", measures.walls.normal_force[3], 2.0, 1e-12);
    close("way", measures.walls.displacement[3], 2.0 * hertz(2.0) - 1e-6, 1e-9);
    // Further away than a wall may yield in one command: refused, and nothing has moved.
    go(&mut rig, [KEEP, KEEP, KEEP, WallTarget::Displacement(-5e-4), KEEP, KEEP]);
    let before = bits(&rig.twin.pack());
    let report = ask(&mut rig, [KEEP, KEEP, KEEP, WallTarget::Force(2.0), KEEP, KEEP]);
    assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
    assert_eq!(bits(&rig.twin.pack()), before);
}

#[test]
fn what_cannot_be_carried_is_refused_and_the_state_kept() {
    let (mut rig, _) = Rig::start(&scene(), &ball());
    rig.go([1e-6; 6]);
    let before = bits(&rig.twin.pack());
    let bad = [
        ([KEEP, KEEP, KEEP, KEEP, KEEP, WallTarget::Stress(0.0)], "z_max"),
        ([KEEP, KEEP, KEEP, KEEP, KEEP, WallTarget::Force(-1.0)], "z_max"),
        ([KEEP, KEEP, KEEP, WallTarget::Stress(f64::NAN), KEEP, KEEP], "y_max"),
        ([KEEP, WallTarget::Force(f64::INFINITY), KEEP, KEEP, KEEP, KEEP], "x_max"),
        ([WallTarget::Unknown(9, 0.0), KEEP, KEEP, KEEP, KEEP, KEEP], "x_min"),
        ([WallTarget::Force(1.0), WallTarget::Force(2.0), KEEP, KEEP, KEEP, KEEP], "x_max"),
    ];
    for (asked, name) in bad {
        let report = ask(&mut rig, asked);
        assert_eq!(report.disposition, Disposition::Invalid, "{}", report.text);
        assert!(report.text.contains(name), "{}", report.text);
        assert_eq!(bits(&rig.twin.pack()), before);
    }
    // A load as of a rig gone mad: the sphere would be crushed.
    let report = ask(&mut rig, [KEEP, KEEP, KEEP, KEEP, KEEP, WallTarget::Stress(1e13)]);
    assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
    assert!(report.text.contains("load"), "{}", report.text);
    assert_eq!(bits(&rig.twin.pack()), before);
    let mut scene = scene();
    scene.solver.method = scene::Method::Dynamic;
    let (mut rig, _) = Rig::start(&scene, &ball());
    let report = ask(&mut rig, [WallTarget::Force(1.0); 6]);
    assert_eq!(report.disposition, Disposition::Invalid);
    assert!(report.text.contains("newton"), "{}", report.text);
}

#[test]
fn a_boundary_command_moves_the_walls_that_carry_no_load() {
    let (mut rig, _) = Rig::start(&scene(), &made(60, 2e6, 3));
    go(&mut rig, pair(0, 2.1e6));
    let report = rig.send([1e-3, 1e-3, 2e-8, 2e-8, 3e-8, 3e-8]);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let walls = report.measures.unwrap().walls;
    assert_eq!(walls.displacement[2..], [2e-8, 2e-8, 3e-8, 3e-8]);
    let stress = walls.normal_force[0] / rig.twin.pack().bounds.area(0);
    close("stress", stress, 2.1e6, 1e-8);
    // Increments go on top: of the load, and of where the walls are.
    let on_top = |targets| Command {
        mode: Mode::Increment,
        ask: Ask::Targets(targets),
        ..absolute(rig.sequence + 1, [0.0; 6])
    };
    let mut step = pair(0, 1e5);
    step[4] = WallTarget::Displacement(1e-8);
    let measures = rig.twin.apply(&on_top(step), Demand::ALL).measures.unwrap();
    close("z_min", measures.walls.displacement[4], 4e-8, 1e-12);
    let stress = measures.walls.normal_force[0] / rig.twin.pack().bounds.area(0);
    close("stress", stress, 2.2e6, 1e-8);
}

#[test]
fn the_scene_can_put_walls_under_loads_from_the_start() {
    let text = "walls: {targets: {x_min: {stress: 2.2e+6}, x_max: {stress: 2.2e+6}}}";
    let (mut rig, report) = Rig::start(&with(text), &made(60, 2e6, 3));
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let at = |measures: &Measures, rig: &Rig| {
        measures.walls.normal_force[0] / rig.twin.pack().bounds.area(0)
    };
    let first = report.measures.unwrap();
    assert_eq!(first.increment, 0);
    close("stress", at(&first, &rig), 2.2e6, 1e-8);
    let second = rig.send([0.0, 0.0, 0.0, 0.0, 3e-8, 3e-8]).measures.unwrap();
    close("stress", at(&second, &rig), 2.2e6, 1e-8);
}

#[test]
fn the_bits_do_not_depend_on_the_threads() {
    for (text, pack) in [("", made(300, 1e6, 1)), (FRICTION, rough(150, 4e6, 11))] {
        let run = |threads| {
            let mut twin = Twin::new(&with(text), &pack, threads).unwrap();
            twin.start(Demand::ALL);
            for k in 1..=6 {
                let stress = if text.is_empty() { 1e6 } else { 4e6 };
                let mut step = pair(0, stress);
                step[2..4].fill(WallTarget::Stress(stress));
                step[4..].fill(WallTarget::Displacement(0.5e-7 * k as f64));
                let report = twin.apply(&targets(k, step), Demand::ALL);
                assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
            }
            bits(&twin.pack())
        };
        let one = run(1);
        assert_eq!(one, run(2));
        assert_eq!(one, run(7));
    }
}

#[test]
fn a_stress_comes_back_to_the_same_pack_where_nothing_is_lost() {
    let (mut rig, _) = Rig::start(&scene(), &made(120, 1e7, 5));
    let start = go(&mut rig, [WallTarget::Stress(1e7); 6]).walls.displacement;
    go(&mut rig, [WallTarget::Stress(1.01e7); 6]);
    let back = go(&mut rig, [WallTarget::Stress(1e7); 6]).walls.displacement;
    let way = by_strain(&rig.twin.pack().bounds, [1e-4; 3])[0];
    for w in 0..wall::COUNT {
        close(wall::NAMES[w], back[w], start[w], 1e-5 * way / start[w].abs());
    }
}

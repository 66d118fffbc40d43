//! Motion that damping brings to rest (B 2.2): the equilibria of Newton's method, the same bits on any
//! number of threads, and an end where it does not arrive.

use std::path::Path;

use graintwin::command::{Ask, Disposition, Shear};
use graintwin::pack::{self, Pack};
use graintwin::report::Measures;
use graintwin::scene::{self, Loaded, Method, Scene};
use graintwin::wall::WallTarget::{self, Keep};

use crate::discs::*;
use crate::threads;

/// `scene` by motion to the residual `tolerance`.
fn by_motion(scene: &Scene, tolerance: f64) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.tolerance) = (Method::Dynamic, tolerance);
    scene
}

fn by_newton(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    (scene.solver.method, scene.solver.tolerance) = (Method::Newton, 1e-11);
    scene
}

/// What the pack is like after each of the commands `asks`.
fn along(scene: &Scene, pack: &Pack, asks: &[Ask]) -> Vec<Measures> {
    let (mut rig, report) = Rig::new(scene, pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    asks.iter().map(|ask| rig.go(*ask)).collect()
}

/// Largest difference of a wall's force over the largest force, and of the place of a grain that carries
/// load over the mean radius. A pack between membranes is held nowhere: places count from their mean.
fn apart(one: &Measures, other: &Measures) -> [f64; 2] {
    let [a, b] = [one, other].map(|measures| measures.walls.normal_force);
    let most = b.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
    let force = a.iter().zip(&b).map(|(a, b)| (a - b).abs() / most).fold(0.0, f64::max);
    let [a, b] = [one, other].map(|measures| measures.grains.as_ref().unwrap());
    let both = a.position.iter().zip(&b.position).zip(a.pressure.iter().zip(&b.pressure));
    let ways: Vec<[f64; 2]> = both
        .filter(|(_, (a, b))| **a != 0.0 && **b != 0.0)
        .map(|((a, b), _)| [0, 1].map(|k| (a[k] - b[k]) / RADIUS))
        .collect();
    let mean = [0, 1].map(|k| ways.iter().map(|way| way[k]).sum::<f64>() / ways.len() as f64);
    let far = ways.iter().flat_map(|way| [0, 1].map(|k| (way[k] - mean[k]).abs()));
    [force, far.fold(0.0, f64::max)]
}

/// Three increments of 4e-5 along y, with 1 bar on the sides.
fn biaxial(pack: &Pack) -> Vec<Ask> {
    let (x, height) = (WallTarget::Stress(1e5), pack.bounds.sides()[1]);
    let y = |k: u32| WallTarget::Displacement(0.5 * 4e-5 * f64::from(k) * height);
    (1..=3).map(|k| Ask::Targets([x, x, y(k), y(k), Keep, Keep])).collect()
}

/// Asserts that wall forces are off by no more than `share` of the residual, and places by no more than
/// `soft` times the residual, at every tolerance.
fn comes_to_newtons(scene: &Scene, pack: &Pack, asks: &[Ask], share: f64, soft: f64) {
    let want = along(&by_newton(scene), pack, asks);
    for tolerance in [1e-5, 1e-7, 1e-9] {
        let got = along(&by_motion(scene, tolerance), pack, asks);
        for (k, (got, want)) in got.iter().zip(&want).enumerate() {
            let state = got.state.unwrap();
            assert!(state.residual <= tolerance, "{tolerance:e} {k}: {:e}", state.residual);
            let [force, far] = apart(got, want);
            assert!(force <= share * tolerance + 1e-11, "{tolerance:e} {k}: forces {force:e}");
            assert!(far <= soft * tolerance + 1e-11, "{tolerance:e} {k}: places {far:e}");
        }
    }
}

#[test]
fn smooth_grains_come_to_the_equilibria_of_newtons_method() {
    let pack = dense(8, 16, 3, 1e5, 0.6);
    comes_to_newtons(&sand("none"), &pack, &biaxial(&pack), 3.0, 10.0);
}

#[test]
fn grains_with_friction_come_to_the_equilibria_of_newtons_method() {
    let pack = dense(8, 16, 3, 1e5, 0.6);
    for update in ["frozen", "current"] {
        let contact = format!("{{friction: {{coefficient: 0.6, update: {update}}}}}");
        comes_to_newtons(&scene(&contact, ""), &pack, &biaxial(&pack), 3.0, 1.0);
    }
}

#[test]
fn the_error_of_wall_forces_is_the_one_that_is_told() {
    let pack = dense(8, 16, 3, 1e5, 0.6);
    for scene in [sand("none"), sand("0.6")] {
        let want = along(&by_newton(&scene), &pack, &biaxial(&pack));
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let got = along(&by_motion(&scene, tolerance), &pack, &biaxial(&pack)[..1]);
            let forces = [&got[0], &want[0]].map(|measures| measures.walls.normal_force);
            let off = (0..4).map(|w| (forces[0][w] - forces[1][w]).abs()).fold(0.0, f64::max);
            let told = got[0].wall_force_error;
            assert!((0.5 * off..5.0 * off).contains(&told), "{tolerance:e}: {off:e} {told:e}");
        }
    }
}

#[test]
fn walls_come_to_the_loads_that_they_shall_carry() {
    let pack = dense(8, 8, 5, 1e5, 0.6);
    let load = |x: f64, y: f64| {
        let [x, y] = [x, y].map(WallTarget::Stress);
        Ask::Targets([x, x, y, y, Keep, Keep])
    };
    let asks = [load(1.05e5, 1e5), load(1.05e5, 1.1e5)];
    comes_to_newtons(&sand("0.6"), &pack, &asks, 10.0, 10.0);
    let last = along(&by_motion(&sand("0.6"), 1e-9), &pack, &asks).pop().unwrap();
    let stress = last.state.unwrap().stress_walls;
    assert!((stress[0] / 1.05e5 - 1.0).abs() < 1e-8 && (stress[4] / 1.1e5 - 1.0).abs() < 1e-8);
}

fn with_walls(walls: &str, contact: &str) -> Scene {
    let text =
        format!("dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\ncontact: {contact}\n");
    scene::parse(&text, "motion.yaml".as_ref()).unwrap()
}

const SAND: &str = "{friction: {coefficient: 0.6}}";

#[test]
fn leaning_boxes_with_glue_and_without_come_to_newtons_equilibria() {
    let pack = dense(8, 8, 2, 1e5, 0.6);
    let loads = [WallTarget::Stress(1e5); 4];
    let [a, b, c, d] = loads;
    let asks =
        [2e-5, 5e-5].map(|tilt| Ask::Shear(Shear { tilt, targets: [a, b, c, d, Keep, Keep] }));
    for walls in ["friction: .inf, glue: true", "friction: .inf"] {
        let targets = "targets: {x_min: {stress: 1.0e5}, x_max: {stress: 1.0e5}, y_min: {stress: \
                       1.0e5}, y_max: {stress: 1.0e5}}";
        let scene = with_walls(&format!("{walls}, {targets}"), SAND);
        comes_to_newtons(&scene, &pack, &asks, 10.0, 10.0);
    }
}

#[test]
fn membranes_press_as_they_do_by_newtons_method() {
    let pack = dense(8, 8, 2, 1e5, 0.6);
    let membranes = "friction: 0.0, membranes: [x_min, x_max], targets: {x_min: {stress: 1.0e5}, \
                     x_max: {stress: 1.0e5}}";
    let way = |k: f64| WallTarget::Displacement(2e-5 * k * pack.bounds.sides()[1]);
    let asks = [1.0, 2.0].map(|k| Ask::Targets([Keep, Keep, way(k), way(k), Keep, Keep]));
    let scene = with_walls(membranes, SAND);
    // Without its walls the pack slides into the membranes first.
    let (rig, _) = Rig::new(&scene, &pack);
    comes_to_newtons(&scene, &rig.twin.pack(), &asks, 20.0, 10.0);
}

#[test]
fn grains_that_cannot_turn_and_circles_around_them_are_those_of_newtons_method() {
    let pack = dense(8, 8, 2, 1e5, 0.6);
    let locked = scene("{rotation: locked, friction: {coefficient: 0.6}}", "");
    comes_to_newtons(&locked, &pack, &biaxial(&pack), 10.0, 10.0);
    let mut ring = loose(8, 8, 2, 0.0);
    let [x, y, _] = ring.bounds.center();
    let half = 0.5 * ring.bounds.sides()[0];
    ring.grains.iter_mut().for_each(|grain| {
        grain.position[0] -= x;
        grain.position[1] -= y;
    });
    ring.grains.retain(|grain| {
        let far = grain.position[0].hypot(grain.position[1]);
        far + grain.radius < half && far - grain.radius > 0.3 * half
    });
    ring.bounds = boxed([-half; 2], [half; 2]);
    let annulus = format!(
        "friction: 0.3, cell: {{annulus: {{inner: {:e}}}}}, targets: {{x_max: {{stress: 1.0e5}}}}",
        0.3 * half
    );
    let scene = with_walls(&annulus, SAND);
    let (mut rig, _) = Rig::new(&with_walls(&annulus, "{friction: none}"), &ring);
    let press =
        |outer: f64| Ask::Targets([Keep, WallTarget::Stress(outer), Keep, Keep, Keep, Keep]);
    rig.go(press(1e5));
    let mut settled = rig.twin.pack();
    settled.grains.iter_mut().for_each(|grain| grain.friction = 0.6);
    comes_to_newtons(&scene, &settled, &[press(1e5), press(1.02e5)], 20.0, 20.0);
}

#[test]
fn bonds_break_in_the_order_in_which_they_do_by_newtons_method() {
    let file = Path::new("scene.yaml");
    let scene = scene::parse(
        "dimension: 2\n\
         materials: {stone: {young: 2.32e9, poisson: 0.16, density: 2650.0}}\n\
         pack: {crystal: {rows: 9, columns: [4, 5], radius: 0.1e-3, material: stone}}\n\
         walls: {friction: 0.0}\n\
         contact: {normal: {linear: {stiffness: 1.0e6, bond: {cohesion: 5.0e6, along_x: 0.9}}}, \
         friction: {coefficient: 0.6}}\n\
         solver: {max_overlap_share: 100.0}",
        file,
    )
    .unwrap();
    let mut pack = pack::build(&Loaded { scene: scene.clone(), file: file.into() }).unwrap();
    // Unlike each other, so that no two bonds are as near to breaking.
    for (k, grain) in pack.grains.iter_mut().enumerate() {
        grain.radius *= 1.0 + 1e-4 * (1.7 * k as f64).sin().powi(2);
    }
    let height = pack.bounds.sides()[1];
    let cracks = |scene: &Scene| {
        let (mut rig, _) = Rig::new(scene, &pack);
        let start = rig.stress([5e5; 2]).walls.displacement;
        let mut order = Vec::new();
        for k in 1..=40 {
            let way = 0.5 * 5e-4 * f64::from(k) * height;
            let [low, high] = [2, 3].map(|side| WallTarget::Displacement(start[side] + way));
            let x = WallTarget::Stress(5e5);
            let measures = rig.go(Ask::Targets([x, x, low, high, Keep, Keep]));
            let list = measures.cracks.unwrap().list;
            order.extend(list.iter().map(|crack| (k, crack.first, crack.second, crack.mode)));
            if order.len() >= 4 {
                break;
            }
        }
        order
    };
    let want = cracks(&by_newton(&scene));
    let got = cracks(&by_motion(&scene, 1e-9));
    assert!(want.len() >= 4 && want[..4] == got[..4], "{want:?} {got:?}");
}

#[test]
fn a_loose_pack_is_pressed_until_it_holds() {
    let scene = by_motion(&sand("none"), 1e-7);
    let (mut rig, _) = Rig::new(&scene, &loose(6, 8, 1, 0.0));
    let state = rig.stress([1e5; 2]).state.unwrap();
    assert!((state.stress_walls[0] / 1e5 - 1.0).abs() < 1e-6);
    assert!((state.stress_walls[4] / 1e5 - 1.0).abs() < 1e-6);
    assert!(state.coordination_number > 3.4, "{}", state.coordination_number);
}

#[test]
fn a_pack_that_its_walls_let_go_carries_nothing() {
    let pack = dense(6, 6, 4, 1e5, 0.6);
    for friction in ["none", "0.6"] {
        let (mut rig, _) = Rig::new(&by_motion(&sand(friction), 1e-6), &pack);
        let out = |k: u32| WallTarget::Displacement(-4e-3 * f64::from(k) * RADIUS);
        let mut last = None;
        for k in 1..=10 {
            last = Some(rig.go(Ask::Targets([out(k), out(k), out(k), out(k), Keep, Keep])));
        }
        assert_eq!(last.unwrap().walls.normal_force, [0.0; 6], "{friction}");
    }
}

#[test]
fn too_few_steps_end_in_an_error_that_leaves_the_state() {
    let pack = dense(6, 6, 4, 1e5, 0.6);
    let mut scene = by_motion(&sand("0.6"), 1e-8);
    scene.solver.max_iterations = Some(3);
    let (mut rig, _) = Rig::new(&scene, &pack);
    let before = format!("{:?}", rig.twin.pack());
    let way = WallTarget::Displacement(1e-2 * RADIUS);
    let report = rig.ask(Ask::Targets([Keep, Keep, way, way, Keep, Keep]));
    assert_eq!(report.disposition, Disposition::NotConverged, "{}", report.text);
    assert!(report.text.contains("no equilibrium in 3 iterations"), "{}", report.text);
    assert_eq!(format!("{:?}", rig.twin.pack()), before);
}

#[test]
fn motion_is_the_same_in_every_run_and_on_any_number_of_threads() {
    for friction in ["none", "0.6"] {
        let scene = by_motion(&sand(friction), 1e-6);
        let one = threads::test(&scene, 1, 2);
        for threads in [1, 2, 7] {
            assert!(threads::test(&scene, threads, 2) == one, "{friction} {threads} threads");
        }
    }
}

#[test]
fn a_biaxial_test_with_events_accounts_for_its_energy() {
    let pack = dense(8, 20, 1, 1e5, 0.6);
    let height = pack.bounds.sides()[1];
    let (mut rig, _) = Rig::new(&by_motion(&sand("0.6"), 1e-6), &pack);
    let (mut peak, mut last) = (0.0_f64, None);
    for k in 1..=80 {
        let state = rig.biaxial(1e5, 0.5 * 2e-4 * f64::from(k) * height).state.unwrap();
        peak = peak.max(state.stress_walls[4] / 1e5);
        last = Some(state);
    }
    let state = last.unwrap();
    let told = state.slip_energy + state.renewal_energy + state.event_energy;
    let off = (state.dissipated_energy - told) / state.dissipated_energy;
    assert!(peak > 2.0, "{peak}");
    assert!(state.event_energy > 0.0 && off.abs() < 0.03, "{off}");
}

#[test]
fn scenes_of_discs_have_motion_and_refuse_what_discs_have_not() {
    let of = |text: &str| {
        let text = format!("dimension: 2\npack: {{file: none.csv}}\n{text}");
        graintwin::scene::parse(&text, "motion.yaml".as_ref())
    };
    let glued = of("walls: {friction: .inf, glue: true}\nsolver: {method: dynamic, damping: 0.5}");
    let solver = glued.unwrap().solver;
    assert_eq!((solver.method, solver.damping), (Method::Dynamic, 0.5));
    for (text, why) in [
        ("solver: {method: conjugate_gradient}", "allowed in the plane: newton, gauss_seidel, dyn"),
        ("solver: {method: dynamic, damping: 1.0}", "0 < damping < 1"),
        ("solver: {method: dynamic, sweeps: 20}", "counts the sweeps of another method"),
    ] {
        let refused = of(text).unwrap_err().to_string();
        assert!(refused.contains(why), "{refused}");
    }
}

//! Membranes around packs of spheres.

use std::f64::consts::PI;
use std::sync::OnceLock;

use graintwin::Vec3;
use graintwin::command::Disposition;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::relax::Workspace;
use graintwin::report::{Measures, PackState};
use graintwin::scene::{self, Cell, Cylinder, Generate, Scene, Solver, Walls};
use graintwin::state::State;
use graintwin::wall::{Bounds, WallTarget};

use crate::packs::{GLASS, Rig, bead, bits, close, recipe, state};
use crate::slopes::{along, vectors};

const KEEP: WallTarget = WallTarget::Keep;
pub(crate) const R: f64 = 1e-4;
pub(crate) const ROUGH: &str = "contact: {friction: {coefficient: 0.4}}";

fn scene_of(walls: &str, rest: &str) -> Scene {
    let text = format!("pack: {{file: none.csv}}\nwalls: {{{walls}}}\n{rest}\n");
    scene::parse(&text, "membranes.yaml".as_ref()).unwrap()
}

pub(crate) fn round_scene(pressure: f64, rest: &str) -> Scene {
    let walls = format!(
        "cell: {{cylinder: {{}}}}, friction: 0.0, membranes: [x_max], \
         targets: {{x_max: {{stress: {pressure:e}}}}}"
    );
    scene_of(&walls, &format!("solver: {{tolerance: 1.0e-10}}\n{rest}"))
}

/// Membranes on two faces of a box.
pub(crate) fn flat(pressure: f64) -> Scene {
    let targets = ["y_min", "y_max"].map(|side| format!("{side}: {{stress: {pressure:e}}}"));
    scene_of(&format!("membranes: [y_min, y_max], targets: {{{}}}", targets.join(", ")), ROUGH)
}

pub(crate) fn round() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| {
        let walls = Walls { cell: Cell::Cylinder(Cylinder::default()), ..Walls::default() };
        let recipe = Generate { aspect: [1.0, 1.0, 1.5], ..recipe(300, 2e6, 5) };
        let mut pack = generate(&recipe, &GLASS, &walls, 0.0, Solver::default()).unwrap();
        pack.grains.iter_mut().for_each(|grain| grain.friction = 0.4);
        pack
    })
}

/// A cubic lattice of beads whose contacts overlap a little.
pub(crate) fn lattice(count: [usize; 3]) -> Pack {
    let pitch = 1.9995 * R;
    let [nx, ny, nz] = count;
    let grains = (0..nx * ny * nz).map(|k| {
        let at = [k % nx, k / nx % ny, k / (nx * ny)].map(|k| (k as f64 + 0.5) * pitch);
        bead(at, R)
    });
    let bounds = Bounds { min: [0.0; 3], max: count.map(|n| n as f64 * pitch) };
    Pack { bounds, grains: grains.collect(), history: None }
}

pub(crate) fn flat_scene(membranes: bool, pressure: f64) -> Scene {
    let what = if membranes { "membranes: [x_min, x_max], " } else { "" };
    let walls = format!(
        "friction: 0.0, {what}targets: {{x_min: {{stress: {pressure:e}}}, \
         x_max: {{stress: {pressure:e}}}}}"
    );
    scene_of(&walls, "solver: {tolerance: 1.0e-11}")
}

#[test]
fn the_pull_of_a_membrane_is_the_slope_of_its_potential() {
    let box_pack = {
        let mut pack =
            generate(&recipe(150, 2e6, 7), &GLASS, &Walls::default(), 0.0, Solver::default())
                .unwrap();
        pack.grains.iter_mut().for_each(|grain| grain.friction = 0.4);
        pack
    };
    for (scene, pack) in [(round_scene(2e6, ROUGH), round()), (flat(2e6), &box_pack)] {
        let model = Model::new(pack, &scene);
        let mut state = State::new(&model);
        let mut work = Workspace::new(&model);
        work.wrap(&model, &mut state);
        work.start(&model, &state);
        let bounds = state.bounds(&model);
        let start = state.position.clone();
        work.evaluate(&model, &state, &bounds);
        let once = work.balance.gradient.clone();
        // Twice the pressure on the same surface: what is more is its pull.
        state.pressure = state.pressure.map(|pressure| 2.0 * pressure);
        work.start(&model, &state);
        work.evaluate(&model, &state, &bounds);
        let pull: Vec<Vec3> =
            work.balance.gradient.iter().zip(&once).map(|(two, one)| two - one).collect();
        let mut potential = |position: Vec<Vec3>| {
            let mut moved = state.clone();
            moved.position = position;
            work.evaluate(&model, &moved, &bounds);
            0.5 * work.balance.membrane_potential
        };
        let n = start.len();
        let step = 1e-2 * R;
        assert!(pull.iter().map(Vec3::norm).sum::<f64>() > 10.0 * 2e6 * R * R);
        for seed in 0..5 {
            let d = vectors(seed + 1, n);
            let mut difference = |step: f64| {
                0.5 * (potential(along(&start, &d, step)) - potential(along(&start, &d, -step)))
            };
            // p V is a polynomial of the third degree: two differences are exact.
            let slope = (8.0 * difference(step) - difference(2.0 * step)) / (6.0 * step);
            let want: f64 = pull.iter().zip(&d).map(|(g, d)| g.dot(d)).sum();
            let scale = 2e6 * R * R * (n as f64).sqrt();
            assert!((want - slope).abs() < 1e-9 * scale, "{want} {slope}");
        }
    }
}

#[test]
fn the_forces_of_a_membrane_add_up_to_the_pressure_on_its_edges() {
    // Around a cylinder they have no part across; along z they press on what the ends differ by, and the
    // force on a face is p times the face.
    let pack = lattice([4, 3, 5]);
    let scene = flat_scene(true, 1e6);
    let model = Model::new(&pack, &scene);
    let mut state = State::new(&model);
    let mut work = Workspace::new(&model);
    work.wrap(&model, &mut state);
    work.start(&model, &state);
    let mut free = state.clone();
    // Grains that do not touch: nothing but the membranes is left.
    let centre = Vec3::from(pack.bounds.center());
    free.position.iter_mut().for_each(|at| *at = centre + (*at - centre) * 1.001);
    let room = model.bounds(&[-2e-2 * R; 6]);
    work.evaluate(&model, &free, &room);
    assert_eq!(work.balance.sums.contacts, 0);
    let [_, y, z] = pack.bounds.sides();
    let sum = |sign: f64| -> Vec3 {
        let pulls = work.balance.gradient.iter().zip(&free.position);
        pulls.filter(|(_, at)| (at.x - centre.x) * sign > 0.0).map(|(g, _)| *g).sum()
    };
    for sign in [1.0, -1.0] {
        let sum = sum(sign);
        close("face", sum.x, sign * 1e6 * y * z, 1e-9);
        assert!(sum.y.abs() + sum.z.abs() < 1e-9 * sum.x.abs(), "{sum}");
    }
}

#[test]
fn on_a_straight_face_a_membrane_is_a_wall_under_the_same_stress() {
    // One grain takes all of the face.
    let pack = lattice([5, 1, 1]);
    let run = |membranes: bool| {
        let (mut rig, report) = Rig::start(&flat_scene(membranes, 1e6), &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let down = WallTarget::Displacement(2e-9);
        rig.take([KEEP, KEEP, KEEP, KEEP, down, down])
    };
    let (with, without) = (run(true), run(false));
    let [one, other] = [&with, &without].map(|m| &m.grains.as_ref().unwrap().position);
    for (one, other) in one.iter().zip(other) {
        for axis in 0..3 {
            let far = (one[axis] - other[axis]).abs();
            assert!(far < 2e-7 * R, "{far:e}");
        }
    }
    for w in 0..6 {
        let [one, other] = [&with, &without].map(|m| m.walls.normal_force[w]);
        assert!((one / other - 1.0).abs() < 1e-4, "{w}: {one:e} {other:e}");
    }
    close("stress", state(&with).stress_walls[0], 1e6, 1e-12);
}

fn lost(state: &PackState) -> f64 {
    state.slip_energy + state.renewal_energy + state.event_energy
}

/// From isotropic, platens in by steps of `step` \[m\].
fn sheared(pack: &Pack, steps: u32, step: f64) -> Vec<Measures> {
    let (mut rig, report) = Rig::start(&round_scene(2e6, ROUGH), pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let mut all = vec![report.measures.unwrap()];
    for k in 1..=steps {
        let down = WallTarget::Displacement(step * f64::from(k));
        all.push(rig.take([KEEP, KEEP, KEEP, KEEP, down, down]));
    }
    all
}

#[test]
fn a_membrane_holds_a_round_pack() {
    let all = sheared(round(), 10, 2e-8);
    let [first, last] = [&all[0], &all[all.len() - 1]].map(state);
    for measures in &all {
        let found = state(measures);
        close("p", found.stress_walls[0], 2e6, 1e-12);
        // The contacts bear p over the volume inside of the surface, but for what that was before it was
        // found anew.
        let across = 0.5 * (found.stress_contacts[0] + found.stress_contacts[4]);
        close("across", across, 2e6, 1e-7);
    }
    let rise = last.deviatoric_stress - first.deviatoric_stress;
    assert!(rise > 2e5, "{rise}");
    // The platens stood while the pack slid into its membrane.
    assert!(first.deviatoric_stress.abs() < 1e6, "{}", first.deviatoric_stress);
    assert!(first.strain.iter().all(|strain| strain.abs() < 1e-5));
    // Work of platens and pressure is what is stored and lost.
    let worked = last.wall_work - first.wall_work;
    let kept = last.stored_energy - first.stored_energy + lost(&last) - lost(&first);
    assert!((worked - kept).abs() < 2e-3 * worked.abs(), "{worked:e} {kept:e}");
}

#[test]
fn turned_about_the_axis_it_does_the_same() {
    let (sin, cos) = 0.9_f64.sin_cos();
    let mut turned = round().clone();
    for grain in &mut turned.grains {
        let [x, y, z] = grain.position;
        grain.position = [cos * x - sin * y, sin * x + cos * y, z];
    }
    let [one, other] = [round(), &turned].map(|pack| sheared(pack, 2, 2e-8));
    for (one, other) in one.iter().zip(&other) {
        for w in [1, 4, 5] {
            let [f, g] = [one, other].map(|m| m.walls.normal_force[w]);
            assert!((f / g - 1.0).abs() < 1e-7, "{w}: {f} {g}");
        }
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let run = |threads: usize| {
        let (mut rig, _) = Rig::start_on(&round_scene(2e6, ROUGH), round(), threads);
        let down = WallTarget::Displacement(3e-8);
        rig.take([KEEP, WallTarget::Stress(2.1e6), KEEP, KEEP, down, down]);
        bits(&rig.twin.pack())
    };
    let one = run(1);
    assert!([2, 3].iter().all(|&threads| run(threads) == one));
}

/// Spheres in a ring.
const COUNT: usize = 12;

/// sin(π/n) of a ring.
fn half() -> f64 {
    (PI / COUNT as f64).sin()
}

/// A ring between an inner wall and a membrane.
pub(crate) fn ring(rest: &str) -> (Pack, Scene) {
    let at = 0.9998 * R / half();
    let grains = (0..COUNT).map(|k| {
        let (sin, cos) = (2.0 * PI * k as f64 / COUNT as f64).sin_cos();
        bead([at * cos, at * sin, 0.0], R)
    });
    let outer = at + R;
    let max = [outer, outer, 0.99999 * R];
    let pack = Pack {
        bounds: Bounds { min: max.map(|x| -x), max },
        grains: grains.collect(),
        history: None,
    };
    let walls = format!(
        "cell: {{cylinder: {{inner: {:e}}}}}, membranes: [x_max], targets: {{x_max: {{stress: 1.0e6}}}}",
        at - 1.0002 * R
    );
    (pack, scene_of(&walls, &format!("solver: {{tolerance: 1.0e-11}}\n{rest}")))
}

#[test]
fn a_ring_of_spheres_carries_its_membrane() {
    let (pack, scene) = ring("");
    let half = half();
    let [_, _, height] = pack.bounds.sides();
    let (_, report) = Rig::start(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let measures = report.measures.unwrap();
    let network = measures.network.as_ref().unwrap();
    let grain = network.second.iter().position(|&second| (second as usize) < COUNT).unwrap();
    let force = network.normal_force[grain];
    let wall = measures.walls.normal_force[0] / COUNT as f64;
    for place in &measures.grains.as_ref().unwrap().position {
        // The pressure on the halves of the faces beside a grain.
        let distance = place[0].hypot(place[1]);
        let face = 2.0 * distance * half * height;
        let out = 1e6 * face * (PI / COUNT as f64).cos();
        close("f", 2.0 * half * force + wall, out, 1e-8);
    }
}

#[test]
fn what_is_no_order_for_a_membrane_is_refused() {
    let (mut rig, _) = Rig::start(&round_scene(2e6, ROUGH), round());
    for target in [WallTarget::Force(1.0), WallTarget::Displacement(1e-7)] {
        let report = rig.aim([KEEP, target, KEEP, KEEP, KEEP, KEEP]);
        assert_eq!(report.disposition, Disposition::Invalid);
        assert!(report.text.contains("x_max is a membrane"), "{}", report.text);
    }
    let refused = |walls: &str, rest: &str| {
        let text = format!("pack: {{file: none.csv}}\nwalls: {{{walls}}}\n{rest}\n");
        scene::parse(&text, "membranes.yaml".as_ref()).unwrap_err().to_string()
    };
    let pressed = "x_min: {stress: 1.0e6}, x_max: {stress: 1.0e6}, y_max: {stress: 1.0e6}";
    for (walls, rest, field) in [
        ("membranes: [x_max]", "", "walls.targets.x_max"),
        ("membranes: [x_max], targets: {x_max: {displacement: 0.0}}", "", "walls.targets.x_max"),
        ("membranes: [z_max], targets: {z_max: {stress: 1.0e6}}", "", "walls.membranes[0]"),
        (&format!("membranes: [x_max, y_max], targets: {{{pressed}}}"), "", "walls.membranes[1]"),
        (
            &format!(
                "membranes: [x_min], cell: {{cylinder: {{inner: 1.0}}}}, targets: {{{pressed}}}"
            ),
            "",
            "walls.membranes[0]",
        ),
        (
            "membranes: [x_max], targets: {x_max: {stress: 1.0e6}}",
            "solver: {method: conjugate_gradient}",
            "solver.method",
        ),
    ] {
        let text = refused(walls, rest);
        assert!(text.contains(field), "{walls} {rest}: {text}");
    }
}

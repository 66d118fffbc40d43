//! Packs of spheres in a cylinder, and between two.

use std::f64::consts::PI;
use std::sync::OnceLock;

use graintwin::command::Disposition;
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::scene::{self, Cell, Cylinder, Generate, Scene, Solver, Walls};
use graintwin::wall::{self, Bounds, WallTarget};
use rayon::ThreadPoolBuilder;

use crate::packs::{E_GRAINS, E_WALL, GLASS, Rig, bead, bits, close, recipe, state};

pub(crate) const KEEP: WallTarget = WallTarget::Keep;
/// Radius of the inner wall of packs that have one \[m\].
pub(crate) const HOLE: f64 = 3e-4;

pub(crate) fn walls_with(inner: Option<f64>) -> Walls {
    Walls { cell: Cell::Cylinder(Cylinder { inner }), ..Walls::default() }
}

fn made_of(grains: usize, inner: Option<f64>) -> Pack {
    let recipe = Generate { aspect: [1.0, 1.0, 1.5], ..recipe(grains, 1e7, 3) };
    generate(&recipe, &GLASS, &walls_with(inner), 0.0, Solver::default()).unwrap()
}

pub(crate) fn solid() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made_of(200, None))
}

pub(crate) fn hollow() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made_of(250, Some(HOLE)))
}

/// A scene in a cylinder, `inner` as in the file, with `rest` besides.
pub(crate) fn scene_in(inner: Option<f64>, walls: &str, rest: &str) -> Scene {
    let inner = inner.map_or(String::new(), |inner| format!("inner: {inner:e}"));
    let text = format!(
        "pack: {{file: none.csv}}\nwalls: {{cell: {{cylinder: {{{inner}}}}}{walls}}}\n\
         solver: {{tolerance: 1.0e-11}}\n{rest}\n"
    );
    scene::parse(&text, "cylinder.yaml".as_ref()).unwrap()
}

/// Loads of the inner wall, the outer wall and both ends.
fn loads(inner: WallTarget, outer: f64, ends: f64) -> [WallTarget; wall::COUNT] {
    let [outer, ends] = [outer, ends].map(WallTarget::Stress);
    [inner, outer, KEEP, KEEP, ends, ends]
}

#[test]
fn a_ring_of_spheres_under_pressure_shrinks_as_its_contacts_do() {
    const COUNT: usize = 12;
    const R: f64 = 1e-4;
    let half = (PI / COUNT as f64).sin();
    let at = 0.9995 * R / half;
    let grains = (0..COUNT).map(|k| {
        let (sin, cos) = (2.0 * PI * k as f64 / COUNT as f64).sin_cos();
        bead([at * cos, at * sin, 0.0], R)
    });
    let outer = at + 0.9995 * R;
    let max = [outer, outer, 0.9999 * R];
    let pack = Pack {
        bounds: Bounds { min: max.map(|x| -x), max },
        grains: grains.collect(),
        history: None,
    };
    let (mut rig, report) = Rig::start(&scene_in(None, "", ""), &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let stress = 1e6;
    let measures = rig.take([KEEP, WallTarget::Stress(stress), KEEP, KEEP, KEEP, KEEP]);
    let radius = outer - measures.walls.displacement[1];
    let height = 2.0 * max[2];
    // N of the wall on a sphere is 2 f sin(π/n) of its neighbours.
    let wall = stress * 2.0 * PI * radius * height / COUNT as f64;
    let force = wall / (2.0 * half);
    let modulus = |e_star: f64, radius: f64| 4.0 / 3.0 * e_star * radius.sqrt();
    let around = R / (1.0 - R / outer);
    let overlap = |force: f64, modulus: f64| (force / modulus).powf(2.0 / 3.0);
    let between = overlap(force, modulus(E_GRAINS, 0.5 * R));
    let outside = overlap(wall, modulus(E_WALL, (R * around).sqrt()));
    let want = (R - 0.5 * between) / half + R - outside;
    close("R", radius, want, 1e-10);
    close("N", measures.walls.normal_force[1], COUNT as f64 * wall, 1e-9);
    let state = state(&measures);
    for k in [0, 4] {
        close("P", state.stress_walls[k], stress, 1e-9);
        close("strain", state.strain[k / 4], 1.0 - radius / outer, 1e-9);
    }
    let ends = measures.walls.normal_force[4];
    close("ends", state.stress_walls[8], ends / (PI * radius * radius), 1e-9);
    let caps = COUNT as f64 * 4.0 / 3.0 * PI * R.powi(3);
    let porosity = 1.0 - caps / (PI * radius * radius * height);
    assert!((state.porosity - porosity).abs() < 1e-4, "{} {porosity}", state.porosity);
    assert!(measures.walls.force[1].iter().all(|f| f.abs() < 1e-9 * COUNT as f64 * wall));
}

#[test]
fn mean_stress_of_the_contacts_is_that_of_the_walls() {
    // Across: 2 σ V = Σ over the walls of normal force times radius, outwards.
    let smooth = ", friction: 0.0";
    let (mut rig, _) = Rig::start(&scene_in(None, smooth, FRICTION), &rough(solid()));
    let measures = rig.take(loads(KEEP, 9.5e6, 1.1e7));
    let found = state(&measures);
    let across = 0.5 * (found.stress_contacts[0] + found.stress_contacts[4]);
    close("across", across, 9.5e6, 1e-9);
    close("along", found.stress_contacts[8], 1.1e7, 1e-9);
    close("walls", found.confining_stress, 1e7, 1e-9);
    close("deviator", found.deviatoric_stress, 1.5e6, 1e-8);

    let (mut rig, _) = Rig::start(&scene_in(Some(HOLE), smooth, FRICTION), &rough(hollow()));
    let outer = 0.5 * hollow().bounds.sides()[0];
    for inside in [WallTarget::Stress(9e6), WallTarget::Displacement(2e-7)] {
        let measures = rig.take(loads(inside, 1e7, 1.1e7));
        let moved = measures.walls.displacement;
        let (a, b) = (HOLE + moved[0], outer - moved[1]);
        let height = hollow().bounds.sides()[2] - moved[4] - moved[5];
        let on_hole = measures.walls.normal_force[0] / (2.0 * PI * a * height);
        if inside == WallTarget::Stress(9e6) {
            close("hole", on_hole, 9e6, 1e-9);
        }
        let want = (1e7 * b * b - on_hole * a * a) / (b * b - a * a);
        let found = state(&measures);
        let across = 0.5 * (found.stress_contacts[0] + found.stress_contacts[4]);
        close("across", across, want, 1e-8);
        close("along", found.stress_contacts[8], 1.1e7, 1e-9);
        close("outer wall", found.stress_walls[0], 1e7, 1e-9);
        let ends = measures.walls.normal_force[5] / (PI * (b * b - a * a));
        close("ends", ends, 1.1e7, 1e-9);
    }
}

fn turned(pack: &Pack, angle: f64) -> Pack {
    let (sin, cos) = angle.sin_cos();
    let mut turned = pack.clone();
    for grain in &mut turned.grains {
        let [x, y, z] = grain.position;
        grain.position = [cos * x - sin * y, sin * x + cos * y, z];
    }
    turned
}

/// With friction 0.3 between all bodies.
fn rough(pack: &Pack) -> Pack {
    let mut pack = pack.clone();
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.3);
    pack
}

const FRICTION: &str = "contact: {friction: {coefficient: 0.3}}";

#[test]
fn a_pack_that_is_turned_about_the_axis_does_the_same() {
    for (pack, inner) in [(solid(), None), (hollow(), Some(HOLE))] {
        let run = |angle: f64| {
            let scene = scene_in(inner, "", FRICTION);
            let (mut rig, _) = Rig::start(&scene, &turned(&rough(pack), angle));
            let mut all = Vec::new();
            for k in 1..=4 {
                let down = WallTarget::Displacement(1e-7 * f64::from(k));
                let outer = WallTarget::Stress(1e7);
                all.push(rig.take([KEEP, outer, KEEP, KEEP, down, down]));
            }
            all
        };
        let [one, other] = [0.0, 0.7].map(run);
        for (one, other) in one.iter().zip(&other) {
            for w in [0, 1, 4, 5] {
                let [f, g] = [one, other].map(|m| m.walls.normal_force[w]);
                assert!((f - g).abs() <= 1e-9 * one.walls.normal_force[1], "{w}: {f} {g}");
            }
            let [a, b] = [one, other].map(state);
            assert_eq!(a.sliding_ratio, b.sliding_ratio);
            assert!((a.shear_energy - b.shear_energy).abs() < 1e-9 * a.stored_energy);
            close("stored", a.stored_energy, b.stored_energy, 1e-9);
            close("radius", one.walls.displacement[1], other.walls.displacement[1], 1e-6);
        }
    }
}

#[test]
fn work_of_the_walls_is_stored() {
    let scene = scene_in(Some(HOLE), ", friction: 0.0", "");
    let (mut rig, first) = Rig::start(&scene, hollow());
    let mut last = first.measures.unwrap();
    let first = state(&last);
    let mut event = 0.0;
    for k in 1..=20 {
        let part = f64::from(k);
        let [hole, ends] = [2e-8, 1e-8].map(|step| WallTarget::Displacement(step * part));
        let outer = WallTarget::Stress(1e7 * (1.0 + 0.005 * part));
        last = rig.take([hole, outer, KEEP, KEEP, ends, ends]);
        event = state(&last).event_energy;
    }
    let last = state(&last);
    let [worked, stored] =
        [last.wall_work - first.wall_work, last.stored_energy - first.stored_energy];
    assert!(worked > 0.05 * first.stored_energy);
    assert!((worked - stored - event).abs() < 1e-4 * worked, "{worked:e} {stored:e} {event:e}");
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    let run = |threads: usize| {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let pack = pool.install(|| made_of(300, Some(HOLE)));
        let scene = scene_in(Some(HOLE), "", FRICTION);
        let (mut rig, _) = Rig::start_on(&scene, &rough(&pack), threads);
        let down = WallTarget::Displacement(2e-7);
        let outer = WallTarget::Stress(1.1e7);
        let measures = rig.take([KEEP, outer, KEEP, KEEP, down, down]);
        let force = measures.walls.normal_force.map(f64::to_bits);
        (bits(&pack), bits(&rig.twin.pack()), force)
    };
    let one = run(1);
    assert!([2, 3].iter().all(|&threads| run(threads) == one));
}

#[test]
fn a_pack_that_is_made_is_at_the_stress_asked_for_and_rests() {
    for (pack, inner) in [(solid(), None), (hollow(), Some(HOLE))] {
        let mut scene = scene_in(inner, ", friction: 0.0", "");
        scene.solver = Solver::default();
        let (_, report) = Rig::start(&scene, pack);
        assert_eq!((report.disposition, report.text.as_str()), (Disposition::Applied, ""));
        let found = state(&report.measures.unwrap());
        for k in [0, 4, 8] {
            close("stress", found.stress_walls[k], 1e7, 1e-3);
        }
        let [x, y, z] = pack.bounds.sides();
        close("round", x, y, 1e-12);
        close("slender", z / x, 1.5, 0.2);
        let distance = |grain: &graintwin::pack::Grain| {
            grain.position[0].hypot(grain.position[1]) + grain.radius
        };
        assert!(pack.grains.iter().all(|grain| distance(grain) < 0.5 * x + 0.02 * grain.radius));
    }
}

#[test]
fn a_pack_is_cut_to_its_cylinder_and_prepared_in_it() {
    const INNER: f64 = 2e-4;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("cut.yaml");
    let cut = |inner: f64, prepare: &str| {
        let text = format!(
            "pack:\n  generate: {{grains: 800, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
             material: glass, seed: 1, confining_stress: 1.0e6, aspect: [1.0, 1.0, 1.5]}}\n  \
             cut: {{min: [-7.0e-4, -7.0e-4, -1.1e-3], max: [7.0e-4, 7.0e-4, 1.1e-3]}}\n{prepare}\
             walls: {{cell: {{cylinder: {{inner: {inner:e}}}}}}}\n"
        );
        std::fs::write(&file, text).unwrap();
        graintwin::pack::build(&scene::load(&file).unwrap()).unwrap()
    };
    let pack = cut(INNER, "");
    assert!(pack.grains.len() > 100, "{}", pack.grains.len());
    for grain in &pack.grains {
        let [x, y, z] = grain.position;
        let (from_axis, radius) = (x.hypot(y), grain.radius);
        assert!(from_axis + radius <= 7.0e-4 && from_axis - radius >= INNER);
        assert!(z.abs() + radius <= 1.1e-3);
    }
    let pack = cut(INNER, "  prepare: [{isotropic: {confining_stress: 1.0e6}}]\n");
    let [x, y, _] = pack.bounds.sides();
    close("round", x, y, 1e-12);
    let mut scene = scene_in(Some(INNER), ", friction: 0.0", "");
    scene.solver = Solver::default();
    let (_, report) = Rig::start(&scene, &pack);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    let found = state(&report.measures.unwrap());
    for k in [0, 4, 8] {
        close("stress", found.stress_walls[k], 1e6, 1e-3);
    }
}

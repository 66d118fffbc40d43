//! Cement in round cells: between grains, on cylinders and platens, and under membranes.

use std::f64::consts::PI;
use std::sync::OnceLock;

use graintwin::command::Disposition;
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::scene::{self, Cell, Cement, Cylinder, Generate, Normal, Scene, Solver, Walls};
use graintwin::wall::WallTarget;

use crate::cemented::{EXPONENTIAL, PARALLEL, breakable, cement};
use crate::packs::{GLASS, Rig, close, recipe, state};

const KEEP: WallTarget = WallTarget::Keep;
/// Radius of the inner wall \[m\].
const HOLE: f64 = 3e-4;

fn made(inner: Option<f64>, stress: f64) -> Pack {
    let walls = Walls { cell: Cell::Cylinder(Cylinder { inner }), ..Walls::default() };
    let recipe = Generate { aspect: [1.0, 1.0, 1.5], ..recipe(200, stress, 3) };
    generate(&recipe, &GLASS, &walls, 0.0, Solver::default()).unwrap()
}

fn hollow() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made(Some(HOLE), 1e7))
}

fn scene_of(walls: &str, cement: Cement) -> Scene {
    let text = format!(
        "pack: {{file: none.csv}}\nwalls: {{{walls}}}\nsolver: {{tolerance: 1.0e-10}}\n\
         contact: {{friction: {{coefficient: 0.4}}}}\n"
    );
    let mut scene = scene::parse(&text, "round.yaml".as_ref()).unwrap();
    scene.contact.normal = Normal::Cement(cement);
    scene
}

fn hollow_scene(cement: Cement) -> Scene {
    scene_of(&format!("cell: {{cylinder: {{inner: {HOLE:e}}}}}"), cement)
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

fn at(way: f64) -> WallTarget {
    WallTarget::Displacement(way)
}

#[test]
fn a_cemented_pack_that_is_turned_about_the_axis_does_the_same() {
    for law in [EXPONENTIAL, PARALLEL] {
        let run = |angle: f64| {
            let (mut rig, first) = Rig::start(&hollow_scene(cement(law)), &turned(hollow(), angle));
            assert_eq!(first.disposition, Disposition::Applied, "{}", first.text);
            let apart = rig.take([at(-1e-8), at(-3e-8), KEEP, KEEP, KEEP, KEEP]);
            let pressed = rig.take([at(1e-8), at(2e-8), KEEP, KEEP, at(3e-8), at(1e-8)]);
            [first.measures.unwrap(), apart, pressed]
        };
        let [one, other] = [0.0, 0.7].map(run);
        let scale = one[2].walls.normal_force[1].abs();
        for (one, other) in one.iter().zip(&other) {
            for w in [0, 1, 4, 5] {
                let [f, g] = [one, other].map(|m| m.walls.normal_force[w]);
                assert!((f - g).abs() < 1e-7 * scale, "{law:?} {w}: {f} {g}");
            }
        }
        // Walls that go apart pull at what is cemented to them.
        if law == EXPONENTIAL {
            assert!(one[1].walls.normal_force[0] < -0.01 * scale);
            assert!(one[1].walls.normal_force[1] < -0.01 * scale);
        }
    }
}

#[test]
fn mean_stress_of_cemented_contacts_is_that_of_smooth_walls() {
    for law in [EXPONENTIAL, PARALLEL] {
        let bare = Cement { walls: false, ..cement(law) };
        let walls = format!("friction: 0.0, cell: {{cylinder: {{inner: {HOLE:e}}}}}");
        let (mut rig, _) = Rig::start(&scene_of(&walls, bare), hollow());
        for outer in [4e-8, 6e-8] {
            let measures = rig.take([at(1e-8), at(outer), KEEP, KEEP, at(2e-8), at(2e-8)]);
            let told = &measures.walls;
            let outer = 0.5 * (told.position[1] - told.position[0]);
            let inner = HOLE + told.displacement[0];
            let height = told.position[5] - told.position[4];
            let volume = PI * (outer * outer - inner * inner) * height;
            let force = told.normal_force;
            // 2 σ V = Σ over the walls of normal force times radius, outwards; along z of the platens.
            let across = 0.5 * (force[1] * outer - force[0] * inner) / volume;
            let along = 0.5 * (force[4] + force[5]) * height / volume;
            let stress = state(&measures).stress_contacts;
            close("across", 0.5 * (stress[0] + stress[4]), across, 1e-7);
            close("along", stress[8], along, 1e-7);
            assert!(force[0] > 0.0 && across > 0.0);
        }
    }
}

#[test]
fn work_of_the_walls_is_stored_in_the_cement() {
    for law in [EXPONENTIAL, PARALLEL] {
        let (mut rig, first) = Rig::start(&hollow_scene(cement(law)), hollow());
        let first = state(&first.measures.unwrap());
        let mut last = first;
        for k in 1..=20 {
            let part = f64::from(k);
            let measures = rig.take([
                at(1e-9 * part),
                at(-2e-9 * part),
                KEEP,
                KEEP,
                at(1e-9 * part),
                at(5e-10 * part),
            ]);
            last = state(&measures);
        }
        let [worked, stored] =
            [last.wall_work - first.wall_work, last.stored_energy - first.stored_energy];
        let lost = last.slip_energy + last.renewal_energy + last.event_energy;
        assert!(stored.abs() > 0.0);
        assert!(
            (worked - stored - lost).abs() < 2e-3 * worked.abs().max(stored.abs()),
            "{law:?} {worked:e} {stored:e} {lost:e}"
        );
    }
}

#[test]
fn under_a_membrane_cement_carries_more_until_it_breaks() {
    let mut pack = made(None, 2e6);
    pack.grains.iter_mut().for_each(|grain| grain.friction = 0.4);
    let walls = "friction: 0.0, cell: {cylinder: {}}, membranes: [x_max], \
                 targets: {x_max: {stress: 2.0e6}}";
    // Platens that nothing sticks to do not help across.
    let inside = |cement: Cement| Normal::Cement(Cement { walls: false, ..cement });
    let sheared = |normal: Normal| {
        let mut scene = scene_of(walls, cement(PARALLEL));
        scene.contact.normal = normal;
        scene.solver.tolerance = 1e-8;
        let (mut rig, report) = Rig::start(&scene, &pack);
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        let before = state(&report.measures.unwrap());
        let mut cracks = None;
        let mut last = before;
        for k in 1..=4 {
            let down = at(5e-8 * f64::from(k));
            let measures = rig.take([KEEP, KEEP, KEEP, KEEP, down, down]);
            last = state(&measures);
            close("p", last.stress_walls[0], 2e6, 1e-12);
            let across = 0.5 * (last.stress_contacts[0] + last.stress_contacts[4]);
            close("across", across, 2e6, 1e-5);
            cracks = measures.cracks;
        }
        let broken = cracks.map_or(0.0, |cracks| {
            f64::from(cracks.tension + cracks.shear) / f64::from(cracks.bonds())
        });
        (last.deviatoric_stress - before.deviatoric_stress, broken)
    };
    let (bare, _) = sheared(Normal::Hertz);
    let (stiff, _) = sheared(inside(cement(EXPONENTIAL)));
    let (whole, none) = sheared(inside(cement(PARALLEL)));
    let (brittle, broken) = sheared(inside(breakable(PARALLEL, 1e11, 2e11)));
    assert_eq!(none, 0.0);
    assert!(whole > 1.2 * bare && stiff > 1.2 * bare, "{whole:e} {stiff:e} {bare:e}");
    assert!(
        broken > 0.0 && broken < 0.5 && (bare..whole).contains(&brittle),
        "{broken} {brittle:e} {whole:e}"
    );
}

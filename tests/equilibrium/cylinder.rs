//! Packs of spheres in a cylinder, and between two.

use std::f64::consts::PI;
use std::sync::OnceLock;

use graintwin::Vec3;
use graintwin::command::{Ask, Command, Disposition};
use graintwin::contact::hertz;
use graintwin::contact::neighbours::Neighbours;
use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::pack::generate::generate;
use graintwin::relax::balance::{Balance, Configuration};
use graintwin::relax::tangential::Reference;
use graintwin::report::{Demand, Measures, Report};
use graintwin::scene::{self, Cell, Cylinder, Generate, Scene, Solver, Walls};
use graintwin::twin::{Twin, TwinError};
use graintwin::wall::{self, Bounds, WallTarget};
use rayon::ThreadPoolBuilder;

use crate::packs::{E_GRAINS, E_WALL, GLASS, Rig, absolute, bead, bits, close, recipe, state};

const KEEP: WallTarget = WallTarget::Keep;
/// Radius of the inner wall of packs that have one \[m\].
const HOLE: f64 = 3e-4;

fn walls_with(inner: Option<f64>) -> Walls {
    Walls { cell: Cell::Cylinder(Cylinder { inner }), ..Walls::default() }
}

fn made_of(grains: usize, inner: Option<f64>) -> Pack {
    let recipe = Generate { aspect: [1.0, 1.0, 1.5], ..recipe(grains, 1e7, 3) };
    generate(&recipe, &GLASS, &walls_with(inner), 0.0, Solver::default()).unwrap()
}

fn solid() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made_of(200, None))
}

fn hollow() -> &'static Pack {
    static PACK: OnceLock<Pack> = OnceLock::new();
    PACK.get_or_init(|| made_of(250, Some(HOLE)))
}

/// A scene in a cylinder, `inner` as in the file, with `rest` besides.
fn scene_in(inner: Option<f64>, walls: &str, rest: &str) -> Scene {
    let inner = inner.map_or(String::new(), |inner| format!("inner: {inner:e}"));
    let text = format!(
        "pack: {{file: none.csv}}\nwalls: {{cell: {{cylinder: {{{inner}}}}}{walls}}}\n\
         solver: {{tolerance: 1.0e-11}}\n{rest}\n"
    );
    scene::parse(&text, "cylinder.yaml".as_ref()).unwrap()
}

fn ask(rig: &mut Rig, targets: [WallTarget; wall::COUNT]) -> Report {
    rig.sequence += 1;
    let ask = Ask::Targets(targets);
    rig.twin.apply(&Command { ask, ..absolute(rig.sequence, [0.0; 6]) }, Demand::ALL)
}

fn go(rig: &mut Rig, targets: [WallTarget; wall::COUNT]) -> Measures {
    let report = ask(rig, targets);
    assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
    report.measures.unwrap()
}

/// Loads of the inner wall, the outer wall and both ends.
fn loads(inner: WallTarget, outer: f64, ends: f64) -> [WallTarget; wall::COUNT] {
    let [outer, ends] = [outer, ends].map(WallTarget::Stress);
    [inner, outer, KEEP, KEEP, ends, ends]
}

/// Numbers between -1 and 1.
fn numbers(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

fn vectors(seed: u64, n: usize) -> Vec<Vec3> {
    numbers(seed, 3 * n).chunks(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect()
}

const REFERENCE: f64 = 3e5;

fn balance(model: &Model, at: &[Vec3], displacement: &[f64; 6]) -> (Balance, Neighbours) {
    let bounds = &model.bounds(displacement);
    let mut neighbours = Neighbours::default();
    neighbours.refresh(model, at, bounds);
    let mut balance = Balance::default();
    balance.evaluate(&Configuration {
        model,
        neighbours: &neighbours,
        position: at,
        rotation: &[],
        reference: &Reference::default(),
        carries: &vec![true; at.len()],
        bounds,
        reference_stiffness: REFERENCE,
    });
    (balance, neighbours)
}

/// H d of the linearisation \[N\] for d \[m\].
fn product(balance: &Balance, near: &Neighbours, d: &[Vec3]) -> Vec<Vec3> {
    let mut product = vec![Vec3::zeros(); d.len()];
    for i in 0..d.len() {
        let first = near.row(i).start;
        for link in &balance.links[first..first + balance.links_in_row[i] as usize] {
            let j = link.second as usize;
            let m = Vec3::from(link.m.map(f64::from));
            let relative = d[i] - d[j];
            let force = m * m.dot(&relative) - relative * f64::from(link.b);
            product[i] += force;
            product[j] -= force;
        }
        let [xx, yy, zz] = balance.wall_stiffness[i].map(f64::from);
        let xy = f64::from(balance.cross_stiffness(i));
        let v = d[i];
        product[i] += Vec3::new(xx * v.x + xy * v.y, xy * v.x + yy * v.y, zz * v.z);
    }
    product.into_iter().map(|p| p * REFERENCE).collect()
}

#[test]
fn forces_and_their_slope_are_derivatives_of_the_energy() {
    for (pack, inner) in [(solid(), None), (hollow(), Some(HOLE))] {
        let model = Model::with(pack, &walls_with(inner), [0.0; 3], Solver::default(), None);
        let n = model.len();
        let start: Vec<Vec3> = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
        let sums = balance(&model, &start, &[0.0; 6]).0.sums;
        let (overlap, force) = (sums.mean_overlap(), sums.mean_force());
        let pushed: Vec<Vec3> =
            start.iter().zip(vectors(5, n)).map(|(at, d)| at + d * (0.3 * overlap)).collect();
        let zero = [0.0; 6];
        let (here, near) = balance(&model, &pushed, &zero);
        let step = 1e-5 * overlap;
        for k in 0..3 {
            let d = vectors(11 + k, n);
            let moved = |sign: f64| -> Vec<Vec3> {
                pushed.iter().zip(&d).map(|(at, d)| at + d * (sign * step)).collect()
            };
            let [after, before] = [1.0, -1.0].map(|sign| balance(&model, &moved(sign), &zero).0);
            let slope = (after.sums.energy - before.sums.energy) / (2.0 * step);
            let want: f64 = here.gradient.iter().zip(&d).map(|(g, d)| g.dot(d)).sum();
            assert!((slope - want).abs() < 1e-7 * force * n as f64, "{slope} {want}");
            let stiffness = 1.5 * force / overlap;
            let off: f64 = (product(&here, &near, &d).iter().enumerate())
                .map(|(i, want)| {
                    let slope = (after.gradient[i] - before.gradient[i]) / (2.0 * step);
                    (want - slope).norm()
                })
                .sum();
            assert!(off < 1e-5 * stiffness * n as f64, "{off} {stiffness}");
        }
        // The force on a wall is what it does over its way.
        let carries = vec![true; n];
        let on_walls =
            walls::normal_forces_in(&model, &near, (&pushed, &carries), &model.bounds(&zero));
        for w in (0..6).filter(|w| ![2, 3].contains(w) && (*w > 0 || inner.is_some())) {
            let energy = |sign: f64| {
                let mut to = zero;
                to[w] = sign * step;
                balance(&model, &pushed, &to).0.sums.energy
            };
            let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
            assert!((slope / on_walls[w] - 1.0).abs() < 1e-7, "{w}: {slope} {}", on_walls[w]);
            assert!(slope > force);
        }
    }
}

/// Complete elliptic integrals K and E of the modulus e, by the arithmetic-geometric mean.
fn elliptic(e: f64) -> [f64; 2] {
    let (mut a, mut b, mut c) = (1.0, (1.0 - e * e).sqrt(), e);
    let (mut sum, mut power) = (0.5 * c * c, 0.5);
    while c.abs() > 1e-16 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
        sum += power * c * c;
    }
    let k = PI / (2.0 * a);
    [k, k * (1.0 - sum)]
}

/// What the force at a given approach is over 4/3 E* √√(R'R'') h^1.5, for the relative radii R' >= R''
/// (Johnson, Contact Mechanics, 4.28 and 4.26c).
fn elliptical(ratio: f64) -> f64 {
    let of = |e: f64| {
        let [k, big_e] = elliptic(e);
        let slender = 1.0 / (1.0 - e * e);
        (slender * big_e - k, k - big_e)
    };
    let (mut low, mut high) = (1e-6, 1.0 - 1e-9);
    for _ in 0..100 {
        let e = 0.5 * (low + high);
        let (x, y) = of(e);
        if x / y < ratio { low = e } else { high = e }
    }
    let e = 0.5 * (low + high);
    let [k, _] = elliptic(e);
    let (x, y) = of(e);
    let across = (1.0 - e * e).sqrt();
    let f1 = (4.0 / (PI * e * e) * across.powf(1.5) * (x * y).sqrt()).cbrt();
    let f2 = 2.0 / PI * across.sqrt() / f1 * k;
    f2.powf(-1.5)
}

#[test]
fn the_effective_radius_is_that_of_the_elliptical_contact() {
    let pack = Pack {
        bounds: Bounds { min: [-1e-3; 3], max: [1e-3; 3] },
        grains: vec![bead([6e-4, 0.0, 0.0], 1e-4), bead([-6e-4, 0.0, 0.0], 2e-4)],
        history: None,
    };
    let model = Model::with(&pack, &walls_with(Some(4e-4)), [0.0; 3], Solver::default(), None);
    for i in 0..2 {
        let r = model.radius[i];
        for (w, curvature) in [(0, 1.0 / 4e-4), (1, -1.0 / 1e-3)] {
            let around = r / (1.0 + r * curvature);
            let ratio = (around / r).max(r / around);
            let exact = (around * r).powf(0.25) * elliptical(ratio);
            let off = model.wall_radius(i, w).sqrt() / exact - 1.0;
            // Second order in the logarithm of the ratio, where a plane is off to the first.
            let log = ratio.ln();
            assert!(off.abs() < 0.025 * log * log, "{w} {r}: {off:e} {log}");
            let plane = r.sqrt() / exact - 1.0;
            assert!(off.abs() < 0.05 * plane.abs(), "{off:e} {plane:e}");
        }
        for w in 2..6 {
            assert_eq!(model.wall_radius(i, w), r);
        }
    }
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
    let measures = go(&mut rig, [KEEP, WallTarget::Stress(stress), KEEP, KEEP, KEEP, KEEP]);
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
    let measures = go(&mut rig, loads(KEEP, 9.5e6, 1.1e7));
    let found = state(&measures);
    let across = 0.5 * (found.stress_contacts[0] + found.stress_contacts[4]);
    close("across", across, 9.5e6, 1e-9);
    close("along", found.stress_contacts[8], 1.1e7, 1e-9);
    close("walls", found.confining_stress, 1e7, 1e-9);
    close("deviator", found.deviatoric_stress, 1.5e6, 1e-8);

    let (mut rig, _) = Rig::start(&scene_in(Some(HOLE), smooth, FRICTION), &rough(hollow()));
    let outer = 0.5 * hollow().bounds.sides()[0];
    for inside in [WallTarget::Stress(9e6), WallTarget::Displacement(2e-7)] {
        let measures = go(&mut rig, loads(inside, 1e7, 1.1e7));
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
                all.push(go(&mut rig, [KEEP, outer, KEEP, KEEP, down, down]));
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
        last = go(&mut rig, [hole, outer, KEEP, KEEP, ends, ends]);
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
        let measures = go(&mut rig, [KEEP, outer, KEEP, KEEP, down, down]);
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

/// A sphere on a rough wall that bends around it: what sticks rolls.
#[test]
fn a_sphere_that_sticks_to_the_outer_wall_resists_around_and_along() {
    const R: f64 = 1e-4;
    let outer = 1e-3;
    let modulus = 4.0 / 3.0 * E_WALL * (R / (1.0 - R / outer).sqrt()).sqrt();
    let wanted = hertz::stiffness(modulus, 1e-7) / 1.5;
    let pack = Pack {
        bounds: Bounds { min: [-outer; 3], max: [outer; 3] },
        grains: vec![bead([outer - R + 1e-7, 0.0, 0.0], R), bead([0.0, 0.0, 0.0], 1.2e-4)],
        history: None,
    };
    let model = Model::with(&pack, &walls_with(None), [0.0; 3], Solver::default(), None);
    let at: Vec<Vec3> = model.grains.iter().map(|g| Vec3::from(g.position)).collect();
    let (balance, _) = balance(&model, &at, &[0.0; 6]);
    let force = balance.gradient.iter().map(Vec3::norm).fold(0.0, f64::max);
    close("P", force, wanted * 1e-7, 1e-9);
}

#[test]
fn what_does_not_fit_a_cylinder_is_refused() {
    let oblong = Pack {
        bounds: Bounds { min: [-1e-3; 3], max: [1e-3, 1.1e-3, 1e-3] },
        grains: vec![bead([0.0; 3], 1e-4)],
        history: None,
    };
    let scene = scene_in(None, "", "");
    let refused = Twin::new(&scene, &oblong, 1).unwrap_err();
    assert!(matches!(&refused, TwinError::Cell(text) if text.contains("square")), "{refused}");
    let mut round = Pack { bounds: Bounds { min: [-1e-3; 3], max: [1e-3; 3] }, ..oblong };
    let wide = Twin::new(&scene_in(Some(2e-3), "", ""), &round, 1).unwrap_err().to_string();
    assert!(wide.contains("no less than the outer one"), "{wide}");
    let inside = Twin::new(&scene_in(Some(2e-4), "", ""), &round, 1).unwrap_err().to_string();
    assert!(inside.contains("grain 0 is"), "{inside}");
    round.grains[0].position = [8e-4, 8e-4, 0.0];
    let beyond = Twin::new(&scene, &round, 1).unwrap_err().to_string();
    assert!(beyond.contains("grain 0 is"), "{beyond}");

    let (mut rig, _) = Rig::start(&scene, solid());
    let way = WallTarget::Displacement(1e-7);
    for (w, name) in [(0, "x_min"), (2, "y_min"), (3, "y_max")] {
        let mut targets = [KEEP; 6];
        targets[w] = way;
        let report = ask(&mut rig, targets);
        assert_eq!(report.disposition, Disposition::Invalid);
        assert!(report.text.contains(name), "{}", report.text);
    }
    // The wall through its opposite.
    let outer = 0.5 * solid().bounds.sides()[0];
    let through = WallTarget::Displacement(1.1 * outer);
    let report = ask(&mut rig, [KEEP, through, KEEP, KEEP, KEEP, KEEP]);
    assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    let (mut rig, _) = Rig::start(&scene_in(Some(HOLE), "", ""), hollow());
    for w in 0..2 {
        let mut targets = [KEEP; 6];
        let room = 0.5 * hollow().bounds.sides()[0] - HOLE;
        targets[w] = WallTarget::Displacement(1.01 * room);
        let report = ask(&mut rig, targets);
        assert_eq!(report.disposition, Disposition::Limit, "{}", report.text);
    }
}

#[test]
fn scenes_that_a_cylinder_cannot_have_are_refused() {
    let refused = |walls: &str, rest: &str| {
        let text = format!("pack: {{file: none.csv}}\nwalls: {{{walls}}}\n{rest}\n");
        scene::parse(&text, "cylinder.yaml".as_ref()).unwrap_err().to_string()
    };
    let solid = "cell: {cylinder: {}}";
    for (walls, rest, field) in [
        ("open: [x_min]", "", "walls.open"),
        ("cell: {cylinder: {}}, open: [x_min]", "", "walls.open[0]"),
        ("cell: {cylinder: {inner: 1.0e-3}}, open: [x_max]", "", "walls.open[0]"),
        ("cell: {cylinder: {inner: -1.0}}", "", "walls.cell.cylinder.inner"),
        ("cell: {annulus: {inner: 1.0}}", "", "walls.cell"),
        (solid, "dimension: 2", "walls.cell"),
        ("cell: {cylinder: {}}, targets: {y_max: {stress: 1.0e6}}", "", "walls.targets.y_max"),
        ("cell: {cylinder: {}}, targets: {x_min: {stress: 1.0e6}}", "", "walls.targets.x_min"),
        (solid, "load_path: [{isotropic: {strain: 1.0e-3, increments: 2}}]", "load_path[0]"),
        (
            solid,
            "load_path: [{walls: {targets: {y_min: {displacement: 1.0e-6}}, increments: 2}}]",
            "load_path[0].walls.targets.y_min",
        ),
        (solid, "outputs: {moduli: tangent}", "outputs.moduli"),
        (solid, "contact: {normal: {cement: {law: linear}}}", "contact.normal"),
    ] {
        let text = refused(walls, rest);
        assert!(text.contains(field), "{walls} {rest}: {text}");
    }
}

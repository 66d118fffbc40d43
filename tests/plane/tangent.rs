//! Tangent moduli of discs against differences of equilibria that commands led to, closed forms, and what
//! must hold of them.

use graintwin::analytic::crystal::Crystal;
use graintwin::command::{Ask, Shear};
use graintwin::pack::Pack;
use graintwin::report::{Measures, Tangent, TangentModuli};
use graintwin::scene::{ModuliKind, Scene};
use graintwin::wall::WallTarget;
use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, SymmetricEigen};

use crate::discs::*;

/// Sides and tilt.
type Motion = SVector<f64, 5>;
type Stiff = SMatrix<f64, 5, 5>;

fn asking(walls: &str, contact: &str, rest: &str) -> Scene {
    let text = format!(
        "dimension: 2\npack: {{file: none.csv}}\nwalls: {{{walls}}}\ncontact: {contact}\n\
         solver: {{tolerance: 1.0e-11}}\noutputs: {{moduli: both}}\n{rest}\n"
    );
    graintwin::scene::parse(&text, "tangent.yaml".as_ref()).unwrap()
}

fn to(at: &Motion) -> Ask {
    let side = |w: usize| WallTarget::Displacement(at[w]);
    let targets = [side(0), side(1), side(2), side(3), WallTarget::Keep, WallTarget::Keep];
    Ask::Shear(Shear { tilt: at[4], targets })
}

/// A way of the sides, of which the last part is taken a little further or less far.
struct Way<'a> {
    scene: &'a Scene,
    pack: &'a Pack,
    path: Vec<Motion>,
}

impl Way<'_> {
    /// By strains and a tilt.
    fn strain(&mut self, x: f64, y: f64, tilt: f64) {
        let [w, h, _] = self.pack.bounds.sides();
        self.path.push(Motion::from([0.5 * x * w, 0.5 * x * w, 0.5 * y * h, 0.5 * y * h, tilt]));
    }

    /// The pack before the last part, and after it taken `more` further.
    fn went(&self, more: &Motion) -> (Measures, Measures) {
        let (mut rig, report) = Rig::new(self.scene, self.pack);
        let Some(mut before) = report.measures else { panic!("{}", report.text) };
        let (last, first) = self.path.split_last().unwrap();
        for part in first {
            before = rig.go(to(part));
        }
        let report = rig.ask(to(&(last + more)));
        assert_eq!(report.substeps, 1, "{}", report.text);
        (before, report.measures.unwrap())
    }

    fn end(&self) -> Measures {
        self.went(&Motion::zeros()).1
    }

    fn tangent(&self) -> Tangent {
        self.end().tangent.unwrap()
    }

    /// Differences of the forces on the boundary over motions of `step` \[m\] and 1000 times as much tilt.
    fn differences(&self, step: f64) -> Stiff {
        let middle = self.pack.bounds.center()[1];
        let columns: Vec<Motion> = (0..5)
            .map(|b| {
                let step = if b == 4 { 1e3 * step } else { step };
                let mut more = Motion::zeros();
                more[b] = step;
                let [low, high] = [-more, more].map(|more| {
                    let tilt = self.path.last().unwrap()[4] + more[4];
                    boundary_forces(&self.went(&more).1, tilt, middle)
                });
                (high - low) / (2.0 * step)
            })
            .collect();
        Stiff::from_columns(&columns)
    }

    /// dσ_l/dε_m by the definition, with `stiff`: the virial of the boundary forces over the volume, of a
    /// box that is upright.
    fn moduli(&self, stiff: &Stiff) -> Matrix3<f64> {
        let end = self.end();
        let position = end.walls.position;
        let (w, h) = (position[1] - position[0], position[3] - position[2]);
        let depth = self.pack.bounds.sides()[2];
        let force = boundary_forces(&end, 0.0, self.pack.bounds.center()[1]);
        let stress = |force: &Motion, w: f64, h: f64, tilt: f64| {
            let [xx, yy] = [0.5 * w * (force[0] + force[1]), 0.5 * h * (force[2] + force[3])];
            let moment = force[4];
            // Sides that lean: the y sides go along x with them, the stress is that of upright axes.
            [xx - tilt * moment, yy + tilt * moment, -moment].map(|of| of / (w * h * depth))
        };
        let step = 1e-6;
        Matrix3::from_fn(|l, m| {
            let [low, high] = [-step, step].map(|e| {
                let motion = match m {
                    0 => Motion::from([0.5 * w, 0.5 * w, 0.0, 0.0, 0.0]),
                    1 => Motion::from([0.0, 0.0, 0.5 * h, 0.5 * h, 0.0]),
                    _ => Motion::from([0.0, 0.0, 0.0, 0.0, -1.0]),
                } * e;
                let (w, h) = (w - motion[0] - motion[1], h - motion[2] - motion[3]);
                stress(&(force + stiff * motion), w, h, motion[4])[l]
            });
            (high - low) / (2.0 * step)
        })
    }
}

/// What the sides and the tilt feel, from the published forces and moments of the walls: a leaning side
/// turns about the point at the height `middle` of the start, a y side goes along the leaning ones.
fn boundary_forces(measures: &Measures, tilt: f64, middle: f64) -> Motion {
    let walls = &measures.walls;
    let [x, y] = [0, 2].map(|w| 0.5 * (walls.position[w] + walls.position[w + 1]));
    let mut forces = Motion::zeros();
    for w in 0..4 {
        let inward = if w % 2 == 0 { 1.0 } else { -1.0 };
        let [fx, fy, _] = walls.force[w];
        let at = walls.position[w];
        if w < 2 {
            forces[w] = -inward * fx;
            let moment = walls.moment[w][2] - ((at - x) * fy - (middle - y) * fx);
            forces[4] += moment / (1.0 + tilt * tilt);
        } else {
            forces[w] = -inward * (fy + tilt * fx);
            forces[4] -= fx * (at - middle);
        }
    }
    forces
}

fn off<const R: usize, const C: usize>(a: &SMatrix<f64, R, C>, b: &SMatrix<f64, R, C>) -> f64 {
    (a - b).abs().max() / b.abs().max()
}

fn relaxed(of: &TangentModuli) -> Matrix3<f64> {
    Matrix3::from_row_slice(&of.relaxed)
}

fn affine(of: &TangentModuli) -> Matrix3<f64> {
    Matrix3::from_row_slice(&of.affine)
}

fn on_walls(of: &TangentModuli) -> Matrix4<f64> {
    Matrix4::from_fn(|v, w| of.wall_stiffness[v][w])
}

fn sides(of: &Stiff) -> Matrix4<f64> {
    of.fixed_view::<4, 4>(0, 0).into()
}

const HERTZ: &str = "{friction: {coefficient: 0.3}}";
const LOCKED: &str = "{friction: {coefficient: 0.3}, rotation: locked}";
const LINEAR: &str = "{friction: {coefficient: 0.3}, normal: {linear: {stiffness: 3.0e5}}}";
const BONDED: &str = "{friction: {coefficient: 0.3}, normal: {linear: {stiffness: 3.0e5, \
                      bond: {cohesion: .inf}}}}";

#[test]
fn they_are_the_differences_of_equilibria() {
    let sand = dense(8, 8, 3, 1e5, 0.3);
    let mut heavy = sand.clone();
    heavy.grains.iter_mut().for_each(|grain| grain.density *= 100.0);
    let weights = "gravity: [3.0, -9.81, 0]";
    for (what, scene, pack) in [
        ("smooth", asking("friction: 0.0", "{normal: hertz}", ""), &dense(8, 8, 3, 1e5, 0.0)),
        ("smooth walls", asking("friction: 0.0", HERTZ, ""), &sand),
        ("rough walls", asking("friction: .inf", HERTZ, ""), &sand),
        ("walls that rub", asking("friction: 0.2", HERTZ, ""), &sand),
        ("locked", asking("friction: .inf", LOCKED, ""), &sand),
        ("linear", asking("friction: .inf", LINEAR, ""), &sand),
        ("bonded", asking("friction: .inf", BONDED, ""), &sand),
        ("weights", asking("friction: .inf", HERTZ, weights), &heavy),
        ("glued", asking("friction: .inf, glue: true", HERTZ, ""), &sand),
        ("locked and glued", asking("friction: .inf, glue: true", LOCKED, ""), &sand),
    ] {
        let mut way = Way { scene: &scene, pack, path: Vec::new() };
        way.strain(3e-4, 1e-3, 0.0);
        way.strain(2e-4, 1.5e-3, 0.0);
        way.strain(2e-4, 1.53e-3, 0.0);
        let end = way.end();
        let found = end.tangent.unwrap().stands;
        let slides = end.state.unwrap().slipped > 3;
        assert_eq!(slides, !["smooth", "bonded"].contains(&what), "{what}");
        let stiff = way.differences(1e-11);
        let error = off(&on_walls(&found), &sides(&stiff));
        assert!(error < 2e-7 && found.error < 1e-10, "{what}: {error:e} {:e}", found.error);
        // What the tilt feels counts from where the contacts were when the increment began.
        let (got, want) = (relaxed(&found), way.moduli(&stiff));
        let smooth = what.starts_with("smooth");
        assert_eq!(got[(0, 2)].is_nan(), smooth);
        let block = |of: &Matrix3<f64>| SMatrix::<f64, 2, 2>::from(of.fixed_view::<2, 2>(0, 0));
        let error = off(&block(&got), &block(&want));
        assert!(error < 2e-7, "{what}: {error:e}");
        if smooth {
            continue;
        }
        // What the sides feel of a tilt, without the turning of axes.
        let [w, h, depth] = pack.bounds.sides();
        let felt = |a: usize| -0.5 * (stiff[(a, 4)] + stiff[(a + 1, 4)]) / (w * h * depth);
        let turning = 0.5 * (got[(2, 0)] - got[(0, 2)]);
        for (found, want) in [
            (0.5 * (got[(0, 2)] + got[(2, 0)]), felt(0) * w),
            (got[(1, 2)] - turning, felt(2) * h),
            (got[(2, 1)] - turning, felt(2) * h),
        ] {
            // The box has shrunk by some of 1e-3 since the start.
            assert!(
                (found - want).abs() < 4e-3 * want.abs() + 1e-6 * got[(0, 0)],
                "{what}: {found:e} {want:e}"
            );
        }
    }
}

#[test]
fn under_a_shear_of_the_box_too() {
    // Nothing is sheared as yet, so that it does not matter from where shear counts.
    let sand = dense(8, 8, 3, 1e5, 5.0);
    let locked = "{friction: {coefficient: 5.0}, rotation: locked}";
    for (what, contact) in [("free", "{friction: {coefficient: 5.0}}"), ("locked", locked)] {
        let scene = asking("friction: .inf", contact, "");
        let way = Way { scene: &scene, pack: &sand, path: vec![Motion::zeros()] };
        let found = way.tangent();
        let stiff = way.differences(1e-11);
        assert!(off(&stiff, &stiff.transpose()) < 1e-6);
        for of in [found.stands, found.sticks] {
            let error = off(&relaxed(&of), &way.moduli(&stiff));
            assert!(error < 1e-6, "{what}: {error:e}");
        }
    }
}

#[test]
fn the_work_of_glued_walls_has_it_as_its_second_derivative() {
    for contact in [
        BONDED,
        "{friction: {coefficient: 0.3}, rotation: locked, normal: {linear: \
                             {stiffness: 3.0e5, bond: {cohesion: .inf}}}}",
    ] {
        let scene = asking("friction: .inf, glue: true", contact, "");
        let pack = dense(8, 8, 3, 1e5, 0.3);
        let way = Way { scene: &scene, pack: &pack, path: vec![Motion::zeros()] };
        // Rounding of the energies leaves some 1e-5 of their difference at a tilt of 3e-6.
        let tilt = 3e-5;
        let works = [-tilt, tilt].map(|tilt| {
            let (before, after) = way.went(&Motion::from([0.0, 0.0, 0.0, 0.0, tilt]));
            assert_eq!(before.state.unwrap().dissipated_energy, 0.0);
            after.state.unwrap().stored_energy - before.state.unwrap().stored_energy
        });
        let modulus = works.iter().sum::<f64>() / (tilt * tilt) / pack.bounds.volume();
        let found = way.tangent().stands.relaxed[8];
        assert!((modulus / found - 1.0).abs() < 1e-6, "{modulus:e} {found:e}");
    }
}

#[test]
fn all_contacts_stick_as_if_friction_had_no_end() {
    let pack = dense(10, 10, 4, 1e5, 0.3);
    let scene = asking("friction: 0.3", HERTZ, "");
    let (mut rig, _) = Rig::new(&scene, &pack);
    let [w, h, _] = pack.bounds.sides();
    let mut measures = None;
    for k in 1..=10 {
        let (x, y) = (-2e-5 * f64::from(k) * w, 5e-5 * f64::from(k) * h);
        measures = Some(rig.go(to(&Motion::from([x, x, y, y, 0.0]))));
    }
    let found = measures.unwrap().tangent.unwrap();
    assert!(relaxed(&found.stands)[(1, 1)] < 0.9 * relaxed(&found.sticks)[(1, 1)]);
    // The same pack with grains that never slide, moved a little.
    let mut endless = rig.twin.pack();
    endless.grains.iter_mut().for_each(|grain| grain.friction = f64::INFINITY);
    let scene = asking("friction: .inf", "{friction: {coefficient: .inf}}", "");
    let way = Way { scene: &scene, pack: &endless, path: vec![Motion::zeros()] };
    let (want, stiff) = (way.tangent(), way.differences(1e-11));
    let error = off(&on_walls(&want.sticks), &sides(&stiff));
    assert!(error < 2e-7, "{error:e}");
    // The pack that begins anew counts its arms anew, and turns a little.
    let error = off(&relaxed(&found.sticks), &relaxed(&want.sticks));
    assert!(error < 1e-5, "{error:e}");
    // Without an increment behind it contacts go on as its history has it.
    let scene = asking("friction: 0.3", HERTZ, "");
    let (_, given) = Rig::new(&scene, &rig.twin.pack());
    let given = given.measures.unwrap().tangent.unwrap();
    assert!(off(&relaxed(&given.sticks), &relaxed(&found.sticks)) < 1e-5);
    // A limit that is renewed when a run begins lets more of them stick.
    let axial = |of: &TangentModuli| relaxed(of)[(1, 1)];
    assert!(axial(&found.stands) <= axial(&given.stands));
    assert!(axial(&given.stands) <= (1.0 + 1e-5) * axial(&given.sticks));
}

/// Least eigenvalue of the symmetric part over the largest of all.
fn least<const N: usize>(of: &SMatrix<f64, N, N>) -> f64 {
    let even = nalgebra::DMatrix::from_fn(N, N, |l, m| 0.5 * (of[(l, m)] + of[(m, l)]));
    let values = SymmetricEigen::new(even).eigenvalues;
    values.min() / values.amax()
}

#[test]
fn stable_packs_resist_symmetrically_and_give_in_beside_the_affine_motion() {
    for (scene, seed) in
        [(asking("friction: .inf", HERTZ, ""), 5), (asking("friction: 0.0", HERTZ, ""), 6)]
    {
        let pack = dense(12, 12, seed, 1e5, 0.3);
        let mut way = Way { scene: &scene, pack: &pack, path: Vec::new() };
        way.strain(0.0, 2e-4, 0.0);
        way.strain(0.0, 2.5e-4, 0.0);
        let end = way.end();
        let found = end.tangent.unwrap();
        for of in [found.stands, found.sticks] {
            let walls = on_walls(&of);
            assert!(off(&walls, &walls.transpose()) < 1e-12);
            assert!(least(&walls) > -1e-9);
            assert_eq!(of.wall_stiffness[4], [0.0; 6]);
            // Areas that shrink make stresses grow.
            let c = relaxed(&of);
            let stress = end.state.unwrap().stress_walls;
            let apart = c[(0, 1)] - c[(1, 0)];
            assert!((apart / (stress[0] - stress[4]) - 1.0).abs() < 1e-9);
            let given_in = affine(&of) - c;
            match c[(2, 2)].is_nan() {
                true => {
                    let given_in = SMatrix::<f64, 2, 2>::from(given_in.fixed_view::<2, 2>(0, 0));
                    assert!(least(&given_in) > 0.0 && seed == 6);
                    assert!(c.row(2).iter().chain(c.column(2).iter()).all(|entry| entry.is_nan()));
                }
                false => assert!(least(&given_in) > 0.0 && least(&c) > 0.1 && seed == 5),
            }
        }
    }
}

#[test]
fn a_random_pack_is_isotropic_within_its_scatter() {
    let pack = dense(28, 28, 7, 1e5, 0.3);
    let [smooth, rough] = ["0.0", ".inf"].map(|friction| {
        let scene = asking(&format!("friction: {friction}"), HERTZ, "");
        Rig::new(&scene, &pack).1.measures.unwrap().tangent.unwrap().sticks
    });
    assert!(smooth.isotropy_index > 0.95, "{}", smooth.isotropy_index);
    let (across, along) = (smooth.shear_pairs[0], rough.relaxed[8]);
    assert!((across / along - 1.0).abs() < 0.1, "{across:e} {along:e}");
    assert!((smooth.p_speed[0] / smooth.p_speed[1] - 1.0).abs() < 0.05);
    // Rough walls hold the grains beside them.
    assert!(rough.bulk > smooth.bulk && smooth.bulk > smooth.shear && smooth.shear > 0.0);
}

#[test]
fn square_blocks_are_as_stiff_as_their_rows() {
    // Rows of n discs between two walls, smooth: the overlaps of a row share one force F, and
    // dF/ds = 1/(Σ 1/kn) with kn = 3/2 F/h. A wall is stiffer than a grain.
    let n = 5;
    let strains = [1e-3, 3e-3];
    let sides = strains.map(|strain| 2.0 * RADIUS * f64::from(n) * (1.0 - strain));
    let place = |k: u32, axis: usize| sides[axis] * (f64::from(k) + 0.5) / f64::from(n);
    let grains = (0..n * n).map(|k| disc(place(k % n, 0), place(k / n, 1), RADIUS, 0.0)).collect();
    let pack = Pack { bounds: boxed([0.0; 2], sides), grains, history: None };
    let scene = asking("friction: 0.0", "{normal: hertz}", "");
    let measures = Rig::new(&scene, &pack).1.measures.unwrap();
    let found = measures.tangent.unwrap().stands;
    let plane = |young: f64, poisson: f64| (1.0 - poisson * poisson) / young;
    let wall = 4.0 / 3.0 * RADIUS.sqrt() / (plane(YOUNG, POISSON) + plane(7e12, 0.495));
    let grain = 4.0 / 3.0 * (0.5 * RADIUS).sqrt() / (2.0 * plane(YOUNG, POISSON));
    for axis in 0..2 {
        let short = 2.0 * RADIUS * f64::from(n) - sides[axis];
        let inner = (wall / grain).powf(2.0 / 3.0);
        let overlap = short / (2.0 + f64::from(n - 1) * inner);
        let force = wall * overlap.powf(1.5);
        let soft = (2.0 + f64::from(n - 1) * inner) * overlap / (1.5 * force);
        let stress = f64::from(n) * force / (sides[1 - axis] * 2.0 * RADIUS);
        let want = f64::from(n) / soft * sides[axis] / (sides[1 - axis] * 2.0 * RADIUS);
        assert!((found.relaxed[4 * axis] / want - 1.0).abs() < 1e-9, "{axis}");
        let apart = found.relaxed[if axis == 0 { 1 } else { 3 }];
        assert!((apart / stress - 1.0).abs() < 1e-6, "{axis}: {apart:e} {stress:e}");
    }
}

/// As B figure 51: rows of `count` - 1 and `count` discs in turn, just touching.
fn crystal(count: u32, rows: u32) -> Pack {
    let rise = 3.0_f64.sqrt() * RADIUS;
    let mut grains = Vec::new();
    for row in 0..rows {
        let (many, from) = if row % 2 == 0 { (count - 1, 2.0) } else { (count, 1.0) };
        for k in 0..many {
            let x = (from + 2.0 * f64::from(k)) * RADIUS;
            grains.push(disc(x, RADIUS + rise * f64::from(row), RADIUS, 0.6));
        }
    }
    let width = 2.0 * f64::from(count) * RADIUS;
    let bounds = boxed([0.0; 2], [width, 2.0 * RADIUS + rise * f64::from(rows - 1)]);
    Pack { bounds, grains, history: None }
}

#[test]
fn large_crystals_have_the_moduli_of_the_closed_form() {
    let stiffness = 1e6;
    let contact = "{friction: {coefficient: 0.6}, normal: {linear: {stiffness: 1.0e6, \
                   bond: {cohesion: .inf}}}}";
    let moduli = |count: u32, walls: &str| {
        let (mut rig, _) = Rig::new(&asking(walls, contact, ""), &crystal(count, 2 * count - 1));
        // So little that the forces do not count beside the stiffness.
        rig.stress([1e2; 2]).tangent.unwrap().sticks
    };
    let kappa = 3.0 * (1.0 - POISSON) / (2.0 - POISSON);
    let want = Crystal { radius: RADIUS, kappa }.elasticity(stiffness);
    // Layers at the walls add a compliance that goes with one over the size. Smooth walls leave an even
    // strain even, rough ones an even shear.
    let sizes = [12, 24, 48];
    let [smooth, rough] =
        ["friction: 0.0", "friction: .inf"].map(|walls| sizes.map(|n| moduli(n, walls)));
    for (name, want, of, value) in [
        ("K", want.bulk_modulus(), &smooth, (|of| of.bulk) as fn(&TangentModuli) -> f64),
        ("G across", want.shear_modulus(), &smooth, |of| of.shear_pairs[0]),
        ("G along", want.shear_modulus(), &rough, |of| of.relaxed[8]),
    ] {
        let soft = of.each_ref().map(|of| want / value(of));
        assert!(soft[0] > soft[1] && soft[1] > soft[2], "{name}: {soft:?}");
        let first = [2.0 * soft[1] - soft[0], 2.0 * soft[2] - soft[1]];
        let endless = (4.0 * first[1] - first[0]) / 3.0;
        // At rough walls, with their corners, more than one over the size is left.
        let near = if name == "G along" { 2e-2 } else { 2e-3 };
        assert!((endless - 1.0).abs() < near, "{name}: {soft:?} {endless}");
    }
}

#[test]
fn a_run_has_the_same_bits_with_tangent_moduli_and_without() {
    let pack = dense(10, 12, 2, 1e5, 0.3);
    let run = |kind| {
        let mut scene = asking("friction: 0.3", HERTZ, "");
        scene.outputs.moduli = kind;
        let (mut rig, _) = Rig::new(&scene, &pack);
        let height = pack.bounds.sides()[1];
        let digests: Vec<String> = (1..=8)
            .map(|k| {
                rig.biaxial(1e5, 2e-4 * f64::from(k) * height);
                rig.twin.digest()
            })
            .collect();
        (digests, rig.twin.effort().gradients)
    };
    assert_eq!(run(ModuliKind::Secant), run(ModuliKind::Both));
}

#[test]
fn what_is_no_minimum_has_no_moduli_and_what_carries_nothing_no_stiffness() {
    // A straight column of three discs that nothing but symmetry holds.
    let short = 1e-3 * RADIUS;
    let place = |k: i32| RADIUS - short + f64::from(k) * (2.0 * RADIUS - short);
    let grains = [0, 1, 2].map(|k| disc(2.0 * RADIUS, place(k), RADIUS, 0.0)).to_vec();
    let bounds = boxed([0.0; 2], [4.0 * RADIUS, 6.0 * RADIUS - 4.0 * short]);
    let pack = Pack { bounds, grains, history: None };
    let scene = asking("friction: 0.0", "{normal: {linear: {stiffness: 1.0e5}}}", "");
    let found = Rig::new(&scene, &pack).1.measures.unwrap().tangent.unwrap().stands;
    assert!(!found.valid && found.bulk.is_nan() && found.relaxed.iter().all(|c| c.is_nan()));
    let far = Pack {
        bounds: boxed([0.0; 2], [8.0 * RADIUS; 2]),
        grains: vec![disc(2.0 * RADIUS, 2.0 * RADIUS, RADIUS, 0.3)],
        history: None,
    };
    let none = Rig::new(&asking("friction: .inf", HERTZ, ""), &far).1;
    let none = none.measures.unwrap().tangent.unwrap().sticks;
    assert!(none.valid && none.relaxed == [0.0; 9] && none.bulk == 0.0);
}

#[test]
fn a_leaning_box_has_them_too() {
    let pack = dense(8, 8, 3, 1e5, 0.3);
    let scene = asking("friction: .inf", HERTZ, "");
    let mut way = Way { scene: &scene, pack: &pack, path: Vec::new() };
    way.strain(1e-4, 0.0, 1e-3);
    way.strain(1e-4, 0.0, 1.03e-3);
    let found = way.tangent().stands;
    let stiff = way.differences(1e-11);
    let error = off(&on_walls(&found), &sides(&stiff));
    assert!(error < 2e-7, "{error:e}");
}

#[test]
fn round_cells_and_sweeps_are_refused() {
    let refused = |keys: &str, what: &str| {
        let text = format!(
            "dimension: 2\npack: {{file: none.csv}}\noutputs: {{moduli: tangent}}\n{keys}\n"
        );
        let message = graintwin::scene::parse(&text, "t.yaml".as_ref()).unwrap_err().to_string();
        assert!(message.contains("outputs.moduli") && message.contains(what), "{message}");
    };
    refused("walls: {cell: {annulus: {inner: 1.0e-3}}}", "straight walls");
    refused("walls: {open: [x_min]}", "straight walls");
    refused("solver: {method: gauss_seidel, sweeps: 3}", "equilibrium");
}

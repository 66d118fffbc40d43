//! Tangent moduli of discs against differences of equilibria that commands led to, closed forms, and what
//! must hold of them.

use graintwin::analytic::cemented;
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

#[test]
fn they_are_the_differences_of_equilibria() {
    let sand = dense(8, 8, 3, 1e5, 0.3);
    let mut heavy = sand.clone();
    heavy.grains.iter_mut().for_each(|grain| grain.density *= 100.0);
    let hertz = "{friction: {coefficient: 0.3}}";
    let locked = "{friction: {coefficient: 0.3}, rotation: locked}";
    let bonded = "{friction: {coefficient: 0.3}, normal: {linear: {stiffness: 3.0e5, \
                  bond: {cohesion: .inf}}}}";
    let linear = "{friction: {coefficient: 0.3}, normal: {linear: {stiffness: 3.0e5}}}";
    for (what, scene, pack) in [
        ("smooth", asking("friction: 0.0", "{normal: hertz}", ""), &dense(8, 8, 3, 1e5, 0.0)),
        ("smooth walls", asking("friction: 0.0", hertz, ""), &sand),
        ("rough walls", asking("friction: .inf", hertz, ""), &sand),
        ("walls that rub", asking("friction: 0.2", hertz, ""), &sand),
        ("locked", asking("friction: .inf", locked, ""), &sand),
        ("linear", asking("friction: .inf", linear, ""), &sand),
        ("bonded", asking("friction: .inf", bonded, ""), &sand),
        ("weights", asking("friction: .inf", hertz, "gravity: [3.0, -9.81, 0]"), &heavy),
    ] {
        let mut way = Way { scene: &scene, pack, path: Vec::new() };
        way.strain(3e-4, 1e-3, 0.0);
        way.strain(2e-4, 1.5e-3, 0.0);
        way.strain(2e-4, 1.53e-3, 0.0);
        let found = way.tangent();
        let stiff = way.differences(1e-11);
        let error = off(&on_walls(&found.stands), &sides(&stiff));
        println!("{what}: walls {error:e} {:e}", found.stands.error);
        let (got, want) = (relaxed(&found.stands), way.moduli(&stiff));
        if got[(2, 2)].is_nan() {
            println!("   {:e}", off(&got.fixed_view::<2, 2>(0, 0).into(), &want.fixed_view::<2, 2>(0, 0).into()));
        } else {
            println!("   {:e} {got} {want}", off(&got, &want));
        }
    }
}

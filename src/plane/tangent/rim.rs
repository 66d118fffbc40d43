//! Second derivatives of the potential over the boundary: the sides and the tilt.
//!
//! A contact with a plane through a, of the normal n, left of it t, and turned by θ, has the overlap h and
//! the shear displacement s of
//!
//! ```text
//! h = r - (x - a)·n,    s = (x - a)·t + arm (θ - φ) + const
//! ```
//!
//! and the potential E(h) + G(s). As the box tilts by γ, a, n and θ go along.

use nalgebra::{SMatrix, SVector};

use super::{MOTIONS, normal};
use crate::contact::Other;
use crate::model::Model;
use crate::plane::act::{Act, Scenery};
use crate::plane::boundary::{Body, SIDES};
use crate::plane::matrix::FREEDOMS;
use crate::plane::pose::Pose;
use crate::plane::slope::Slope;
use crate::plane::{Vec2, glue, left_of};
use crate::wall;

/// x, y and the turn times the radius of a grain, the displacement of a side, the tilt.
const LOCAL: usize = FREEDOMS + 2;
const WAY: usize = FREEDOMS;
const TILT: usize = FREEDOMS + 1;

/// The derivatives that the grains do not have alone.
pub(super) struct Rim {
    /// C: ∂(gradient)/∂b, three numbers a grain.
    pub(super) columns: [Vec<f64>; MOTIONS],
    /// D: ∂²(potential)/∂b².
    pub(super) corner: SMatrix<f64, MOTIONS, MOTIONS>,
}

impl Rim {
    /// At `pose`, where `slope` is the derivative over the grains.
    pub(super) fn new(scenery: &Scenery<'_>, pose: &Pose, slope: &Slope) -> Self {
        let length = FREEDOMS * pose.at.len();
        let mut rim =
            Self { columns: std::array::from_fn(|_| vec![0.0; length]), corner: SMatrix::zeros() };
        for joint in &scenery.reference.edges {
            let Some(act) = scenery.edge(joint, pose) else { continue };
            let Other::Wall(b) = joint.second else { continue };
            let body = &scenery.bodies[usize::from(b)];
            let i = joint.first as usize;
            let lever = joint.arm[0] / scenery.model.radius[i];
            if let Some(second) = second(&act, body, pose.at[i], [joint.arm[0], lever]) {
                rim.add(usize::from(body.side), i, &second);
            }
        }
        rim.take_glued(scenery, pose, slope);
        rim
    }

    fn add(&mut self, side: usize, grain: usize, second: &SMatrix<f64, LOCAL, LOCAL>) {
        for a in 0..FREEDOMS {
            self.columns[side][FREEDOMS * grain + a] += second[(a, WAY)];
            self.columns[SIDES][FREEDOMS * grain + a] += second[(a, TILT)];
        }
        self.corner[(side, side)] += second[(WAY, WAY)];
        self.corner[(side, SIDES)] += second[(WAY, TILT)];
        self.corner[(SIDES, side)] += second[(WAY, TILT)];
        self.corner[(SIDES, SIDES)] += second[(TILT, TILT)];
    }

    /// Glued grains are parts of their sides.
    fn take_glued(&mut self, scenery: &Scenery<'_>, pose: &Pose, slope: &Slope) {
        if scenery.glued.is_empty() {
            return;
        }
        let model = scenery.model;
        let gradient = pulled(scenery, pose);
        let mut ways: [Vec<f64>; MOTIONS] = std::array::from_fn(|_| vec![0.0; gradient.len()]);
        for (i, side) in scenery.glued.iter().enumerate() {
            let Some(side) = side.map(usize::from) else { continue };
            let body = &scenery.bodies[side];
            let (radius, local) = (model.radius[i], pose.at[i] - body.at);
            let rate = body.swing.rate;
            let tilted = body.swing.way + left_of(local) * rate;
            let own = FREEDOMS * i..FREEDOMS * (i + 1);
            ways[side][own.clone()].copy_from_slice(&[body.slide.x, body.slide.y, 0.0]);
            ways[SIDES][own.clone()].copy_from_slice(&[tilted.x, tilted.y, rate * radius]);
            let [x, y, turn] = [0, 1, 2].map(|a| gradient[own.start + a]);
            let pull = Vec2::new(x, y);
            let cross = pull.dot(&slid_by_tilt(body));
            self.corner[(side, SIDES)] += cross;
            self.corner[(SIDES, side)] += cross;
            let (turned, bent) = (left_of(local) * growth(body), local * (rate * rate));
            self.corner[(SIDES, SIDES)] +=
                pull.dot(&(turned - bent)) + turn * radius * growth(body);
        }
        for (b, way) in ways.iter().enumerate() {
            let mut pushed = vec![0.0; way.len()];
            slope.multiply(way, (scenery.reference, &[]), &mut pushed);
            for (a, other) in ways.iter().enumerate() {
                self.corner[(a, b)] += super::dot(other, &pushed);
            }
            glue::clear(scenery.glued, &mut pushed);
            self.columns[b].iter_mut().zip(&pushed).for_each(|(to, push)| *to += push);
        }
    }
}

/// ∂(slide)/∂γ of the side of `body`: a y side goes along the leaning sides.
fn slid_by_tilt(body: &Body) -> Vec2 {
    let side = usize::from(body.side);
    if wall::axis(side) == 1 { Vec2::new(wall::inward(side), 0.0) } else { Vec2::zeros() }
}

/// ∂²θ/∂γ² of a side that leans by θ = -atan γ; 0 of one that does not.
fn growth(body: &Body) -> f64 {
    let rate = body.swing.rate;
    // tan θ = -γ and rate = -cos² θ.
    -2.0 * body.swing.turn.tan() * rate * rate
}

/// Gradient of the potential over all grains \[N\] as if none were glued, which only the pairs make.
fn pulled(scenery: &Scenery<'_>, pose: &Pose) -> Vec<f64> {
    let Model { radius, gravity, .. } = scenery.model;
    let mut gradient = vec![0.0; FREEDOMS * pose.at.len()];
    let mut add = |grain: usize, force: Vec2, moment: f64| {
        let to = &mut gradient[FREEDOMS * grain..];
        (to[0], to[1], to[2]) = (to[0] + force.x, to[1] + force.y, to[2] + moment / radius[grain]);
    };
    for (_, j, joint, act) in scenery.pairs(pose) {
        add(joint.first as usize, -act.force(), -joint.arm[0] * act.shear.force);
        add(j, act.force(), -joint.arm[1] * act.shear.force);
    }
    let weight = Vec2::new(gravity.x, gravity.y);
    (0..pose.at.len()).for_each(|i| add(i, -weight * scenery.model.mass(i), 0.0));
    gradient
}

/// Second derivative of the potential of one contact; nothing where the body is no plane.
fn second(
    act: &Act,
    body: &Body,
    at: Vec2,
    [arm, lever]: [f64; 2],
) -> Option<SMatrix<f64, LOCAL, LOCAL>> {
    let n = normal(body)?;
    let t = left_of(n);
    let (from, slide, way, rate) = (at - body.at, body.slide, body.swing.way, body.swing.rate);
    let (n_1, t_1, grow) = (t * rate, -n * rate, growth(body));
    let (n_2, t_2) = (t * grow - n * (rate * rate), -n * grow - t * (rate * rate));
    let across = slid_by_tilt(body);
    let gap = SVector::from([-n.x, -n.y, 0.0, slide.dot(&n), way.dot(&n) - from.dot(&n_1)]);
    let slid = SVector::from([
        t.x,
        t.y,
        -lever,
        -slide.dot(&t),
        from.dot(&t_1) - way.dot(&t) + arm * rate,
    ]);
    // ∂²h and ∂²s: over x and γ, over the way of the side and γ, over γ twice.
    let closing =
        [-n_1.x, -n_1.y, across.dot(&n) + slide.dot(&n_1), 2.0 * way.dot(&n_1) - from.dot(&n_2)];
    let shearing = [
        t_1.x,
        t_1.y,
        -across.dot(&t) - slide.dot(&t_1),
        from.dot(&t_2) - 2.0 * way.dot(&t_1) + arm * grow,
    ];
    let mut second = gap * gap.transpose() * act.normal.stiffness
        + slid * slid.transpose() * act.shear.stiffness;
    for (place, (h, s)) in [0, 1, WAY, TILT].into_iter().zip(closing.into_iter().zip(shearing)) {
        let bend = act.normal.force * h + act.shear.force * s;
        second[(place, TILT)] += bend;
        if place != TILT {
            second[(TILT, place)] += bend;
        }
    }
    Some(second)
}

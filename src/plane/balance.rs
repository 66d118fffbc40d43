//! The balance of forces at one configuration, and its exact derivative.

use super::boundary::{Body, SIDES, Shape};
use super::law::{self, Answer};
use super::matrix::{Block, FREEDOMS, Matrix};
use super::membrane::Membrane;
use super::reference::{Joint, Reference};
use super::{Setup, Vec2, glue, left_of};
use crate::contact::Other;
use crate::heap;
use crate::model::Model;
use crate::relax::balance::Sums;
use crate::wall;

/// Tangent of an angle below which its series is exact.
const SMALL: f64 = 0.05;

/// Where the grains are.
#[derive(Clone, Debug, Default)]
pub struct Pose {
    /// Centres \[m\], shape (n).
    pub at: Vec<Vec2>,
    /// Turns since the reference \[rad\], shape (n).
    pub turn: Vec<f64>,
}

impl Pose {
    /// Takes over `other`.
    pub fn copy_from(&mut self, other: &Self) {
        self.at.clone_from(&other.at);
        self.turn.clone_from(&other.turn);
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.at) + heap::bytes(&self.turn)
    }
}

/// What one contact does.
#[derive(Clone, Copy, Debug)]
pub struct Act {
    /// Unit vector along which the distance grows.
    pub along: Vec2,
    /// Distance \[m\].
    pub distance: f64,
    /// -1 in a ring.
    pub sign: f64,
    /// Overlap \[m\].
    pub overlap: f64,
    /// Shear displacement since the reference \[m\].
    pub slid: f64,
    /// Normal answer.
    pub normal: Answer,
    /// Shear answer.
    pub shear: Answer,
    /// Whether it slides.
    pub slides: bool,
    /// ∂(shear displacement)/∂x of grain i, along the tangent.
    pub pitch: f64,
}

impl Act {
    /// Force on grain i \[N\].
    #[must_use]
    pub fn force(&self) -> Vec2 {
        self.along * (self.sign * self.normal.force) + self.tangential()
    }

    /// Tangential force on grain i \[N\].
    #[must_use]
    pub fn tangential(&self) -> Vec2 {
        left_of(self.along) * (-self.pitch * self.shear.force)
    }
}

/// What the balance is taken of.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a> {
    /// Constants.
    pub model: &'a Model,
    /// Constants of discs.
    pub setup: &'a Setup,
    /// What shear counts from.
    pub reference: &'a Reference,
    /// What surrounds the grains.
    pub bodies: &'a [Body],
    /// Membranes around them.
    pub membranes: &'a [Membrane],
    /// Grains that take part.
    pub carries: &'a [bool],
    /// The side that each grain sticks to ([`glue`]); empty where none does.
    pub glued: &'a [Option<u8>],
    /// Whether every contact goes on as in the last increment: those that slid then slide, all others
    /// stick whatever their limit.
    pub goes_on: bool,
}

impl Scenery<'_> {
    /// What the pair `joint` does; `None` where it does nothing.
    #[inline]
    #[must_use]
    pub fn pair(&self, joint: &Joint, pose: &Pose) -> Option<Act> {
        let Other::Grain(j) = joint.second else { return None };
        let (i, j) = (joint.first as usize, j as usize);
        let branch = pose.at[i] - pose.at[j];
        let square = branch.norm_squared();
        let apart = square >= joint.reach * joint.reach;
        let shears = joint.held && !joint.opened;
        if apart && !joint.bonded && !shears {
            return None;
        }
        if !(self.carries[i] && self.carries[j]) || glue::joins(self.glued, joint) {
            return None;
        }
        let distance = square.sqrt();
        let along = branch / distance;
        let overlap = joint.reach - distance;
        let normal = law::normal(self.setup.law, joint.modulus, overlap, joint.bonded);
        let mut act = Act::pressing(along, distance, 1.0, overlap, normal);
        if joint.held && !joint.opened {
            let rolled = joint.arm[0] * pose.turn[i] + joint.arm[1] * pose.turn[j];
            let slid = joint.span * angle(&joint.along, &along) - rolled;
            act.slide(joint, slid, joint.span / distance, self.goes_on);
        }
        Some(act)
    }

    /// The pairs that do something: their place in the list, the other grain, and what they do.
    pub fn pairs<'a>(
        &'a self,
        pose: &'a Pose,
    ) -> impl Iterator<Item = (usize, usize, &'a Joint, Act)> {
        let near = self.reference.near.iter().zip(&self.reference.pairs).enumerate();
        near.filter_map(move |(k, (near, joint))| {
            let [i, j] = near.grains.map(|grain| grain as usize);
            if (pose.at[i] - pose.at[j]).norm_squared() >= near.square {
                return None;
            }
            self.pair(joint, pose).map(|act| (k, j, joint, act))
        })
    }

    /// What the edge `joint` does; `None` where it does nothing.
    #[inline]
    #[must_use]
    pub fn edge(&self, joint: &Joint, pose: &Pose) -> Option<Act> {
        let Other::Wall(b) = joint.second else { return None };
        let i = joint.first as usize;
        let body = &self.bodies[b as usize];
        let near = body.near(pose.at[i], self.model.radius[i]);
        let shears = joint.held && !joint.opened;
        if near.overlap <= 0.0 && !shears || !self.carries[i] || glue::joins(self.glued, joint) {
            return None;
        }
        let normal = law::normal(self.setup.law, joint.modulus, near.overlap, false);
        let mut act = Act::pressing(near.along, near.distance, near.sign, near.overlap, normal);
        if shears {
            let rolled = joint.arm[0] * pose.turn[i];
            match body.shape {
                Shape::Plane(normal) => {
                    // Seen from the wall, the grain turns back as the wall turns.
                    let station = (pose.at[i] - body.at).dot(&left_of(normal))
                        + joint.arm[0] * body.swing.turn;
                    act.slide(joint, station - joint.station - rolled, 1.0, self.goes_on);
                }
                Shape::Disc(_) | Shape::Ring(_) | Shape::Nothing => {
                    let way = joint.span * angle(&joint.along, &near.along);
                    let pitch = joint.span / near.distance;
                    act.slide(joint, way - rolled, pitch, self.goes_on);
                }
            }
        }
        Some(act)
    }
}

impl Act {
    /// Where the contact has turned round since the derivative was taken last, from sliding one way to
    /// sliding the other, takes its secant: steps would go on passing the narrow range in which it
    /// sticks. The secant is that of the parabola around where it has no shear, which bounds its energy.
    #[inline]
    fn turn(&mut self, joint: &Joint, (way, times): &mut (i8, u8)) {
        let now = match self.slides {
            true => {
                if self.shear.force > 0.0 {
                    1
                } else {
                    -1
                }
            }
            false => 0,
        };
        if now * *way < 0 {
            *times = TURNED;
        }
        if now != 0 {
            *way = now;
        }
        if *times > 0 && now != 0 && joint.shear.stiffness > 0.0 {
            let free = self.slid + joint.shear.carried / joint.shear.stiffness;
            self.shear.stiffness = self.shear.force / free;
            *times -= 1;
        }
    }

    #[inline]
    fn pressing(along: Vec2, distance: f64, sign: f64, overlap: f64, normal: Answer) -> Self {
        let shear = Answer::default();
        Self { along, distance, sign, overlap, slid: 0.0, normal, shear, slides: false, pitch: 0.0 }
    }

    #[inline]
    fn slide(&mut self, joint: &Joint, slid: f64, pitch: f64, goes_on: bool) {
        (self.shear, self.slides) = match goes_on {
            true => joint.shear.as_before(slid, joint.slid),
            false => joint.shear.answer(slid),
        };
        self.slid = slid;
        self.pitch = pitch;
    }
}

/// Angle from `from` to `to` \[rad\].
#[inline]
fn angle(from: &Vec2, to: &Vec2) -> f64 {
    let (across, along) = (from.perp(to), from.dot(to));
    if across.abs() >= SMALL * along {
        return across.atan2(along);
    }
    // The series of the arc tangent, exact to the last bits here and much faster.
    let x = across / along;
    let square = x * x;
    let rest = 1.0 / 7.0 - square * (1.0 / 9.0 - square * (1.0 / 11.0 - square / 13.0));
    x * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square * rest)))
}

/// Energy and gradient at one configuration.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Gradient of the potential over x, y and the turn times the radius \[N\], three numbers a grain;
    /// zero for grains that take no part.
    pub gradient: Vec<f64>,
    /// Its derivatives over the inward displacements of the sides \[N\]: what each side is pressed with.
    pub sides: [f64; SIDES],
    /// Its derivative over the tilt of the box \[N m\].
    pub tilt: f64,
    /// x-component of the forces of the low and of the high y side on the grains \[N\], along its inward
    /// normal turned to the right.
    pub drag: [f64; 2],
    /// Totals of the normal forces.
    pub sums: Sums,
    /// Potential of shear since the reference \[J\].
    pub shear_potential: f64,
    /// Contacts of each grain that carry more than a faint force, those that hold by a bond twice, shape
    /// (n).
    pub support: Vec<u32>,
    /// Force below which a contact is faint \[N\].
    pub faint: f64,
    /// Potential of the membranes \[J\]; not of what the pack stores.
    pub pressure_potential: f64,
    /// How often the balance was taken.
    pub evaluations: u64,
}

impl Balance {
    /// Takes the balance of `pose`.
    pub fn evaluate(&mut self, scenery: &Scenery<'_>, pose: &Pose) {
        let Scenery { model, setup, reference, bodies, membranes, carries, .. } = scenery;
        self.evaluations += 1;
        self.gradient.clear();
        self.gradient.resize(FREEDOMS * pose.at.len(), 0.0);
        self.support.clear();
        self.support.resize(pose.at.len(), 0);
        self.sides = [0.0; SIDES];
        (self.tilt, self.drag) = (0.0, [0.0; 2]);
        self.sums = Sums::NONE;
        self.shear_potential = 0.0;
        self.pressure_potential = 0.0;
        for (_, j, joint, act) in scenery.pairs(pose) {
            let force = act.force();
            self.add(model, joint.first, -force, -joint.arm[0] * act.shear.force);
            self.add(model, j as u32, force, -joint.arm[1] * act.shear.force);
            let holds = self.holds(joint, &act);
            self.support[joint.first as usize] += holds;
            self.support[j] += holds;
            self.count(&act);
        }
        for joint in &reference.edges {
            let Some(act) = scenery.edge(joint, pose) else { continue };
            let Other::Wall(b) = joint.second else { continue };
            let body = &bodies[b as usize];
            self.add(model, joint.first, -act.force(), -joint.arm[0] * act.shear.force);
            self.press(body, Self::pressed(&act, body), act.force());
            let station = (pose.at[joint.first as usize] - body.at).dot(&left_of(act.along));
            self.tilt += Self::tilted(&act, body, station, joint.arm[0]);
            self.support[joint.first as usize] += self.holds(joint, &act);
            self.count(&act);
        }
        for membrane in *membranes {
            membrane.add_gradient(pose, &mut self.gradient);
            // A membrane holds what it presses on.
            membrane.chain.iter().for_each(|&grain| self.support[grain as usize] += 2);
            self.pressure_potential += membrane.potential(pose);
        }
        let gravity = Vec2::new(model.gravity.x, model.gravity.y);
        if model.has_gravity() {
            for (i, at) in pose.at.iter().enumerate().filter(|(i, _)| carries[*i]) {
                let weight = gravity * model.mass(i);
                self.sums.energy -= weight.dot(at);
                self.add(model, i as u32, -weight, 0.0);
            }
        }
        glue::take_over(scenery, pose, self);
        if !setup.turns {
            self.gradient.iter_mut().skip(2).step_by(FREEDOMS).for_each(|turn| *turn = 0.0);
        }
    }

    fn holds(&self, joint: &Joint, act: &Act) -> u32 {
        if joint.bonded { 2 } else { u32::from(act.normal.force > self.faint) }
    }

    /// What `act` presses the side of `body` with, along its inward displacement \[N\].
    pub(super) fn pressed(act: &Act, body: &Body) -> f64 {
        act.normal.force * body.growth + act.force().dot(&body.slide)
    }

    /// Counts what `body` is pressed with along the way of its side, and its force on a grain.
    pub(super) fn press(&mut self, body: &Body, pressed: f64, force: Vec2) {
        let side = usize::from(body.side);
        self.sides[side] += pressed;
        if wall::axis(side) == 1 {
            self.drag[side % 2] += wall::inward(side) * force.x;
        }
    }

    /// Derivative of the potential of `act` over the tilt \[N m\]; the grain is at `station` along the
    /// wall, with the lever `arm` \[m\].
    fn tilted(act: &Act, body: &Body, station: f64, arm: f64) -> f64 {
        // As n turns left, -n·x changes by -(left of n)·x, and (left of n)·x by -n·x.
        let turned =
            -act.normal.force * station + act.shear.force * act.pitch * (arm - act.distance);
        act.force().dot(&body.swing.way) + turned * body.swing.rate
    }

    #[inline]
    fn add(&mut self, model: &Model, grain: u32, force: Vec2, moment: f64) {
        let to = FREEDOMS * grain as usize;
        self.gradient[to] += force.x;
        self.gradient[to + 1] += force.y;
        self.gradient[to + 2] += moment / model.radius[grain as usize];
    }

    #[inline]
    fn count(&mut self, act: &Act) {
        let Answer { energy, force, .. } = act.normal;
        self.shear_potential += act.shear.energy;
        if force == 0.0 {
            return;
        }
        let sums = &mut self.sums;
        sums.energy += energy;
        sums.force += force.abs();
        sums.overlap += act.overlap.max(0.0);
        sums.contacts += 1;
        for axis in 0..2 {
            sums.virial[axis] += force * act.along[axis].powi(2) * act.distance;
        }
    }

    /// Potential of the pack \[J\].
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.sums.energy + self.shear_potential
    }
}

/// The derivative of the balance over grains and sides.
#[derive(Clone, Debug, Default)]
pub struct Slope {
    /// Over the grains.
    pub matrix: Matrix,
    /// ∂(gradient)/∂(inward displacement) of each side \[N/m\], three numbers a grain.
    pub columns: [Vec<f64>; SIDES],
    /// ∂²(potential)/∂(displacement)² of each side \[N/m\].
    pub corner: [f64; SIDES],
    /// Which way each joint slid when the derivative was taken last, pairs and then edges, and for how
    /// many times more it counts as one that turned round.
    slides: Vec<(i8, u8)>,
    /// Stiffness of what is not solved for, so that it stays where it is \[N/m\].
    pub idle: f64,
}

/// Times that a contact is taken by its secant after it turned round.
const TURNED: u8 = 4;

impl Slope {
    /// A search begins: no contact has turned round in it.
    pub(super) fn begin(&mut self) {
        self.slides.clear();
    }

    /// Takes the derivative at `pose`, or with `convex` what is positive in it contact by contact: no
    /// contact then pushes its grains aside.
    pub fn assemble(&mut self, scenery: &Scenery<'_>, pose: &Pose, convex: bool) {
        let Scenery { model, setup, reference, bodies, membranes, carries, .. } = scenery;
        self.matrix.clear();
        self.corner = [0.0; SIDES];
        for column in &mut self.columns {
            column.clear();
            column.resize(FREEDOMS * pose.at.len(), 0.0);
        }
        let mut slides = std::mem::take(&mut self.slides);
        slides.resize(reference.pairs.len() + reference.edges.len(), (0, 0));
        let (of_pairs, of_edges) = slides.split_at_mut(reference.pairs.len());
        for (k, j, joint, mut act) in scenery.pairs(pose) {
            act.turn(joint, &mut of_pairs[k]);
            let i = joint.first as usize;
            let parts = Parts::of(&act, convex);
            let lever = [joint.arm[0] / model.radius[i], joint.arm[1] / model.radius[j]];
            let [own, mixed, other] = parts.blocks(lever, setup.turns);
            add(&mut self.matrix.diagonal[i], &own);
            add(&mut self.matrix.diagonal[j], &other);
            self.matrix.pairs[k] = mixed;
        }
        for (joint, slides) in reference.edges.iter().zip(of_edges) {
            let Some(mut act) = scenery.edge(joint, pose) else { continue };
            act.turn(joint, slides);
            let Other::Wall(b) = joint.second else { continue };
            let body = &bodies[b as usize];
            let i = joint.first as usize;
            let mut parts = Parts::of(&act, convex);
            if joint.is_flat(bodies) {
                parts.flat();
            }
            let lever = [joint.arm[0] / model.radius[i], 0.0];
            let [own, ..] = parts.blocks(lever, setup.turns);
            add(&mut self.matrix.diagonal[i], &own);
            let side = body.side as usize;
            let (column, corner) = parts.column(lever[0], body, setup.turns);
            let to = &mut self.columns[side][FREEDOMS * i..FREEDOMS * (i + 1)];
            to.iter_mut().zip(column).for_each(|(to, x)| *to += x);
            self.corner[side] += corner;
        }
        self.slides = slides;
        let Matrix { diagonal, pairs, .. } = &mut self.matrix;
        let mut links = &mut pairs[reference.pairs.len()..];
        for membrane in *membranes {
            let (own, rest) = std::mem::take(&mut links).split_at_mut(membrane.links().count());
            membrane.add_slope(diagonal, own);
            links = rest;
        }
        for (block, carries) in self.matrix.diagonal.iter_mut().zip(*carries) {
            // What is not solved for stays.
            let solved = match (*carries, setup.turns) {
                (false, _) => 0,
                (true, false) => 2,
                (true, true) => FREEDOMS,
            };
            (solved..FREEDOMS).for_each(|a| block[a][a] += self.idle);
        }
    }
}

/// The parts of the second derivative of one contact: of x of grain i relative to the other body.
struct Parts {
    /// Over the relative position.
    push: [[f64; 2]; 2],
    /// ∇ of the shear displacement over the relative position.
    shift: Vec2,
    /// ∇ of the overlap over the relative position.
    close: Vec2,
    normal: f64,
    shear: f64,
}

impl Parts {
    #[inline]
    fn of(act: &Act, convex: bool) -> Self {
        let e = act.along;
        let t = left_of(e);
        let shear = act.shear.stiffness;
        let close = e * -act.sign;
        let shift = t * act.pitch;
        // ∇²h = -sign t tᵀ/d and ∇²u = -pitch (e tᵀ + t eᵀ)/d.
        let bend = -act.sign * act.normal.force / act.distance;
        let swing = -act.shear.force * act.pitch / act.distance;
        let (bend, swing) = if convex { (bend.max(0.0), 0.0) } else { (bend, swing) };
        let mut push = [[0.0; 2]; 2];
        for a in 0..2 {
            for b in 0..2 {
                push[a][b] = act.normal.stiffness * close[a] * close[b]
                    + shear * shift[a] * shift[b]
                    + bend * t[a] * t[b]
                    + swing * (e[a] * t[b] + t[a] * e[b]);
            }
        }
        Self { push, shift, close, normal: act.normal.stiffness, shear }
    }

    /// Takes away what the curvature of a plane would do: there is none.
    fn flat(&mut self) {
        for a in 0..2 {
            for b in 0..2 {
                self.push[a][b] = self.normal * self.close[a] * self.close[b]
                    + self.shear * self.shift[a] * self.shift[b];
            }
        }
    }

    /// Blocks (i, i), (i, j) and (j, j) over position and turn times radius.
    #[inline]
    fn blocks(&self, lever: [f64; 2], turns: bool) -> [Block; 3] {
        let mut own = [[0.0; FREEDOMS]; FREEDOMS];
        let (mut mixed, mut other) = (own, own);
        for a in 0..2 {
            for b in 0..2 {
                own[a][b] = self.push[a][b];
                mixed[a][b] = -self.push[a][b];
                other[a][b] = self.push[a][b];
            }
        }
        if turns {
            let [li, lj] = lever;
            for a in 0..2 {
                let pull = self.shear * self.shift[a];
                own[a][2] = -pull * li;
                own[2][a] = own[a][2];
                mixed[a][2] = -pull * lj;
                mixed[2][a] = pull * li;
                other[a][2] = pull * lj;
                other[2][a] = other[a][2];
            }
            own[2][2] = self.shear * li * li;
            mixed[2][2] = self.shear * li * lj;
            other[2][2] = self.shear * lj * lj;
        }
        [own, mixed, other]
    }

    /// ∂(gradient of the grain)/∂(inward displacement) of the side of `body`, and the second derivative
    /// over that displacement alone.
    fn column(&self, lever: f64, body: &Body, turns: bool) -> ([f64; FREEDOMS], f64) {
        let v = body.slide;
        let grown = self.normal * body.growth;
        let mut column = [0.0; FREEDOMS];
        let rows = self.push.iter().zip(self.close.iter());
        for (to, (push, close)) in column.iter_mut().zip(rows) {
            *to = -(push[0] * v.x + push[1] * v.y) + grown * close;
        }
        if turns {
            column[2] = self.shear * lever * self.shift.dot(&v);
        }
        let mut corner = grown * body.growth;
        for a in 0..2 {
            for b in 0..2 {
                corner += v[a] * self.push[a][b] * v[b];
            }
            corner -= 2.0 * grown * self.close[a] * v[a];
        }
        (column, corner)
    }
}

fn add(to: &mut Block, block: &Block) {
    for (to, from) in to.iter_mut().zip(block) {
        to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
    }
}

impl Slope {
    /// Adds the product of the derivative over the grains with `of`, three numbers a grain, to `to`.
    pub fn multiply(
        &self,
        of: &[f64],
        (reference, links): (&Reference, &[(u32, u32)]),
        to: &mut [f64],
    ) {
        for (i, block) in self.matrix.diagonal.iter().enumerate() {
            for (a, row) in block.iter().enumerate() {
                for (b, entry) in row.iter().enumerate() {
                    to[FREEDOMS * i + a] += entry * of[FREEDOMS * i + b];
                }
            }
        }
        let pairs = reference.pairs.iter().filter_map(|joint| match joint.second {
            Other::Grain(j) => Some((joint.first, j)),
            Other::Wall(_) => None,
        });
        let links = links.iter().map(|&(i, j)| (i.min(j), i.max(j)));
        for ((i, j), block) in pairs.chain(links).zip(&self.matrix.pairs) {
            let (i, j) = (FREEDOMS * i as usize, FREEDOMS * j as usize);
            for (a, row) in block.iter().enumerate() {
                for (b, entry) in row.iter().enumerate() {
                    to[i + a] += entry * of[j + b];
                    to[j + b] += entry * of[i + a];
                }
            }
        }
    }
}

/// Block of one grain for one contact; `lever` over the radius is negative for the other grain of a
/// pair, which sees everything but turns the other way round.
pub(super) fn own_block(act: &Act, lever: f64, flat: bool, turns: bool) -> Block {
    let mut parts = Parts::of(act, false);
    if flat {
        parts.flat();
    }
    let [own, ..] = parts.blocks([lever, 0.0], turns);
    own
}

//! The exact derivative of the balance at one configuration.

use super::act::{Act, Scenery};
use super::boundary::{Body, SIDES};
use super::matrix::{Block, FREEDOMS, Matrix};
use super::pose::Pose;
use super::reference::{Joint, Reference};
use super::{Vec2, left_of};
use crate::contact::Other;

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
            self.matrix.fill(k, mixed);
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
        let Matrix { diagonal, pairs, filled, .. } = &mut self.matrix;
        filled.extend(reference.pairs.len() as u32..pairs.len() as u32);
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
        for &k in &self.matrix.filled {
            let k = k as usize;
            let [i, j] = match reference.near.get(k) {
                Some(near) => near.grains,
                None => match links.get(k - reference.near.len()) {
                    Some(&link) => link.into(),
                    None => break,
                },
            };
            let (i, j) = (FREEDOMS * i.min(j) as usize, FREEDOMS * i.max(j) as usize);
            let block = &self.matrix.pairs[k];
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

impl Act {
    /// Where the contact has turned round since the derivative was taken last, from sliding one way to
    /// sliding the other, takes its secant: steps would go on passing the narrow range in which it
    /// sticks. The secant is that of the parabola around where it has no shear, which bounds its energy.
    #[inline]
    fn turn(&mut self, joint: &Joint, (way, times): &mut (i8, u8)) {
        let now = match (self.slides, self.shear.force > 0.0) {
            (false, _) => 0,
            (true, true) => 1,
            (true, false) => -1,
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
}

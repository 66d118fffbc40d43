//! One part of the linear system with friction: its blocks, its products and its vectors.

use super::block6::{Block6, Six};
use super::joint::Joint;
use crate::Vec3;
use crate::heap;
use crate::relax::lanes::{self, Four, Kernel, LANE_ROWS, Lanes, dispatch};
use crate::relax::split::Pattern;
use crate::relax::sym3::Sym3;

/// Pivots below this share of a row's mean diagonal are lifted to it.
const SMALL_PIVOT: f32 = 0.02;

/// Rows of the grains of this part, and behind them those of the separator it touches.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// The grain of each row.
    grain: Vec<u32>,
    /// Where its contacts stand.
    pub(super) pattern: Pattern,
    pub(super) joints: Vec<Joint>,
    /// Contacts with walls, in the order of the rows, and the block that those of a row make.
    wall_joints: Vec<(u32, Joint)>,
    walls: Vec<(u32, Block6)>,
    /// Diagonal blocks without shift, also of the separator.
    pub(super) diagonal: Vec<Block6>,
    /// Inverse of the shifted diagonal blocks; empty before they are taken.
    inverse: Vec<Block6>,
    shift: Vec<f32>,
    step: Vec<Six>,
    residual: Vec<Six>,
    /// Also of the separator.
    pub(super) direction: Vec<Six>,
    /// The preconditioned residual, then the product, then again; also for the separator.
    pub(super) product: Vec<Six>,
    /// The last scalar product.
    pub(super) dot: f64,
    /// The square of the residual.
    pub(super) square: f64,
}

impl Part {
    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.grain)
            + self.pattern.heap_bytes()
            + heap::bytes(&self.joints)
            + heap::bytes(&self.wall_joints)
            + heap::bytes(&self.walls)
            + heap::bytes(&self.diagonal)
            + heap::bytes(&self.inverse)
            + heap::bytes(&self.shift)
            + heap::bytes(&self.step)
            + heap::bytes(&self.residual)
            + heap::bytes(&self.direction)
            + heap::bytes(&self.product)
    }

    /// Begins an assembly of `rows` grains, with the separator `all` rows.
    pub(super) fn begin(&mut self, rows: usize, all: usize) {
        self.grain.resize(rows, 0);
        self.pattern.begin(rows);
        self.wall_joints.clear();
        self.walls.clear();
        self.diagonal.clear();
        self.diagonal.resize(all, Block6::default());
        self.inverse.clear();
        for vector in [&mut self.step, &mut self.residual] {
            vector.resize(rows, Six::default());
        }
        for vector in [&mut self.direction, &mut self.product] {
            vector.resize(all, Six::default());
        }
    }

    /// Rows of grains.
    pub(super) fn rows(&self) -> usize {
        self.grain.len()
    }

    /// Puts `grain` into `row`.
    #[inline(always)]
    pub(super) fn place(&mut self, row: usize, grain: u32) {
        self.grain[row] = grain;
    }

    /// Makes room for the contacts announced to the pattern.
    pub(super) fn make_room(&mut self) {
        let count = self.pattern.make_room();
        self.joints.resize(count, Joint::default());
    }

    /// Takes one contact announced.
    #[inline(always)]
    pub(super) fn insert(&mut self, row: usize, second: u32, joint: Joint) {
        let at = self.pattern.insert(row, second);
        self.joints[at] = joint;
    }

    /// Takes a contact of `row` with a wall.
    pub(super) fn insert_wall(&mut self, row: u32, joint: Joint) {
        self.wall_joints.push((row, joint));
    }

    /// Adds up the diagonal blocks.
    pub(super) fn add_blocks(&mut self) {
        dispatch(AddBlocks { part: self });
        for (row, block) in &self.walls {
            self.diagonal[*row as usize].add(block);
        }
    }

    /// Inverts the diagonal blocks shifted by `shift`, one a grain, with unit blocks for rows that
    /// nothing holds.
    pub(super) fn factorise(&mut self, shift: &[f32]) {
        if self.inverse.is_empty() {
            self.shift.clear();
            self.shift.extend(self.grain.iter().map(|&grain| shift[grain as usize]));
            let inverse = |(d, s): (&Block6, &f32)| inverse(d, *s);
            self.inverse.extend(self.diagonal.iter().zip(&self.shift).map(inverse));
            return;
        }
        // Another try at the same linearisation: few shifts changed.
        for (row, &grain) in self.grain.iter().enumerate() {
            let shift = shift[grain as usize];
            if self.shift[row] != shift {
                self.shift[row] = shift;
                self.inverse[row] = inverse(&self.diagonal[row], shift);
            }
        }
    }

    /// Takes -gradient / unit and -moment / unit as the residual.
    pub(super) fn start(&mut self, gradient: &[Vec3], moment: &[Vec3], unit: f64) {
        self.step.fill(Six::default());
        self.direction.fill(Six::default());
        let four = |v: &Vec3| {
            let r = v * (-1.0 / unit);
            Four([r.x as f32, r.y as f32, r.z as f32, 0.0])
        };
        for (r, &grain) in self.residual.iter_mut().zip(&self.grain) {
            *r = Six { u: four(&gradient[grain as usize]), w: four(&moment[grain as usize]) };
        }
    }

    /// Goes `alpha` along the direction; `product` becomes the preconditioned residual and `dot`
    /// that of both.
    pub(super) fn descend(&mut self, alpha: f32) {
        [self.dot, self.square] = dispatch(Descend { part: self, alpha });
    }

    /// Direction ← preconditioned residual + `beta` direction.
    pub(super) fn turn(&mut self, beta: f32) {
        dispatch(Turn { part: self, beta });
    }

    /// Takes the direction of the separator.
    pub(super) fn take_separator(&mut self, late: &[Six]) {
        let rows = self.grain.len();
        self.direction[rows..].copy_from_slice(late);
    }

    /// product ← (H + Σ) direction, but for what other parts add to it.
    pub(super) fn multiply(&mut self) {
        dispatch(Multiply { part: self });
    }

    /// `dot` becomes that of direction and product.
    pub(super) fn measure(&mut self) {
        self.dot = dispatch(Measure { part: self });
    }

    /// The displacement and the rotation times radius of `row`.
    pub(super) fn step(&self, row: usize) -> [[f32; 3]; 2] {
        let Six { u: Four([x, y, z, _]), w: Four([a, b, c, _]) } = self.step[row];
        [[x, y, z], [a, b, c]]
    }

    /// The part of the curvature of the direction in the unknowns of `row`.
    pub(super) fn curvature(&self, row: usize) -> f32 {
        let (p, q) = (&self.direction[row], &self.product[row]);
        [(&p.u, &q.u), (&p.w, &q.w)]
            .iter()
            .map(|(Four(p), Four(q))| p[0] * q[0] + p[1] * q[1] + p[2] * q[2])
            .sum()
    }
}

fn inverse(block: &Block6, shift: f32) -> Block6 {
    let mut block = block.sym6();
    for part in [&mut block.u, &mut block.w] {
        if part.trace() == 0.0 {
            *part = Sym3::diagonal([1.0; 3]);
        }
    }
    Block6::from(&block.inverse(shift, SMALL_PIVOT))
}

struct AddBlocks<'a> {
    part: &'a mut Part,
}

impl Kernel for AddBlocks<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, pattern, joints, wall_joints, walls, diagonal, .. } = self.part;
        for (row, joint) in &*wall_joints {
            match walls.last_mut() {
                Some((last, block)) if last == row => joint.add_block(l, 0, block),
                _ => {
                    let mut block = Block6::default();
                    joint.add_block(l, 0, &mut block);
                    walls.push((*row, block));
                }
            }
        }
        for i in 0..grain.len() {
            let range = pattern.row(i);
            for (joint, &j) in joints[range.clone()].iter().zip(&pattern.second[range]) {
                joint.add_block(l, 0, &mut diagonal[i]);
                joint.add_block(l, 1, &mut diagonal[j as usize]);
            }
        }
    }
}

struct Multiply<'a> {
    part: &'a mut Part,
}

impl Kernel for Multiply<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { pattern, joints, walls, shift, direction, product, .. } = self.part;
        for ((y, x), &s) in product.iter_mut().zip(&*direction).zip(&*shift) {
            let s = l.splat(s);
            l.store(&mut y.u, l.mul(s, l.load(&x.u)));
            l.store(&mut y.w, l.mul(s, l.load(&x.w)));
        }
        product[shift.len()..].fill(Six::default());
        for (row, block) in &*walls {
            let (x, y) = (&direction[*row as usize], &mut product[*row as usize]);
            let [force, moment] = block.times(l, l.load(&x.u), l.load(&x.w));
            let (u, w) = (l.load(&y.u), l.load(&y.w));
            l.store(&mut y.u, l.add(u, force));
            l.store(&mut y.w, l.add(w, moment));
        }
        for i in 0..shift.len() {
            let (x, y) = (&direction[i], &product[i]);
            let x = [l.load(&x.u), l.load(&x.w)];
            let mut sum = [l.load(&y.u), l.load(&y.w)];
            let range = pattern.row(i);
            for (joint, &j) in joints[range.clone()].iter().zip(&pattern.second[range]) {
                let j = j as usize;
                sum = joint.multiply(l, x, &direction[j], sum, &mut product[j]);
            }
            l.store(&mut product[i].u, sum[0]);
            l.store(&mut product[i].w, sum[1]);
        }
    }
}

struct Measure<'a> {
    part: &'a mut Part,
}

impl Kernel for Measure<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> f64 {
        let Part { grain, direction, product, .. } = self.part;
        let rows = grain.len();
        let chunks = direction[..rows].chunks(LANE_ROWS).zip(product[..rows].chunks(LANE_ROWS));
        let mut total = 0.0;
        for (p, q) in chunks {
            let mut lanes = l.splat(0.0);
            for (p, q) in p.iter().zip(q) {
                lanes = l.mul_add(l.load(&p.u), l.load(&q.u), lanes);
                lanes = l.mul_add(l.load(&p.w), l.load(&q.w), lanes);
            }
            total += lanes::in_double(l.array(lanes));
        }
        total
    }
}

struct Descend<'a> {
    part: &'a mut Part,
    alpha: f32,
}

impl Kernel for Descend<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> [f64; 2] {
        let Part { inverse, step, residual, direction, product, .. } = self.part;
        let alpha = l.splat(self.alpha);
        let mut total = [0.0; 2];
        for (chunk, inverse) in inverse.chunks(LANE_ROWS).enumerate() {
            let mut lanes = [l.splat(0.0); 2];
            for (k, inverse) in inverse.iter().enumerate() {
                let i = chunk * LANE_ROWS + k;
                let (x, r, p, q) = (&mut step[i], &mut residual[i], &direction[i], &mut product[i]);
                let ahead = [(&mut x.u, &p.u), (&mut x.w, &p.w)];
                for (x, p) in ahead {
                    let next = l.mul_add(alpha, l.load(p), l.load(x));
                    l.store(x, next);
                }
                let u = l.sub_mul(alpha, l.load(&q.u), l.load(&r.u));
                let w = l.sub_mul(alpha, l.load(&q.w), l.load(&r.w));
                l.store(&mut r.u, u);
                l.store(&mut r.w, w);
                let [zu, zw] = inverse.times(l, u, w);
                l.store(&mut q.u, zu);
                l.store(&mut q.w, zw);
                lanes[0] = l.mul_add(zw, w, l.mul_add(zu, u, lanes[0]));
                lanes[1] = l.mul_add(w, w, l.mul_add(u, u, lanes[1]));
            }
            for (total, lanes) in total.iter_mut().zip(lanes) {
                *total += lanes::in_double(l.array(lanes));
            }
        }
        total
    }
}

struct Turn<'a> {
    part: &'a mut Part,
    beta: f32,
}

impl Kernel for Turn<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, direction, product, .. } = self.part;
        let beta = l.splat(self.beta);
        for (p, z) in direction[..grain.len()].iter_mut().zip(&*product) {
            let u = l.mul_add(beta, l.load(&p.u), l.load(&z.u));
            let w = l.mul_add(beta, l.load(&p.w), l.load(&z.w));
            l.store(&mut p.u, u);
            l.store(&mut p.w, w);
        }
    }
}

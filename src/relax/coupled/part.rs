//! One part of the linear system with friction: its blocks, its products and its vectors.

use super::block6::{Block6, Six};
use super::invert;
use super::joint::Joint;
use super::list::{List, Lists};
use crate::Vec3;
use crate::heap;
use crate::relax::curvature::{Curvature, Pairs};
use crate::relax::lanes::{self, Arithmetic, Four, Kernel, LANE_ROWS, Lanes, dispatch};
use crate::relax::split::Split;

/// Rows of the grains of this part, and behind them those of the separator it touches.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// The grain of each row.
    grain: Vec<u32>,
    /// Its contacts by rows.
    pub(super) list: List,
    /// The blocks that contacts with walls and membranes make.
    walls: Vec<(u32, Block6)>,
    /// Coupled grains that need not touch.
    pairs: Pairs,
    /// Sum of P/r of each row, also of the separator.
    pub(super) bending: Vec<f32>,
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
            + self.list.heap_bytes()
            + heap::bytes(&self.walls)
            + self.pairs.heap_bytes()
            + heap::bytes(&self.bending)
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
        self.walls.clear();
        self.bending.clear();
        self.bending.resize(all, 0.0);
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

    /// Takes the contacts of part `k`, which this is.
    pub(super) fn take_contacts(&mut self, split: &Split, k: usize, from: &Lists<'_>) {
        let List { pattern, joints, walls, .. } = &mut self.list;
        split.deal(k, from, pattern);
        from.copy(&pattern.source, joints);
        walls.clear();
        take_walls(walls, &from.lists[k], split, k);
    }

    /// Takes the contacts between the rows of this separator of `parts`.
    pub(super) fn take_between(&mut self, split: &Split, parts: &[Self], from: &Lists<'_>) {
        let List { pattern, joints, walls, .. } = &mut self.list;
        split.deal_between(parts.iter().map(|part| &part.list.pattern), pattern);
        from.copy(&pattern.source, joints);
        walls.clear();
        from.lists.iter().for_each(|list| take_walls(walls, list, split, parts.len()));
    }

    /// Takes what part `k`, which this is, has of `curvature`.
    pub(super) fn take_curvature(&mut self, split: &Split, k: usize, curvature: &Curvature) {
        self.pairs.take(split, k, curvature);
        let blocks = curvature.own_of(split, k);
        self.walls.extend(blocks.map(|(row, u)| (row as u32, Block6 { u, ..Block6::default() })));
    }

    /// Sum of P/r over the contacts of `row`, in units of the reference stiffness.
    pub(super) fn bending(&self, row: u32) -> f32 {
        self.bending[row as usize]
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
        let fresh = self.inverse.is_empty();
        self.inverse.resize(self.grain.len(), Block6::default());
        self.shift.resize(self.grain.len(), 0.0);
        dispatch(Invert { part: self, shift, fresh });
    }

    /// Takes -gradient / unit and -moment / unit as the residual.
    pub(super) fn start(&mut self, gradient: &[Vec3], moment: &[Vec3], unit: f64) {
        // The products too: those of a step that was refused may be no numbers.
        for vector in [&mut self.step, &mut self.direction, &mut self.product] {
            vector.fill(Six::default());
        }
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
        let Self { pairs, direction, product, .. } = self;
        pairs.multiply((direction, |x| &x.u), (product, |y| &mut y.u));
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

/// Takes the contacts of `list` with walls that belong to part `k`.
fn take_walls(walls: &mut Vec<(u32, Joint)>, list: &List, split: &Split, k: usize) {
    for &(grain, joint) in &list.walls {
        let at = split.places()[grain as usize];
        if at.part as usize == k {
            walls.push((at.row, joint));
        }
    }
}

struct Invert<'a> {
    part: &'a mut Part,
    shift: &'a [f32],
    /// Whether no inverse is known yet; otherwise few shifts changed.
    fresh: bool,
}

impl Kernel for Invert<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, diagonal, inverse, shift, .. } = self.part;
        let (grains, few_grains) = grain.as_chunks::<4>();
        let (shifts, few_shifts) = shift.as_chunks_mut::<4>();
        let (inverses, few_inverses) = inverse.as_chunks_mut::<4>();
        let (blocks, few_blocks) = diagonal[..grain.len()].as_chunks::<4>();
        let rows = grains.iter().zip(shifts).zip(blocks).zip(inverses);
        for (((grains, shift), blocks), inverses) in rows {
            let [a, b, c, d] = *grains;
            let at = self.shift;
            let wanted = [at[a as usize], at[b as usize], at[c as usize], at[d as usize]];
            if self.fresh || *shift != wanted {
                *shift = wanted;
                invert::four(l, blocks, wanted, inverses);
            }
        }
        let rows = few_grains.iter().zip(few_shifts).zip(few_blocks).zip(few_inverses);
        for (((&grain, shift), block), inverse) in rows {
            *shift = self.shift[grain as usize];
            *inverse = invert::one(block, *shift);
        }
    }
}

struct AddBlocks<'a> {
    part: &'a mut Part,
}

impl Kernel for AddBlocks<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, list, walls, diagonal, bending, .. } = self.part;
        let List { pattern, joints, .. } = &*list;
        for (row, joint) in &list.walls {
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
                bending[i] += joint.b.abs();
                bending[j as usize] += joint.b.abs();
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
        let Part { list, walls, shift, direction, product, .. } = self.part;
        let List { pattern, joints, .. } = &*list;
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
        let (two, zero) = (l.two(), l.splat(0.0));
        for i in 0..shift.len() {
            let (x, y) = (&direction[i], &product[i]);
            let x = [l.load(&x.u), l.load(&x.w)];
            let mut sum = [l.load(&y.u), l.load(&y.w)];
            let range = pattern.row(i);
            let (joints, one) = joints[range.clone()].as_chunks::<2>();
            let (second, one_second) = pattern.second[range].as_chunks::<2>();
            if !joints.is_empty() {
                // The second grains of a row's contacts all differ.
                let xi = [l.pair(x[0], x[0]), l.pair(x[1], x[1])];
                let mut sums = [l.pair(sum[0], zero), l.pair(sum[1], zero)];
                for (joints, &[j, k]) in joints.iter().zip(second) {
                    let (j, k) = (j as usize, k as usize);
                    let xj = six_pair(l, &direction[j], &direction[k]);
                    let yj = six_pair(l, &product[j], &product[k]);
                    let loaded = Joint::loaded_two(l, joints);
                    let [y, [u, w]] = loaded.multiply(two, [xi, xj], [sums, yj]);
                    sums = y;
                    let ([uj, uk], [wj, wk]) = (l.halves(u), l.halves(w));
                    l.store(&mut product[j].u, uj);
                    l.store(&mut product[j].w, wj);
                    l.store(&mut product[k].u, uk);
                    l.store(&mut product[k].w, wk);
                }
                let ([u, v], [w, z]) = (l.halves(sums[0]), l.halves(sums[1]));
                sum = [l.add(u, v), l.add(w, z)];
            }
            for (joint, &j) in one.iter().zip(one_second) {
                let j = j as usize;
                let xj = [l.load(&direction[j].u), l.load(&direction[j].w)];
                let yj = [l.load(&product[j].u), l.load(&product[j].w)];
                let [y, [u, w]] = joint.loaded(l).multiply(l, [x, xj], [sum, yj]);
                sum = y;
                l.store(&mut product[j].u, u);
                l.store(&mut product[j].w, w);
            }
            l.store(&mut product[i].u, sum[0]);
            l.store(&mut product[i].w, sum[1]);
        }
    }
}

/// Two rows beside each other.
#[inline(always)]
fn six_pair<L: Lanes>(l: L, a: &Six, b: &Six) -> [<L::Two as Arithmetic>::F; 2] {
    [l.pair(l.load(&a.u), l.load(&b.u)), l.pair(l.load(&a.w), l.load(&b.w))]
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

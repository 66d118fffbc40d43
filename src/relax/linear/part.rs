//! One part of the linear system: its factorisation, its sweeps and its vectors.

use crate::Vec3;
use crate::heap;
use crate::relax::balance::Link;
use crate::relax::block::Block;
use crate::relax::lanes::{self, Four, Kernel, LANE_ROWS, Lanes, dispatch};
use crate::relax::split::{Contacts, Pattern, Split};
use crate::relax::sym3::Sym3;

/// A pivot below this share of its row's mean diagonal is lifted to it.
const SMALL_PIVOT: f32 = 0.02;

/// What the sweeps need of a row, in one line of the cache.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Row {
    /// Δ⁻¹.
    inverse: Block,
    /// 2Δ - D.
    excess: Block,
}

/// Rows of the grains of this part, and behind them those of the separator it touches.
#[derive(Clone, Debug, Default)]
pub(super) struct Part {
    /// The grain of each row.
    grain: Vec<u32>,
    /// Where its contacts stand.
    pattern: Pattern,
    /// (m, -b) of each contact.
    contact: Vec<Four>,
    /// D without shift, also of the separator.
    pub(super) diagonal: Vec<Sym3>,
    /// Δ, and what it takes from the separator.
    pub(super) factor: Vec<Sym3>,
    rows: Vec<Row>,
    /// Δ once more, for the products with it.
    scale: Vec<Block>,
    /// The step, in units of `unit`.
    pub(super) step: Vec<Four>,
    residual: Vec<Four>,
    direction: Vec<Four>,
    /// (Δ + Lᵀ)⁻¹ p, also of the separator.
    pub(super) t: Vec<Four>,
    /// The preconditioned residual, then the product, then again; also for the separator.
    pub(super) w: Vec<Four>,
    /// The last scalar product.
    pub(super) dot: f64,
}

impl Part {
    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.grain)
            + self.pattern.heap_bytes()
            + heap::bytes(&self.contact)
            + heap::bytes(&self.diagonal)
            + heap::bytes(&self.factor)
            + heap::bytes(&self.rows)
            + heap::bytes(&self.scale)
            + heap::bytes(&self.step)
            + heap::bytes(&self.residual)
            + heap::bytes(&self.direction)
            + heap::bytes(&self.t)
            + heap::bytes(&self.w)
    }

    /// Begins an assembly of `rows` grains, with the separator `all` rows.
    pub(super) fn begin(&mut self, rows: usize, all: usize) {
        self.grain.resize(rows, 0);
        self.diagonal.clear();
        self.diagonal.resize(all, Sym3::default());
        self.factor.resize(all, Sym3::default());
        self.rows.resize(rows, Row::default());
        self.scale.resize(rows, Block::default());
        for vector in [&mut self.step, &mut self.residual, &mut self.direction] {
            vector.resize(rows, Four::default());
        }
        for vector in [&mut self.t, &mut self.w] {
            vector.resize(all, Four::default());
        }
    }

    /// Rows of grains.
    pub(super) fn rows(&self) -> usize {
        self.grain.len()
    }

    /// Puts `grain` with the stiffness of its walls into `row`.
    #[inline(always)]
    pub(super) fn place(&mut self, row: usize, grain: u32, walls: [f32; 3]) {
        self.grain[row] = grain;
        self.diagonal[row] = Sym3::diagonal(walls);
    }

    /// Takes the contacts of part `k`, which this is.
    pub(super) fn take_contacts(
        &mut self,
        split: &Split,
        k: usize,
        contacts: &impl Contacts,
        links: &[Link],
    ) {
        let Self { pattern, contact, diagonal, .. } = self;
        contact.clear();
        split.deal(k, contacts, pattern, |dealt| {
            let link = &links[dealt.contact as usize];
            add_contact_block(diagonal, dealt.row, dealt.second, link);
            contact.push(four(link));
        });
    }

    /// Takes the contacts between the rows of this separator of `parts`.
    pub(super) fn take_between(&mut self, parts: &[Self], links: &[Link]) {
        self.contact.clear();
        self.pattern.begin();
        for dealt in parts.iter().flat_map(|part| &part.pattern.between) {
            let link = &links[dealt.contact as usize];
            add_contact_block(&mut self.diagonal, dealt.row, dealt.second, link);
            self.pattern.push(dealt.row, dealt.second);
            self.contact.push(four(link));
        }
        self.pattern.end(self.grain.len());
    }

    /// Gives rows without contacts a unit block.
    pub(super) fn fill_empty_rows(&mut self) {
        for block in &mut self.diagonal[..self.grain.len()] {
            if block.trace() == 0.0 {
                *block = Sym3::diagonal([1.0; 3]);
            }
        }
    }

    /// Factorises this part.
    pub(super) fn factorise(&mut self, shift: &[f32]) {
        self.begin_factor(shift);
        self.factorise_rows();
    }

    /// Takes the shifted diagonal to the factor.
    pub(super) fn begin_factor(&mut self, shift: &[f32]) {
        self.factor.fill(Sym3::default());
        for ((factor, diagonal), &grain) in
            self.factor.iter_mut().zip(&self.diagonal).zip(&self.grain)
        {
            *factor = diagonal.shifted(shift[grain as usize]);
        }
        for (row, factor) in self.rows.iter_mut().zip(&self.factor) {
            // The shifted D waits here until Δ is known.
            row.excess = Block::from(factor);
        }
    }

    /// Eliminates row after row.
    pub(super) fn factorise_rows(&mut self) {
        for i in 0..self.grain.len() {
            let diagonal = self.rows[i].excess.sym3();
            let floor = SMALL_PIVOT * (diagonal.trace().abs() / 3.0).max(f32::MIN_POSITIVE);
            let (factor, inverse) = self.factor[i].inverse_lifted(floor);
            self.rows[i] = Row {
                inverse: Block::from(&inverse),
                excess: Block::from(&factor.twice_minus(&diagonal)),
            };
            self.scale[i] = Block::from(&factor);
            for k in self.pattern.row(i) {
                let Four([x, y, z, minus_b]) = self.contact[k];
                let second = self.pattern.second[k] as usize;
                self.factor[second].subtract_product([x, y, z], -minus_b, &inverse);
            }
        }
    }

    /// Takes -gradient / unit for the forward sweep that makes it the first residual.
    pub(super) fn start(&mut self, gradient: &[Vec3], unit: f64) {
        self.step.fill(Four::default());
        self.direction.fill(Four::default());
        self.t.fill(Four::default());
        self.w.fill(Four::default());
        for (w, &grain) in self.w.iter_mut().zip(&self.grain) {
            let r = gradient[grain as usize] * (-1.0 / unit);
            *w = Four([r.x as f32, r.y as f32, r.z as f32, 0.0]);
        }
    }

    /// Takes t of the separator, and forgets what the last forward sweep left for it.
    pub(super) fn take_separator(&mut self, late: &[Four]) {
        let rows = self.grain.len();
        self.t[rows..].copy_from_slice(late);
        self.w[rows..].fill(Four::default());
    }

    /// Direction ← w + `beta` direction, t ← (Δ + Lᵀ)⁻¹ direction and w ← direction - (2Δ - D) t.
    pub(super) fn backward(&mut self, beta: f32) {
        dispatch(Backward { part: self, beta });
    }

    /// w ← t + (Δ + L)⁻¹ w; `dot` becomes that of direction and w.
    pub(super) fn forward(&mut self) {
        self.dot = dispatch(Forward { part: self });
    }

    /// Goes `alpha` along the direction, or with `None` takes w as the residual; w ← Δ residual,
    /// and `dot` becomes that of both.
    pub(super) fn descend(&mut self, alpha: Option<f32>) {
        if alpha.is_none() {
            self.residual.copy_from_slice(&self.w[..self.grain.len()]);
        }
        self.dot = dispatch(Descend { part: self, alpha: alpha.unwrap_or(0.0) });
    }
}

#[inline(always)]
fn add_contact_block(diagonal: &mut [Sym3], row: u32, second: u32, link: &Link) {
    let block = Sym3::outer_minus(link.m, link.b);
    diagonal[row as usize].add(&block);
    diagonal[second as usize].add(&block);
}

#[inline(always)]
fn four(link: &Link) -> Four {
    let [x, y, z] = link.m;
    Four([x, y, z, -link.b])
}

struct Backward<'a> {
    part: &'a mut Part,
    beta: f32,
}

impl Kernel for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { pattern, contact, rows, direction, t, w, .. } = self.part;
        let beta = l.splat(self.beta);
        for (i, row) in rows.iter().enumerate().rev() {
            let p = l.mul_add(beta, l.load(&direction[i]), l.load(&w[i]));
            l.store(&mut direction[i], p);
            let range = pattern.row(i);
            let mut sum = p;
            for (contact, &j) in contact[range.clone()].iter().zip(&pattern.second[range]) {
                sum = add_contact(l, sum, l.load(contact), l.load(&t[j as usize]));
            }
            let ti = row.inverse.times(l, sum);
            l.store(&mut t[i], ti);
            l.store(&mut w[i], l.sub(p, row.excess.times(l, ti)));
        }
    }
}

struct Forward<'a> {
    part: &'a mut Part,
}

impl Kernel for Forward<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> f64 {
        let Part { pattern, contact, rows, direction, t, w, .. } = self.part;
        let mut total = 0.0;
        for (chunk, rows) in rows.chunks(LANE_ROWS).enumerate() {
            let mut lanes = l.splat(0.0);
            for (k, row) in rows.iter().enumerate() {
                let i = chunk * LANE_ROWS + k;
                let y = row.inverse.times(l, l.load(&w[i]));
                let range = pattern.row(i);
                for (contact, &j) in contact[range.clone()].iter().zip(&pattern.second[range]) {
                    let to = &mut w[j as usize];
                    let sum = add_contact(l, l.load(to), l.load(contact), y);
                    l.store(to, sum);
                }
                let wi = l.add(l.load(&t[i]), y);
                l.store(&mut w[i], wi);
                lanes = l.mul_add(l.load(&direction[i]), wi, lanes);
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
    type Output = f64;

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) -> f64 {
        let Part { scale, step, residual, t, w, .. } = self.part;
        let alpha = l.splat(self.alpha);
        let mut total = 0.0;
        for (chunk, scale) in scale.chunks(LANE_ROWS).enumerate() {
            let mut lanes = l.splat(0.0);
            for (k, scale) in scale.iter().enumerate() {
                let i = chunk * LANE_ROWS + k;
                let x = l.mul_add(alpha, l.load(&t[i]), l.load(&step[i]));
                l.store(&mut step[i], x);
                let r = l.sub_mul(alpha, l.load(&w[i]), l.load(&residual[i]));
                l.store(&mut residual[i], r);
                let z = scale.times(l, r);
                l.store(&mut w[i], z);
                lanes = l.mul_add(z, r, lanes);
            }
            total += lanes::in_double(l.array(lanes));
        }
        total
    }
}

/// `to` + K v for K = m mᵀ - b I, given (m, -b); lane 3 of v is zero, that of the sum undefined.
#[inline(always)]
fn add_contact<L: Lanes>(l: L, to: L::F, contact: L::F, v: L::F) -> L::F {
    let along = l.sum(l.mul(contact, v));
    l.mul_add(l.lane::<3>(contact), v, l.mul_add(contact, along, to))
}

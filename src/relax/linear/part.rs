//! One part of the linear system: its factorisation, its sweeps and its vectors.

use crate::Vec3;
use crate::heap;
use crate::relax::balance::Link;
use crate::relax::block::Block;
use crate::relax::curvature::{Curvature, Pairs};
use crate::relax::lanes::{self, Four, Kernel, LANE_ROWS, Lanes, dispatch};
use crate::relax::split::{Contacts, Pattern, Split};

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
    /// Coupled grains that need not touch.
    pairs: Pairs,
    /// D without shift, also of the separator.
    pub(super) diagonal: Vec<Block>,
    /// Δ, and what it takes from the separator.
    pub(super) factor: Vec<Block>,
    rows: Vec<Row>,
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
            + self.pairs.heap_bytes()
            + heap::bytes(&self.diagonal)
            + heap::bytes(&self.factor)
            + heap::bytes(&self.rows)
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
        self.diagonal.resize(all, Block::default());
        self.factor.resize(all, Block::default());
        self.rows.resize(rows, Row::default());
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
    pub(super) fn place(&mut self, row: usize, grain: u32, walls: Block) {
        self.grain[row] = grain;
        self.diagonal[row] = walls;
    }

    /// Takes the contacts of part `k`, which this is.
    pub(super) fn take_contacts(
        &mut self,
        split: &Split,
        k: usize,
        contacts: &impl Contacts,
        links: &[Link],
    ) {
        split.deal(k, contacts, &mut self.pattern);
        dispatch(Take { part: self, links });
    }

    /// Takes the contacts between the rows of this separator of `parts`.
    pub(super) fn take_between(&mut self, split: &Split, parts: &[Self], links: &[Link]) {
        split.deal_between(parts.iter().map(|part| &part.pattern), &mut self.pattern);
        dispatch(Take { part: self, links });
    }

    /// Gives rows without contacts a unit block.
    pub(super) fn fill_empty_rows(&mut self) {
        for block in &mut self.diagonal[..self.grain.len()] {
            if block.trace() == 0.0 {
                *block = Block::diagonal([1.0; 3]);
            }
        }
    }

    /// Takes what part `k`, which this is, has of `curvature`.
    pub(super) fn take_curvature(&mut self, split: &Split, k: usize, curvature: &Curvature) {
        self.pairs.take(split, k, curvature);
        for (row, block) in curvature.own_of(split, k) {
            self.diagonal[row].add(&block);
        }
    }

    /// Begins a factorisation.
    pub(super) fn begin_factor(&mut self) {
        self.factor.fill(Block::default());
    }

    /// Eliminates row after row of this part, shifted by `shift`, one a grain.
    pub(super) fn factorise(&mut self, shift: &[f32]) {
        dispatch(Factorise { part: self, shift });
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

    /// w ← w + C t for what couples grains that do not touch, between the sweeps.
    pub(super) fn bend(&mut self) {
        let Self { pairs, t, w, .. } = self;
        pairs.multiply((t, |t| t), (w, |w| w));
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

struct Take<'a> {
    part: &'a mut Part,
    links: &'a [Link],
}

impl Kernel for Take<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, pattern, contact, diagonal, .. } = self.part;
        let three = l.load(&Four([1.0, 1.0, 1.0, 0.0]));
        contact.resize(pattern.second.len(), Four::default());
        for i in 0..grain.len() {
            let range = pattern.row(i);
            let mut own = [l.load(&diagonal[i].on), l.load(&diagonal[i].off)];
            let contacts = contact[range.clone()].iter_mut().zip(&pattern.source[range.clone()]);
            for ((contact, source), &j) in contacts.zip(&pattern.second[range]) {
                let Link { m: [x, y, z], b, .. } = self.links[source.contact as usize];
                let link = l.set([x, y, z, -b]);
                l.store(contact, link);
                let m = l.mul(link, three);
                // m mᵀ - b I
                let on = l.mul_add(m, m, l.mul(l.lane::<3>(link), three));
                let off = l.mul(m, l.yzx(m));
                own = [l.add(own[0], on), l.add(own[1], off)];
                let Block { on: to_on, off: to_off } = &mut diagonal[j as usize];
                l.store(to_on, l.add(l.load(to_on), on));
                l.store(to_off, l.add(l.load(to_off), off));
            }
            l.store(&mut diagonal[i].on, own[0]);
            l.store(&mut diagonal[i].off, own[1]);
        }
    }
}

struct Factorise<'a> {
    part: &'a mut Part,
    shift: &'a [f32],
}

impl Kernel for Factorise<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, l: L) {
        let Part { grain, pattern, contact, diagonal, factor, rows, .. } = self.part;
        let three = l.load(&Four([1.0, 1.0, 1.0, 0.0]));
        for (i, row) in rows.iter_mut().enumerate() {
            let shift = l.mul(l.splat(self.shift[grain[i] as usize]), three);
            let on = l.add(l.load(&diagonal[i].on), shift);
            let off = l.load(&diagonal[i].off);
            let [trace, ..] = l.array(l.sum(on));
            let floor = SMALL_PIVOT * (trace.abs() / 3.0).max(f32::MIN_POSITIVE);
            let own = &mut factor[i];
            let (left_on, left_off) = (l.load(&own.on), l.load(&own.off));
            l.store(&mut own.on, l.add(on, left_on));
            l.store(&mut own.off, l.add(off, left_off));
            if !own.invert(l, floor, &mut row.inverse) {
                (*own, row.inverse) = own.inverse_lifted(floor);
            }
            l.store(&mut row.excess.on, l.sub(l.add(l.load(&own.on), l.load(&own.on)), on));
            l.store(&mut row.excess.off, l.sub(l.add(l.load(&own.off), l.load(&own.off)), off));
            // Δ_j -= K Δ_i⁻¹ K, with A for the inverse:
            // K A K = (m·Am) m mᵀ - b (m (Am)ᵀ + (Am) mᵀ) + b² A.
            let (a_on, a_off) = (l.load(&row.inverse.on), l.load(&row.inverse.off));
            let range = pattern.row(i);
            for (contact, &j) in contact[range.clone()].iter().zip(&pattern.second[range]) {
                let contact = l.load(contact);
                let m = l.mul(contact, three);
                let am = row.inverse.times(l, m);
                let minus_b = l.lane::<3>(contact);
                let square = l.mul(minus_b, minus_b);
                let along = l.mul(l.sum(l.mul(m, am)), m);
                let (m1, am1) = (l.yzx(m), l.yzx(am));
                let half = l.mul_add(minus_b, am, along);
                let whole = l.mul_add(minus_b, am, half);
                let to = &mut factor[j as usize];
                let on = l.sub_mul(square, a_on, l.load(&to.on));
                l.store(&mut to.on, l.sub_mul(m, whole, on));
                let off = l.sub_mul(square, a_off, l.load(&to.off));
                let off = l.sub_mul(m1, half, off);
                l.store(&mut to.off, l.sub_mul(l.mul(minus_b, m), am1, off));
            }
        }
    }
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
        let Part { grain, factor, step, residual, t, w, .. } = self.part;
        let alpha = l.splat(self.alpha);
        let mut total = 0.0;
        for (chunk, factor) in factor[..grain.len()].chunks(LANE_ROWS).enumerate() {
            let mut lanes = l.splat(0.0);
            for (k, factor) in factor.iter().enumerate() {
                let i = chunk * LANE_ROWS + k;
                let x = l.mul_add(alpha, l.load(&t[i]), l.load(&step[i]));
                l.store(&mut step[i], x);
                let r = l.sub_mul(alpha, l.load(&w[i]), l.load(&residual[i]));
                l.store(&mut residual[i], r);
                let z = factor.times(l, r);
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

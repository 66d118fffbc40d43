//! The linearised balance H s = -g, solved in single precision by preconditioned conjugate gradients.
//!
//! H = L + D + Lᵀ in 3x3 blocks. The preconditioner P = (Δ + L) Δ⁻¹ (Δ + Lᵀ) is an incomplete
//! Cholesky factorisation that modifies only the diagonal blocks, Δ_i = D_i - Σ_j K_ij Δ_j⁻¹ K_ij
//! over the earlier neighbours j. With Eisenstat's trick one backward and one forward sweep do
//! both the product with H and the two triangular solves (SIAM J. Sci. Stat. Comput. 2, 1, 1981).
//! What couples grains that do not touch is left out of L: of it P has the diagonal blocks alone, and the
//! product adds it between the sweeps.
//!
//! The parts of a split come first in the order of elimination and its separator last, so
//! that the parts can be swept at the same time.

mod part;

use std::sync::RwLock;

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::relax::balance::Balance;
use crate::relax::block::Block;
use crate::relax::crew::{read, together, write};
use crate::relax::lanes::Four;
use crate::relax::split::{Contacts, Place, Split, for_each};
use part::Part;

/// How an inner solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inner {
    /// The residual fell as far as asked, or the iterations ran out: the step descends.
    Step,
    /// A direction of negative curvature was met.
    NegativeCurvature,
}

/// The linear system and the vectors of its solution.
#[derive(Clone, Debug, Default)]
pub struct Linear {
    split: Split,
    parts: Vec<Part>,
    separator: Part,
    /// Products with H so far.
    pub products: u64,
}

/// The contacts of a balance.
struct Touching<'a> {
    balance: &'a Balance,
    neighbours: &'a Neighbours,
}

impl Contacts for Touching<'_> {
    #[inline(always)]
    fn row(&self, i: usize) -> impl DoubleEndedIterator<Item = (u32, u32)> {
        let first = self.neighbours.row(i).start;
        let row = &self.balance.links[first..first + self.balance.links_in_row[i] as usize];
        row.iter().enumerate().map(move |(k, link)| (link.second, (first + k) as u32))
    }
}

impl Linear {
    /// Takes the linearisation of `balance`; grains without contacts get a unit block.
    pub fn assemble(&mut self, balance: &Balance, neighbours: &Neighbours) {
        let contacts = Touching { balance, neighbours };
        let Self { split, parts, separator, .. } = self;
        let curvature = &balance.curvature;
        split.arrange(balance.gradient.len(), &contacts, curvature.grains());
        let split = &*split;
        parts.resize_with(split.parts(), Part::default);
        for_each(parts, |k, part| {
            part.begin(split.rows(k), split.rows_with_separator(k));
            for (i, at) in split.range(k).filter(|(_, at)| at.part as usize == k) {
                part.place(at.row as usize, i as u32, balance.wall_block(i));
            }
            part.take_contacts(split, k, &contacts, &balance.links);
            part.fill_empty_rows();
            part.take_curvature(split, k, curvature);
        });
        let late = split.parts();
        separator.begin(split.rows(late), split.rows_with_separator(late));
        for (i, at) in split.separator() {
            separator.place(at.row as usize, i as u32, balance.wall_block(i));
        }
        separator.take_between(split, parts, &balance.links);
        for part in &*parts {
            separator.add_diagonals(part);
        }
        separator.fill_empty_rows();
        separator.take_curvature(split, late, curvature);
    }

    /// Factorises H + Σ, where Σ shifts the block of grain i by `shift[i]` in units of the
    /// reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        for_each(&mut self.parts, |_, part| {
            part.begin_factor();
            part.factorise(shift);
        });
        self.separator.begin_factor();
        for part in &self.parts {
            self.separator.add_factors(part);
        }
        self.separator.factorise(shift);
    }

    /// Solves (H + Σ) s = -g until the preconditioned residual fell by `forcing`.
    ///
    /// `unit` is the force that right-hand side and step are scaled by.
    pub fn solve(&mut self, gradient: &[Vec3], unit: f64, forcing: f64, most: u32) -> Inner {
        let Self { parts, separator, products, .. } = self;
        let separator = RwLock::new(separator);
        let work = |part: &mut Part, order: Order| match order {
            Order::Start => {
                part.start(gradient, unit);
                part.forward();
            }
            Order::Sweep { beta } => {
                part.take_separator(&read(&separator).t);
                part.backward(beta);
                part.bend();
                part.forward();
            }
            Order::Descend { alpha } => part.descend(alpha),
        };
        together(parts, Order::Start, work, |crew| {
            let sum =
                |separator: &Part| crew.parts().map(|part| part.dot).sum::<f64>() + separator.dot;
            let descend = |alpha: Option<f32>| {
                write(&separator).descend(alpha);
                crew.call(Order::Descend { alpha });
                sum(&read(&separator))
            };
            let forward = || {
                let mut separator = write(&separator);
                crew.parts().for_each(|part| separator.gather(&part));
                separator.forward();
            };
            write(&separator).start(gradient, unit);
            crew.call(Order::Start);
            forward();
            let mut rho = descend(None);
            let target = rho * forcing * forcing;
            let mut beta = 0.0;
            for _ in 0..most {
                if rho <= target || rho <= 0.0 {
                    break;
                }
                *products += 1;
                write(&separator).backward(beta);
                write(&separator).bend();
                crew.call(Order::Sweep { beta });
                forward();
                let curvature = sum(&read(&separator));
                if curvature <= 0.0 || curvature.is_nan() {
                    return Inner::NegativeCurvature;
                }
                let next = descend(Some((rho / curvature) as f32));
                beta = (next / rho) as f32;
                rho = next;
            }
            Inner::Step
        })
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.parts)
            + self.split.heap_bytes()
            + self.separator.heap_bytes()
            + self.parts.iter().map(Part::heap_bytes).sum::<usize>()
    }

    /// The step \[m\] of grain `i`; `unit` is the force of [`solve`](Self::solve) over the
    /// reference stiffness.
    #[must_use]
    pub fn step(&self, i: usize, unit: f64) -> Vec3 {
        let Place { part, row } = self.split.places()[i];
        let part = self.parts.get(part as usize).unwrap_or(&self.separator);
        let Four([x, y, z, _]) = part.step[row as usize];
        Vec3::new(f64::from(x), f64::from(y), f64::from(z)) * unit
    }
}

/// What the parts do between two points where all must have come.
#[derive(Clone, Copy, Debug)]
enum Order {
    /// The first residual.
    Start,
    /// Both sweeps of a product.
    Sweep { beta: f32 },
    /// Along the direction.
    Descend { alpha: Option<f32> },
}

/// Σ v over the rows of `from` that stand for the separator, added to `to`.
fn add_late<T>(to: &mut [T], from: &[T], mut add: impl FnMut(&mut T, &T)) {
    for (to, from) in to.iter_mut().zip(from) {
        add(to, from);
    }
}

impl Part {
    /// Diagonal blocks that `part` has for this separator.
    fn add_diagonals(&mut self, part: &Self) {
        add_late(&mut self.diagonal, &part.diagonal[part.rows()..], Block::add);
    }

    /// What the factorisation of `part` leaves for this separator.
    fn add_factors(&mut self, part: &Self) {
        add_late(&mut self.factor, &part.factor[part.rows()..], Block::add);
    }

    /// What the forward sweep of `part` leaves for this separator.
    fn gather(&mut self, part: &Self) {
        add_late(&mut self.w, &part.w[part.rows()..], |Four(to), Four(from)| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += from;
            }
        });
    }
}

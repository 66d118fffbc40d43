//! The linearised balance H s = -g, solved in single precision by preconditioned conjugate gradients.
//!
//! H = L + D + Lᵀ in 3x3 blocks. The preconditioner P = (Δ + L) Δ⁻¹ (Δ + Lᵀ) is an incomplete
//! Cholesky factorisation that modifies only the diagonal blocks, Δ_i = D_i - Σ_j K_ij Δ_j⁻¹ K_ij
//! over the earlier neighbours j. With Eisenstat's trick one backward and one forward sweep do
//! both the product with H and the two triangular solves (SIAM J. Sci. Stat. Comput. 2, 1, 1981).
//!
//! The parts of a split come first in the order of elimination and its separator last, so
//! that the parts can be swept at the same time.

mod part;

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::relax::balance::{Balance, Link};
use crate::relax::lanes::Four;
use crate::relax::split::{Place, Split, for_each, part_of};
use crate::relax::sym3::Sym3;
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

/// The contacts of `balance`: the first grain of each, and the rest.
fn contacts<'a>(
    balance: &'a Balance,
    neighbours: &'a Neighbours,
) -> impl Iterator<Item = (usize, &'a Link)> {
    (0..balance.gradient.len()).flat_map(|i| {
        let first = neighbours.row(i).start;
        let row = &balance.links[first..first + balance.links_in_row[i] as usize];
        row.iter().map(move |link| (i, link))
    })
}

impl Linear {
    /// Takes the linearisation of `balance`; grains without contacts get a unit block.
    pub fn assemble(&mut self, balance: &Balance, neighbours: &Neighbours) {
        let rows = balance.gradient.len();
        let pairs = contacts(balance, neighbours).map(|(i, link)| (i as u32, link.second));
        self.split.arrange(rows, pairs);
        let parts = self.split.parts();
        self.parts.resize_with(parts, Part::default);
        for (k, part) in self.parts.iter_mut().chain([&mut self.separator]).enumerate() {
            part.begin(self.split.rows(k), self.split.rows_with_separator(k));
        }
        for (i, &Place { part, row }) in self.split.places().iter().enumerate() {
            let part = part_of(&mut self.parts, &mut self.separator, part as usize);
            part.place(row as usize, i as u32, balance.wall_stiffness[i]);
        }
        if parts == 1 {
            // The contacts are in order already.
            let part = &mut self.parts[0];
            for i in 0..rows {
                let first = neighbours.row(i).start;
                part.push_row(i, &balance.links[first..][..balance.links_in_row[i] as usize]);
            }
        } else {
            for (i, link) in contacts(balance, neighbours) {
                let meeting = self.split.meet(i, link.second);
                part_of(&mut self.parts, &mut self.separator, meeting.part)
                    .pattern
                    .count(meeting.row);
            }
            for part in self.parts.iter_mut().chain([&mut self.separator]) {
                part.make_room();
            }
            for (i, link) in contacts(balance, neighbours) {
                let meeting = self.split.meet(i, link.second);
                let part = part_of(&mut self.parts, &mut self.separator, meeting.part);
                part.insert(meeting.row, meeting.second, link);
            }
        }
        for part in &self.parts {
            self.separator.add_diagonals(part);
        }
        for part in self.parts.iter_mut().chain([&mut self.separator]) {
            part.fill_empty_rows();
        }
    }

    /// Factorises H + Σ, where Σ shifts the block of grain i by `shift[i]` in units of the
    /// reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        for_each(&mut self.parts, |part| part.factorise(shift));
        self.separator.begin_factor(shift);
        for part in &self.parts {
            self.separator.add_factors(part);
        }
        self.separator.factorise_rows();
    }

    /// Solves (H + Σ) s = -g until the preconditioned residual fell by `forcing`.
    ///
    /// `unit` is the force that right-hand side and step are scaled by.
    pub fn solve(&mut self, gradient: &[Vec3], unit: f64, forcing: f64, most: u32) -> Inner {
        let Self { parts, separator, products, .. } = self;
        separator.start(gradient, unit);
        for_each(parts, |part| {
            part.start(gradient, unit);
            part.forward();
        });
        separator.gather(parts);
        separator.forward();
        let mut rho = descend(parts, separator, None);
        let target = rho * forcing * forcing;
        let mut beta = 0.0;
        for _ in 0..most {
            if rho <= target || rho <= 0.0 {
                break;
            }
            *products += 1;
            separator.backward(beta);
            let late = &separator.t;
            for_each(parts, |part| {
                part.take_separator(late);
                part.backward(beta);
                part.forward();
            });
            separator.gather(parts);
            separator.forward();
            let curvature = parts.iter().map(|part| part.dot).sum::<f64>() + separator.dot;
            if curvature <= 0.0 || curvature.is_nan() {
                return Inner::NegativeCurvature;
            }
            let next = descend(parts, separator, Some((rho / curvature) as f32));
            beta = (next / rho) as f32;
            rho = next;
        }
        Inner::Step
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

/// Goes `alpha` along the direction, or takes the first residual; returns r·z.
fn descend(parts: &mut [Part], separator: &mut Part, alpha: Option<f32>) -> f64 {
    separator.descend(alpha);
    for_each(parts, |part| part.descend(alpha));
    parts.iter().map(|part| part.dot).sum::<f64>() + separator.dot
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
        add_late(&mut self.diagonal, &part.diagonal[part.rows()..], Sym3::add);
    }

    /// What the factorisation of `part` leaves for this separator.
    fn add_factors(&mut self, part: &Self) {
        add_late(&mut self.factor, &part.factor[part.rows()..], Sym3::add);
    }

    /// What the forward sweeps of `parts` leave for this separator.
    fn gather(&mut self, parts: &[Self]) {
        for part in parts {
            add_late(&mut self.w, &part.w[part.rows()..], |Four(to), Four(from)| {
                for (to, from) in to.iter_mut().zip(from) {
                    *to += from;
                }
            });
        }
    }
}

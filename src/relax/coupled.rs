//! The linearised balance with friction: six unknowns a grain, displacement u and rotation times
//! radius w = ΩR, solved in single precision by conjugate gradients with a 6x6 block-Jacobi
//! preconditioner.
//!
//! With d = u_i - u_j and ω = λ_i w_i + λ_j w_j, λ = arm/R, the sliding displacement of a contact
//! is s = T d + n̂ × ω and its stiffness across and along the direction of sliding is α and α + β:
//! the shear answers with t = α s + β e (e·s). Terms of the order Q/r against α are left out: they
//! change the way to the equilibrium, not the equilibrium.
//!
//! The rows are cut into the parts of a split, so that threads can share the work.

mod block6;
mod invert;
mod joint;
mod list;
mod part;

use std::sync::RwLock;

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::model;
use crate::relax::balance::Balance;
use crate::relax::crew::{read, together, write};
use crate::relax::lanes::Four;
use crate::relax::linear::Inner;
use crate::relax::split::{Place, Split, for_each};
use crate::relax::tangential::Reference;
use block6::Six;
use list::{List, Lists, Sources};
use part::Part;

/// Bending of a grain without contacts, over the reference stiffness.
const NO_BENDING: f32 = 1e-9;

/// The linear system and the vectors of its solution.
#[derive(Clone, Debug, Default)]
pub struct Coupled {
    /// Contacts of the grains in their order, part by part; empty where that is the only part.
    lists: Vec<List>,
    /// 1/R of each grain \[1/m\].
    over_radius: Vec<f32>,
    split: Split,
    parts: Vec<Part>,
    separator: Part,
    /// Products with the matrix so far.
    pub products: u64,
}

impl Coupled {
    /// Takes the linearisation of `balance`; grains without contacts get a unit block.
    pub fn assemble(
        &mut self,
        balance: &Balance,
        near: &Neighbours,
        reference: &Reference,
        radius: &[f64],
        reference_stiffness: f64,
    ) {
        let scale = (1.0 / reference_stiffness) as f32;
        let n = balance.gradient.len();
        let Self { split, parts, separator, lists, over_radius, .. } = self;
        over_radius.clear();
        over_radius.extend(radius.iter().map(|radius| (1.0 / radius) as f32));
        let sources = Sources { balance, near, reference, over_radius, scale };
        let count = model::parts(n);
        let length = n.div_ceil(count).max(1);
        lists.resize_with(if count == 1 { 0 } else { count }, List::default);
        for_each(lists, |k, list| {
            list.join(k * length..((k + 1) * length).min(n), sources);
        });
        let mut number = 0;
        for list in lists.iter_mut() {
            list.number = number;
            number += list.joints.len() as u32;
        }
        let lists = Lists { lists, length };
        let curvature = &balance.curvature;
        split.arrange(n, &lists, curvature.grains());
        let split = &*split;
        parts.resize_with(count, Part::default);
        for_each(parts, |k, part| {
            part.begin(split.rows(k), split.rows_with_separator(k));
            for (i, at) in split.range(k).filter(|(_, at)| at.part as usize == k) {
                part.place(at.row as usize, i as u32);
            }
            match count {
                1 => part.list.join(0..n, sources),
                _ => part.take_contacts(split, k, &lists),
            }
            part.take_curvature(split, k, curvature);
            part.add_blocks();
        });
        separator.begin(split.rows(count), split.rows_with_separator(count));
        for (i, at) in split.separator() {
            separator.place(at.row as usize, i as u32);
        }
        separator.take_between(split, parts, &lists);
        separator.take_curvature(split, count, curvature);
        separator.add_blocks();
        for part in &*parts {
            separator.add_tail(part);
        }
    }

    /// Inverts the diagonal blocks of H + Σ, where Σ shifts the block of grain i by `shift[i]` in
    /// units of the reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        self.separator.factorise(shift);
        for_each(&mut self.parts, |_, part| part.factorise(shift));
    }

    /// Solves (H + Σ) s = -g until the residual fell by `forcing`, preconditioned and as it is;
    /// `moment` is the gradient with respect to w. `unit` is the force that right-hand side and step
    /// are scaled by.
    pub fn solve(
        &mut self,
        gradient: &[Vec3],
        moment: &[Vec3],
        unit: f64,
        forcing: f64,
        most: u32,
    ) -> Inner {
        let Self { parts, separator, products, .. } = self;
        let separator = RwLock::new(separator);
        let work = |part: &mut Part, order: Order| match order {
            Order::Start => {
                part.start(gradient, moment, unit);
                part.descend(0.0);
            }
            Order::Multiply { beta } => {
                part.turn(beta);
                part.take_separator(&read(&separator).direction);
                part.multiply();
                part.measure();
            }
            Order::Descend { alpha } => part.descend(alpha),
        };
        together(parts, Order::Start, work, |crew| {
            let sum = |of: fn(&Part) -> f64, separator: &Part| {
                crew.parts().map(|part| of(&part)).sum::<f64>() + of(separator)
            };
            let dot = |separator: &Part| sum(|part| part.dot, separator);
            let square = |separator: &Part| sum(|part| part.square, separator);
            write(&separator).start(gradient, moment, unit);
            write(&separator).descend(0.0);
            crew.call(Order::Start);
            let mut rho = dot(&read(&separator));
            let target = rho * forcing * forcing;
            // What hardly holds a grain makes up most of the preconditioned residual.
            let plain = square(&read(&separator)) * forcing * forcing;
            let mut beta = 0.0;
            for _ in 0..most {
                if (rho <= target && square(&read(&separator)) <= plain) || rho <= 0.0 {
                    break;
                }
                *products += 1;
                write(&separator).turn(beta);
                crew.call(Order::Multiply { beta });
                let curvature = {
                    let mut separator = write(&separator);
                    separator.multiply();
                    crew.parts().for_each(|part| separator.gather(&part));
                    separator.measure();
                    dot(&separator)
                };
                if curvature <= 0.0 || curvature.is_nan() {
                    return Inner::NegativeCurvature;
                }
                let alpha = (rho / curvature) as f32;
                write(&separator).descend(alpha);
                crew.call(Order::Descend { alpha });
                let next = dot(&read(&separator));
                beta = (next / rho) as f32;
                rho = next;
            }
            Inner::Step
        })
    }

    /// After [`Inner::NegativeCurvature`]: the part of the curvature in the unknowns of grain `i`.
    #[must_use]
    pub fn curvature(&self, i: usize) -> f32 {
        let Place { part, row } = self.split.places()[i];
        self.part(part).curvature(row as usize)
    }

    /// Sum of P/r over the contacts of each grain, in units of the reference stiffness; a little
    /// more than none for grains without contacts.
    pub fn bending(&self) -> impl Iterator<Item = f32> {
        self.split.places().iter().map(|at| self.part(at.part).bending(at.row).max(NO_BENDING))
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.lists)
            + self.lists.iter().map(List::heap_bytes).sum::<usize>()
            + heap::bytes(&self.over_radius)
            + heap::bytes(&self.parts)
            + self.split.heap_bytes()
            + self.separator.heap_bytes()
            + self.parts.iter().map(Part::heap_bytes).sum::<usize>()
    }

    /// The displacement and the rotation times radius \[m\] of grain `i`; `unit` is the force of
    /// [`solve`](Self::solve) over the reference stiffness.
    #[must_use]
    pub fn step(&self, i: usize, unit: f64) -> [Vec3; 2] {
        let Place { part, row } = self.split.places()[i];
        let [[x, y, z], [a, b, c]] = self.part(part).step(row as usize);
        let three = |x: f32, y: f32, z: f32| Vec3::new(x.into(), y.into(), z.into()) * unit;
        [three(x, y, z), three(a, b, c)]
    }

    fn part(&self, k: u32) -> &Part {
        self.parts.get(k as usize).unwrap_or(&self.separator)
    }
}

impl Part {
    /// The blocks that `part` has for this separator.
    fn add_tail(&mut self, part: &Self) {
        for (to, from) in self.diagonal.iter_mut().zip(&part.diagonal[part.rows()..]) {
            to.add(from);
        }
        for (to, from) in self.bending.iter_mut().zip(&part.bending[part.rows()..]) {
            *to += from;
        }
    }

    /// What the product of `part` leaves for this separator.
    fn gather(&mut self, part: &Self) {
        let add = |Four(to): &mut Four, Four(from): &Four| {
            for (to, from) in to.iter_mut().zip(from) {
                *to += from;
            }
        };
        for (to, from) in self.product.iter_mut().zip(&part.product[part.rows()..]) {
            let Six { u, w } = to;
            add(u, &from.u);
            add(w, &from.w);
        }
    }
}

/// What the parts do between two points where all must have come.
#[derive(Clone, Copy, Debug)]
enum Order {
    /// The first residual.
    Start,
    /// A product with the next direction.
    Multiply { beta: f32 },
    /// Along the direction.
    Descend { alpha: f32 },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::loose::tests::strained;

    #[test]
    fn a_solve_does_not_remember_forces_that_were_no_numbers() {
        let (model, _, mut work) = strained(7);
        work.shift.resize(model.len(), 0.1);
        work.assemble(&model);
        let unit = work.balance.largest();
        assert_eq!(work.solve(unit, 0.1, 100), Inner::Step);
        let clean = (work.step.clone(), work.turn.clone());
        let mut spoilt = work.balance.clone();
        spoilt.gradient[3] = Vec3::repeat(f64::NAN);
        assert!(spoilt.largest().is_nan());
        assert_eq!(work.solve_again(&spoilt, unit, 0.1, 100), Inner::NegativeCurvature);
        assert_eq!(work.solve(unit, 0.1, 100), Inner::Step);
        assert!((&work.step, &work.turn) == (&clean.0, &clean.1));
    }
}

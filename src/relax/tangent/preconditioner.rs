//! The linear systems of the relaxation as a preconditioner of the exact derivative: they are in
//! single precision, and with friction they leave out terms of the order Q/r.

use crate::Vec3;
use crate::model::Model;
use crate::relax::balance::{Balance, Configuration};
use crate::relax::coupled::Coupled;
use crate::relax::linear::{Inner, Linear};

/// Reduction of the residual that is asked of one solve, most products of it, and of all.
const FORCING: f64 = 0.01;
const MOST_PRODUCTS: u32 = 500;
const BUDGET: u64 = 10_000;
/// Shifts that are tried in turn, over the mean sum of P/r of a grain. Without friction the
/// linear system is that of the energy, and a state that needs more than the second, which is what
/// single precision cannot tell, is no minimum.
const SHIFTS: [f64; 6] = [0.0, 1e-3, 1e-2, 1e-1, 1.0, 10.0];
const SHIFTS_OF_A_MINIMUM: usize = 2;

/// The linear system of one balance.
pub(super) struct Preconditioner {
    linear: Linear,
    coupled: Coupled,
    frictional: bool,
    reference_stiffness: f64,
    /// \[N/m\].
    bending: f64,
    /// Which of the shifts is in use.
    shift: usize,
    grains: usize,
}

impl Preconditioner {
    /// Of `balance`, taken at the configuration `at`.
    pub(super) fn new(model: &Model, balance: &Balance, at: &Configuration<'_>) -> Self {
        let mut new = Self {
            linear: Linear::default(),
            coupled: Coupled::default(),
            frictional: at.reference.active,
            reference_stiffness: at.reference_stiffness,
            bending: 2.0 * balance.sums.bending / model.len() as f64,
            shift: 0,
            grains: model.len(),
        };
        match new.frictional {
            false => new.linear.assemble(balance, at.neighbours),
            true => new.coupled.assemble(
                balance,
                at.neighbours,
                at.reference,
                &model.radius,
                at.reference_stiffness,
            ),
        }
        new.factorise();
        new
    }

    fn factorise(&mut self) {
        let shift = SHIFTS[self.shift] * self.bending / self.reference_stiffness;
        let shift = vec![shift as f32; self.grains];
        match self.frictional {
            false => self.linear.factorise(&shift),
            true => self.coupled.factorise(&shift),
        }
    }

    /// Products with the matrix so far.
    pub(super) fn products(&self) -> u64 {
        self.linear.products + self.coupled.products
    }

    /// What solves for `right`, nearly; `None` where the state is no minimum, or where it took too
    /// much.
    pub(super) fn solve(&mut self, right: &[Vec3]) -> Option<Vec<Vec3>> {
        let gradient: Vec<Vec3> = right.iter().map(|r| -r).collect();
        let (forces, moments) = gradient.split_at(self.grains);
        let largest = right.iter().map(Vec3::norm).fold(0.0, f64::max);
        let shifts = if self.frictional { SHIFTS.len() } else { SHIFTS_OF_A_MINIMUM };
        if self.products() > BUDGET {
            return None;
        }
        loop {
            let inner = match self.frictional {
                false => self.linear.solve(forces, largest, FORCING, MOST_PRODUCTS),
                true => self.coupled.solve(forces, moments, largest, FORCING, MOST_PRODUCTS),
            };
            if inner == Inner::Step {
                return Some(self.step(largest / self.reference_stiffness));
            }
            if self.shift + 1 == shifts || self.products() > BUDGET {
                return None;
            }
            self.shift += 1;
            self.factorise();
        }
    }

    fn step(&self, unit: f64) -> Vec<Vec3> {
        if !self.frictional {
            return (0..self.grains).map(|i| self.linear.step(i, unit)).collect();
        }
        let part = |k: usize| (0..self.grains).map(move |i| self.coupled.step(i, unit)[k]);
        part(0).chain(part(1)).collect()
    }
}

//! The generalised coordinates θ of a step, and the forces along them.

use crate::Vec3;
use crate::heap;

/// Most walls' drives: one an axis.
pub(super) const DRIVES: usize = 3;

/// Displacements u \[m\], rotations times radius w = ΩR \[m\] and motions of the drives e \[m\], or
/// the forces along them \[N\].
#[derive(Clone, Debug, Default)]
pub(super) struct Coordinates {
    /// Shape (n).
    pub(super) shift: Vec<Vec3>,
    /// Shape (n), or empty where no grain turns.
    pub(super) turn: Vec<Vec3>,
    /// Zero where there is no drive.
    pub(super) drive: [f64; DRIVES],
}

impl Coordinates {
    /// Makes them zero, for `shifts` and `turns` grains.
    pub(super) fn clear(&mut self, shifts: usize, turns: usize) {
        for (list, length) in [(&mut self.shift, shifts), (&mut self.turn, turns)] {
            list.clear();
            list.resize(length, Vec3::zeros());
        }
        self.drive = [0.0; DRIVES];
    }

    pub(super) fn dot(&self, other: &Self) -> f64 {
        let grains =
            |a: &[Vec3], b: &[Vec3]| -> f64 { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
        let drives: f64 = self.drive.iter().zip(other.drive).map(|(a, b)| a * b).sum();
        grains(&self.shift, &other.shift) + grains(&self.turn, &other.turn) + drives
    }

    /// self += factor other.
    pub(super) fn add(&mut self, factor: f64, other: &Self) {
        self.combine(1.0, factor, other);
    }

    /// self = own self + factor other.
    pub(super) fn combine(&mut self, own: f64, factor: f64, other: &Self) {
        let grains = |to: &mut [Vec3], by: &[Vec3]| {
            to.iter_mut().zip(by).for_each(|(to, by)| *to = *to * own + by * factor);
        };
        grains(&mut self.shift, &other.shift);
        grains(&mut self.turn, &other.turn);
        self.drive.iter_mut().zip(other.drive).for_each(|(to, by)| *to = *to * own + by * factor);
    }

    /// Largest entry of a grain; no number where one is none.
    pub(super) fn largest(&self) -> f64 {
        let squares = self.shift.iter().chain(&self.turn).map(Vec3::norm_squared);
        squares.fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most }).sqrt()
    }

    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.shift) + heap::bytes(&self.turn)
    }
}

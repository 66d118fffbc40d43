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
mod joint;
mod part;

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::relax::balance::{Balance, Link};
use crate::relax::lanes::Four;
use crate::relax::linear::Inner;
use crate::relax::split::{Place, Split, for_each, part_of};
use crate::relax::tangential::{Reference, Traction};
use block6::Six;
use joint::Joint;
use part::Part;

/// Bending of a grain without contacts, over the reference stiffness.
const NO_BENDING: f32 = 1e-9;

/// The linear system and the vectors of its solution.
#[derive(Clone, Debug, Default)]
pub struct Coupled {
    /// Contacts between grains as they come, with the grains they join.
    joints: Vec<Joint>,
    pairs: Vec<(u32, u32)>,
    /// Contacts of a grain with walls.
    walls: Vec<(u32, Joint)>,
    /// Sum of P/r of each grain.
    bending: Vec<f32>,
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
        self.join(balance, near, reference, radius, reference_stiffness);
        self.split.arrange(balance.gradient.len(), self.pairs.iter().copied());
        let Self { split, parts, separator, .. } = self;
        parts.resize_with(split.parts(), Part::default);
        for (k, part) in parts.iter_mut().chain([&mut *separator]).enumerate() {
            part.begin(split.rows(k), split.rows_with_separator(k));
        }
        for (i, &Place { part, row }) in split.places().iter().enumerate() {
            part_of(parts, separator, part as usize).place(row as usize, i as u32);
        }
        for (i, joint) in &self.walls {
            let Place { part, row } = split.places()[*i as usize];
            part_of(parts, separator, part as usize).insert_wall(row, *joint);
        }
        for &(i, j) in &self.pairs {
            let meeting = split.meet(i as usize, j);
            part_of(parts, separator, meeting.part).pattern.count(meeting.row);
        }
        for part in parts.iter_mut().chain([&mut *separator]) {
            part.make_room();
        }
        for (&(i, j), joint) in self.pairs.iter().zip(&self.joints) {
            let meeting = split.meet(i as usize, j);
            let joint = if meeting.swapped { joint.swapped() } else { *joint };
            part_of(parts, separator, meeting.part).insert(meeting.row, meeting.second, joint);
        }
        separator.add_blocks();
        for_each(parts, Part::add_blocks);
        for part in &*parts {
            for (to, from) in separator.diagonal.iter_mut().zip(&part.diagonal[part.rows()..]) {
                to.add(from);
            }
        }
    }

    /// Lists the contacts that touch, those that hold shear, and those that do both, in order.
    fn join(
        &mut self,
        balance: &Balance,
        near: &Neighbours,
        reference: &Reference,
        radius: &[f64],
        reference_stiffness: f64,
    ) {
        let rows = balance.gradient.len();
        let scale = (1.0 / reference_stiffness) as f32;
        let radius = |i: usize| radius[i] as f32;
        self.joints.clear();
        self.pairs.clear();
        self.walls.clear();
        self.bending.clear();
        self.bending.resize(rows, 0.0);
        let mut held = reference.contacts.iter().zip(&balance.tractions).peekable();
        for i in 0..rows {
            let first = near.row(i).start;
            let mut links = balance.links[first..first + balance.links_in_row[i] as usize].iter();
            let mut link = links.next();
            loop {
                let traction = held.peek().and_then(|(h, t)| match h.second {
                    Other::Grain(j) if h.first as usize == i => Some((j, *t)),
                    _ => None,
                });
                let (second, touching, shearing) = match (link, traction) {
                    (None, None) => break,
                    (Some(l), Some((j, t))) if l.second == j => (j, Some(l), Some(t)),
                    (Some(l), Some((j, _))) if l.second < j => (l.second, Some(l), None),
                    (Some(l), None) => (l.second, Some(l), None),
                    (_, Some((j, t))) => (j, None, Some(t)),
                };
                if shearing.is_some() {
                    held.next();
                }
                if let Some(l) = touching {
                    self.bending[i] += l.b;
                    self.bending[second as usize] += l.b;
                    link = links.next();
                }
                let live = shearing.filter(|t| t.live);
                if touching.is_some() || live.is_some() {
                    let radii = [radius(i), radius(second as usize)];
                    self.joints.push(joint(touching, live, radii, scale));
                    self.pairs.push((i as u32, second));
                }
            }
            for (axis, &k) in
                balance.wall_stiffness[i].iter().enumerate().filter(|(_, k)| **k != 0.0)
            {
                self.walls.push((i as u32, Joint::wall(axis, k)));
            }
            while let Some((_, t)) = held.next_if(|(h, _)| h.first as usize == i) {
                if t.live {
                    self.walls.push((i as u32, joint(None, Some(t), [radius(i); 2], scale)));
                }
            }
        }
    }

    /// Inverts the diagonal blocks of H + Σ, where Σ shifts the block of grain i by `shift[i]` in
    /// units of the reference stiffness.
    pub fn factorise(&mut self, shift: &[f32]) {
        self.separator.factorise(shift);
        for_each(&mut self.parts, |part| part.factorise(shift));
    }

    /// Solves (H + Σ) s = -g until the residual fell by `forcing`, preconditioned and as it is; `moment` is the
    /// gradient with respect to w. `unit` is the force that right-hand side and step are scaled by.
    pub fn solve(
        &mut self,
        gradient: &[Vec3],
        moment: &[Vec3],
        unit: f64,
        forcing: f64,
        most: u32,
    ) -> Inner {
        let Self { parts, separator, products, .. } = self;
        separator.start(gradient, moment, unit);
        for_each(parts, |part| part.start(gradient, moment, unit));
        let mut rho = descend(parts, separator, 0.0);
        // What hardly holds a grain makes up most of the preconditioned residual.
        let square = |parts: &[Part], separator: &Part| {
            parts.iter().map(|part| part.square).sum::<f64>() + separator.square
        };
        let target = rho * forcing * forcing;
        let plain = square(parts, separator) * forcing * forcing;
        let mut beta = 0.0;
        for _ in 0..most {
            if (rho <= target && square(parts, separator) <= plain) || rho <= 0.0 {
                break;
            }
            *products += 1;
            separator.turn(beta);
            separator.multiply();
            let late = &separator.direction;
            for_each(parts, |part| {
                part.turn(beta);
                part.take_separator(late);
                part.multiply();
                part.measure();
            });
            for part in &*parts {
                separator.gather(part);
            }
            separator.measure();
            let curvature = parts.iter().map(|part| part.dot).sum::<f64>() + separator.dot;
            if curvature <= 0.0 || curvature.is_nan() {
                return Inner::NegativeCurvature;
            }
            let next = descend(parts, separator, (rho / curvature) as f32);
            beta = (next / rho) as f32;
            rho = next;
        }
        Inner::Step
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
        self.bending.iter().map(|b| b.max(NO_BENDING))
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.joints)
            + heap::bytes(&self.pairs)
            + heap::bytes(&self.walls)
            + heap::bytes(&self.bending)
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
        self.part(part).step(row as usize).map(|s| Vec3::from(s.map(f64::from)) * unit)
    }

    fn part(&self, k: u32) -> &Part {
        self.parts.get(k as usize).unwrap_or(&self.separator)
    }
}

impl Part {
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

/// The contact of a touching pair, a pair that holds shear, or both.
fn joint(touching: Option<&Link>, live: Option<&Traction>, radii: [f32; 2], scale: f32) -> Joint {
    let mut joint = Joint::default();
    if let Some(link) = touching {
        joint.press(link.m, link.b);
    }
    if let Some(traction) = live {
        joint.shear(traction, radii, scale);
    }
    joint
}

/// Goes `alpha` along the direction; returns the product of the residual with the preconditioned.
fn descend(parts: &mut [Part], separator: &mut Part, alpha: f32) -> f64 {
    separator.descend(alpha);
    for_each(parts, |part| part.descend(alpha));
    parts.iter().map(|part| part.dot).sum::<f64>() + separator.dot
}

//! Walls under loads: their positions are unknowns of the equilibrium, like those of the grains.
//!
//! A drive moves one wall of a pair, or both by half, by e inwards until their mean normal force F
//! is the load f. With the grains taken along affinely, x = v + Σ X_a e_a, the unknowns v and e
//! balance where
//!
//! ```text
//! g = ∂Π/∂v = 0,    Γ_a = F_a - f_a + X_a·g = 0
//! ```
//!
//! and a Newton step is solved by elimination: H s = -g at standing walls as ever, H z_a = -∂g/∂e_a
//! for each drive, S_ab = ∂Γ_a/∂e_b + ∂g/∂e_a·z_b (the stiffness of the relaxed pack), and then
//!
//! ```text
//! S e = -(F - f + X·g + z·g),    v = s + Σ z_a e_a
//! ```
//!
//! Derivatives along e are differences of two balances. H and z change little from one step to the
//! next: they are renewed where the last step left too much of the unbalanced load. A pack that
//! does not resist (S is not positive) is unstable under its load.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::Vec3;
use crate::contact::neighbours::Neighbours;
use crate::heap;
use crate::measure::walls;
use crate::model::Model;
use crate::relax::linear::Inner;
use crate::relax::{Workspace, newton};
use crate::state::State;
use crate::wall::{self, Load, Room, Setpoint};

/// Overlaps change by this share between the two balances of a difference.
const DIFFERENCE: f64 = 1e-4;
/// The same as a strain where nothing touches.
const LEAST_STRAIN: f64 = 1e-9;
/// Reduction of the residual that is asked of the response to a drive, and most products of it.
const FORCING: f64 = 0.05;
const MOST_PRODUCTS: u32 = 400;
/// An eigenvalue of S that is this share of the largest is none.
const SOFT: f64 = 1e-9;
/// Longest step that is looked for, over the longest that is taken.
const FAR: f64 = 1e3;
/// Share of the unbalanced load that a step may leave before the response is renewed.
const SLOW: f64 = 0.05;

/// What moves one pair of walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Axis of the pair.
    pub axis: usize,
    /// Shares of the motion that the low and the high wall take; they sum to 1.
    pub shares: [f64; 2],
    /// The load of each wall that moves.
    pub load: Load,
}

impl Drive {
    /// The drives of `setpoint`, in the order of the axes. Round walls and membranes have their own.
    #[must_use]
    pub fn of(model: &Model, setpoint: &Setpoint) -> Vec<Self> {
        let alone = |w: usize| {
            let load = setpoint[w].load()?;
            let shares = if w.is_multiple_of(2) { [1.0, 0.0] } else { [0.0, 1.0] };
            Some(Self { axis: wall::axis(w), shares, load })
        };
        let drive = |axis: usize| {
            let loads = [setpoint[2 * axis].load(), setpoint[2 * axis + 1].load()];
            let (shares, load) = match loads {
                [Some(load), Some(_)] => ([0.5, 0.5], load),
                [Some(load), None] => ([1.0, 0.0], load),
                [None, Some(load)] => ([0.0, 1.0], load),
                [None, None] => return None,
            };
            Some(Self { axis, shares, load })
        };
        let Some(cell) = &model.cell else { return (0..3).filter_map(drive).collect() };
        let mut drives = Vec::new();
        for axis in 0..3 {
            let pair = [2 * axis, 2 * axis + 1];
            match cell.is_paired(axis) && !pair.iter().any(|&w| cell.is_membrane(w)) {
                true => drives.extend(drive(axis)),
                false => drives.extend(pair.into_iter().filter_map(alone)),
            }
        }
        drives
    }

    /// Whether it is the pressure of a membrane, which no wall moves by.
    #[must_use]
    pub(super) fn is_membrane(&self, model: &Model) -> bool {
        model.cell.as_ref().is_some_and(|cell| cell.is_membrane(self.wall()))
    }

    /// A wall that moves.
    #[must_use]
    pub(super) fn wall(&self) -> usize {
        2 * self.axis + usize::from(self.shares[0] == 0.0)
    }

    /// What its motion is a strain of \[m\].
    fn length(&self, room: &Room) -> f64 {
        match room.radii() {
            Some([_, outer]) if self.axis == 0 => outer,
            _ => room.sides()[self.axis],
        }
    }

    /// Mean normal force on the walls that move \[N\], of those on all walls.
    #[must_use]
    pub fn force(&self, forces: &[f64; wall::COUNT]) -> f64 {
        let [low, high] = self.shares;
        low * forces[2 * self.axis] + high * forces[2 * self.axis + 1]
    }

    /// Normal force that each wall shall carry in the box `bounds` \[N\].
    #[must_use]
    pub fn goal(&self, bounds: &Room) -> f64 {
        self.load.force(bounds.area(self.wall()))
    }

    /// The stress, where the load is one \[Pa\].
    #[must_use]
    pub fn stress(&self) -> Option<f64> {
        match self.load {
            Load::Force(_) => None,
            Load::Stress(stress) => Some(stress),
        }
    }

    /// Where the drive takes what is at `position`, over its own motion: X.
    fn carried(&self, position: &Vec3, bounds: &Room) -> Vec3 {
        if self.axis == 0 && bounds.is_round() {
            return bounds.carried(position, self.wall());
        }
        let mut carried = Vec3::zeros();
        let [low, high] = [bounds.min[self.axis], bounds.max[self.axis]];
        carried[self.axis] = self.shares[0] - (position[self.axis] - low) / (high - low);
        carried
    }
}

/// The drives of an increment, and how the pack responds to them.
#[derive(Clone, Debug, Default)]
pub struct Servo {
    /// At most three, one an axis; none where all walls stand.
    pub drives: Vec<Drive>,
    /// Motion of each drive in the present step \[m\].
    pub step: [f64; 3],
    /// Largest strain that one step, and all of a search, may take.
    most_strain: f64,
    /// Strain of each drive since the search began.
    strain: [f64; 3],
    /// z and z R of each drive, shapes (n) and (n) or empty.
    response: [(Vec<Vec3>, Vec<Vec3>); 3],
    /// ∂g/∂e, and with respect to w.
    forces: [(Vec<Vec3>, Vec<Vec3>); 3],
    /// S \[N/m\]; the unit matrix where there is no drive.
    stiffness: Matrix3<f64>,
    /// Whether response and stiffness are those of the present step.
    fresh: bool,
    /// What was left of the unbalanced loads when the last step began \[N\].
    left: f64,
    /// The step of the grains at standing walls, while the response is being solved for.
    standing: (Vec<Vec3>, Vec<Vec3>),
}

impl Servo {
    /// Whether any wall is under a load.
    #[must_use]
    pub fn is_active(&self) -> bool {
        !self.drives.is_empty()
    }

    /// Begins an increment under `drives`, none of which shall strain the box by more than
    /// `most_strain`.
    pub fn begin(&mut self, drives: &[Drive], most_strain: f64) {
        self.drives.clear();
        self.drives.extend_from_slice(drives);
        self.most_strain = most_strain;
        self.step = [0.0; 3];
    }

    /// Begins a search.
    pub(super) fn search(&mut self) {
        self.strain = [0.0; 3];
        self.renew();
    }

    /// Forgets how the pack responds.
    pub(super) fn renew(&mut self) {
        self.fresh = false;
        self.left = f64::INFINITY;
    }

    /// Unbalanced loads F - f \[N\]; the grains are their positions and which of them carry.
    pub(super) fn unbalance(
        &self,
        model: &Model,
        near: &Neighbours,
        grains: (&[Vec3], &[bool]),
        bounds: &Room,
        cement: &[f64; wall::COUNT],
    ) -> [f64; 3] {
        if self.drives.is_empty() {
            return [0.0; 3];
        }
        let mut forces = walls::normal_forces_in(model, near, grains, bounds);
        forces.iter_mut().zip(cement).for_each(|(force, cement)| *force += cement);
        std::array::from_fn(|a| match self.drives.get(a) {
            Some(drive) => drive.force(&forces) - drive.goal(bounds),
            None => 0.0,
        })
    }

    /// Largest unbalanced load over the load itself, or over `least` \[N\] where that is more.
    pub(super) fn residual(&self, unbalance: &[f64; 3], bounds: &Room, least: f64) -> f64 {
        (self.drives.iter().zip(unbalance))
            .map(|(drive, left)| left.abs() / drive.goal(bounds).max(least).max(f64::MIN_POSITIVE))
            .fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
    }

    /// Inward displacements after `factor` times the step \[m\].
    pub(super) fn displaced(
        &self,
        displacement: &[f64; wall::COUNT],
        factor: f64,
    ) -> [f64; wall::COUNT] {
        let mut displaced = *displacement;
        for (drive, step) in self.drives.iter().zip(self.step) {
            for side in 0..2 {
                // A wall that has no share keeps its bits.
                if drive.shares[side] > 0.0 {
                    displaced[2 * drive.axis + side] += drive.shares[side] * factor * step;
                }
            }
        }
        displaced
    }

    /// Work of the loads over `factor` times the step, which began in the box `before` and ends in
    /// `after` \[J\].
    pub(super) fn work(&self, before: &Room, after: &Room, factor: f64) -> f64 {
        (self.drives.iter().zip(self.step))
            .map(|(drive, step)| 0.5 * (drive.goal(before) + drive.goal(after)) * factor * step)
            .sum()
    }

    /// Whether the drives have strained the box further than they may since the search began.
    pub(super) fn ran_away(&self) -> bool {
        self.strain.iter().any(|strain| strain.abs() > self.most_strain)
    }

    /// Counts the step that was taken, `factor` times what it was.
    pub(super) fn took(&mut self, bounds: &Room, factor: f64) {
        for (a, drive) in self.drives.iter().enumerate() {
            self.strain[a] += factor * self.step[a] / drive.length(bounds);
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        let all = self.response.iter().chain(&self.forces).chain([&self.standing]);
        heap::bytes(&self.drives) + all.map(|(u, w)| heap::bytes(u) + heap::bytes(w)).sum::<usize>()
    }
}

/// How a step of the walls was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// To the balance of the linearised pack.
    Newton,
    /// Shorter than that, or downhill only: the pack yields.
    Yielding,
}

/// Adds the step of the walls to `work.step`, the one of the grains at standing walls. No grain
/// goes further than `cap` \[m\] beyond what the walls take it along.
pub(super) fn drive(
    model: &Model,
    state: &State,
    work: &mut Workspace,
    bounds: &Room,
    cap: f64,
) -> Motion {
    if !work.servo.is_active() {
        return Motion::Newton;
    }
    let mut left = unbalanced(state, work, bounds);
    let sums = work.balance.sums;
    let loads = work.servo.residual(&left.into(), bounds, sums.mean_force());
    let slow = left.norm() > SLOW * work.servo.left
        && loads > SLOW * newton::residual(model, work.balance.largest(), sums.mean_force());
    if !work.servo.fresh || slow {
        respond(model, state, work, bounds);
        left = unbalanced(state, work, bounds);
    }
    let servo = &mut work.servo;
    servo.left = left.norm();
    let (step, motion) = wall_step(servo, &left, bounds);
    servo.step = step;
    for (a, drive) in servo.drives.iter().enumerate() {
        let (response, turns) = &servo.response[a];
        let add = |to: &mut [Vec3], by: &[Vec3]| {
            for (to, by) in to.iter_mut().zip(by) {
                let by = by * step[a];
                let length = by.norm();
                *to += if length > cap { by * (cap / length) } else { by };
            }
        };
        add(&mut work.step, response);
        add(&mut work.turn, turns);
        for (to, at) in work.step.iter_mut().zip(&state.position) {
            *to += drive.carried(at, bounds) * step[a];
        }
    }
    motion
}

/// Where the walls of `state`, an equilibrium at other loads, yield to those of the drives: to their
/// balance if the pack resists that far, else downhill by the strain allowed. Displacements \[m\].
pub(super) fn yielding(model: &Model, state: &State, work: &mut Workspace) -> [f64; wall::COUNT] {
    let bounds = state.bounds(model);
    work.servo.search();
    work.begin(model, state);
    work.evaluate(model, state, &bounds);
    work.assemble(model);
    work.shift.clear();
    work.shift.resize(model.len(), 0.0);
    work.rest();
    drive(model, state, work, &bounds, work.balance.sums.mean_overlap());
    work.servo.displaced(&state.displacement, 1.0)
}

/// F - f + X·g + z·g: what the relaxed pack would leave of each load \[N\].
fn unbalanced(state: &State, work: &Workspace, bounds: &Room) -> Vector3<f64> {
    let Workspace { servo, balance, .. } = work;
    let mut left = Vector3::from(balance.unbalance);
    for (a, drive) in servo.drives.iter().enumerate() {
        left[a] += carried_force(drive, state, &balance.gradient, bounds);
        if servo.fresh {
            let (response, turns) = &servo.response[a];
            left[a] += dot(response, &balance.gradient) + dot(turns, &balance.moment);
        }
    }
    left
}

/// X·g \[N\].
fn carried_force(drive: &Drive, state: &State, gradient: &[Vec3], bounds: &Room) -> f64 {
    (state.position.iter().zip(gradient)).map(|(at, g)| drive.carried(at, bounds).dot(g)).sum()
}

fn dot(one: &[Vec3], other: &[Vec3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.dot(b)).sum()
}

/// The step of the drives \[m\] that leaves nothing of `left`, if the pack resists and the strain is
/// allowed; otherwise as far as it is, downhill.
fn wall_step(servo: &Servo, left: &Vector3<f64>, bounds: &Room) -> ([f64; 3], Motion) {
    let count = servo.drives.len();
    let symmetric = 0.5 * (servo.stiffness + servo.stiffness.transpose());
    if !symmetric.iter().chain(left).all(|number| number.is_finite()) {
        // The search sees that the balance is none; eigenvalues would be looked for in vain.
        return ([0.0; 3], Motion::Yielding);
    }
    let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(symmetric);
    let largest = eigenvalues.amax();
    let sides = bounds.sides();
    // What does not resist at all is far from its balance; how far does not matter.
    let far = FAR * servo.most_strain * Vector3::from(sides).amax();
    let least = (SOFT * largest).max(left.norm() / far).max(f64::MIN_POSITIVE);
    let mut step = Vector3::zeros();
    let mut motion = Motion::Newton;
    for (value, direction) in eigenvalues.iter().zip(eigenvectors.column_iter()) {
        if *value <= SOFT * largest {
            motion = Motion::Yielding;
        }
        step -= direction * (direction.dot(left) / value.abs().max(least));
    }
    let strain =
        (0..count).map(|a| step[a].abs() / servo.drives[a].length(bounds)).fold(0.0, f64::max);
    if strain > servo.most_strain {
        step *= servo.most_strain / strain;
        motion = Motion::Yielding;
    }
    (std::array::from_fn(|a| if a < count { step[a] } else { 0.0 }), motion)
}

/// Takes response and stiffness anew, with the linear system at hand; `work.step` stays.
fn respond(model: &Model, state: &State, work: &mut Workspace, bounds: &Room) {
    std::mem::swap(&mut work.servo.standing.0, &mut work.step);
    std::mem::swap(&mut work.servo.standing.1, &mut work.turn);
    let count = work.servo.drives.len();
    let mut stiffness = Matrix3::identity();
    work.servo.fresh = false;
    let here = unbalanced(state, work, bounds);
    let overlap = work.balance.sums.mean_overlap() / (2.0 * model.mean_radius);
    let strain = (DIFFERENCE * overlap).max(LEAST_STRAIN);
    for b in 0..count {
        let drive = work.servo.drives[b];
        let shift = strain * drive.length(bounds);
        work.step.clear();
        work.step.extend(state.position.iter().map(|at| drive.carried(at, bounds) * shift));
        work.turn.clear();
        work.turn.resize(state.rotation.len(), Vec3::zeros());
        work.servo.step = std::array::from_fn(|a| if a == b { shift } else { 0.0 });
        work.try_step(model, state, 1.0);
        let Workspace { servo, balance, trial_balance, .. } = work;
        for a in 0..count {
            let drive = servo.drives[a];
            let there = trial_balance.unbalance[a]
                + carried_force(&drive, state, &trial_balance.gradient, bounds);
            stiffness[(a, b)] = (there - here[a]) / shift;
        }
        let (forces, moments) = &mut servo.forces[b];
        difference(forces, &trial_balance.gradient, &balance.gradient, shift);
        difference(moments, &trial_balance.moment, &balance.moment, shift);
    }
    for b in 0..count {
        let mut right = std::mem::take(&mut work.trial_balance);
        right.gradient.clone_from(&work.servo.forces[b].0);
        right.moment.clone_from(&work.servo.forces[b].1);
        let largest = right.largest();
        let solved = largest > 0.0
            && work.solve_again(&right, largest, FORCING, MOST_PRODUCTS) == Inner::Step;
        work.trial_balance = right;
        let Workspace { servo, step, turn, .. } = work;
        if !solved {
            // The grains then go with the walls: a stiffer pack, and a shorter step.
            step.clear();
            step.resize(state.position.len(), Vec3::zeros());
            turn.clear();
            turn.resize(state.rotation.len(), Vec3::zeros());
        }
        let (response, turns) = &mut servo.response[b];
        std::mem::swap(response, step);
        std::mem::swap(turns, turn);
        for a in 0..count {
            let (forces, moments) = &servo.forces[a];
            let (response, turns) = &servo.response[b];
            stiffness[(a, b)] += dot(forces, response) + dot(moments, turns);
        }
    }
    let servo = &mut work.servo;
    // What no drive moves takes no part.
    let scale = (0..count).map(|a| stiffness[(a, a)].abs()).fold(0.0, f64::max);
    for a in count..3 {
        stiffness[(a, a)] = scale;
    }
    servo.stiffness = stiffness;
    servo.fresh = true;
    std::mem::swap(&mut servo.standing.0, &mut work.step);
    std::mem::swap(&mut servo.standing.1, &mut work.turn);
}

/// (to - from) / shift.
fn difference(into: &mut Vec<Vec3>, to: &[Vec3], from: &[Vec3], shift: f64) {
    into.clear();
    into.extend(to.iter().zip(from).map(|(to, from)| (to - from) / shift));
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::wall::Bounds;

    fn unit_box() -> Room {
        Room::from(Bounds { min: [0.0; 3], max: [1e-3; 3] })
    }

    fn servo(stiffness: Matrix3<f64>) -> Servo {
        let drive = |axis| Drive { axis, shares: [0.5, 0.5], load: Load::Stress(1e6) };
        Servo { drives: vec![drive(0), drive(2)], most_strain: 1e-4, stiffness, ..Servo::default() }
    }

    #[test]
    fn walls_go_to_the_balance_of_a_pack_that_resists() {
        let stiffness = Matrix3::new(3e6, 1e6, 0.0, 1e6, 2e6, 0.0, 0.0, 0.0, 3e6);
        let (step, motion) =
            wall_step(&servo(stiffness), &Vector3::new(-0.04, 0.01, 0.0), &unit_box());
        assert_eq!(motion, Motion::Newton);
        // 3 x + y = 0.04, x + 2 y = -0.01, in 1e-6 m.
        assert!((step[0] - 0.018e-6).abs() < 1e-20 && (step[1] + 0.014e-6).abs() < 1e-20);
        assert_eq!(step[2], 0.0);
    }

    #[test]
    fn walls_go_downhill_and_no_further_than_allowed_where_the_pack_yields() {
        let stiffness = Matrix3::from_diagonal(&Vector3::new(3e6, -1e3, 3e6));
        let (step, motion) =
            wall_step(&servo(stiffness), &Vector3::new(0.0, -0.5, 0.0), &unit_box());
        assert_eq!((motion, step[0]), (Motion::Yielding, 0.0));
        assert!((step[1] / 1e-7 - 1.0).abs() < 1e-12, "{step:?}");
        let nothing = Matrix3::zeros();
        let (step, motion) = wall_step(&servo(nothing), &Vector3::new(-1.0, 0.0, 0.0), &unit_box());
        assert_eq!(motion, Motion::Yielding);
        assert!((step[0] / 1e-7 - 1.0).abs() < 1e-12, "{step:?}");
    }

    #[test]
    fn a_balance_that_is_none_moves_no_wall() {
        for number in [f64::NAN, f64::INFINITY] {
            let left = Vector3::new(1.0, number, 0.0);
            assert_eq!(wall_step(&servo(Matrix3::identity()), &left, &unit_box()).0, [0.0; 3]);
            let stiffness = Matrix3::identity() * number;
            assert_eq!(wall_step(&servo(stiffness), &Vector3::x(), &unit_box()).0, [0.0; 3]);
        }
    }
}

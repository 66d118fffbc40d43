//! Jumps: what an instability did to the pack.

use crate::Vec3;
use crate::heap;
use crate::model::Model;
use crate::plane::lean::Lean;
use crate::relax::balance::Balance;
use crate::state::{Dissociated, State};
use crate::wall::{self, Room};

/// The unbalanced force has grown when it is this many times its least.
const GROWTH: f64 = 1.5;
/// A grain jumped when it went further than this many mean overlaps.
const FAR: f64 = 1.0;

/// Where the grains are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Centres \[m\], shape (n).
    pub position: Vec<Vec3>,
    /// Rotations \[rad\], shape (n) or empty.
    pub rotation: Vec<Vec3>,
    /// Inward displacement of the walls since the start \[m\].
    pub displacement: [f64; wall::COUNT],
    /// Shear by which a box of discs leans.
    pub tilt: f64,
    /// What had happened to the grains.
    pub dissociated: Dissociated,
}

impl Pose {
    /// Takes that of `state`.
    pub fn copy(&mut self, state: &State) {
        self.position.clone_from(&state.position);
        self.rotation.clone_from(&state.rotation);
        self.displacement = state.displacement;
        self.tilt = state.tilt;
        self.dissociated = state.dissociated;
    }

    /// How far each grain of `state` is from here, but for where the walls took it along \[m\].
    pub fn moved<'a>(&'a self, model: &Model, state: &'a State) -> impl Iterator<Item = Vec3> + 'a {
        let carry = self.carry(model, state);
        state.position.iter().zip(&self.position).map(move |(at, from)| at - carry(from))
    }

    /// Where the walls on their way to where `state` has them take what is at a place.
    pub fn carry(&self, model: &Model, state: &State) -> impl Fn(&Vec3) -> Vec3 + use<> {
        let (before, after) = (self.bounds(model), state.bounds(model));
        let stands = self.displacement == state.displacement && self.tilt == state.tilt;
        let carried = Carried::new(&before, &after);
        let leans = self.tilt != 0.0 || state.tilt != 0.0;
        let [from, to] = [(&before, self.tilt), (&after, state.tilt)]
            .map(|(bounds, tilt)| Lean::new(model, bounds, tilt));
        move |at| match (stands, leans) {
            (true, _) => *at,
            (false, true) => from.carry(&to, at),
            (false, false) => carried.to(at),
        }
    }

    /// That of `state`.
    fn of(state: &State) -> Self {
        let mut pose = Self::default();
        pose.copy(state);
        pose
    }

    /// The box.
    #[must_use]
    pub fn bounds(&self, model: &Model) -> Room {
        model.bounds(&self.displacement)
    }

    /// Memory that its lists hold \[bytes\].
    pub(crate) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.position) + heap::bytes(&self.rotation)
    }

    /// Puts the grains of `state` here.
    pub(super) fn restore(&self, state: &mut State) {
        state.position.copy_from_slice(&self.position);
        state.rotation.copy_from_slice(&self.rotation);
    }
}

/// The motion of what is between walls that go from one place to another: affine in a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Carried {
    before: Room,
    after: Room,
    from: Vec3,
    to: Vec3,
    scale: Vec3,
}

impl Carried {
    pub(super) fn new(before: &Room, after: &Room) -> Self {
        Self {
            before: *before,
            after: *after,
            from: before.min.into(),
            to: after.min.into(),
            scale: Vec3::from(after.sides()).component_div(&Vec3::from(before.sides())),
        }
    }

    /// Where it takes what was at `at`.
    pub(super) fn to(&self, at: &Vec3) -> Vec3 {
        match self.before.is_round() {
            false => self.to + self.scale.component_mul(&(at - self.from)),
            true => self.before.carry(&self.after, at),
        }
    }
}

/// A rearrangement while the walls stood still: from where stability was lost to an equilibrium.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// Mean normal stress of the contacts, the trace over three \[Pa\], where stability was lost.
    pub stress_before: f64,
    /// The same at the equilibrium that the pack came to.
    pub stress_after: f64,
    /// Elastic and gravitational energy where stability was lost, with what slip took since the
    /// last equilibrium \[J\].
    pub energy_before: f64,
    /// The same at the equilibrium that the pack came to.
    pub energy_after: f64,
    /// Grains that went further than the mean overlap, in the solver's order, and how far \[m\].
    pub grains: Vec<(u32, f64)>,
    /// Where stability was lost.
    pub before: Pose,
    /// Where the pack came to.
    pub after: Pose,
}

impl Jump {
    /// Energy that neither the pack stores nor slip took \[J\]: what drag takes in overdamped motion.
    #[must_use]
    pub fn released(&self) -> f64 {
        self.energy_before - self.energy_after
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        heap::bytes(&self.grains) + self.before.heap_bytes() + self.after.heap_bytes()
    }
}

/// Looks for the point at which stability was lost: on its way down the unbalanced force of the
/// pack first dies away as if there were an equilibrium, and then grows again.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    pose: Pose,
    virial: f64,
    potential: f64,
    least: f64,
    grown: bool,
}

impl Watch {
    /// Sees a configuration of the flow.
    pub(super) fn see(&mut self, state: &State, balance: &Balance) {
        if self.grown {
            return;
        }
        let all = balance.gradient.iter().chain(&balance.moment);
        let square: f64 = all.map(Vec3::norm_squared).sum();
        if self.pose.position.is_empty() || square < self.least {
            self.least = square;
            self.pose.copy(state);
            self.virial = balance.sums.virial.iter().sum();
            self.potential = balance.potential();
        } else {
            self.grown = square > GROWTH * GROWTH * self.least;
        }
    }

    /// What happened on the way to the equilibrium `state` with `balance`; `None` where the force
    /// only fell, or no grain that carries load jumped.
    pub(super) fn jump(self, model: &Model, state: &State, balance: &Balance) -> Option<Jump> {
        if !self.grown {
            return None;
        }
        let sums = &balance.sums;
        let far = FAR * sums.mean_overlap();
        let moved = |i: usize| (state.position[i] - self.pose.position[i]).norm();
        let grains: Vec<(u32, f64)> = (0..model.len())
            .filter(|&i| state.carries[i])
            .map(|i| (i as u32, moved(i)))
            .filter(|&(_, moved)| moved > far)
            .collect();
        let volume = 3.0 * state.bounds(model).volume();
        let after: f64 = sums.virial.iter().sum();
        (!grains.is_empty()).then(|| Jump {
            stress_before: self.virial / volume,
            stress_after: after / volume,
            energy_before: self.potential,
            energy_after: balance.potential(),
            grains,
            before: self.pose,
            after: Pose::of(state),
        })
    }
}

//! Discs that move, push each other apart and come to rest under a stress.
//!
//! Time is counted in steps; masses are those of the stiffness of a contact at the stress asked for, so
//! that a step is a part of the period of a contact. A weak drag takes the energy.

use nalgebra::Vector2;

use super::contacts::{self, Law, Pair, Sums};
use super::frame::Frame;
use crate::contact::hertz;

/// Mass of a mean grain over the stiffness of a contact at the stress asked for.
const MASS: f64 = 6.0;
/// Share of its velocity that a grain loses in a step.
const DRAG: f64 = 0.01;
/// Longest way of a grain in a step over its mean radius.
const LONGEST: f64 = 0.05;
/// Skin of the list of pairs over the mean radius.
const SKIN: f64 = 0.3;
/// Steps in which the discs grow, and their size at the start.
const GROWTH: (u32, f64) = (4000, 0.01);
/// Strain of the box in a step while the grains hardly press, and while they do over the overlap strain.
const RATES: (f64, f64) = (2e-5, 5e-3);
/// Stress over the one asked for below which they hardly press.
const PRESSED: f64 = 0.05;
/// Most steps of the compaction.
const MOST_STEPS: u32 = 400_000;
/// Overlap over mean radius at which discs gather, and what the stress is divided by in each stage of relief
/// from there, at most. Discs that overlap less are near to where nothing holds them: they rearrange for
/// long before they come to rest under a rising stress, and stay where they are under a falling one.
const GATHERED: f64 = 2e-3;
const RELIEF: f64 = 8.0;
/// Mean contact force over stress and squared mean radius: 2σV/(n_c d̄) of 2 contacts a grain.
const FORCE_PER_STRESS: f64 = 4.2;

/// Discs in motion. Arrays have one entry a grain.
#[derive(Clone, Debug)]
pub(super) struct Discs {
    /// Centres \[m\].
    pub(super) at: Vec<Vector2<f64>>,
    /// Velocity along x and y, and of the rim by the turn, \[m\] a step.
    pub(super) speed: Vec<[f64; 3]>,
    /// Force along x and y, and couple over radius \[N\].
    pub(super) force: Vec<[f64; 3]>,
    /// Radii of the grown discs \[m\].
    pub(super) radius: Vec<f64>,
    /// (1-ν²)/E and (2-ν)/G \[1/Pa\].
    pub(super) compliance: Vec<f64>,
    pub(super) shear_compliance: Vec<f64>,
    /// Hertz' modulus with a wall \[N/m^1.5\].
    pub(super) at_wall: Vec<f64>,
    pub(super) law: Law,
    /// Present size over that when grown.
    pub(super) grown: f64,
    pub(super) frame: Frame,
    /// Depth of the pack \[m\].
    pub(super) depth: f64,
    pub(super) pairs: Vec<Pair>,
}

/// Where a compaction goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// Stress on the walls that move \[Pa\].
    pub(super) stress: f64,
    /// Largest of shear over normal force.
    pub(super) friction: f64,
}

/// What a run counts in.
struct Clock {
    /// One over the mass of each grain \[1/kg\].
    lightness: Vec<f64>,
    mean_radius: f64,
    /// Mean overlap at the stress asked for \[m\].
    overlap: f64,
    /// How far pairs may yet come closer before the list is made anew \[m\].
    allowance: f64,
    /// Time and strain of the last step.
    time: f64,
    strain: [f64; 2],
}

impl Discs {
    /// Blows the discs up between walls that stand, from a hundredth of their size.
    pub(super) fn grow(&mut self, goal: &Goal) {
        let mut clock = self.clock(goal);
        let (steps, least) = GROWTH;
        for step in 1..=steps {
            let before = self.grown;
            self.grown = least + (1.0 - least) * f64::from(step) / f64::from(steps);
            let largest = self.radius.iter().fold(0.0, |most: f64, &radius| most.max(radius));
            clock.allowance -= 2.0 * largest * (self.grown - before);
            let sums = self.press(goal, &mut clock);
            self.go(&sums, [0.0; 2], &mut clock);
        }
    }

    /// Brings the walls and the discs to rest with the stress asked for on all walls that move, until the root mean
    /// square of the unbalanced forces over the mean contact force is `residual`; says whether they came
    /// to that.
    pub(super) fn compact(&mut self, goal: &Goal, residual: f64) -> bool {
        let mut clock = self.clock(goal);
        let (free, pressed) = RATES;
        let pressed = free.min(pressed * clock.overlap / clock.mean_radius);
        for _ in 0..MOST_STEPS {
            let sums = self.press(goal, &mut clock);
            let volume = self.frame.area() * self.depth;
            let stress = sums.moment.map(|moment| moment / volume);
            let presses = stress[0] + stress[1] > 2.0 * PRESSED * goal.stress;
            let rate = if presses { pressed } else { free };
            let excess = stress.map(|stress| stress / goal.stress - 1.0);
            let square: f64 = self.force.iter().flatten().map(|force| force * force).sum();
            let unbalanced = (square / (3 * self.at.len()) as f64).sqrt();
            if !square.is_finite() {
                return false;
            }
            let even = excess.iter().all(|excess| excess.abs() <= residual);
            if even && unbalanced <= residual * sums.mean_force() {
                return true;
            }
            self.go(&sums, excess.map(|excess| rate * excess.clamp(-1.0, 1.0)), &mut clock);
        }
        false
    }

    /// The stresses above that of `goal` \[Pa\] from which the discs come to it, one after the other: from
    /// where they overlap enough to gather, or from what presses them now if they are under more than the
    /// goal already.
    pub(super) fn relief(&mut self, goal: &Goal) -> Vec<f64> {
        let (mean_radius, _) = self.means();
        let (overlap, _) = self.contact(goal.stress);
        let power = match self.law {
            Law::Hertz => 1.5,
            Law::Linear { .. } => 1.0,
        };
        let rise = (GATHERED * mean_radius / overlap).powf(power);
        if rise <= 1.0 {
            return Vec::new();
        }
        let mut clock = self.clock(goal);
        let moment = self.press(goal, &mut clock).moment;
        let now = 0.5 * (moment[0] + moment[1]) / (self.frame.area() * self.depth);
        let stages = (rise.ln() / RELIEF.ln()).ceil();
        let stage = |left: u32| goal.stress * rise.powf(f64::from(left) / stages);
        let all = (1..=stages as u32).rev().map(stage);
        all.filter(|&stress| now < goal.stress || stress < now).collect()
    }

    /// Mean radius \[m\] and mean of (1-ν²)/E \[1/Pa\].
    fn means(&self) -> (f64, f64) {
        let count = self.at.len() as f64;
        let compliance = self.compliance.iter().sum::<f64>() / count;
        (self.radius.iter().sum::<f64>() / count, compliance)
    }

    /// Mean overlap \[m\] and stiffness \[N/m\] of the contacts at `stress` \[Pa\].
    fn contact(&self, stress: f64) -> (f64, f64) {
        let (mean_radius, compliance) = self.means();
        let modulus = hertz::modulus(0.5 * mean_radius, 2.0 * compliance);
        let force = FORCE_PER_STRESS * stress * mean_radius * mean_radius;
        match self.law {
            Law::Hertz => {
                let overlap = (force / modulus).powf(2.0 / 3.0);
                (overlap, 1.5 * force / overlap)
            }
            Law::Linear { normal, .. } => (force / normal, normal),
        }
    }

    fn clock(&self, goal: &Goal) -> Clock {
        let (mean_radius, compliance) = self.means();
        let (overlap, stiffness) = self.contact(goal.stress);
        let lightness = |(radius, own): (&f64, &f64)| {
            let (size, softness) = (radius / mean_radius, own / compliance);
            softness / (MASS * stiffness * 0.5 * (1.0 + size * size))
        };
        let lightness = self.radius.iter().zip(&self.compliance).map(lightness).collect();
        Clock { lightness, mean_radius, overlap, allowance: 0.0, time: 0.0, strain: [0.0; 2] }
    }

    fn press(&mut self, goal: &Goal, clock: &mut Clock) -> Sums {
        if clock.allowance <= 0.0 {
            clock.allowance = SKIN * clock.mean_radius;
            contacts::list(self, clock.allowance);
        }
        contacts::press(self, goal.friction, clock.strain, clock.time)
    }

    /// Moves the grains by a step, and the walls by `strain`, outwards where it is positive.
    fn go(&mut self, sums: &Sums, strain: [f64; 2], clock: &mut Clock) {
        // The period of a contact goes with the fourth root of the overlap.
        let time = match self.law {
            Law::Hertz => (clock.overlap / sums.mean_overlap()).powf(0.25).min(1.0),
            Law::Linear { .. } => 1.0,
        };
        let fastest = LONGEST * clock.mean_radius / time;
        let mut most = 0.0_f64;
        for (i, speed) in self.speed.iter_mut().enumerate() {
            let kick = clock.lightness[i] * time;
            for (speed, force) in speed.iter_mut().zip(self.force[i]) {
                *speed = *speed * (1.0 - DRAG) + force * kick;
            }
            let length = speed[0].hypot(speed[1]);
            if length > fastest {
                speed.iter_mut().for_each(|speed| *speed *= fastest / length);
            }
            most = most.max(length.min(fastest));
            let carried = self.frame.carried(self.at[i], strain);
            self.at[i] += carried + Vector2::new(speed[0], speed[1]) * time;
        }
        let largest = self.radius.iter().fold(0.0, |most: f64, &radius| most.max(radius));
        let reach = 2.0 * largest + SKIN * clock.mean_radius;
        clock.allowance -= 2.0 * most * time + self.frame.shortening(strain) * reach;
        self.frame.strain(strain);
        (clock.time, clock.strain) = (time, strain);
    }
}

//! How far the relaxation goes along a step: to where the potential no longer falls, and not so far that
//! grains could jump over each other (B 2.4, "truncate").

use super::Vec2;
use super::act::Scenery;
use super::balance::Balance;
use super::boundary::{self, SIDES};
use super::matrix::FREEDOMS;
use super::newton::{Search, largest, unit_force};
use super::pose::Pose;
use super::work::{Drive, Workspace};
use crate::model::Model;
use crate::state::State;
use crate::wall;

/// Longest step of a grain over the mean radius, and largest strain of a drive.
const LONGEST: f64 = 0.05;
const LARGEST_STRAIN: f64 = 0.01;
/// Share of the first slope along a step that may be left where it ends.
const FLAT: f64 = 0.5;
/// Most configurations that are looked at along one step.
const LOOKS: u32 = 25;
/// Share of the force that a whole step leaves where grains are released, 1 / 3^(3/2), give or take.
const RELEASED: std::ops::Range<f64> = 0.185..0.2;

/// Goes along the step as far as it goes down. Says whether it went anywhere.
pub(super) fn go(model: &Model, state: &mut State, work: &mut Workspace) -> bool {
    let factor = longest_share(model, state, work);
    let first = slope_along(work, &work.balance);
    if first >= 0.0 {
        // Rounding: nothing is left to gain.
        return first == 0.0 || largest(&work.balance) <= 1e-6 * unit_force(model, work);
    }
    let (mut share, mut bottom) = (factor, Bottom::between(first));
    for _ in 0..LOOKS {
        try_share(model, state, work, share);
        let slope = slope_along(work, &work.trial_balance);
        if slope.abs() <= FLAT * first.abs() || (slope < 0.0 && bottom.high.is_infinite()) {
            break;
        }
        share = bottom.next(share, slope);
    }
    if share == 1.0 {
        release(model, state, work);
    }
    std::mem::swap(&mut work.pose, &mut work.trial);
    std::mem::swap(&mut work.balance, &mut work.trial_balance);
    state.displacement = work.trial_displacement;
    true
}

/// Where along a step the potential stops falling.
struct Bottom {
    /// It falls here, and rises there.
    low: f64,
    high: f64,
    /// Slopes at both \[J\].
    low_slope: f64,
    high_slope: f64,
    /// How far they were apart when a straight line was last followed.
    wide: f64,
}

impl Bottom {
    fn between(first: f64) -> Self {
        let far = f64::INFINITY;
        Self { low: 0.0, high: far, low_slope: first, high_slope: far, wide: far }
    }

    /// Where to look after a look at `share`, where the slope was `slope`.
    fn next(&mut self, share: f64, slope: f64) -> f64 {
        let mut straight = None;
        if slope < 0.0 {
            (self.low, self.low_slope) = (share, slope);
        } else {
            // Beyond where a contact came to stick the slope is straight: two looks there tell where it
            // vanishes. With one look there a line between both ends has to do.
            let (to, at) = match slope < self.high_slope && self.high_slope.is_finite() {
                true => (self.high, self.high_slope),
                false => (self.low, self.low_slope),
            };
            straight =
                Some(share - slope * (to - share) / (at - slope)).filter(|at| at.is_finite());
            (self.high, self.high_slope) = (share, slope);
        }
        let wide = self.high - self.low;
        // Half way where lines have hardly brought the ends together.
        let helps = wide <= 0.5 * self.wide;
        self.wide = if helps { wide } else { f64::INFINITY };
        match straight.filter(|_| helps) {
            Some(at) => at.clamp(self.low + 0.05 * wide, self.low + 0.95 * wide),
            None => self.low + 0.5 * wide,
        }
    }
}

/// Goes further where the last grains out of balance are about to lose their contacts. As forces of Hertz
/// go with the power 3/2 of overlaps, whole steps leave a third of each, and half as much again leaves
/// nothing.
fn release(model: &Model, state: &State, work: &mut Workspace) {
    let [before, after] = [&work.balance, &work.trial_balance].map(largest);
    if !RELEASED.contains(&(after / before)) {
        return;
    }
    try_share(model, state, work, 1.5);
    if largest(&work.trial_balance).is_nan() || largest(&work.trial_balance) > after {
        try_share(model, state, work, 1.0);
    }
}

/// Share of the step that is not too long.
pub(super) fn longest_share(model: &Model, state: &State, work: &Workspace) -> f64 {
    let step = longest(&work.search.step);
    let sides = state.bounds(model).sides();
    let strain = |(drive, way): (&Drive, &f64)| {
        let along = |side: usize| (drive.shares[side] * way).abs() / sides[wall::axis(side)];
        (0..SIDES).map(along).fold(0.0, f64::max)
    };
    let strain = work.drives.iter().zip(&work.search.way).map(strain).fold(0.0, f64::max);
    let share = |length: f64, most: f64| if length > most { most / length } else { 1.0 };
    share(step, LONGEST * model.mean_radius).min(share(strain, LARGEST_STRAIN))
}

/// Slope of the potential along the step at `balance` \[J\].
fn slope_along(work: &Workspace, balance: &Balance) -> f64 {
    let unbalance = work.unbalance(balance);
    let mut slope = dot(&work.search.step, &balance.gradient);
    let drives = work.search.carried.iter().zip(&work.search.way).zip(unbalance);
    for ((carried, way), unbalance) in drives.take(work.drives.len()) {
        slope += way * (unbalance + dot(carried, &balance.gradient));
    }
    slope
}

/// Takes the balance after `share` of the step into the trial.
pub(super) fn try_share(model: &Model, state: &State, work: &mut Workspace, share: f64) {
    let Some(setup) = &model.plane else { return };
    let Workspace { pose, trial, search, drives, .. } = work;
    advance(model, pose, search, share, drives.len(), trial);
    work.trial_displacement = state.displacement;
    for (drive, way) in work.drives.iter().zip(&work.search.way) {
        for (to, part) in work.trial_displacement.iter_mut().zip(drive.shares) {
            *to += share * way * part;
        }
    }
    boundary::bodies(model, &work.trial_displacement, state.tilt, &mut work.bodies);
    let Workspace { reference, bodies, membranes, trial, balance, trial_balance, .. } = work;
    trial_balance.faint = balance.faint;
    let scenery = Scenery::of(model, setup, state, (reference, bodies, membranes));
    trial_balance.evaluate(&scenery, trial);
}

fn advance(model: &Model, from: &Pose, search: &Search, share: f64, drives: usize, to: &mut Pose) {
    to.copy_from(from);
    for (i, (at, turn)) in to.at.iter_mut().zip(&mut to.turn).enumerate() {
        let own = FREEDOMS * i;
        let mut way = Vec2::new(search.step[own], search.step[own + 1]);
        for k in 0..drives {
            let x = &search.carried[k];
            way += Vec2::new(x[own], x[own + 1]) * search.way[k];
        }
        *at += way * share;
        *turn += share * search.step[own + 2] / model.radius[i];
    }
}

/// Longest of the grains' vectors, or of their turns, of three numbers a grain.
pub(super) fn longest(of: &[f64]) -> f64 {
    let square = |v: &[f64]| (v[0] * v[0] + v[1] * v[1]).max(v[2] * v[2]);
    of.chunks_exact(FREEDOMS).map(square).fold(0.0, f64::max).sqrt()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

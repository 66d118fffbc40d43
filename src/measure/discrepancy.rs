//! The twin against the real rig: which measurement belongs to which increment, and what is
//! between them.
//!
//! A load cell's samples and the commands come over topics of their own, in any order. An
//! increment is therefore held until every measured wall has a sample that is not older than its
//! command, or for [`PATIENCE`]; then each wall gets the sample whose stamp is nearest to that of
//! the command.

use std::collections::VecDeque;
use std::time::Duration;

use crate::command::Stamp;
use crate::wall;

/// How long an increment waits for samples.
pub const PATIENCE: Duration = Duration::from_millis(500);

/// Samples kept of each wall: 4 s at 1 kHz.
pub const SAMPLES: usize = 4096;

/// Increments that may wait; the oldest goes without waiting when there are more.
pub const WAITING: usize = 4096;

/// Which walls the rig measures, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cells {
    /// The walls with a load cell.
    pub walls: [bool; wall::COUNT],
    /// 1 when a cell shows the force of the pack on the wall, -1 when that of the wall on the pack.
    pub sign: f64,
    /// Longest time between the stamps of a command and a measurement of it \[s\]; 0 = any.
    pub max_delay: f64,
}

/// One increment against the rig; NaN where a wall was not measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Discrepancy {
    /// Stamp of the command served.
    pub stamp: Stamp,
    /// The increment.
    pub increment: u64,
    /// Normal force in the twin \[N\].
    pub twin: [f64; wall::COUNT],
    /// Normal force at the rig \[N\].
    pub rig: [f64; wall::COUNT],
    /// Stamp of the measurement minus stamp of the command \[s\].
    pub delay: [f64; wall::COUNT],
}

impl Discrepancy {
    /// An increment that is compared with nothing.
    #[must_use]
    pub fn unmeasured(stamp: Stamp, increment: u64, twin: [f64; wall::COUNT]) -> Self {
        let nothing = [f64::NAN; wall::COUNT];
        Self { stamp, increment, twin, rig: nothing, delay: nothing }
    }

    /// Whether wall `wall` was measured close enough in time.
    #[must_use]
    pub fn is_valid(&self, wall: usize) -> bool {
        !self.rig[wall].is_nan()
    }
}

/// An increment that waits.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    stamp: Stamp,
    increment: u64,
    twin: [f64; wall::COUNT],
    since: Duration,
}

/// Pairs increments with measurements. Times of day are stamps; how long something waits is told
/// by a clock of the caller's that never goes back.
#[derive(Debug)]
pub struct Pairing {
    cells: Cells,
    /// Stamps \[ns\] and normal forces \[N\] in the order of arrival.
    samples: [VecDeque<(i64, f64)>; wall::COUNT],
    waiting: VecDeque<Waiting>,
}

impl Pairing {
    /// No measurement yet.
    #[must_use]
    pub fn new(cells: Cells) -> Self {
        Self { cells, samples: Default::default(), waiting: VecDeque::new() }
    }

    /// Takes a sample of the load cell of `wall`: a force in axes as the pack's, of which the
    /// part along the wall's normal counts. False when the sample is not used: its wall is not
    /// measured, or its force is no finite number.
    pub fn measured(&mut self, wall: usize, stamp: Stamp, force: [f64; 3]) -> bool {
        let normal = -wall::inward(wall) * self.cells.sign * force[wall::axis(wall)];
        if !self.cells.walls[wall] || !normal.is_finite() {
            return false;
        }
        let samples = &mut self.samples[wall];
        if samples.len() == SAMPLES {
            samples.pop_front();
        }
        samples.push_back((stamp.nanoseconds(), normal));
        true
    }

    /// Takes the normal forces of an increment that was served `now`.
    pub fn served(
        &mut self,
        stamp: Stamp,
        increment: u64,
        twin: [f64; wall::COUNT],
        now: Duration,
    ) {
        self.waiting.push_back(Waiting { stamp, increment, twin, since: now });
    }

    /// The oldest increment, when it need not wait any more; `None` when nothing is ready `now`.
    pub fn ready(&mut self, now: Duration) -> Option<Discrepancy> {
        let first = self.waiting.front()?;
        let over = now.saturating_sub(first.since) >= PATIENCE || self.waiting.len() > WAITING;
        if over || self.is_complete(first.stamp) { self.take_oldest() } else { None }
    }

    /// The oldest increment, however short it waited.
    pub fn take_oldest(&mut self) -> Option<Discrepancy> {
        let Waiting { stamp, increment, twin, .. } = self.waiting.pop_front()?;
        let pairs: [_; wall::COUNT] = std::array::from_fn(|wall| self.nearest(wall, stamp));
        let part = |number: fn((f64, f64)) -> f64| pairs.map(|pair| pair.map_or(f64::NAN, number));
        Some(Discrepancy {
            stamp,
            increment,
            twin,
            rig: part(|(force, _)| force),
            delay: part(|(_, delay)| delay),
        })
    }

    /// Whether no wall can get a nearer sample, as long as cells do not go back in time.
    fn is_complete(&self, stamp: Stamp) -> bool {
        let stamp = stamp.nanoseconds();
        self.cells.walls.iter().zip(&self.samples).all(|(measured, samples)| {
            !measured || samples.back().is_some_and(|(newest, _)| *newest >= stamp)
        })
    }

    /// Force and delay of the sample of `wall` that is nearest to `stamp`, the newer one of two.
    fn nearest(&self, wall: usize, stamp: Stamp) -> Option<(f64, f64)> {
        let stamp = stamp.nanoseconds();
        let nearest = self.samples[wall].iter().rev().min_by_key(|(at, _)| at.abs_diff(stamp))?;
        let (at, force) = *nearest;
        let delay = at.saturating_sub(stamp) as f64 * 1e-9;
        let near = self.cells.max_delay == 0.0 || delay.abs() <= self.cells.max_delay;
        near.then_some((force, delay))
    }
}

#[cfg(test)]
mod tests;

//! Limits of travel, rate, strain and force, and the box that no command may leave.
//!
//! Walls go straight from where they are to their target, all in step; with `clamp` they stop at
//! the first limit on that way. What is beyond a limit already may come back.

use super::Gate;
use crate::wall::{self, Control, Load, Setpoint};

/// A box side may shrink to this share of what it was at the start.
const LEAST_SIDE: f64 = 0.5;
/// A box side may grow, and the box may travel, up to this many times the side at the start.
const MOST_SIDE: f64 = 2.0;
/// What stopped at a limit may come out beyond it by rounding.
const ROUNDING: f64 = 1e-12;
/// An equilibrium tells a force up to the solver's tolerance: a wall that carries as much as is
/// allowed may come out beyond it by this share.
const SLACK: f64 = 1e-6;
/// Names of the axes.
const AXES: [char; 3] = ['x', 'y', 'z'];

/// The walls at an equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stand {
    /// Inward displacement since the start \[m\].
    pub displacement: [f64; wall::COUNT],
    /// Normal force \[N\].
    pub force: [f64; wall::COUNT],
}

/// A quantity on its way; its magnitude has a limit.
struct Course {
    from: f64,
    to: f64,
    limit: f64,
}

impl Course {
    /// How much of the way is within the limit, below 1 when not all of it is.
    fn share(&self) -> Option<f64> {
        let limit = self.limit.max(self.from.abs());
        let beyond = self.to.abs() > limit * (1.0 + ROUNDING);
        beyond.then(|| (self.to.signum() * limit - self.from) / (self.to - self.from))
    }
}

impl Gate {
    /// Where `setpoint` sends the walls \[m\]; those under a load stay meanwhile.
    pub(super) fn destination(&self, setpoint: &Setpoint) -> [f64; wall::COUNT] {
        std::array::from_fn(|w| match setpoint[w] {
            Control::Displacement(displacement) => displacement,
            Control::Load(_) => self.displacement[w],
        })
    }

    /// Why the walls cannot be at `target`, whatever the limits of the scene.
    fn beyond_box(&self, target: &[f64; wall::COUNT]) -> Option<String> {
        if let Some(text) = self.beyond_hole(target) {
            return Some(text);
        }
        let (start, now) = (self.start.sides(), self.bounds(target).sides());
        (0..3).find_map(|axis| {
            let (low, high) = (wall::NAMES[2 * axis], wall::NAMES[2 * axis + 1]);
            let allowed = [LEAST_SIDE * start[axis], MOST_SIDE * start[axis]];
            if !(allowed[0]..=allowed[1]).contains(&now[axis]) {
                return Some(format!(
                    "{low} and {high} would be {:e} m apart: {:e} to {:e} m are allowed",
                    now[axis], allowed[0], allowed[1]
                ));
            }
            let travel = target[2 * axis].abs().max(target[2 * axis + 1].abs());
            (travel > allowed[1]).then(|| {
                format!("{low} or {high} would travel {travel:e} m: {:e} m are allowed", allowed[1])
            })
        })
    }

    /// Why the inner wall of an annulus cannot be at `target`.
    fn beyond_hole(&self, target: &[f64; wall::COUNT]) -> Option<String> {
        let cell = self.cell.as_ref()?;
        let [inner, outer] = cell.radii(target)?;
        let [hole, rim] = cell.radii(&[0.0; wall::COUNT])?;
        let least = LEAST_SIDE * hole;
        let thick = LEAST_SIDE * (rim - hole)..=MOST_SIDE * (rim - hole);
        if inner < least {
            return Some(format!(
                "the inner radius would be {inner:e} m: at least {least:e} m is allowed"
            ));
        }
        (cell.has(0) && !thick.contains(&(outer - inner))).then(|| {
            format!(
                "x_min and x_max would be {:e} m apart: {:e} to {:e} m are allowed",
                outer - inner,
                thick.start(),
                thick.end()
            )
        })
    }

    /// Why the walls cannot go where `setpoint` sends them, not even a part of the way.
    pub(super) fn beyond_hard_limits(&self, setpoint: &Setpoint) -> Option<String> {
        self.beyond_box(&self.destination(setpoint))
    }

    /// `setpoint` and `tilt` as far as the limits allow, and which limit is in the way of the rest. `elapsed`
    /// is the time that a rate counts by \[s\], when there is one.
    pub(super) fn within_limits(
        &self,
        setpoint: &Setpoint,
        tilt: f64,
        elapsed: Option<f64>,
    ) -> (Setpoint, f64, Option<String>) {
        let (share, mut beyond) = self.share_within(&self.destination(setpoint), tilt, elapsed);
        let mut within = *setpoint;
        for (w, control) in within.iter_mut().enumerate() {
            match control {
                Control::Displacement(to) if share < 1.0 => {
                    *to = self.displacement[w] + share * (*to - self.displacement[w]);
                }
                Control::Displacement(_) => {}
                Control::Load(load) => {
                    if let Some((allowed, text)) = self.beyond_force(w, *load) {
                        *load = allowed;
                        beyond.get_or_insert(text);
                    }
                }
            }
        }
        let tilt = if share < 1.0 { self.tilted_by(tilt, share) } else { tilt };
        (within, tilt, beyond)
    }

    /// The tilt after `share` of the way to `tilt`.
    #[must_use]
    pub fn tilted_by(&self, tilt: f64, share: f64) -> f64 {
        self.tilt + share * (tilt - self.tilt)
    }

    /// How much of the way to `target` and `tilt` is within the limits, and the sentence of the
    /// strictest.
    fn share_within(
        &self,
        target: &[f64; wall::COUNT],
        tilt: f64,
        elapsed: Option<f64>,
    ) -> (f64, Option<String>) {
        let mut strictest = (1.0, None);
        let mut check = |course: &Course, tell: &dyn Fn() -> String| {
            if let Some(share) = course.share()
                && share < strictest.0
            {
                strictest = (share, Some(tell()));
            }
        };
        let from = &self.displacement;
        let limits = &self.limits;
        for w in 0..wall::COUNT {
            if limits.travel > 0.0 {
                let course = Course { from: from[w], to: target[w], limit: limits.travel };
                check(&course, &|| self.travels(w, target[w]));
            }
            if limits.rate > 0.0
                && let Some(elapsed) = elapsed
            {
                let way = target[w] - from[w];
                let course = Course { from: 0.0, to: way, limit: limits.rate * elapsed };
                check(&course, &|| self.hurries(w, way, elapsed));
            }
        }
        if limits.strain > 0.0 {
            let course = Course { from: self.tilt, to: tilt, limit: limits.strain };
            check(&course, &|| self.leans_by(tilt));
            for axis in 0..3 {
                let (from, to) = (self.strain(axis, from), self.strain(axis, target));
                check(&Course { from, to, limit: limits.strain }, &|| self.strains(axis, to));
            }
        }
        strictest
    }

    /// Engineering strain of an axis against the box at the start.
    fn strain(&self, axis: usize, displacement: &[f64; wall::COUNT]) -> f64 {
        match &self.cell {
            Some(cell) if !cell.is_paired(axis) => {
                1.0 - cell.bounds(displacement).sides()[axis] / self.start.sides()[axis]
            }
            _ => (displacement[2 * axis] + displacement[2 * axis + 1]) / self.start.sides()[axis],
        }
    }

    /// The largest load of the kind of `load` that wall `w` may carry when that is less, and why.
    fn beyond_force(&self, w: usize, load: Load) -> Option<(Load, String)> {
        let area = self.area(w);
        let force = load.force(area);
        let now = self.now[w].load().map_or(0.0, |load| load.force(area));
        let allowed = self.limits.force.max(now);
        (self.limits.force > 0.0 && force > allowed * (1.0 + ROUNDING)).then(|| {
            let load = match load {
                Load::Force(_) => Load::Force(allowed),
                Load::Stress(_) => Load::Stress(allowed / area),
            };
            (load, self.bears(w, force))
        })
    }

    /// Present area of wall `w` \[m²\].
    fn area(&self, w: usize) -> f64 {
        match &self.cell {
            None => self.start.displaced(&self.displacement).area(w),
            Some(cell) => cell.area(w, &self.displacement),
        }
    }

    /// Whether the equilibrium that `setpoint` leads to must be looked at with
    /// [`Gate::beyond_limits`].
    #[must_use]
    pub fn watches(&self, setpoint: &Setpoint) -> bool {
        self.limits.force > 0.0 || setpoint.iter().any(|control| control.load().is_some())
    }

    /// Why the walls may not stay where `setpoint` took them from `before`: a force, or how far
    /// those under a load went.
    #[must_use]
    pub fn beyond_limits(
        &self,
        setpoint: &Setpoint,
        before: &Stand,
        after: &Stand,
    ) -> Option<String> {
        let force = self.limits.force;
        let most = |w: usize| force.max(before.force[w]) * (1.0 + SLACK);
        if force > 0.0
            && let Some(w) = (0..wall::COUNT).find(|&w| after.force[w] > most(w))
        {
            return Some(self.bears(w, after.force[w]));
        }
        if setpoint.iter().all(|control| control.load().is_none()) {
            return None;
        }
        self.beyond_box(&after.displacement)
            .or_else(|| self.share_within(&after.displacement, self.tilt, None).1)
    }

    /// A setpoint on the way from the walls' present state, whose equilibrium is `stand`, to
    /// `setpoint`: targets and loads after `share` of their change.
    #[must_use]
    pub fn part(&self, setpoint: &Setpoint, stand: &Stand, share: f64) -> Setpoint {
        let between = |from: f64, to: f64| from + share * (to - from);
        std::array::from_fn(|w| match setpoint[w] {
            Control::Displacement(to) => Control::Displacement(between(self.displacement[w], to)),
            Control::Load(load) => {
                let alone = self.cell.as_ref().is_some_and(|cell| !cell.is_paired(wall::axis(w)));
                let pair = if alone { [w, w] } else { [w & !1, w | 1] };
                let area = self.area(w);
                // One for both walls of a pair when both carry the load, since it is the same.
                let carried = pair.into_iter().find_map(|w| self.now[w].load());
                let loaded = pair.into_iter().filter(|&w| setpoint[w].load().is_some());
                let mean =
                    loaded.clone().map(|w| stand.force[w]).sum::<f64>() / loaded.count() as f64;
                let from = carried.map_or(mean, |load| load.force(area));
                Control::Load(match load {
                    Load::Force(to) => Load::Force(between(from, to)),
                    Load::Stress(to) => Load::Stress(between(from / area, to)),
                })
            }
        })
    }

    fn travels(&self, w: usize, travel: f64) -> String {
        format!(
            "{} would be {travel:e} m from its start: {:e} m are allowed (node.limits.travel)",
            wall::NAMES[w],
            self.limits.travel
        )
    }

    fn hurries(&self, w: usize, way: f64, elapsed: f64) -> String {
        let (name, rate) = (wall::NAMES[w], self.limits.rate);
        if elapsed == 0.0 {
            return format!(
                "{name} would move {way:e} m in no time, for the stamp is not later than that of \
                 the last accepted command: {rate:e} m/s are allowed (node.limits.rate)"
            );
        }
        let found = way / elapsed;
        format!("{name} would move at {found:e} m/s: {rate:e} m/s are allowed (node.limits.rate)")
    }

    fn strains(&self, axis: usize, strain: f64) -> String {
        format!(
            "the strain along {} would be {strain:e}: {:e} is allowed (node.limits.strain)",
            AXES[axis], self.limits.strain
        )
    }

    fn leans_by(&self, tilt: f64) -> String {
        let allowed = self.limits.strain;
        format!("the box would be tilted by {tilt:e}: {allowed:e} is allowed (node.limits.strain)")
    }

    fn bears(&self, w: usize, force: f64) -> String {
        format!(
            "{} would carry {force:e} N: {:e} N are allowed (node.limits.force)",
            wall::NAMES[w],
            self.limits.force
        )
    }
}

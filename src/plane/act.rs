//! What each contact does at a configuration.

use super::boundary::{Body, Shape};
use super::law::{self, Answer};
use super::membrane::Membrane;
use super::pose::Pose;
use super::reference::{Joint, Near, Reference};
use super::{Setup, Vec2, glue, left_of};
use crate::contact::Other;
use crate::model::Model;
use crate::state::State;

/// Tangents of an angle below which its series is exact, and its first three terms.
const SMALL: f64 = 0.05;
const TINY: f64 = 2e-3;

/// What one contact does.
#[derive(Clone, Copy, Debug)]
pub struct Act {
    /// Unit vector along which the distance grows.
    pub along: Vec2,
    /// Distance \[m\].
    pub distance: f64,
    /// -1 in a ring.
    pub sign: f64,
    /// Overlap \[m\].
    pub overlap: f64,
    /// Shear displacement since the reference \[m\].
    pub slid: f64,
    /// Normal answer.
    pub normal: Answer,
    /// Shear answer.
    pub shear: Answer,
    /// Whether it slides.
    pub slides: bool,
    /// ∂(shear displacement)/∂x of grain i, along the tangent.
    pub pitch: f64,
}

impl Act {
    /// Force on grain i \[N\].
    #[must_use]
    pub fn force(&self) -> Vec2 {
        self.along * (self.sign * self.normal.force) + self.tangential()
    }

    /// Tangential force on grain i \[N\].
    #[must_use]
    pub fn tangential(&self) -> Vec2 {
        left_of(self.along) * (-self.pitch * self.shear.force)
    }

    /// Of a contact that presses alone.
    #[inline]
    fn pressing(along: Vec2, distance: f64, sign: f64, overlap: f64, normal: Answer) -> Self {
        let shear = Answer::default();
        Self { along, distance, sign, overlap, slid: 0.0, normal, shear, slides: false, pitch: 0.0 }
    }

    #[inline]
    fn slide(&mut self, joint: &Joint, slid: f64, pitch: f64, goes_on: bool) {
        (self.shear, self.slides) = match goes_on {
            true => joint.shear.as_before(slid, joint.slid),
            false => joint.shear.answer(slid),
        };
        self.slid = slid;
        self.pitch = pitch;
    }
}

/// What the balance is taken of.
#[derive(Clone, Copy, Debug)]
pub struct Scenery<'a> {
    /// Constants.
    pub model: &'a Model,
    /// Constants of discs.
    pub setup: &'a Setup,
    /// What shear counts from.
    pub reference: &'a Reference,
    /// What surrounds the grains.
    pub bodies: &'a [Body],
    /// Membranes around them.
    pub membranes: &'a [Membrane],
    /// Grains that take part.
    pub carries: &'a [bool],
    /// The side that each grain sticks to ([`glue`]); empty where none does.
    pub glued: &'a [Option<u8>],
    /// Whether every contact goes on as in the last increment: those that slid then slide, all others
    /// stick whatever their limit.
    pub goes_on: bool,
}

impl<'a> Scenery<'a> {
    /// That of `state`, where shear counts from `reference` and `bodies` and `membranes` are around the
    /// grains.
    pub(super) fn of(
        model: &'a Model,
        setup: &'a Setup,
        state: &'a State,
        (reference, bodies, membranes): (&'a Reference, &'a [Body], &'a [Membrane]),
    ) -> Self {
        let (carries, glued) = (&state.carries, &state.glued);
        Self { model, setup, reference, bodies, membranes, carries, glued, goes_on: false }
    }

    /// What the pair `joint` does; `None` where it does nothing.
    #[inline]
    #[must_use]
    pub fn pair(&self, joint: &Joint, pose: &Pose) -> Option<Act> {
        let Other::Grain(j) = joint.second else { return None };
        let (i, j) = (joint.first as usize, j as usize);
        let branch = pose.at[i] - pose.at[j];
        let square = branch.norm_squared();
        let apart = square >= joint.reach * joint.reach;
        let shears = joint.held && !joint.opened;
        if apart && !joint.bonded && !shears {
            return None;
        }
        if !(self.carries[i] && self.carries[j]) || glue::joins(self.glued, joint) {
            return None;
        }
        let distance = square.sqrt();
        let along = branch / distance;
        let overlap = joint.reach - distance;
        let normal = law::normal(self.setup.law, joint.modulus, overlap, joint.bonded);
        let mut act = Act::pressing(along, distance, 1.0, overlap, normal);
        if joint.held && !joint.opened {
            let rolled = joint.arm[0] * pose.turn[i] + joint.arm[1] * pose.turn[j];
            let slid = joint.span * angle(&joint.along, &along) - rolled;
            act.slide(joint, slid, joint.span / distance, self.goes_on);
        }
        Some(act)
    }

    /// The pairs that do something: their place in the list, the other grain, and what they do.
    pub fn pairs<'b>(
        &'b self,
        pose: &'b Pose,
    ) -> impl Iterator<Item = (usize, usize, &'b Joint, Act)> {
        let near = self.reference.near.iter().zip(&self.reference.pairs).enumerate();
        near.filter_map(move |(k, (near, joint))| {
            self.near_pair(near, joint, pose).map(|(j, act)| (k, j, joint, act))
        })
    }

    /// The other grain and what the pair does, if it is `near` enough.
    #[inline(always)]
    pub(super) fn near_pair(
        &self,
        near: &Near,
        joint: &Joint,
        pose: &Pose,
    ) -> Option<(usize, Act)> {
        let [i, j] = near.grains.map(|grain| grain as usize);
        if (pose.at[i] - pose.at[j]).norm_squared() >= near.square {
            return None;
        }
        self.pair(joint, pose).map(|act| (j, act))
    }

    /// What the edge `joint` does; `None` where it does nothing.
    #[inline]
    #[must_use]
    pub fn edge(&self, joint: &Joint, pose: &Pose) -> Option<Act> {
        let Other::Wall(b) = joint.second else { return None };
        let i = joint.first as usize;
        let body = &self.bodies[b as usize];
        let near = body.near(pose.at[i], self.model.radius[i]);
        let shears = joint.held && !joint.opened;
        if near.overlap <= 0.0 && !shears || !self.carries[i] || glue::joins(self.glued, joint) {
            return None;
        }
        let normal = law::normal(self.setup.law, joint.modulus, near.overlap, false);
        let mut act = Act::pressing(near.along, near.distance, near.sign, near.overlap, normal);
        if shears {
            let rolled = joint.arm[0] * pose.turn[i];
            match body.shape {
                Shape::Plane(normal) => {
                    // Seen from the wall, the grain turns back as the wall turns.
                    let station = (pose.at[i] - body.at).dot(&left_of(normal))
                        + joint.arm[0] * body.swing.turn;
                    act.slide(joint, station - joint.station - rolled, 1.0, self.goes_on);
                }
                Shape::Disc(_) | Shape::Ring(_) | Shape::Nothing => {
                    let way = joint.span * angle(&joint.along, &near.along);
                    let pitch = joint.span / near.distance;
                    act.slide(joint, way - rolled, pitch, self.goes_on);
                }
            }
        }
        Some(act)
    }
}

/// Angle from `from` to `to` \[rad\].
#[inline]
fn angle(from: &Vec2, to: &Vec2) -> f64 {
    let (across, along) = (from.perp(to), from.dot(to));
    // The series of the arc tangent, exact to the last bits here and much faster.
    let x = across / along;
    let square = x * x;
    if across.abs() < TINY * along {
        return x * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0)));
    }
    if across.abs() >= SMALL * along {
        return across.atan2(along);
    }
    let rest = 1.0 / 7.0 - square * (1.0 / 9.0 - square * (1.0 / 11.0 - square / 13.0));
    x * (1.0 - square * (1.0 / 3.0 - square * (1.0 / 5.0 - square * rest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_exact_on_both_sides_of_every_switch() {
        let from = Vec2::new(0.6, -0.8);
        for size in [0.0, 1e-9, 1.9e-3, 2.1e-3, 0.049, 0.051, 1.0, 3.0_f64] {
            for want in [size, -size] {
                let to = nalgebra::Rotation2::new(want) * from;
                assert!(
                    (angle(&from, &to) - want).abs() <= 4.0 * f64::EPSILON * size.max(0.3),
                    "{want}"
                );
            }
        }
    }
}

//! The balance of forces at one configuration.

use super::act::{Act, Scenery};
use super::boundary::{Body, SIDES};
use super::law::Answer;
use super::matrix::FREEDOMS;
use super::pose::Pose;
use super::reference::Joint;
use super::{Vec2, glue, left_of};
use crate::contact::Other;
use crate::model::Model;
use crate::relax::balance::Sums;
use crate::wall;

/// Energy and gradient at one configuration.
#[derive(Clone, Debug, Default)]
pub struct Balance {
    /// Gradient of the potential over x, y and the turn times the radius \[N\], three numbers a grain;
    /// zero for grains that take no part.
    pub gradient: Vec<f64>,
    /// Its derivatives over the inward displacements of the sides \[N\]: what each side is pressed with.
    pub sides: [f64; SIDES],
    /// Its derivative over the tilt of the box \[N m\].
    pub tilt: f64,
    /// x-component of the forces of the low and of the high y side on the grains \[N\], along its inward
    /// normal turned to the right.
    pub drag: [f64; 2],
    /// Totals of the normal forces.
    pub sums: Sums,
    /// Potential of shear since the reference \[J\].
    pub shear_potential: f64,
    /// Contacts of each grain that carry more than a faint force, those that hold by a bond twice, shape
    /// (n).
    pub support: Vec<u32>,
    /// Force below which a contact is faint \[N\].
    pub faint: f64,
    /// Potential of the membranes \[J\]; not of what the pack stores.
    pub pressure_potential: f64,
    /// How often the balance was taken.
    pub evaluations: u64,
}

impl Balance {
    /// Takes the balance of `pose`.
    pub fn evaluate(&mut self, scenery: &Scenery<'_>, pose: &Pose) {
        self.evaluate_and(scenery, pose, |_, _, _| {});
    }

    /// The same, and shows `see` what each contact does, with the body where there is one.
    pub(super) fn evaluate_and(
        &mut self,
        scenery: &Scenery<'_>,
        pose: &Pose,
        mut see: impl FnMut(&Joint, &Act, Option<&Body>),
    ) {
        let Scenery { model, setup, reference, bodies, membranes, carries, .. } = scenery;
        self.evaluations += 1;
        self.gradient.clear();
        self.gradient.resize(FREEDOMS * pose.at.len(), 0.0);
        self.support.clear();
        self.support.resize(pose.at.len(), 0);
        self.sides = [0.0; SIDES];
        (self.tilt, self.drag) = (0.0, [0.0; 2]);
        self.sums = Sums::NONE;
        self.shear_potential = 0.0;
        self.pressure_potential = 0.0;
        // Not by `pairs`: the loop that all else waits for is not left to the mercy of inlined closures.
        for (near, joint) in reference.near.iter().zip(&reference.pairs) {
            let Some((j, act)) = scenery.near_pair(near, joint, pose) else { continue };
            let force = act.force();
            self.add(model, joint.first, -force, -joint.arm[0] * act.shear.force);
            self.add(model, j as u32, force, -joint.arm[1] * act.shear.force);
            let holds = self.holds(joint, &act);
            self.support[joint.first as usize] += holds;
            self.support[j] += holds;
            self.count(&act);
            see(joint, &act, None);
        }
        for joint in &reference.edges {
            let Some(act) = scenery.edge(joint, pose) else { continue };
            let Other::Wall(b) = joint.second else { continue };
            let body = &bodies[b as usize];
            self.add(model, joint.first, -act.force(), -joint.arm[0] * act.shear.force);
            self.press(body, Self::pressed(&act, body), act.force());
            let station = (pose.at[joint.first as usize] - body.at).dot(&left_of(act.along));
            self.tilt += Self::tilted(&act, body, station, joint.arm[0]);
            self.support[joint.first as usize] += self.holds(joint, &act);
            self.count(&act);
            see(joint, &act, Some(body));
        }
        for membrane in *membranes {
            membrane.add_gradient(pose, &mut self.gradient);
            // A membrane holds what it presses on.
            membrane.chain.iter().for_each(|&grain| self.support[grain as usize] += 2);
            self.pressure_potential += membrane.potential(pose);
        }
        let gravity = Vec2::new(model.gravity.x, model.gravity.y);
        if model.has_gravity() {
            for (i, at) in pose.at.iter().enumerate().filter(|(i, _)| carries[*i]) {
                let weight = gravity * model.mass(i);
                self.sums.energy -= weight.dot(at);
                self.add(model, i as u32, -weight, 0.0);
            }
        }
        glue::take_over(scenery, pose, self);
        if !setup.turns {
            self.gradient.iter_mut().skip(2).step_by(FREEDOMS).for_each(|turn| *turn = 0.0);
        }
    }

    fn holds(&self, joint: &Joint, act: &Act) -> u32 {
        if joint.bonded { 2 } else { u32::from(act.normal.force > self.faint) }
    }

    /// What `act` presses the side of `body` with, along its inward displacement \[N\].
    pub(super) fn pressed(act: &Act, body: &Body) -> f64 {
        act.normal.force * body.growth + act.force().dot(&body.slide)
    }

    /// Counts what `body` is pressed with along the way of its side, and its force on a grain.
    pub(super) fn press(&mut self, body: &Body, pressed: f64, force: Vec2) {
        let side = usize::from(body.side);
        self.sides[side] += pressed;
        if wall::axis(side) == 1 {
            self.drag[side % 2] += wall::inward(side) * force.x;
        }
    }

    /// Derivative of the potential of `act` over the tilt \[N m\]; the grain is at `station` along the
    /// wall, with the lever `arm` \[m\].
    fn tilted(act: &Act, body: &Body, station: f64, arm: f64) -> f64 {
        // As n turns left, -n·x changes by -(left of n)·x, and (left of n)·x by -n·x.
        let turned =
            -act.normal.force * station + act.shear.force * act.pitch * (arm - act.distance);
        act.force().dot(&body.swing.way) + turned * body.swing.rate
    }

    #[inline]
    fn add(&mut self, model: &Model, grain: u32, force: Vec2, moment: f64) {
        let to = FREEDOMS * grain as usize;
        self.gradient[to] += force.x;
        self.gradient[to + 1] += force.y;
        self.gradient[to + 2] += moment / model.radius[grain as usize];
    }

    #[inline]
    fn count(&mut self, act: &Act) {
        let Answer { energy, force, .. } = act.normal;
        self.shear_potential += act.shear.energy;
        if force == 0.0 {
            return;
        }
        let sums = &mut self.sums;
        sums.energy += energy;
        sums.force += force.abs();
        sums.overlap += act.overlap.max(0.0);
        sums.contacts += 1;
        for axis in 0..2 {
            sums.virial[axis] += force * act.along[axis].powi(2) * act.distance;
        }
    }

    /// Potential of the pack \[J\].
    #[must_use]
    pub fn potential(&self) -> f64 {
        self.sums.energy + self.shear_potential
    }
}

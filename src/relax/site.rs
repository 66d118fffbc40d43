//! One grain among the others, which stay where they are: its contacts, one after the other.

use crate::Vec3;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::relax::tangential::{Held, Pose, Pull, Reference, Traction};
use crate::wall::{self, Bounds};

/// What the grains can touch, wherever they are.
#[derive(Clone, Copy)]
pub(super) struct Others<'a> {
    pub(super) model: &'a Model,
    pub(super) neighbours: &'a Neighbours,
    pub(super) reference: &'a Reference,
    pub(super) carries: &'a [bool],
    pub(super) bounds: &'a Bounds,
}

/// The grains where they are.
#[derive(Clone, Copy)]
pub(super) struct Site<'a> {
    pub(super) others: &'a Others<'a>,
    pub(super) position: &'a [Vec3],
    pub(super) rotation: &'a [Vec3],
}

/// A contact that presses on the grain.
pub(super) struct Press {
    /// M \[N/m^1.5\].
    pub(super) modulus: f64,
    /// h \[m\].
    pub(super) overlap: f64,
    /// n̂, towards the grain.
    pub(super) normal: Vec3,
    /// 1/r of the pair \[1/m\]; 0 at a wall.
    pub(super) curvature: f64,
}

/// A contact that shears the grain.
pub(super) struct Grip<'a> {
    pub(super) held: &'a Held,
    pub(super) traction: Traction,
    pub(super) pull: Pull,
    /// Whether the grain is the second one of the contact.
    pub(super) second: bool,
}

impl Grip<'_> {
    /// Gradient of the energy of the contact, and that with respect to w = ΩR \[N\].
    pub(super) fn gradient(&self, radius: f64) -> [Vec3; 2] {
        let sign = if self.second { -1.0 } else { 1.0 };
        let Pull { force, lever, couple, arm, .. } = &self.pull;
        [-force * sign, (lever * arm[usize::from(self.second)] - couple * sign) / radius]
    }
}

impl<'a> Site<'a> {
    /// Hands over what touches grain `i` where `near` are its neighbours, with Hertz' M.
    pub(super) fn presses(&self, i: usize, near: &[(u32, f64)], mut take: impl FnMut(Press)) {
        let Self { others: &Others { model, neighbours, bounds, .. }, position, .. } = *self;
        let (xi, ri) = (position[i], model.radius[i]);
        for &(j, modulus) in near {
            let branch = xi - position[j as usize];
            let reach = ri + model.radius[j as usize];
            let distance2 = branch.norm_squared();
            if distance2 < reach * reach {
                let distance = distance2.sqrt();
                let normal = branch / distance;
                let overlap = reach - distance;
                take(Press { modulus, overlap, normal, curvature: 1.0 / distance });
            }
        }
        for &wall in neighbours.walls_near(i) {
            let wall = usize::from(wall);
            let overlap = ri - wall_gap(&xi, wall, bounds);
            if overlap > 0.0 {
                let mut normal = Vec3::zeros();
                normal[wall::axis(wall)] = wall::inward(wall);
                let modulus = neighbours.wall_modulus[i];
                take(Press { modulus, overlap, normal, curvature: 0.0 });
            }
        }
    }

    /// Hands over the shear of grain `i` in its contacts `held` at the reference.
    pub(super) fn grips(&self, i: usize, held: &[u32], mut take: impl FnMut(Grip<'a>)) {
        let Self { others, position, rotation } = *self;
        let Others { model, reference, carries, bounds, .. } = *others;
        let Some(friction) = &model.friction else { return };
        let pose = Pose { model, position, rotation, bounds };
        for &k in held {
            let held = &reference.contacts[k as usize];
            let (traction, pull) = reference.answer(held, friction.law, &pose, carries);
            if traction.live {
                take(Grip { held, traction, pull, second: held.first as usize != i });
            }
        }
    }
}

//! One grain among the others, which stay where they are: its contacts, one after the other.

use crate::Vec3;
use crate::contact::Other;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::relax::rows::{Near, Rows};
use crate::relax::tangential::{Held, Pose, Pull, Reference, Traction};
use crate::wall::Room;

/// What the grains can touch, wherever they are.
#[derive(Clone, Copy)]
pub(super) struct Others<'a> {
    pub(super) model: &'a Model,
    pub(super) neighbours: &'a Neighbours,
    pub(super) reference: &'a Reference,
    pub(super) carries: &'a [bool],
    pub(super) bounds: &'a Room,
}

/// What each grain can touch.
#[derive(Clone, Debug, Default)]
pub(super) struct Adjacency {
    /// Neighbours.
    near: Rows<Near>,
    /// Contacts at the reference.
    held: Rows<u32>,
    /// The neighbour list that `near` was made of.
    listed: Option<u64>,
    /// Whether `held` is that of the reference.
    knows_held: bool,
}

impl Adjacency {
    /// Begins another search: the reference may be another one, and with it the approach at which
    /// pairs begin to press whose cement broke.
    pub(super) fn begin(&mut self) {
        self.knows_held = false;
        self.listed = None;
    }

    /// Lists what is not listed yet.
    pub(super) fn refresh(&mut self, others: &Others<'_>) {
        let Others { model, neighbours, reference, .. } = *others;
        if self.listed != Some(neighbours.rebuilds) {
            self.near.fill_pairs(neighbours, model, |_, _, _| true);
            self.listed = Some(neighbours.rebuilds);
        }
        if !self.knows_held {
            self.held.fill(model.len(), || {
                reference.contacts.iter().enumerate().flat_map(|(k, held)| {
                    let second = match held.second {
                        Other::Grain(j) => Some((j as usize, k as u32)),
                        Other::Wall(_) => None,
                    };
                    std::iter::once((held.first as usize, k as u32)).chain(second)
                })
            });
            self.knows_held = true;
        }
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.near.heap_bytes() + self.held.heap_bytes()
    }
}

/// The grains where they are.
#[derive(Clone, Copy)]
pub(super) struct Site<'a> {
    pub(super) others: &'a Others<'a>,
    pub(super) adjacency: &'a Adjacency,
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
    /// 1/r of the pair \[1/m\]; 0 at a wall, whose own curvature is left out.
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
        let Pull { force, moment, .. } = &self.pull;
        [-force * sign, moment[usize::from(self.second)] / radius]
    }
}

impl<'a> Site<'a> {
    /// Hands over what presses on grain `i`.
    pub(super) fn presses(&self, i: usize, mut take: impl FnMut(Press)) {
        let Self { others, adjacency, position, .. } = *self;
        let Others { model, neighbours, carries, bounds, .. } = *others;
        let xi = position[i];
        let near = adjacency.near.row(i).iter().filter(|near| carries[near.second as usize]);
        for &Near { second, modulus, reach } in near {
            let branch = xi - position[second as usize];
            let distance2 = branch.norm_squared();
            if reach > 0.0 && distance2 < reach * reach {
                let distance = distance2.sqrt();
                let normal = branch / distance;
                let overlap = reach - distance;
                take(Press { modulus, overlap, normal, curvature: 1.0 / distance });
            }
        }
        for (wall, reach) in neighbours.walls_near(model, i) {
            let wall = usize::from(wall);
            let overlap = reach - wall_gap(&xi, wall, bounds);
            if overlap > 0.0 {
                let normal = bounds.normal(&xi, wall);
                let modulus = neighbours.wall_modulus(i, wall);
                take(Press { modulus, overlap, normal, curvature: 0.0 });
            }
        }
    }

    /// Hands over what shears grain `i`.
    pub(super) fn grips(&self, i: usize, mut take: impl FnMut(Grip<'a>)) {
        let Self { others, adjacency, position, rotation } = *self;
        let Others { model, reference, carries, bounds, .. } = *others;
        let Some(friction) = &model.friction else { return };
        let pose = Pose { model, position, rotation, bounds };
        for &k in adjacency.held.row(i) {
            let held = &reference.contacts[k as usize];
            let (traction, pull) = reference.answer(held, friction.law, &pose, carries);
            if traction.live {
                take(Grip { held, traction, pull, second: held.first as usize != i });
            }
        }
    }
}

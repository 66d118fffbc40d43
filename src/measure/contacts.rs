//! The load-carrying contacts of a state.

use crate::Vec3;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::contact::{Other, hertz};
use crate::model::Model;
use crate::state::State;
use crate::wall::{self, Bounds};

/// Contacts below this share of the mean normal force are not counted: rattlers hover around zero.
pub const FAINT: f64 = 1e-6;
/// A contact slides whose tangential force is within this share of μP (T 3.6.2: "determined by
/// the ratio between the tangential and normal contact forces").
pub const AT_LIMIT: f64 = 1e-3;

/// One contact.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// Grain i, in the solver's order.
    pub first: u32,
    /// The other body.
    pub second: Other,
    /// Unit normal from the other body to grain i.
    pub normal: Vec3,
    /// P \[N\].
    pub force: f64,
    /// h \[m\].
    pub overlap: f64,
    /// Q on grain i \[N\]; zero without friction.
    pub shear: Vec3,
    /// Couple on grain i along `normal` \[N m\].
    pub torsion: f64,
    /// Whether |Q| is at μP, of the present P.
    pub slides: bool,
    /// Whether it slid in the last increment.
    pub slipped: bool,
    /// From the other grain's centre, or the wall's plane, to the centre of grain i \[m\].
    pub distance: f64,
}

/// Contacts of one state with the mean of their forces.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// All with a positive overlap between bodies that take part in the balance.
    pub list: Vec<Contact>,
    /// Mean normal force of `list` \[N\].
    pub mean_force: f64,
    /// Mean magnitude of the tangential forces of `list` \[N\].
    pub mean_shear: f64,
}

impl Contacts {
    /// Lists the contacts of `state`; the neighbour list must hold them.
    #[must_use]
    pub fn of(model: &Model, state: &State, neighbours: &Neighbours) -> Self {
        let bounds = state.bounds(model);
        let mut list = Vec::with_capacity(neighbours.second.len());
        for i in (0..model.len()).filter(|&i| state.carries[i]) {
            let at = state.position[i];
            for k in neighbours.row(i) {
                let j = neighbours.second[k] as usize;
                let branch = at - state.position[j];
                let distance = branch.norm();
                let overlap = model.radius[i] + model.radius[j] - distance;
                if overlap > 0.0 && state.carries[j] {
                    list.push(Contact {
                        first: i as u32,
                        second: Other::Grain(j as u32),
                        normal: branch / distance,
                        force: hertz::force(neighbours.modulus[k], overlap),
                        shear: Vec3::zeros(),
                        torsion: 0.0,
                        slides: false,
                        slipped: false,
                        overlap,
                        distance,
                    });
                }
            }
            for &wall in neighbours.walls_near(i) {
                list.extend(wall_contact(model, neighbours, i, &at, wall, &bounds));
            }
        }
        let mut memory = state.memory.contacts.iter().peekable();
        for contact in &mut list {
            let key = (contact.first, contact.second);
            while memory.next_if(|m| m.key() < key).is_some() {}
            if let Some(load) = memory.next_if(|m| m.key() == key) {
                contact.shear = load.shear;
                contact.torsion = load.torsion;
                contact.slipped = load.slides;
                contact.slides = model.friction.as_ref().is_some_and(|friction| {
                    let limit = friction.between(contact.first, contact.second) * contact.force;
                    contact.shear.norm() >= (1.0 - AT_LIMIT) * limit
                });
            }
        }
        let mean = |sum: f64| sum / list.len().max(1) as f64;
        let mean_force = mean(list.iter().map(|c| c.force).sum());
        let mean_shear = mean(list.iter().map(|c| c.shear.norm()).sum());
        Self { list, mean_force, mean_shear }
    }

    /// Sliding contacts over all (T 3.6.2), of those that count.
    #[must_use]
    pub fn sliding_ratio(&self) -> f64 {
        let sliding = self.counted().filter(|c| c.slides).count();
        sliding as f64 / self.counted().count().max(1) as f64
    }

    /// Those that count: at least [`FAINT`] of the mean force.
    pub fn counted(&self) -> impl Iterator<Item = &Contact> {
        let least = FAINT * self.mean_force;
        self.list.iter().filter(move |c| c.force >= least)
    }
}

fn wall_contact(
    model: &Model,
    neighbours: &Neighbours,
    i: usize,
    at: &Vec3,
    wall: u8,
    bounds: &Bounds,
) -> Option<Contact> {
    let w = usize::from(wall);
    let distance = wall_gap(at, w, bounds);
    let overlap = model.radius[i] - distance;
    let mut normal = Vec3::zeros();
    normal[wall::axis(w)] = wall::inward(w);
    (overlap > 0.0).then(|| Contact {
        first: i as u32,
        second: Other::Wall(wall),
        normal,
        force: hertz::force(neighbours.wall_modulus[i], overlap),
        shear: Vec3::zeros(),
        torsion: 0.0,
        slides: false,
        slipped: false,
        overlap,
        distance,
    })
}

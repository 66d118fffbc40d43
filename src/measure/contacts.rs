//! The load-carrying contacts of a state.

use crate::Vec3;
use crate::contact::hertz;
use crate::contact::neighbours::{Neighbours, wall_gap};
use crate::model::Model;
use crate::state::State;
use crate::wall::{self, Bounds};

/// Contacts below this share of the mean normal force are not counted: rattlers hover around zero.
pub const FAINT: f64 = 1e-6;

/// What a grain touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Other {
    /// Another grain, in the solver's order.
    Grain(u32),
    /// A wall.
    Wall(u8),
}

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
                        overlap,
                        distance,
                    });
                }
            }
            for &wall in neighbours.walls_near(i) {
                list.extend(wall_contact(model, neighbours, i, &at, wall, &bounds));
            }
        }
        let mean_force = list.iter().map(|c| c.force).sum::<f64>() / list.len().max(1) as f64;
        Self { list, mean_force }
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
        overlap,
        distance,
    })
}

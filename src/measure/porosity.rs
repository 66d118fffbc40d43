//! Porosity with the caps of overlapping spheres removed (T 2.16-2.19).

use std::f64::consts::PI;

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::wall::Bounds;

/// Pore volume over total volume `volume` \[m³\] (T 2.19).
#[must_use]
pub fn porosity(model: &Model, contacts: &[Contact], volume: f64) -> f64 {
    let spheres: f64 = model.radius.iter().map(|&r| model.grain_volume(r)).sum();
    let caps: f64 = contacts
        .iter()
        .filter(|contact| contact.overlap > 0.0)
        .map(|contact| {
            let [first, second] = caps(model, contact);
            first + second
        })
        .sum();
    1.0 - (spheres - caps) / volume
}

/// Volumes of hydrate and pores \[m³\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pores {
    /// Of the grains of hydrate.
    pub hydrate: f64,
    /// Of the box without the other grains: fluid and hydrate.
    pub all: f64,
}

impl Pores {
    /// Hydrate over all pores (T 5.2.1).
    #[must_use]
    pub fn saturation(&self) -> f64 {
        self.hydrate / self.all
    }
}

/// Where hydrate and fluid are; every grain without its own caps.
#[must_use]
pub fn pores(model: &Model, contacts: &[Contact], bounds: &Bounds) -> Pores {
    let solid = solids(model, contacts);
    let of = |hydrate: bool| {
        let grains = solid.iter().zip(&model.grains).filter(|(_, grain)| grain.hydrate == hydrate);
        grains.map(|(volume, _)| volume).sum::<f64>()
    };
    Pores { hydrate: of(true), all: bounds.volume() - of(false) }
}

/// Volume of each grain without its caps \[m³\], shape (n), in the solver's order.
#[must_use]
pub fn solids(model: &Model, contacts: &[Contact]) -> Vec<f64> {
    let mut solid: Vec<f64> = model.radius.iter().map(|&r| model.grain_volume(r)).collect();
    for contact in contacts {
        let [first, second] = caps(model, contact);
        solid[contact.first as usize] -= first;
        if let Other::Grain(j) = contact.second {
            solid[j as usize] -= second;
        }
    }
    solid
}

/// Volumes that the two bodies of a contact lose to it \[m³\]; a wall loses none.
fn caps(model: &Model, contact: &Contact) -> [f64; 2] {
    let ri = model.radius[contact.first as usize];
    match contact.second {
        Other::Grain(j) => {
            let rj = model.radius[j as usize];
            // Distance of the disc of (2.16) from either centre.
            let r = contact.distance;
            let di = (r * r + ri * ri - rj * rj) / (2.0 * r);
            [cap(model, ri, ri - di), cap(model, rj, rj - (r - di))]
        }
        Other::Wall(_) => [cap(model, ri, contact.overlap), 0.0],
    }
}

/// Volume of a cap of the given height \[m³\]: of a sphere (2.17b; 2.17a is the same in ρ), or of a disc.
fn cap(model: &Model, radius: f64, height: f64) -> f64 {
    match &model.plane {
        None => PI * height * height * (radius - height / 3.0),
        Some(plane) => {
            let to_chord = radius - height;
            let half_chord = (height * (2.0 * radius - height)).sqrt();
            let sector = radius * radius * half_chord.atan2(to_chord);
            plane.depth * (sector - to_chord * half_chord)
        }
    }
}

//! Grains of hydrate, and what dissociation does to all grains (T 5.2.2).
//!
//! A saturation counts hydrate as part of the pores: S = V_h / V_tot, where V_tot is the box without
//! the other grains. What is lost is counted in the pore volume at the start, so that the volume of
//! every hydrate grain is 1 - ΔS/S of what it was. An excess pore pressure p leaves 1 - p/K_i of the
//! volume of grain i, K_i = E/(3 (1 - 2ν)). The mass of what dissolves is gone, compression keeps it.

use super::{Model, sphere_volume};
use crate::contact::neighbours::Neighbours;
use crate::measure::contacts::Contacts;
use crate::measure::porosity;
use crate::pack::Grain;
use crate::state::{Dissociated, State};

/// Largest share of the hydrate that can be lost: what is left of a grain has a tenth of its radius.
pub const MOST_LOST: f64 = 0.999;
/// Largest pore pressure over the bulk modulus of the softest grain: the strains of grains are small.
pub const MOST_PRESSURE: f64 = 0.1;

/// The hydrate of a pack.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Hydrate {
    /// Saturation S of the pack as loaded, with that of its cement; 0 without hydrate.
    pub saturation: f64,
    /// Bulk modulus of the softest grain \[Pa\].
    pub softest: f64,
    /// Lost saturation that radii and weights stand for.
    lost: f64,
    /// Pore pressure that they stand for \[Pa\].
    pressure: f64,
}

impl Hydrate {
    /// Of a model as loaded.
    pub(super) fn of(model: &Model) -> Self {
        let softest = model.grains.iter().map(bulk_modulus).fold(f64::INFINITY, f64::min);
        let cement = model.cement.map_or(0.0, |cement| cement.saturation);
        if !model.grains.iter().any(|grain| grain.hydrate) {
            return Self { saturation: cement, softest, ..Self::default() };
        }
        let state = State::new(model);
        let bounds = state.bounds(model);
        let mut near = Neighbours::default();
        near.refresh(model, &state.position, &bounds);
        let contacts = Contacts::of(model, &state, &near);
        let saturation = porosity::pores(model, &contacts.list, &bounds).saturation();
        let saturation = saturation + cement;
        Self { saturation, softest, ..Self::default() }
    }

    /// Share of the hydrate that is left when `lost` of the saturation is gone.
    #[must_use]
    pub fn left(&self, lost: f64) -> f64 {
        if lost == 0.0 { 1.0 } else { 1.0 - lost / self.saturation }
    }
}

/// K = E/(3 (1 - 2ν)) \[Pa\].
#[must_use]
pub fn bulk_modulus(grain: &Grain) -> f64 {
    grain.young / (3.0 * (1.0 - 2.0 * grain.poisson))
}

impl Model {
    /// Makes radii and weights those of grains to which `to` has happened; says whether they
    /// changed. A neighbour list made before is then wrong.
    pub fn dissociate(&mut self, to: &Dissociated) -> bool {
        if self.stands_for(to) {
            return false;
        }
        (self.hydrate.lost, self.hydrate.pressure) = (to.lost, to.pressure);
        for k in 0..self.len() {
            self.radius[k] = self.radius_at(k, to);
        }
        for k in 0..self.weight.len() {
            self.weight[k] = self.gravity * self.mass(k);
        }
        self.mean_radius = self.radius.iter().sum::<f64>() / self.len().max(1) as f64;
        self.max_radius = self.radius.iter().copied().fold(0.0, f64::max);
        true
    }

    /// Whether radii and weights are those of grains to which `what` has happened.
    #[must_use]
    pub fn stands_for(&self, what: &Dissociated) -> bool {
        (self.hydrate.lost, self.hydrate.pressure) == (what.lost, what.pressure)
    }

    /// Radius of grain `k` when `at` has happened to it \[m\].
    #[must_use]
    pub fn radius_at(&self, k: usize, at: &Dissociated) -> f64 {
        let grain = &self.grains[k];
        let left = if grain.hydrate { self.hydrate.left(at.lost) } else { 1.0 };
        grain.radius * (left * (1.0 - at.pressure / bulk_modulus(grain))).cbrt()
    }

    /// Mass of grain `k` \[kg\].
    #[must_use]
    pub fn mass(&self, k: usize) -> f64 {
        let grain = &self.grains[k];
        if let Some(plane) = &self.plane {
            return grain.density * plane.volume(grain.radius);
        }
        let loaded = grain.density * sphere_volume(grain.radius);
        if grain.hydrate { loaded * self.hydrate.left(self.hydrate.lost) } else { loaded }
    }

    /// Grain `k` as it is now, but for its position.
    #[must_use]
    pub fn grain(&self, k: usize) -> Grain {
        let grain = self.grains[k];
        // A compressed grain has its mass in less room.
        let density = grain.density / (1.0 - self.hydrate.pressure / bulk_modulus(&grain));
        Grain { radius: self.radius[k], density, ..grain }
    }
}

//! Statistics of the force network: fabric, force chains, forces against angle, distributions.
//!
//! Magnitudes and chains are of all contacts that count, directions of those between grains: walls
//! prescribe the normals of their contacts.

pub mod angle;
pub mod chains;
pub mod distribution;
pub mod tensor;

use crate::contact::Other;
use crate::measure::contacts::{Contact, Contacts};
use crate::measure::{coordination, stress};
use crate::model::Model;
use crate::report::Fabric;
use crate::state::{Condition, State};

/// The statistics of `contacts`, which are those of `state`; `share` of them, those with the
/// largest normal forces, make the force chains (τ_FC of T 2.7.4.1). Where cement pulls, it is a share
/// of those that press.
#[must_use]
pub fn fabric(model: &Model, state: &State, contacts: &Contacts, share: f64) -> Fabric {
    let counted: Vec<&Contact> = contacts.counted().collect();
    let is_between_grains = |contact: &&Contact| matches!(contact.second, Other::Grain(_));
    let inner: Vec<&Contact> = counted.iter().copied().filter(is_between_grains).collect();
    let mean = |sum: f64| if counted.is_empty() { 0.0 } else { sum / counted.len() as f64 };
    // Cement pulls too, and does not slide.
    let mean_normal_force = mean(counted.iter().map(|contact| contact.force.abs()).sum());
    let pressing: Vec<&Contact> = counted.iter().copied().filter(|one| one.force > 0.0).collect();
    let rubbing: Vec<&Contact> =
        counted.iter().copied().filter(|one| one.cement != Some(Condition::Intact)).collect();
    let chains = chains::chains(model.len(), &pressing, share);
    let stress = stress::in_volume(&contacts.list, state.volume(model));
    let numbers = coordination::numbers(model, counted.iter().copied());
    Fabric {
        contacts: counted.len() as u32,
        grain_contacts: inner.len() as u32,
        mean_normal_force,
        mean_tangential_force: mean(counted.iter().map(|contact| contact.shear.norm()).sum()),
        directions: tensor::directions(&inner, chains.threshold),
        chains,
        angle: angle::by_angle(&inner, angle::predicted(&counted, &stress)),
        force_histogram: distribution::forces(&counted, mean_normal_force),
        mobilised_histogram: model.friction.as_ref().map_or_else(Vec::new, |friction| {
            let limit =
                |contact: &Contact| friction.between(contact.first, contact.second) * contact.force;
            distribution::mobilised(&rubbing, limit)
        }),
        coordination: coordination::histograms(model, state, &numbers),
    }
}

//! The statistics of the force network as a message.

use super::pack_header;
use crate::msg::Fabric;
use crate::report::{self, AngularForm, ByAngle, Chains, Directions, Measures};

/// The statistics of the force network, when they were asked for.
#[must_use]
pub fn fabric(measures: &Measures) -> Option<Fabric> {
    let report::Fabric {
        contacts,
        grain_contacts,
        mean_normal_force,
        mean_tangential_force,
        directions,
        chains,
        angle,
        force_histogram,
        mobilised_histogram,
        coordination,
    } = measures.fabric.clone()?;
    let Directions {
        fabric,
        force_fabric,
        shear_fabric,
        contact_anisotropy,
        normal_anisotropy,
        tangential_anisotropy,
        cone_all,
        cone_largest,
    } = directions;
    let Chains { share, threshold, contacts: chain_contacts, grains, count, largest, load, .. } =
        chains;
    let ByAngle { count: angle_count, normal, tangential, shear, fitted, predicted } = angle;
    let form = |AngularForm { lateral, axial, shear }| [lateral, axial, shear];
    Some(Fabric {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        contacts,
        grain_contacts,
        mean_normal_force,
        mean_tangential_force,
        fabric,
        force_fabric,
        shear_fabric,
        contact_anisotropy,
        normal_anisotropy,
        tangential_anisotropy,
        cone_all,
        cone_largest,
        chain_share: share,
        chain_threshold: threshold,
        chain_contacts,
        chain_grains: grains,
        chains: count,
        largest_chain: largest,
        chain_load: load,
        chain_spans: chains.spans,
        strongest_path: chains.strongest_path,
        force_histogram,
        mobilised_histogram,
        angle_count,
        angle_normal: normal,
        angle_tangential: tangential,
        angle_shear: shear,
        angle_fitted: form(fitted),
        angle_predicted: form(predicted),
        coordination: coordination.all,
        interior_coordination: coordination.interior,
    })
}

//! What is told of discs as a message.

use super::pack_header;
use crate::msg::PlaneState;
use crate::report::{self, Measures, Polar, Rings};

/// The state of a pack of discs, when it was asked for.
#[must_use]
pub fn plane_state(measures: &Measures) -> Option<PlaneState> {
    let report::PlaneState { polar, rings, .. } = measures.plane.as_ref()?;
    let report::PlaneState {
        mean_diameter,
        tilt,
        margin,
        area,
        stress,
        principal_stress,
        principal_direction,
        contacts_per_grain,
        contact_density,
        share_broken,
        mean_rotation,
        network_strain,
        contact_strain,
        ..
    } = *measures.plane.as_ref()?;
    let Polar { contacts, normal, shear } = polar.clone();
    let Rings { radius, radial_stress, hoop_stress, contact_density: ring_density } = rings.clone();
    Some(PlaneState {
        header: pack_header(measures.stamp),
        increment: measures.increment,
        mean_diameter,
        tilt,
        margin,
        area,
        stress,
        principal_stress,
        principal_direction,
        contacts_per_grain,
        contact_density,
        share_broken,
        mean_rotation,
        network_strain,
        contact_strain,
        polar_contacts: contacts,
        polar_normal: normal,
        polar_shear: shear,
        ring_radius: radius,
        ring_radial_stress: radial_stress,
        ring_hoop_stress: hoop_stress,
        ring_contact_density: ring_density,
    })
}

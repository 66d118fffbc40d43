//! What each grain tells: where it is, the pressure in it, how far it went.

use crate::Vec3;
use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::Model;
use crate::report::Grains;
use crate::state::State;

/// Every grain of `state` in the order of the pack file; `contacts` are all that carry load.
///
/// The stress of a grain is that of Love and Weber, the sum over its contacts of force times lever
/// over its volume, so that these stresses times the grains' volumes add up to the stress of the
/// pack times that of the box ([`from_contacts`](super::stress::from_contacts)). Of its trace
/// nothing but the normal forces is left: levers are along the normals, shear is across.
#[must_use]
pub fn grains(model: &Model, state: &State, contacts: &[Contact]) -> Grains {
    let mut moment = vec![0.0; model.len()];
    for contact in contacts {
        let i = contact.first as usize;
        let lever = match contact.second {
            Other::Wall(_) => contact.distance,
            Other::Grain(j) => {
                let [radius, other] = [i, j as usize].map(|k| model.radius[k]);
                let lever = to_contact(radius, other, contact.distance);
                moment[j as usize] += contact.force * (contact.distance - lever);
                lever
            }
        };
        moment[i] += contact.force * lever;
    }
    let mut grains = Grains {
        position: vec![[0.0; 3]; model.len()],
        radius: vec![0.0; model.len()],
        pressure: vec![0.0; model.len()],
        displacement: vec![[0.0; 3]; model.len()],
        turn: if model.plane.is_some() { vec![0.0; state.rotation.len()] } else { Vec::new() },
    };
    let dimensions = f64::from(model.dimensions());
    for (k, &order) in model.order.iter().enumerate() {
        let at = order as usize;
        let given = Vec3::from(model.grains[k].position);
        grains.position[at] = state.position[k].into();
        grains.radius[at] = model.radius[k];
        grains.pressure[at] = moment[k] / (dimensions * model.grain_volume(model.radius[k]));
        grains.displacement[at] = (state.position[k] - given).into();
        if let (Some(turn), Some(rotation)) = (grains.turn.get_mut(at), state.rotation.get(k)) {
            *turn = rotation.z;
        }
    }
    grains
}

/// From the centre of a sphere to the plane in which it and an `other` one intersect \[m\].
fn to_contact(radius: f64, other: f64, distance: f64) -> f64 {
    0.5 * (distance + (radius - other) * (radius + other) / distance)
}

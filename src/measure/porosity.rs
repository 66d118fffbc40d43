//! Porosity with the caps of overlapping spheres removed (T 2.16-2.19).

use std::f64::consts::PI;

use crate::contact::Other;
use crate::measure::contacts::Contact;
use crate::model::{Model, sphere_volume};
use crate::wall::Bounds;

/// Pore volume over total volume (T 2.19).
#[must_use]
pub fn porosity(model: &Model, contacts: &[Contact], bounds: &Bounds) -> f64 {
    let spheres: f64 = model.radius.iter().map(|&r| sphere_volume(r)).sum();
    let caps: f64 = contacts
        .iter()
        .filter(|contact| contact.overlap > 0.0)
        .map(|contact| {
            let ri = model.radius[contact.first as usize];
            match contact.second {
                Other::Grain(j) => {
                    let rj = model.radius[j as usize];
                    // Distance of the disc of (2.16) from either centre.
                    let r = contact.distance;
                    let di = (r * r + ri * ri - rj * rj) / (2.0 * r);
                    cap(ri, ri - di) + cap(rj, rj - (r - di))
                }
                Other::Wall(_) => cap(ri, contact.overlap),
            }
        })
        .sum();
    1.0 - (spheres - caps) / bounds.volume()
}

/// Volume of a spherical cap of the given height \[m³\] (2.17b; 2.17a is the same in ρ).
fn cap(radius: f64, height: f64) -> f64 {
    PI * height * height * (radius - height / 3.0)
}

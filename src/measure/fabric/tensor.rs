//! Fabric tensors and shares of directions.
//!
//! With a density of normals (1 + n·a n)/4π and a traceless a, the mean of n⊗n is 1/3 + 2/15 a. So
//! a = 15/2 of the deviator. The Love-Weber stress of contacts of one length d, N of them in V, is
//! σ = d/V Σ (P n + Q)⊗n, hence with p its mean pressure σ/p = 3 (Σ P n⊗n + Σ Q⊗n)/Σ P, and
//! q/p = 2/5 (a_c + a_n + 3/2 a_t) holds exactly with the anisotropies as they are defined here.
//! To first order they are those of L. Rothenburg and R. J. Bathurst (Géotechnique 39, 601, 1989).

use nalgebra::Matrix3;

use crate::measure::contacts::Contact;
use crate::measure::row_major;
use crate::report::Directions;

/// The axis of the scene.
pub(super) const AXIS: usize = 2;

/// A normal this close to the edge of a cone is in it: crystals have theirs on the edge, a rounding
/// apart.
const EDGE: f64 = 1e-9;

/// Directions of contacts between grains; the largest forces are those of at least `threshold`
/// \[N\].
#[must_use]
pub fn directions(contacts: &[&Contact], threshold: f64) -> Directions {
    let mut normals = Matrix3::zeros();
    let mut forces = Matrix3::zeros();
    let mut shears = Matrix3::zeros();
    for contact in contacts {
        let dyad = contact.normal * contact.normal.transpose();
        normals += dyad;
        forces += dyad * contact.force;
        shears += contact.shear * contact.normal.transpose();
    }
    let load = forces.trace();
    let fabric = over(normals, contacts.len() as f64);
    let force_fabric = over(forces, load);
    let shear_fabric = over(shears, load);
    Directions {
        fabric: row_major(&fabric),
        force_fabric: row_major(&force_fabric),
        shear_fabric: row_major(&shear_fabric),
        contact_anisotropy: 7.5 * axial(&fabric),
        normal_anisotropy: 7.5 * axial(&(force_fabric - fabric)),
        tangential_anisotropy: 5.0 * axial(&shear_fabric),
        cone_all: cones(contacts.iter().copied()),
        cone_largest: cones(contacts.iter().copied().filter(|one| one.force >= threshold)),
    }
}

/// Share of the normals within 45° of each axis (T 2.7.4.2).
fn cones<'a>(contacts: impl Iterator<Item = &'a Contact>) -> [f64; 3] {
    let mut all = 0_u32;
    let mut inside = [0_u32; 3];
    for contact in contacts {
        all += 1;
        for (count, along) in inside.iter_mut().zip(&contact.normal) {
            *count += u32::from(along * along >= 0.5 - EDGE);
        }
    }
    match all {
        0 => [f64::NAN; 3],
        _ => inside.map(|count| f64::from(count) / f64::from(all)),
    }
}

/// `m` over `by`; NaN of one sign when there is nothing.
fn over(m: Matrix3<f64>, by: f64) -> Matrix3<f64> {
    if by > 0.0 { m / by } else { Matrix3::repeat(f64::NAN) }
}

/// What the axis has more than the mean of the other two.
fn axial(m: &Matrix3<f64>) -> f64 {
    1.5 * m[(AXIS, AXIS)] - 0.5 * m.trace()
}

//! Mean forces against the angle of the contact to the axis (B A.55-A.73).
//!
//! B A.73, F_n = F (c² + σ1/σ3 s²) and F_s = F (1 - σ1/σ3) c s of a contact at the angle α to σ3, are
//! the components along and across n of one vector, F σ n/σ3: the mean force of a contact is the
//! traction on a plane with its normal, times an area. In three dimensions the area follows from
//! Love and Weber, σ = N d̄/V ⟨f⊗n⟩, with contacts in all directions alike, ⟨n⊗n⟩ = 1/3, and lengths
//! that do not depend on them: f(n) = F₀ σ n/p with F₀ = 3 p V/(N d̄), where the plane has 2 for
//! the 3 (B A.68). Over all turns about the axis that is, with θ from the axis,
//!
//! P(θ) = F₀/p (σ_l sin²θ + σ_a cos²θ), Q(θ) = F₀/p (σ_a - σ_l) sin θ cos θ.
//!
//! Contacts without friction cannot do so: normal forces alone have to carry the deviator, which
//! takes 5/2 of its part of P (`docs/network.md`).

use nalgebra::Matrix3;

use super::tensor::AXIS;
use crate::measure::contacts::Contact;
use crate::report::{AngularForm, ByAngle};

/// Bins of equal |cos θ|.
pub const BINS: usize = 10;

/// Below this sine a contact lies along the axis and its plane has no direction of shear.
const ALONG: f64 = 1e-9;

/// The form that `stress` \[Pa\], that of Love and Weber, predicts for `contacts`: all that carry it.
#[must_use]
pub fn predicted(contacts: &[&Contact], stress: &Matrix3<f64>) -> AngularForm {
    let (length, moment) = contacts.iter().fold((0.0, 0.0), |(length, moment), contact| {
        (length + contact.distance, moment + contact.force * contact.distance)
    });
    let pressure = stress.trace() / 3.0;
    if !(length > 0.0 && pressure > 0.0) {
        return AngularForm { lateral: f64::NAN, axial: f64::NAN, shear: f64::NAN };
    }
    // 3 p V is the sum of the forces times the lengths.
    let mean = moment / length;
    let axial = mean * stress[(AXIS, AXIS)] / pressure;
    let lateral = mean * (1.5 - 0.5 * stress[(AXIS, AXIS)] / pressure);
    AngularForm { lateral, axial, shear: axial - lateral }
}

/// Forces of `contacts`, which are between grains, in bins, with the form fitted to them.
#[must_use]
pub fn by_angle(contacts: &[&Contact], predicted: AngularForm) -> ByAngle {
    let mut count = vec![0_u32; BINS];
    let [mut normal, mut tangential, mut shear] = [(); 3].map(|()| vec![0.0; BINS]);
    for contact in contacts {
        let cosine = contact.normal[AXIS].abs();
        let bin = ((cosine * BINS as f64) as usize).min(BINS - 1);
        count[bin] += 1;
        normal[bin] += contact.force;
        tangential[bin] += contact.shear.norm();
        shear[bin] += axial_shear(contact);
    }
    for (k, &count) in count.iter().enumerate() {
        for sum in [&mut normal[k], &mut tangential[k], &mut shear[k]] {
            *sum = if count > 0 { *sum / f64::from(count) } else { f64::NAN };
        }
    }
    ByAngle { count, normal, tangential, shear, fitted: fitted(contacts), predicted }
}

/// Component of the tangential force along the axis' projection on the contact plane \[N\]: the same
/// for either grain of the contact.
fn axial_shear(contact: &Contact) -> f64 {
    let cosine = contact.normal[AXIS];
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    if sine < ALONG { 0.0 } else { contact.shear[AXIS] * cosine.signum() / sine }
}

/// Least squares over the contacts; NaN where their directions cannot tell a number.
fn fitted(contacts: &[&Contact]) -> AngularForm {
    // Sums of s⁴, s²c², c⁴, P s², P c² and Q_z n_z = Q s c.
    let [mut ss, mut sc, mut cc, mut ps, mut pc, mut qz] = [0.0; 6];
    for contact in contacts {
        let c = contact.normal[AXIS] * contact.normal[AXIS];
        let s = 1.0 - c;
        ss += s * s;
        sc += s * c;
        cc += c * c;
        ps += contact.force * s;
        pc += contact.force * c;
        qz += contact.shear[AXIS] * contact.normal[AXIS];
    }
    // Relative to its terms: all contacts at one angle leave rounding.
    let determinant = ss * cc - sc * sc;
    let (lateral, axial) = match determinant > 1e-12 * ss * cc {
        true => ((ps * cc - pc * sc) / determinant, (pc * ss - ps * sc) / determinant),
        false => (f64::NAN, f64::NAN),
    };
    AngularForm { lateral, axial, shear: if sc > 0.0 { qz / sc } else { f64::NAN } }
}

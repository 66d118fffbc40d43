//! Statistics of a force network that was never there, every field another number.

use std::array::from_fn;

use graintwin::measure::coordination::Histograms;
use graintwin::report::{AngularForm, ByAngle, Chains, Directions, Fabric};

/// Floats from `next`; counts that tell them apart.
pub(crate) fn fabric(next: &mut impl FnMut() -> f64) -> Fabric {
    let form = |next: &mut dyn FnMut() -> f64| AngularForm {
        lateral: next(),
        axial: next(),
        shear: next(),
    };
    Fabric {
        contacts: 90_001,
        grain_contacts: 80_002,
        mean_normal_force: next(),
        mean_tangential_force: next(),
        directions: Directions {
            fabric: from_fn(|_| next()),
            force_fabric: from_fn(|_| next()),
            shear_fabric: from_fn(|_| next()),
            contact_anisotropy: next(),
            normal_anisotropy: next(),
            tangential_anisotropy: next(),
            cone_all: from_fn(|_| next()),
            cone_largest: from_fn(|_| next()),
        },
        chains: Chains {
            share: next(),
            threshold: next(),
            contacts: 9_003,
            grains: 7_004,
            count: 705,
            largest: 606,
            load: next(),
            spans: [true, false, true],
            strongest_path: from_fn(|_| next()),
        },
        angle: ByAngle {
            count: vec![7, 0, 9],
            normal: vec![next(), f64::NAN, next()],
            tangential: vec![next(), f64::NAN, next()],
            shear: vec![next(), f64::NAN, next()],
            fitted: form(next),
            predicted: form(next),
        },
        force_histogram: vec![10, 11, 0, 12],
        mobilised_histogram: vec![13, 14],
        coordination: Histograms { all: vec![15, 0, 16], interior: vec![17] },
    }
}

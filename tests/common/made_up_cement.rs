//! Bonds and cracks that were never there, every field another number.

use std::array::from_fn;

use graintwin::report::{BondCondition, Bonds, Crack, Cracks};

/// So many bonds, with floats from `next`.
pub(crate) fn bonds(count: u32, next: &mut impl FnMut() -> f64) -> Bonds {
    let mut values = |count: u32| (0..count).map(|_| next()).collect::<Vec<f64>>();
    Bonds {
        tensile_strength: values(1)[0],
        shear_strength: f64::INFINITY,
        first: (0..count).collect(),
        second: (0..count).map(|bond| u32::MAX - bond % 6).collect(),
        condition: (0..count).map(|bond| (bond % 3) as u8).collect(),
        share: values(count),
        radius: values(count),
        position: values(3 * count),
        normal: values(3 * count),
        normal_force: values(count),
        tangential_force: values(3 * count),
        torsion: values(count),
        strength_use: values(count),
    }
}

/// So many cracks, with floats from `next`.
pub(crate) fn cracks(count: u32, next: &mut impl FnMut() -> f64) -> Cracks {
    let crack = |k: u32| Crack {
        first: k,
        second: u32::MAX - k % 6,
        mode: if k.is_multiple_of(2) { BondCondition::Shear } else { BondCondition::Tension },
        substep: k / 2,
        position: from_fn(|_| next()),
        normal: from_fn(|_| next()),
        normal_force: -next(),
        tangential_force: next(),
        torsion: next(),
        overload: next(),
        stress_before: next(),
        stress_after: next(),
        energy_released: next(),
    };
    Cracks { intact: 31, tension: 7, shear: 5, list: (0..count).map(crack).collect() }
}

//! Moduli from a tangent stiffness: the isotropic body closest to it, and how far that is.

mod plane;

use nalgebra::Matrix3;

use crate::measure::row_major;
use crate::relax::tangent::{Stiffness, Tangent};
use crate::report::{self, Moduli, TangentModuli};
use crate::wall;

/// The moduli of `tangent` for a pack of bulk density `density` \[kg/m³\], of spheres or in the `plane`.
#[must_use]
pub fn report(tangent: &Tangent, density: f64, plane: bool) -> report::Tangent {
    let moduli = if plane { plane::moduli } else { moduli };
    let of = |stiffness: &Option<Stiffness>| match stiffness {
        Some(stiffness) => moduli(stiffness, density),
        None => UNKNOWN,
    };
    let (stands, sticks) = (of(&tangent.stands), of(&tangent.sticks));
    report::Tangent { density, products: tangent.products, stands, sticks }
}

const UNKNOWN: TangentModuli = TangentModuli {
    valid: false,
    error: f64::NAN,
    relaxed: [f64::NAN; 9],
    affine: [f64::NAN; 9],
    wall_stiffness: [[f64::NAN; wall::COUNT]; wall::COUNT],
    bulk: f64::NAN,
    shear: f64::NAN,
    young: f64::NAN,
    poisson: f64::NAN,
    lame: f64::NAN,
    p_wave: f64::NAN,
    shear_pairs: [f64::NAN; 3],
    p_speed: [f64::NAN; 3],
    s_speed: [f64::NAN; 3],
    isotropy_index: f64::NAN,
};

/// The λ and G of (2.15) that fit C = dσ/dε best, λ + 2G δ_lm, are those of K = ΣC/9 and of G as
/// the mean over the pairs of directions, each from the strain (1, -1).
fn moduli(stiffness: &Stiffness, density: f64) -> TangentModuli {
    let c = &stiffness.relaxed;
    let bulk = c.sum() / 9.0;
    let pair = |l: usize, m: usize| 0.25 * (c[(l, l)] + c[(m, m)] - c[(l, m)] - c[(m, l)]);
    let shear_pairs = [pair(0, 1), pair(1, 2), pair(2, 0)];
    let shear = shear_pairs.iter().sum::<f64>() / 3.0;
    let lame = bulk - 2.0 / 3.0 * shear;
    let isotropic = Matrix3::repeat(lame) + Matrix3::identity() * (2.0 * shear);
    let speed = |modulus: f64| (modulus / density).sqrt();
    TangentModuli {
        valid: true,
        error: stiffness.error,
        relaxed: row_major(c),
        affine: row_major(&stiffness.affine),
        wall_stiffness: std::array::from_fn(|v| std::array::from_fn(|w| stiffness.walls[(v, w)])),
        bulk,
        shear,
        young: 9.0 * bulk * shear / (3.0 * bulk + shear),
        poisson: (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)),
        lame,
        p_wave: bulk + 4.0 / 3.0 * shear,
        shear_pairs,
        p_speed: std::array::from_fn(|axis| speed(c[(axis, axis)])), // (2.20a)
        s_speed: shear_pairs.map(speed),                             // (2.20b)
        isotropy_index: 1.0 - (c - isotropic).norm() / c.norm(),
    }
}

impl Moduli {
    /// Those of the state, the wave speeds with all contacts sticking.
    #[must_use]
    pub fn of_tangent(tangent: &report::Tangent) -> Self {
        let report::Tangent { stands, sticks, density, .. } = tangent;
        let speed = |modulus: f64| (modulus / density).sqrt();
        Self {
            valid: stands.valid,
            bulk: stands.bulk,
            shear: stands.shear,
            young: stands.young,
            poisson: stands.poisson,
            lame: stands.lame,
            p_wave: stands.p_wave,
            tangent: stands.relaxed,
            p_speed: speed(sticks.p_wave),
            s_speed: speed(sticks.shear),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix6;

    use super::*;

    fn of(relaxed: Matrix3<f64>) -> TangentModuli {
        let (affine, walls) = (relaxed * 2.0, Matrix6::identity());
        moduli(&Stiffness { relaxed, affine, walls, error: 1e-12 }, 2.0)
    }

    #[test]
    fn a_hookean_solid_has_its_moduli_and_is_isotropic() {
        // λ = 3, G = 2.
        let found = of(Matrix3::new(7.0, 3.0, 3.0, 3.0, 7.0, 3.0, 3.0, 3.0, 7.0));
        for (got, want) in [
            (found.lame, 3.0),
            (found.shear, 2.0),
            (found.bulk, 3.0 + 4.0 / 3.0),
            (found.young, 5.2),
            (found.poisson, 0.3),
            (found.p_wave, 7.0),
            (found.p_speed[1], 3.5f64.sqrt()),
            (found.s_speed[2], 1.0),
            (found.isotropy_index, 1.0),
        ] {
            assert!((got - want).abs() < 1e-12, "{got} {want}");
        }
    }

    #[test]
    fn the_fit_is_the_closest_isotropic_body() {
        let c = Matrix3::new(9.0, 2.0, 4.0, 2.5, 7.0, 3.0, 3.0, 1.0, 5.0);
        let found = of(c);
        let off = |lame: f64, shear: f64| {
            (c - Matrix3::repeat(lame) - Matrix3::identity() * (2.0 * shear)).norm()
        };
        let least = off(found.lame, found.shear);
        for (lame, shear) in [(1e-3, 0.0), (-1e-3, 0.0), (0.0, 1e-3), (0.0, -1e-3)] {
            assert!(off(found.lame + lame, found.shear + shear) > least);
        }
        assert!((found.isotropy_index - (1.0 - least / c.norm())).abs() < 1e-14);
        // By hand: (9 + 7 - 2 - 2.5)/4, (7 + 5 - 3 - 1)/4, (5 + 9 - 4 - 3)/4.
        assert_eq!(found.shear_pairs, [2.875, 2.0, 1.75]);
    }
}

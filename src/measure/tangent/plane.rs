//! The isotropic body in the plane that is closest to a tangent stiffness over xx, yy and γ = 2 εxy.

use nalgebra::Matrix3;

use crate::measure::row_major;
use crate::relax::tangent::Stiffness;
use crate::report::TangentModuli;

/// K is the mean stress over the strain of the area. G is ¼ (C_xx,xx + C_yy,yy - C_xx,yy - C_yy,xx) under
/// the strain (1, -1) and C_xy,xy under γ; the body that fits C best as a tensor has their mean, and E and
/// ν of B A.9. Where sides cannot shear the pack γ is not known, and the first stands alone.
pub(super) fn moduli(stiffness: &Stiffness, density: f64) -> TangentModuli {
    let c = &stiffness.relaxed;
    let bulk = 0.25 * c.fixed_view::<2, 2>(0, 0).sum();
    let across = 0.25 * (c[(0, 0)] + c[(1, 1)] - c[(0, 1)] - c[(1, 0)]);
    let along = c[(2, 2)];
    let sheared = along.is_finite();
    let shear = if sheared { 0.5 * (across + along) } else { across };
    let lame = bulk - shear;
    let speed = |modulus: f64| (modulus / density).sqrt();
    let (young, poisson) = match bulk + shear == 0.0 {
        true => (0.0, f64::NAN),
        false => (4.0 * bulk * shear / (bulk + shear), (bulk - shear) / (bulk + shear)),
    };
    TangentModuli {
        valid: true,
        error: stiffness.error,
        relaxed: row_major(c),
        affine: row_major(&stiffness.affine),
        wall_stiffness: std::array::from_fn(|v| std::array::from_fn(|w| stiffness.walls[(v, w)])),
        bulk,
        shear,
        young,
        poisson,
        lame,
        p_wave: bulk + shear,
        shear_pairs: [across, f64::NAN, f64::NAN],
        p_speed: [speed(c[(0, 0)]), speed(c[(1, 1)]), f64::NAN],
        s_speed: [speed(if sheared { along } else { across }), f64::NAN, f64::NAN],
        isotropy_index: isotropy(c, lame, shear, sheared),
    }
}

/// 1 - |C - C_iso|/|C| with the lengths of tensors, in which the entries of γ count 2 and 4 times.
fn isotropy(c: &Matrix3<f64>, lame: f64, shear: f64, sheared: bool) -> f64 {
    let isotropic =
        Matrix3::new(lame + 2.0 * shear, lame, 0.0, lame, lame + 2.0 * shear, 0.0, 0.0, 0.0, shear);
    let length = |of: Matrix3<f64>| {
        let square = |l: usize, m: usize| match (l < 2, m < 2) {
            (true, true) => of[(l, m)].powi(2),
            _ if !sheared => 0.0,
            (false, false) => 4.0 * of[(l, m)].powi(2),
            _ => 2.0 * of[(l, m)].powi(2),
        };
        (0..3)
            .flat_map(|l| (0..3).map(move |m| (l, m)))
            .map(|(l, m)| square(l, m))
            .sum::<f64>()
            .sqrt()
    };
    1.0 - length(c - isotropic) / length(*c)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix6, Rotation2};

    use super::*;
    use crate::analytic::hooke::Hooke;
    use crate::analytic::tensor::Tensor;

    fn of(relaxed: Matrix3<f64>) -> TangentModuli {
        moduli(&Stiffness { relaxed, affine: relaxed, walls: Matrix6::identity(), error: 0.0 }, 2.0)
    }

    /// C of a law from strains to stresses.
    fn law(stress: impl Fn(&Tensor) -> Tensor) -> Matrix3<f64> {
        let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.5]].map(|[xx, yy, xy]| {
            let Tensor { xx, yy, xy } = stress(&Tensor { xx, yy, xy });
            [xx, yy, xy].into()
        });
        Matrix3::from_columns(&columns)
    }

    #[test]
    fn a_hookean_plane_has_its_moduli_and_is_isotropic() {
        let hooke = Hooke { young: 5.0, poisson: 0.2 };
        let found = of(law(|strain| hooke.stress(strain)));
        for (got, want) in [
            (found.young, 5.0),
            (found.poisson, 0.2),
            (found.bulk, hooke.bulk_modulus()),
            (found.shear, hooke.shear_modulus()),
            (found.p_wave, hooke.compression_modulus()),
            (found.p_speed[0], (0.5 * hooke.compression_modulus()).sqrt()),
            (found.s_speed[0], (0.5 * hooke.shear_modulus()).sqrt()),
            (found.isotropy_index, 1.0),
        ] {
            assert!((got - want).abs() < 1e-14, "{got} {want}");
        }
        assert!(found.p_speed[2].is_nan() && found.shear_pairs[1].is_nan());
    }

    #[test]
    fn moduli_do_not_depend_on_the_axes() {
        let c = Matrix3::new(9.0, 2.0, 0.7, 2.5, 7.0, -0.3, 0.4, 0.1, 3.0);
        let turn = *Rotation2::new(0.4).matrix();
        let matrix = |t: &Tensor| nalgebra::Matrix2::new(t.xx, t.xy, t.xy, t.yy);
        let tensor =
            |m: nalgebra::Matrix2<f64>| Tensor { xx: m[(0, 0)], yy: m[(1, 1)], xy: m[(0, 1)] };
        let turned = law(|strain| {
            let e = tensor(turn.transpose() * matrix(strain) * turn);
            let s = c * nalgebra::Vector3::new(e.xx, e.yy, 2.0 * e.xy);
            tensor(turn * matrix(&Tensor { xx: s[0], yy: s[1], xy: s[2] }) * turn.transpose())
        });
        let (one, other) = (of(c), of(turned));
        for (a, b) in [
            (one.bulk, other.bulk),
            (one.shear, other.shear),
            (one.isotropy_index, other.isotropy_index),
        ] {
            assert!((a - b).abs() < 1e-14, "{a} {b}");
        }
    }
}

//! Secant moduli of a load interval, by the least-squares fit of Hooke's law (T 2.15).

use crate::report::Moduli;

/// A path whose volumetric (or deviatoric) strain is below this share of the whole cannot tell
/// the bulk (or shear) modulus: the other part's response would drown it.
const TELLING: f64 = 0.05;

impl Moduli {
    /// Nothing known.
    pub const UNKNOWN: Self = Self {
        valid: false,
        bulk: f64::NAN,
        shear: f64::NAN,
        young: f64::NAN,
        poisson: f64::NAN,
        lame: f64::NAN,
        p_wave: f64::NAN,
        tangent: [f64::NAN; 9],
        p_speed: f64::NAN,
        s_speed: f64::NAN,
    };
}

/// Moduli from the change of normal stress \[Pa\] and engineering strain over an interval.
///
/// The fit of σ = λ tr ε + 2Gε to three directions splits into K = tr dσ / (3 tr dε) and
/// G = s:e / (2 e:e) with the deviators s and e. `density` is the bulk density \[kg/m³\].
#[must_use]
pub fn secant(stress: [f64; 3], strain: [f64; 3], density: f64) -> Moduli {
    let trace = strain.iter().sum::<f64>();
    let size = strain.iter().map(|e| e * e).sum::<f64>().sqrt();
    let mean_stress = stress.iter().sum::<f64>() / 3.0;
    let e = strain.map(|e| e - trace / 3.0);
    let s = stress.map(|s| s - mean_stress);
    let ee = e.iter().map(|e| e * e).sum::<f64>();
    let se = s.iter().zip(&e).map(|(s, e)| s * e).sum::<f64>();
    let known = |told: bool, value: f64| if told && value.is_finite() { value } else { f64::NAN };
    let bulk = known(trace.abs() > TELLING * size, mean_stress / trace);
    let shear = known(ee.sqrt() > TELLING * size, se / (2.0 * ee));
    let p_wave = bulk + 4.0 / 3.0 * shear;
    Moduli {
        valid: bulk.is_finite() || shear.is_finite(),
        bulk,
        shear,
        young: 9.0 * bulk * shear / (3.0 * bulk + shear),
        poisson: (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear)),
        lame: bulk - 2.0 / 3.0 * shear,
        p_wave,
        p_speed: (p_wave / density).sqrt(), // (2.20a)
        s_speed: (shear / density).sqrt(),  // (2.20b)
        ..Moduli::UNKNOWN
    }
}

/// As [`secant`] in the plane, where nothing strains along z and E and ν are those of B A.9: K is the
/// mean stress over the strain of the area, E = 4KG/(K + G), ν = (K - G)/(K + G).
#[must_use]
pub fn secant_in_plane(stress: [f64; 3], strain: [f64; 3], density: f64) -> Moduli {
    let [trace, apart] = [strain[0] + strain[1], strain[0] - strain[1]];
    let size = strain[0].hypot(strain[1]);
    let known = |told: f64, value: f64| {
        if told.abs() > TELLING * size && value.is_finite() { value } else { f64::NAN }
    };
    let bulk = known(trace, 0.5 * (stress[0] + stress[1]) / trace);
    let shear = known(apart, 0.5 * (stress[0] - stress[1]) / apart);
    let p_wave = bulk + shear;
    Moduli {
        valid: bulk.is_finite() || shear.is_finite(),
        bulk,
        shear,
        young: 4.0 * bulk * shear / (bulk + shear),
        poisson: (bulk - shear) / (bulk + shear),
        lame: bulk - shear,
        p_wave,
        p_speed: (p_wave / density).sqrt(),
        s_speed: (shear / density).sqrt(),
        ..Moduli::UNKNOWN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moduli_in_the_plane_are_those_of_its_hooke() {
        // ε = (σ - ν σ')/E (B A.9) with E = 5, ν = 0.2.
        let stress = [1.0, 3.0, 0.0];
        let strain = [(1.0 - 0.2 * 3.0) / 5.0, (3.0 - 0.2) / 5.0, 0.0];
        let m = secant_in_plane(stress, strain, 2.0);
        assert!((m.young - 5.0).abs() < 1e-12 && (m.poisson - 0.2).abs() < 1e-12);
        assert!((m.shear - 5.0 / 2.4).abs() < 1e-12);
    }

    /// An isotropic solid with λ = 3, G = 2 under dε: σ = λ tr ε + 2Gε.
    fn hooke(strain: [f64; 3]) -> [f64; 3] {
        strain.map(|e| 3.0 * strain.iter().sum::<f64>() + 4.0 * e)
    }

    #[test]
    fn a_uniaxial_path_tells_all_moduli_of_a_hookean_solid() {
        let strain = [0.0, 0.0, 1e-4];
        let m = secant(hooke(strain), strain, 2.0);
        for (got, want) in [
            (m.lame, 3.0),
            (m.shear, 2.0),
            (m.bulk, 3.0 + 4.0 / 3.0),
            (m.young, 5.2),
            (m.poisson, 0.3),
            (m.p_wave, 7.0),
            (m.p_speed, 3.5f64.sqrt()),
            (m.s_speed, 1.0),
        ] {
            assert!((got - want).abs() < 1e-12, "{got} {want}");
        }
        assert!(m.valid);
    }

    #[test]
    fn an_isotropic_path_tells_the_bulk_modulus_only() {
        let m = secant(hooke([1e-4; 3]), [1e-4; 3], 2.0);
        assert!(m.valid && (m.bulk - 13.0 / 3.0).abs() < 1e-12);
        assert!(m.shear.is_nan() && m.young.is_nan() && m.s_speed.is_nan());
    }

    #[test]
    fn a_constant_volume_path_tells_the_shear_modulus_only() {
        let strain = [-5e-5, -5e-5, 1.001e-4];
        let m = secant(hooke(strain), strain, 2.0);
        assert!(m.valid && (m.shear - 2.0).abs() < 1e-12);
        assert!(m.bulk.is_nan() && m.lame.is_nan() && m.p_wave.is_nan());
    }

    #[test]
    fn no_strain_tells_nothing() {
        let m = secant([1.0, 2.0, 3.0], [0.0; 3], 2.0);
        assert!(!m.valid && m.bulk.is_nan() && m.shear.is_nan());
    }
}

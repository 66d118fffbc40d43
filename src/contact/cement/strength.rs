//! When cement breaks: the largest stresses of its cross-section, a disc of radius a, against its
//! strengths (Potyondy and Cundall 2004, their eqs 13 and 14; it has no bending here).

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

/// Strengths of cement \[Pa\], above 0 to infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strength {
    /// Of the tensile stress.
    pub tension: f64,
    /// Of the shear stress.
    pub shear: f64,
}

/// How cement broke.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// By the tensile stress.
    Tension,
    /// By the shear stress.
    Shear,
}

/// Load of a bond.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Normal force of the cement \[N\], negative in tension.
    pub normal: f64,
    /// Magnitude of the tangential force \[N\].
    pub shear: f64,
    /// Magnitude of the couple about the normal \[N m\].
    pub torsion: f64,
}

impl Strength {
    /// The larger of the stresses of `load` over their strengths on a disc of the radius `radius`
    /// \[m\], and which it is: the cement breaks at 1.
    #[must_use]
    pub fn use_of(&self, load: &Load, radius: f64) -> (f64, Mode) {
        let area = PI * radius * radius;
        let tension = -load.normal / area;
        // Of the twist at the rim: M a/J with J = π a⁴/2.
        let shear = load.shear / area + 2.0 * load.torsion / (area * radius);
        let uses = [tension / self.tension, shear / self.shear];
        if uses[0] >= uses[1] { (uses[0], Mode::Tension) } else { (uses[1], Mode::Shear) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bond_breaks_by_the_stress_that_reaches_its_strength_first() {
        let strength = Strength { tension: 2e6, shear: 3e6 };
        let a: f64 = 1e-5;
        let area = PI * a * a;
        let load = |normal: f64, shear: f64, torsion: f64| Load { normal, shear, torsion };
        let close = |(x, mode): (f64, Mode), y: f64, other: Mode| {
            assert!((x - y).abs() < 1e-12 && mode == other, "{x} {mode:?}");
        };
        close(strength.use_of(&load(-2e6 * area, 0.0, 0.0), a), 1.0, Mode::Tension);
        close(strength.use_of(&load(5.0, 3e6 * area, 0.0), a), 1.0, Mode::Shear);
        // Torsion: τ = M a / (π a⁴ / 2).
        let couple = 3e6 * 0.5 * area * a;
        close(strength.use_of(&load(0.0, 0.0, couple), a), 1.0, Mode::Shear);
        let unbreakable = Strength { tension: f64::INFINITY, shear: f64::INFINITY };
        close(unbreakable.use_of(&load(-1.0, 1.0, 1.0), a), 0.0, Mode::Tension);
    }
}

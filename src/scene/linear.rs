//! Linear contacts of discs and the bonds between cohesive ones (B 2.1.2).

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// Contacts whose normal force is proportional to the overlap (8-10), in the plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Linear {
    /// k_n \[N/m\], above 0.
    pub stiffness: f64,
    /// κ = k_s/k_n (10), above 0; without it that of the grains' Poisson's ratio by (6).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_ratio: Option<f64>,
    /// Bonds between the grains that touch when the run begins; without it nothing sticks together.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bond: Option<LinearBond>,
}

/// Bonds of cohesive grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LinearBond {
    /// c_μ \[Pa\], above 0, `.inf` for bonds that never break.
    pub cohesion: f64,
    /// F_t = c_μ r̄² or c_μ r_i r_j.
    #[serde(default)]
    pub form: BondForm,
    /// Whether a bond breaks when its tension exceeds F_t (12), beside breaking by shear (11).
    #[serde(default = "default_tension")]
    pub tension: bool,
    /// Strength where the contact's normal is along x, as a share of that along y; above 0 (B 4.4.4).
    #[serde(default = "default_along_x")]
    pub along_x: f64,
}

/// Which radii the strength of a bond goes with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BondForm {
    /// r̄² with r̄ = 2 r_i r_j/(r_i + r_j).
    #[default]
    Mean,
    /// r_i r_j.
    Product,
}

fn default_tension() -> bool {
    true
}

fn default_along_x() -> f64 {
    1.0
}

impl Linear {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.positive(at.key("stiffness"), self.stiffness, "stiffness > 0 N/m");
        if let Some(ratio) = self.shear_ratio {
            problems.positive(at.key("shear_ratio"), ratio, "shear_ratio > 0");
        }
        if let Some(bond) = &self.bond {
            let at = at.key("bond");
            if bond.cohesion.is_nan() || bond.cohesion <= 0.0 {
                let text = format!("{:?} is outside cohesion > 0 Pa, .inf included", bond.cohesion);
                problems.add(at.key("cohesion"), text);
            }
            problems.positive(at.key("along_x"), bond.along_x, "along_x > 0");
        }
    }
}

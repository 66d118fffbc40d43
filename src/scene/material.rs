//! Grain materials, and the three of T table 2.1 that a scene may use without defining them.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer, Serialize};

use super::check::{Field, Problems};

/// A grain material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Mean Young's modulus E \[Pa\], above 0.
    pub young: f64,
    /// Mean Poisson's ratio ν, -1 < ν < 0.5.
    pub poisson: f64,
    /// Density ρ \[kg/m³\], above 0.
    pub density: f64,
    /// Relative standard deviation of E and ν from grain to grain, 0 to 0.3.
    #[serde(default)]
    pub spread: f64,
}

impl Material {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.positive(at.key("young"), self.young, "young > 0 Pa");
        problems
            .number(at.key("poisson"), self.poisson, "-1 < nu < 0.5", |nu| -1.0 < nu && nu < 0.5);
        problems.positive(at.key("density"), self.density, "density > 0 kg/m³");
        problems.number(at.key("spread"), self.spread, "0 <= spread <= 0.3", |spread| {
            (0.0..=0.3).contains(&spread)
        });
        // Draws are kept within these limits, so the mean must lie between them.
        if self.spread > 0.0 && (-1.0..0.5).contains(&self.poisson) {
            problems.number(
                at.key("poisson"),
                self.poisson,
                "-0.99 < nu < 0.495, the range of a material with a spread",
                |nu| -0.99 < nu && nu < 0.495,
            );
        }
    }
}

/// Quartz sand, glass beads and methane hydrate of T table 2.1.
pub(super) fn builtin() -> BTreeMap<String, Material> {
    let quartz = Material { young: 100.0e9, poisson: 0.15, density: 2650.0, spread: 0.1 };
    let glass = Material { young: 70.0e9, poisson: 0.2, density: 2420.0, spread: 0.1 };
    let hydrate = Material { young: 6.6e9, poisson: 0.32, density: 900.0, spread: 0.0 };
    BTreeMap::from([
        ("quartz".into(), quartz),
        ("glass".into(), glass),
        ("hydrate".into(), hydrate),
    ])
}

pub(super) fn with_builtin<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<BTreeMap<String, Material>, D::Error> {
    let mut materials = builtin();
    materials.extend(BTreeMap::<String, Material>::deserialize(from)?);
    Ok(materials)
}

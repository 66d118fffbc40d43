//! Gas hydrate in the pores of a pack (T 5.2.1).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Material;
use super::check::{Field, Problems};
use super::pack::known;

/// The smallest grains are hydrate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Hydrate {
    /// Volume of hydrate over the pore volume, in which it counts, above 0 and below 1.
    pub saturation: f64,
    /// Name of its material.
    #[serde(default = "default_material")]
    pub material: String,
}

fn default_material() -> String {
    "hydrate".into()
}

impl Hydrate {
    pub(super) fn check(
        &self,
        at: &Field,
        materials: &BTreeMap<String, Material>,
        problems: &mut Problems,
    ) {
        problems.number(at.key("saturation"), self.saturation, "0 < saturation < 1", |part| {
            0.0 < part && part < 1.0
        });
        known(&at.key("material"), &self.material, materials, problems);
    }
}

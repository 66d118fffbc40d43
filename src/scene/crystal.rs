//! A crystal of grains of one size.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Material;
use super::check::{Field, Problems};
use super::pack::known;

/// Most rows, and most grains of a row.
const MOST: u64 = 10_000;

/// One layer of grains that touch, in horizontal rows; each row lies in the gaps of the one below
/// (B chapter 5). The box touches the outer ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Crystal {
    /// Number of rows along y, at least 1.
    pub rows: usize,
    /// Grains along x of the first row and of the second, which take turns; at least 1, and equal or
    /// one apart. Rows of equal length are shifted by a radius, to x_min the first.
    pub columns: [usize; 2],
    /// Radius \[m\], above 0.
    pub radius: f64,
    /// Name of a material.
    pub material: String,
}

impl Crystal {
    pub(super) fn check(
        &self,
        at: &Field,
        materials: &BTreeMap<String, Material>,
        problems: &mut Problems,
    ) {
        problems.count(at.key("rows"), self.rows as u64, 1, MOST);
        let [first, second] = self.columns;
        for (index, &columns) in self.columns.iter().enumerate() {
            problems.count(at.key("columns").index(index), columns as u64, 1, MOST);
        }
        if first.abs_diff(second) > 1 {
            let text = format!(
                "{first} and {second} grains do not lie in each other's gaps; allowed: as many, or \
                 one more or less"
            );
            problems.add(at.key("columns"), text);
        }
        problems.positive(at.key("radius"), self.radius, "radius > 0 m");
        known(&at.key("material"), &self.material, materials, problems);
    }
}

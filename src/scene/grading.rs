//! Gradings of sand by mean size and ratio of sizes (B appendix 4).

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// Mean and width of a grading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grading {
    /// Mean of the radii r̄ over the number of grains \[m\], above 0.
    pub mean: f64,
    /// M = r_max/r_min (A.5), 1 to 100.
    pub ratio: f64,
}

impl Grading {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        problems.positive(at.key("mean"), self.mean, "mean > 0 m");
        let ratios = 1.0..=100.0;
        problems.number(at.key("ratio"), self.ratio, "1 <= ratio <= 100", |m| ratios.contains(&m));
    }
}

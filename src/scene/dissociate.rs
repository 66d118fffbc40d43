//! The step of a load path by which hydrate dissociates.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// Biot-Willis coefficient of sands when nothing else is said (T 5.3).
pub const BIOT: f64 = 0.8;

/// See [`Step::Dissociate`](super::Step::Dissociate). What is not given stays what it was.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Dissociate {
    /// Hydrate saturation that is lost at the step's end since the start of the run (ΔS), a part of
    /// the pore volume: from 0 to the saturation of the pack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub saturation_loss: Option<f64>,
    /// Excess pore pressure at the step's end \[Pa\], at least 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pore_pressure: Option<f64>,
    /// Biot-Willis coefficient α_b, 0 to 1.
    #[serde(default = "default_biot")]
    pub biot: f64,
    /// Equal parts, at least 1.
    #[serde(default = "default_increments")]
    pub increments: u32,
}

fn default_biot() -> f64 {
    BIOT
}

fn default_increments() -> u32 {
    1
}

impl Dissociate {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let Self { saturation_loss, pore_pressure, biot, .. } = *self;
        if saturation_loss.is_none() && pore_pressure.is_none() {
            problems.add(
                at.clone(),
                "needs saturation_loss or pore_pressure; allowed: one of the two, or both",
            );
        }
        if let Some(loss) = saturation_loss {
            let inside = |loss| (0.0..1.0).contains(&loss);
            problems.number(at.key("saturation_loss"), loss, "0 <= saturation_loss < 1", inside);
        }
        if let Some(pressure) = pore_pressure {
            let inside = |pressure| pressure >= 0.0;
            problems.number(at.key("pore_pressure"), pressure, "pore_pressure >= 0 Pa", inside);
        }
        let inside = |biot| (0.0..=1.0).contains(&biot);
        problems.number(at.key("biot"), biot, "0 <= biot <= 1", inside);
    }
}

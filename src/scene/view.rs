//! The pictures for viewers.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use super::choice::Choice;
use super::outputs::{Outputs, When};

/// Largest scale; the smallest is above zero.
pub const VIEW_SCALE: f64 = 1e12;

/// What spheres are coloured by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColorBy {
    /// The mean pressure in the grain \[Pa\].
    #[default]
    Force,
    /// How far the grain went since the start \[m\].
    Displacement,
    /// How far it went in the increment beside what the box took along \[m\].
    NonAffine,
    /// D²min of its neighbourhood in the increment \[m²\].
    D2min,
    /// Its rotation in the increment \[rad\].
    Rotation,
}

impl ColorBy {
    /// Whether it is of the [motion](crate::report::GrainMotion) of the grains in the increment.
    #[must_use]
    pub fn is_of_motion(self) -> bool {
        match self {
            Self::Force | Self::Displacement => false,
            Self::NonAffine | Self::D2min | Self::Rotation => true,
        }
    }
}

/// How pictures are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct View {
    /// Size of the picture over that of the specimen, viewers being made for robots. `auto`: the
    /// power of ten that brings the largest side of the box nearest to 1 m.
    pub scale: Choice<f64>,
    /// What spheres are coloured by.
    pub color: ColorBy,
    /// Values of the first and of the last colour, in the unit of what is shown. `auto`: from 0 to three times the
    /// mean of the grains, at each increment anew.
    pub range: Choice<[f64; 2]>,
    /// Opacity of the spheres, above 0: those that are not opaque let force chains be seen.
    pub opacity: f64,
    /// Pictures are recorded at every increment that is a multiple of this. `auto`: at the first
    /// ten increments, of small packs at more (30 000 over the number of grains), then at each
    /// tenth; they are as large as half a contact network.
    pub every: Choice<u64>,
}

impl Default for View {
    fn default() -> Self {
        Self {
            scale: Choice::Auto,
            color: ColorBy::Force,
            range: Choice::Auto,
            opacity: 0.4,
            every: Choice::Auto,
        }
    }
}

impl View {
    pub(super) fn check(&self, at: &Field, outputs: &Outputs, problems: &mut Problems) {
        if self.color.is_of_motion() && outputs.grain_motion == When::Never {
            let text = "shows the motion of the grains; allowed with outputs.grain_motion: on_demand or always";
            problems.add(at.key("color"), text);
        }
        if let Choice::Given(scale) = self.scale {
            problems.number(at.key("scale"), scale, "0 < scale <= 1e12, or auto", |scale| {
                scale > 0.0 && scale <= VIEW_SCALE
            });
        }
        if let Choice::Given([low, high]) = self.range {
            let field = at.key("range");
            problems.finite(&field, &[low, high]);
            if low >= high {
                problems.add(field.index(1), format!("{high:?} is outside high > low = {low:?}"));
            }
        }
        problems.number(at.key("opacity"), self.opacity, "0 < opacity <= 1", |opacity| {
            opacity > 0.0 && opacity <= 1.0
        });
        if let Choice::Given(every) = self.every {
            problems.count(at.key("every"), every, 1, 1_000_000_000);
        }
    }
}

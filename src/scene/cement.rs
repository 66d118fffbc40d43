//! Cemented contacts.

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};

/// Cement between grains that are close when the run begins, and between them and the walls
/// (T chapter 4). It carries tension, shear and torsion and does not slide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cement {
    /// Law of a cemented contact.
    pub law: CementLaw,
    /// κ: radius of the cement over that of the contact of the grains (T 4.4), at least 0. The
    /// parallel bond has no use for it.
    #[serde(default = "default_kappa")]
    pub kappa: f64,
    /// C_s: stiffness in shear over that without slip (T 4.6), 0 to 1. The parallel bond has no use
    /// for it.
    #[serde(default = "default_partial_slip")]
    pub partial_slip: f64,
    /// Widest gap that cement bridges, over the sum of the radii (T 4.5), 0 to 1.
    #[serde(default = "default_bridge")]
    pub bridge: f64,
    /// Whether grains are cemented to the walls.
    #[serde(default = "default_walls")]
    pub walls: bool,
    /// How the balance of an increment is found.
    #[serde(default)]
    pub solution: Solution,
    /// Stresses at which a bond breaks; left out, none does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strength: Option<CementStrength>,
}

fn default_kappa() -> f64 {
    0.01
}

fn default_partial_slip() -> f64 {
    0.1
}

fn default_bridge() -> f64 {
    0.1
}

fn default_walls() -> bool {
    true
}

/// How the balance of cemented contacts is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Solution {
    /// In the geometry at the end of the increment, to the tolerance.
    #[default]
    Nonlinear,
    /// By two linear steps (T A.2.2): with directions and stiffnesses of the start, then with those
    /// of where that led. For the effective laws.
    TwoStep,
}

/// Law of a cemented contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CementLaw {
    /// Effective stiffness that stays what it was at the deposition.
    Fixed,
    /// Hertz' contact of the grains and cement of constant radius (T 4.10). It bridges no gap.
    LinearElastic,
    /// Effective radius that grows exponentially with the strain of the contact (T 4.11-4.12).
    Exponential(Exponential),
    /// Effective radius that grows with a power of the strain of the contact (T 4.13).
    Power(Power),
    /// An elastic cylinder beside the frictionless contact of the grains (T 4.7).
    Parallel(Parallel),
}

/// See [`CementLaw::Exponential`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Exponential {
    /// γ, at least 0.
    pub gamma: f64,
}

/// See [`CementLaw::Power`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Power {
    /// η, at least 0.
    pub eta: f64,
    /// ω, at least 0.
    pub omega: f64,
}

/// See [`CementLaw::Parallel`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parallel {
    /// Young's modulus Ē of the cement \[Pa\].
    pub young: f64,
    /// Shear modulus Ḡ of the cement \[Pa\].
    pub shear: f64,
    /// λ^R: radius of the cylinder over the effective radius R* of the pair.
    pub radius_ratio: f64,
    /// λ^L: length of the cylinder over the effective radius R* of the pair.
    pub length_ratio: f64,
}

/// Stresses at which a bond breaks \[Pa\], above 0, `.inf` for never.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CementStrength {
    /// Tensile stress.
    pub tension: f64,
    /// Shear stress.
    pub shear: f64,
}

impl Cement {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let least = |x: f64| x >= 0.0;
        problems.number(at.key("kappa"), self.kappa, "kappa >= 0", least);
        let share = |x: f64| (0.0..=1.0).contains(&x);
        problems.number(at.key("partial_slip"), self.partial_slip, "0 <= partial_slip <= 1", share);
        problems.number(at.key("bridge"), self.bridge, "0 <= bridge <= 1", share);
        let law = at.key("law");
        match self.law {
            CementLaw::Fixed | CementLaw::LinearElastic => {}
            CementLaw::Exponential(Exponential { gamma }) => {
                problems.number(law.key("exponential").key("gamma"), gamma, "gamma >= 0", least);
            }
            CementLaw::Power(Power { eta, omega }) => {
                let law = law.key("power");
                problems.number(law.key("eta"), eta, "eta >= 0", least);
                problems.number(law.key("omega"), omega, "omega >= 0", least);
            }
            CementLaw::Parallel(Parallel { young, shear, radius_ratio, length_ratio }) => {
                let law = law.key("parallel");
                problems.positive(law.key("young"), young, "young > 0 Pa");
                problems.positive(law.key("shear"), shear, "shear > 0 Pa");
                problems.positive(law.key("radius_ratio"), radius_ratio, "radius_ratio > 0");
                problems.positive(law.key("length_ratio"), length_ratio, "length_ratio > 0");
                if self.solution == Solution::TwoStep {
                    let text = "two_step is for the effective laws, not for parallel bonds; \
                                allowed: nonlinear";
                    problems.add(at.key("solution"), text);
                }
            }
        }
        if let Some(strength) = &self.strength {
            let at = at.key("strength");
            for (key, value) in [("tension", strength.tension), ("shear", strength.shear)] {
                if value.is_nan() || value <= 0.0 {
                    let text = format!("{value:?} is outside {key} > 0 Pa, .inf included");
                    problems.add(at.key(key), text);
                }
            }
        }
    }
}

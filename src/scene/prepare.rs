//! Steps that prepare a pack before the run: confined without friction, then loaded with friction
//! until the contacts slide as they do in a real specimen (T 3.6.2, HZ-17).

mod rescale;

use serde::{Deserialize, Serialize};

pub use rescale::Rescale;

use super::check::{Field, Problems};
use super::{Axis, Contact, Friction, Moving};

/// Strain at which the walls would be closer than a run allows.
const STRAIN_LIMIT: f64 = 0.5;

/// Checks the steps at `at` of a scene with the contacts `contact`.
pub(super) fn check(steps: &[Step], at: &Field, contact: &Contact, problems: &mut Problems) {
    for (index, step) in steps.iter().enumerate() {
        let at = at.index(index);
        match step {
            Step::Isotropic(step) => problems.positive(
                at.key("isotropic").key("confining_stress"),
                step.confining_stress,
                "confining_stress > 0 Pa",
            ),
            Step::Uniaxial(step) => step.check(&at.key("uniaxial"), contact, problems),
            Step::Rescale(step) => step.check(&at.key("rescale"), problems),
        }
    }
}

/// One step of a preparation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// The pack is brought to an isotropic stress, without friction and without gravity, as a pack
    /// that is made (T 2.7.2). Its contact history ends here.
    Isotropic(Isotropic),
    /// The walls of one axis move in, the others stay, with the scene's friction and gravity.
    Uniaxial(Uniaxial),
    /// All lengths or all forces are multiplied; nothing is relaxed.
    Rescale(Rescale),
}

/// Frictionless relaxation to an isotropic stress.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {
    /// Stress on all walls \[Pa\], above 0; it may lie below that of the pack.
    pub confining_stress: f64,
}

/// Strain along one axis in small increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Keys", into = "Keys")]
pub struct Uniaxial {
    /// Axis along which the walls move.
    pub axis: Axis,
    /// Which of its two walls moves.
    pub moving: Moving,
    /// Largest strain of an increment, of the box at the step's start, above 0 and at most 0.01.
    pub strain_increment: f64,
    /// When the step ends.
    pub end: End,
}

/// When a uniaxial step ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// At this strain of the box at the step's start, compression positive, not 0.
    Strain(f64),
    /// When the ratio of sliding contacts is steady.
    Steady(Steady),
}

/// When the ratio of sliding contacts counts as steady.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// The ratio is above 0 and changed by less than this over the last `window` increments.
    pub steady: f64,
    /// Increments over which it is compared, at least 1.
    pub window: u32,
    /// Strain at which the preparation fails when the ratio is not steady yet.
    pub max_strain: f64,
}

impl Default for Steady {
    fn default() -> Self {
        Self { steady: 0.005, window: 10, max_strain: 0.02 }
    }
}

impl Uniaxial {
    fn check(&self, at: &Field, contact: &Contact, problems: &mut Problems) {
        let increment = self.strain_increment;
        let field = at.key("strain_increment");
        let allowed = "1e-7 <= strain_increment <= 1e-2";
        problems.number(field, increment, allowed, |increment| (1e-7..=1e-2).contains(&increment));
        match self.end {
            End::Strain(strain) => {
                problems.number(at.key("strain"), strain, "-0.5 < strain < 0.5, not 0", |strain| {
                    strain != 0.0 && strain.abs() < STRAIN_LIMIT
                });
            }
            End::Steady(_) if contact.friction == Friction::None => problems.add(
                at.clone(),
                "without friction no contact slides; allowed: `contact.friction`, or `strain` to \
                 end the step",
            ),
            End::Steady(end) => end.check(at, increment, problems),
        }
    }
}

impl Steady {
    fn check(&self, at: &Field, increment: f64, problems: &mut Problems) {
        let allowed = "0 < steady <= 1";
        problems
            .number(at.key("steady"), self.steady, allowed, |change| 0.0 < change && change <= 1.0);
        problems.count(at.key("window"), u64::from(self.window), 1, 10_000);
        let least = f64::from(self.window) * increment;
        let allowed = format!("{least:?} <= max_strain < 0.5, where `window` increments have room");
        problems.number(at.key("max_strain"), self.max_strain, &allowed, |strain| {
            least <= strain && strain < STRAIN_LIMIT
        });
    }
}

/// [`Uniaxial`] as the file has it.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename = "uniaxial")]
struct Keys {
    #[serde(default)]
    axis: Axis,
    #[serde(default)]
    moving: Moving,
    #[serde(default = "default_strain_increment")]
    strain_increment: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    strain: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    steady: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    window: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    max_strain: Option<f64>,
}

fn default_strain_increment() -> f64 {
    1.0e-4
}

impl TryFrom<Keys> for Uniaxial {
    type Error = &'static str;

    fn try_from(keys: Keys) -> Result<Self, Self::Error> {
        let Keys { axis, moving, strain_increment, strain, steady, window, max_strain } = keys;
        let end = match (strain, steady, window, max_strain) {
            (Some(strain), None, None, None) => End::Strain(strain),
            (Some(_), ..) => {
                return Err(
                    "`strain` alone ends the step; allowed: `strain`, or some of `steady`, \
                            `window` and `max_strain`",
                );
            }
            (None, steady, window, max_strain) => {
                let default = Steady::default();
                End::Steady(Steady {
                    steady: steady.unwrap_or(default.steady),
                    window: window.unwrap_or(default.window),
                    max_strain: max_strain.unwrap_or(default.max_strain),
                })
            }
        };
        Ok(Self { axis, moving, strain_increment, end })
    }
}

impl From<Uniaxial> for Keys {
    fn from(step: Uniaxial) -> Self {
        let Uniaxial { axis, moving, strain_increment, end } = step;
        let (strain, steady) = match end {
            End::Strain(strain) => (Some(strain), None),
            End::Steady(steady) => (None, Some(steady)),
        };
        Self {
            axis,
            moving,
            strain_increment,
            strain,
            steady: steady.map(|end| end.steady),
            window: steady.map(|end| end.window),
            max_strain: steady.map(|end| end.max_strain),
        }
    }
}

//! Load paths: what moves the walls when no rig does.

use std::fmt;
use std::path::PathBuf;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::check::{Field, Problems};
use super::{Dissociate, RigLog, ShearStep, Targets};

/// Most commands that a load path may have, files included.
pub const MAX_COMMANDS: u64 = 1_000_000;

/// What moves the walls: a list of steps, or one step alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct LoadPath(pub Vec<Step>);

impl LoadPath {
    /// `paired` as in [`Targets`].
    pub(super) fn check(&self, at: &Field, paired: bool, problems: &mut Problems) {
        let before = problems.0.len();
        check_steps(&self.0, at, paired, problems);
        if problems.0.len() == before && commands(&self.0) > MAX_COMMANDS {
            problems.add(
                at.clone(),
                format!("more than {MAX_COMMANDS} increments in all; allowed: fewer"),
            );
        }
    }
}

fn check_steps(steps: &[Step], at: &Field, paired: bool, problems: &mut Problems) {
    for (index, step) in steps.iter().enumerate() {
        step.check(&at.index(index), paired, problems);
    }
}

/// Increments of `steps`, without those that files hold; saturates.
fn commands(steps: &[Step]) -> u64 {
    let one = |step: &Step| match step {
        Step::Isotropic(step) => u64::from(step.increments),
        Step::Uniaxial(step) => u64::from(step.increments),
        Step::Triaxial(step) => u64::from(step.increments),
        Step::Polyaxial(step) => u64::from(step.increments),
        Step::Unload(step) => u64::from(step.increments),
        Step::Walls(step) => u64::from(step.increments),
        Step::Dissociate(step) => u64::from(step.increments),
        Step::Shear(step) => u64::from(step.increments),
        Step::Repeat(step) => u64::from(step.times).saturating_mul(commands(&step.steps)),
        Step::Commands(_) | Step::RigLog(_) => 0,
    };
    steps.iter().map(one).fold(0, u64::saturating_add)
}

impl<'de> Deserialize<'de> for LoadPath {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Steps)
    }
}

struct Steps;

impl<'de> Visitor<'de> for Steps {
    type Value = LoadPath;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a list of steps, or one step such as `uniaxial: {...}`")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, steps: A) -> Result<LoadPath, A::Error> {
        Vec::deserialize(SeqAccessDeserializer::new(steps)).map(LoadPath)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<LoadPath, A::Error> {
        let step = Step::deserialize(MapAccessDeserializer::new(&mut map))?;
        if map.next_key::<IgnoredAny>()?.is_some() {
            return Err(A::Error::custom(
                "more than one step; allowed: a list with one `- step: {...}` an entry",
            ));
        }
        Ok(LoadPath(vec![step]))
    }
}

/// One step of a load path. Strains are of the box at the step's start, compression positive.
/// Stresses go in equal parts from what they are at the step's start; walls that a step gives
/// neither strain nor stress stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// The same strain or stress along all axes; a negative strain expands.
    Isotropic(Isotropic),
    /// Strain or stress along one axis, the other walls fixed: an oedometer.
    Uniaxial(Uniaxial),
    /// Axial strain or stress and two equal lateral strains or stresses.
    Triaxial(Triaxial),
    /// Three strains or three stresses.
    Polyaxial(Polyaxial),
    /// Back towards the walls' positions at the start of the run.
    Unload(Unload),
    /// A target of each wall.
    Walls(WallsStep),
    /// Hydrate dissociates and the pore pressure changes.
    Dissociate(Dissociate),
    /// A box of discs is tilted.
    Shear(ShearStep),
    /// Steps several times over.
    Repeat(Repeat),
    /// A command CSV, relative to the scene file.
    Commands(PathBuf),
    /// A rig's measured strain history.
    RigLog(RigLog),
}

impl Step {
    fn check(&self, at: &Field, paired: bool, problems: &mut Problems) {
        match self {
            Self::Isotropic(step) => {
                let at = at.key("isotropic");
                check_one(&at, ["strain", "stress"], [step.strain, step.stress], problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Uniaxial(step) => {
                let at = at.key("uniaxial");
                check_one(&at, ["strain", "stress"], [step.strain, step.stress], problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Triaxial(step) => {
                let at = at.key("triaxial");
                let axial = [step.axial_strain, step.axial_stress];
                check_one(&at, ["axial_strain", "axial_stress"], axial, problems);
                let lateral = [step.lateral_strain, step.lateral_stress];
                check_one(&at, ["lateral_strain", "lateral_stress"], lateral, problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Polyaxial(step) => {
                let at = at.key("polyaxial");
                if step.strain.is_some() == step.stress.is_some() {
                    problems.add(at.clone(), one_of(["strain", "stress"]));
                }
                for (axis, &strain) in step.strain.iter().flatten().enumerate() {
                    check_strain(at.key("strain").index(axis), strain, problems);
                }
                for (axis, &stress) in step.stress.iter().flatten().enumerate() {
                    problems.positive(at.key("stress").index(axis), stress, "stress > 0 Pa");
                }
                check_increments(&at, step.increments, problems);
            }
            Self::Unload(step) => {
                let at = at.key("unload");
                problems
                    .number(at.key("to"), step.to, "0 <= to < 1", |to| (0.0..1.0).contains(&to));
                check_increments(&at, step.increments, problems);
            }
            Self::Walls(step) => {
                let at = at.key("walls");
                step.targets.check(&at.key("targets"), paired, problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Dissociate(step) => {
                let at = at.key("dissociate");
                step.check(&at, problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Shear(step) => {
                let at = at.key("shear");
                step.check(&at, problems);
                check_increments(&at, step.increments, problems);
            }
            Self::Repeat(step) => {
                let at = at.key("repeat");
                problems.count(at.key("times"), u64::from(step.times), 1, MAX_COMMANDS);
                check_steps(&step.steps, &at.key("steps"), paired, problems);
            }
            Self::Commands(_) => {}
            Self::RigLog(step) => step.check(&at.key("rig_log"), problems),
        }
    }
}

/// One of a strain and a stress.
fn check_one(at: &Field, names: [&str; 2], values: [Option<f64>; 2], problems: &mut Problems) {
    match values {
        [Some(strain), None] => check_strain(at.key(names[0]), strain, problems),
        [None, Some(stress)] => problems.positive(at.key(names[1]), stress, "stress > 0 Pa"),
        _ => problems.add(at.clone(), one_of(names)),
    }
}

fn one_of([one, other]: [&str; 2]) -> String {
    format!("needs {one} or {other}; allowed: one of the two")
}

/// At a strain of 1 the walls of a pair meet.
fn check_strain(field: Field, strain: f64, problems: &mut Problems) {
    problems.number(field, strain, "-1 < strain < 1", |strain| strain.abs() < 1.0);
}

fn check_increments(at: &Field, increments: u32, problems: &mut Problems) {
    problems.count(at.key("increments"), u64::from(increments), 1, MAX_COMMANDS);
}

/// Which walls of a pair move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Moving {
    /// Both by half.
    #[default]
    Both,
    /// Only the `_min` walls.
    Min,
    /// Only the `_max` walls.
    Max,
}

impl Moving {
    /// Shares of a strain that the `_min` and the `_max` wall take.
    #[must_use]
    pub const fn shares(self) -> [f64; 2] {
        match self {
            Self::Both => [0.5, 0.5],
            Self::Min => [1.0, 0.0],
            Self::Max => [0.0, 1.0],
        }
    }
}

/// Coordinate axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// x
    X,
    /// y
    Y,
    /// z
    #[default]
    Z,
}

impl Axis {
    /// 0, 1 or 2.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// See [`Step::Isotropic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {
    /// Strain of each axis over the step, between -1 and 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<f64>,
    /// Stress of each axis at the step's end, above 0 \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<f64>,
    /// Equal parts, at least 1.
    pub increments: u32,
    /// Walls that move, or that carry the stress.
    #[serde(default)]
    pub moving: Moving,
}

/// See [`Step::Uniaxial`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Uniaxial {
    /// Axis.
    #[serde(default)]
    pub axis: Axis,
    /// Strain over the step, between -1 and 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<f64>,
    /// Stress at the step's end, above 0 \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<f64>,
    /// Equal parts, at least 1.
    pub increments: u32,
    /// Walls that move, or that carry the stress.
    #[serde(default)]
    pub moving: Moving,
}

/// See [`Step::Triaxial`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Triaxial {
    /// Axis of the axial strain.
    #[serde(default)]
    pub axis: Axis,
    /// Axial strain over the step, between -1 and 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axial_strain: Option<f64>,
    /// Axial stress at the step's end, above 0 \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axial_stress: Option<f64>,
    /// Strain of the other two axes; T's uniaxial stress is -0.25 of the axial one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral_strain: Option<f64>,
    /// Stress of the other two axes at the step's end, above 0 \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lateral_stress: Option<f64>,
    /// Equal parts, at least 1.
    pub increments: u32,
    /// Walls that move, or that carry the stress.
    #[serde(default)]
    pub moving: Moving,
}

/// See [`Step::Polyaxial`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polyaxial {
    /// Strains of x, y, z over the step, between -1 and 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub strain: Option<[f64; 3]>,
    /// Stresses of x, y, z at the step's end, above 0 \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress: Option<[f64; 3]>,
    /// Equal parts, at least 1.
    pub increments: u32,
    /// Walls that move, or that carry the stress.
    #[serde(default)]
    pub moving: Moving,
}

/// See [`Step::Unload`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Unload {
    /// Share of the walls' displacement that remains: 0 is all the way back.
    #[serde(default)]
    pub to: f64,
    /// Equal parts, at least 1.
    pub increments: u32,
}

/// See [`Step::Walls`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WallsStep {
    /// What each wall does at the step's end; one that is not named does what it did.
    pub targets: Targets,
    /// Equal parts, at least 1.
    pub increments: u32,
}

/// See [`Step::Repeat`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How often, at least once.
    pub times: u32,
    /// What.
    pub steps: Vec<Step>,
}

//! The scene file: everything that a run depends on, with a default for every key but `pack`.
//!
//! The types here are what serde reads; `load` resolves files and validates the whole.
//! Lengths are in m, moduli and stresses in Pa.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::wall::Bounds;

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name shown in summaries and recordings.
    #[serde(default = "default_name")]
    pub name: String,
    /// 3 for spheres.
    #[serde(default = "default_dimension")]
    pub dimension: u8,
    /// Materials by name; `quartz`, `glass` and `hydrate` of T table 2.1 need no definition.
    #[serde(default)]
    pub materials: BTreeMap<String, Material>,
    /// Walls.
    #[serde(default)]
    pub walls: Walls,
    /// Grains: made or read.
    pub pack: PackSource,
    /// Contact laws.
    #[serde(default)]
    pub contact: Contact,
    /// Gravitational acceleration \[m/s²\].
    #[serde(default)]
    pub gravity: [f64; 3],
    /// Box that engineering strain refers to; without it the box at the start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<Bounds>,
    /// Relaxation.
    #[serde(default)]
    pub solver: Solver,
    /// What moves the walls when no rig does.
    #[serde(default)]
    pub load_path: LoadPath,
    /// What is computed when.
    #[serde(default)]
    pub outputs: Outputs,
    /// The ROS 2 node.
    #[serde(default)]
    pub node: Node,
    /// The recorder.
    #[serde(default)]
    pub record: Record,
}

fn default_name() -> String {
    "unnamed".into()
}

fn default_dimension() -> u8 {
    3
}

/// A grain material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Relative standard deviation of E and ν from grain to grain.
    #[serde(default)]
    pub spread: f64,
}

/// The elastic walls; T 2.7.1 takes 100 times the grains' modulus.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Walls {
    /// Young's modulus \[Pa\].
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Coefficient of friction between grains and walls.
    pub friction: f64,
}

impl Default for Walls {
    fn default() -> Self {
        Self { young: 7.0e12, poisson: 0.495, friction: 0.3 }
    }
}

/// Where the grains come from; exactly one of `generate` and `file`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackSource {
    /// Make the pack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generate: Option<Generate>,
    /// Read it from this CSV, relative to the scene file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<PathBuf>,
    /// Box of a pack that is read; without it the JSON beside the CSV gives it.
    #[serde(rename = "box", default, skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Material of all grains of a file that has neither a `material` nor property columns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Keep only the grains that lie wholly inside this box, which becomes the pack's (HZ-15).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cut: Option<Bounds>,
    /// Seed of the per-grain spread of a material given to a pack that is read.
    #[serde(default)]
    pub seed: u64,
}

/// A pack made from a seed (T 2.7.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generate {
    /// Number of grains.
    pub grains: usize,
    /// Radii \[m\].
    pub radius: Radius,
    /// Name of a material.
    pub material: String,
    /// Seed of radii, properties and positions.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Isotropic stress to compact to \[Pa\].
    pub confining_stress: f64,
    /// Proportions of the box.
    #[serde(default = "default_aspect")]
    pub aspect: [f64; 3],
    /// Rounds in which grains with fewer than 4 contacts are expanded until they have 4 (T 2.7.2).
    #[serde(default)]
    pub expand_floaters: u32,
}

fn default_seed() -> u64 {
    1
}

fn default_aspect() -> [f64; 3] {
    [1.0; 3]
}

/// Distribution of the radii \[m\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Radius {
    /// Evenly between the two.
    Uniform([f64; 2]),
    /// All the same.
    Constant(f64),
}

/// Contact laws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Normal law.
    pub normal: Normal,
    /// Tangential law.
    pub friction: Friction,
    /// Torsional couple of frictional contacts.
    pub torsion: bool,
}

impl Default for Contact {
    fn default() -> Self {
        Self { normal: Normal::Hertz, friction: Friction::None, torsion: true }
    }
}

/// Normal contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normal {
    /// Hertz (T 2.2).
    Hertz,
}

/// Tangential contact law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Friction {
    /// Ideally smooth grains (T chapter 2).
    None,
}

/// Relaxation to equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Solver {
    /// Method.
    pub method: Method,
    /// Largest unbalanced force of a grain over the mean contact force.
    pub tolerance: f64,
    /// Largest strain between two equilibria; larger commands are sub-stepped.
    pub max_strain_increment: f64,
    /// Largest strain between two equilibria, as a share of the mean overlap strain h/(2R).
    pub max_overlap_share: f64,
    /// Newton steps before an increment is given up.
    pub max_iterations: u32,
}

impl Default for Solver {
    fn default() -> Self {
        Self {
            method: Method::Newton,
            tolerance: 1.0e-8,
            max_strain_increment: 1.0e-4,
            max_overlap_share: 0.1,
            max_iterations: 500,
        }
    }
}

/// Relaxation method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Newton steps, each solved by preconditioned conjugate gradients.
    Newton,
}

/// What moves the walls: a list of steps, or one step alone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct LoadPath(pub Vec<Step>);

/// One step of a load path. Strains are of the box at the step's start, compression positive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// The same strain along all axes; negative expands.
    Isotropic(Isotropic),
    /// Strain along one axis, the other walls fixed.
    Uniaxial(Uniaxial),
    /// Axial strain and two equal lateral ones.
    Triaxial(Triaxial),
    /// Three strains.
    Polyaxial(Polyaxial),
    /// Back towards the walls' positions at the start of the run.
    Unload(Unload),
    /// Steps several times over.
    Repeat(Repeat),
    /// A command CSV.
    Commands(PathBuf),
    /// A rig's measured strain history.
    RigLog(RigLog),
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

/// See [`Step::Isotropic`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Isotropic {
    /// Strain of each axis over the step.
    pub strain: f64,
    /// Equal parts.
    pub increments: u32,
    /// Walls that move.
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
    /// Strain over the step.
    pub strain: f64,
    /// Equal parts.
    pub increments: u32,
    /// Walls that move.
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
    /// Axial strain over the step.
    pub axial_strain: f64,
    /// Strain of the other two axes; T's uniaxial stress is -0.25 of the axial one.
    pub lateral_strain: f64,
    /// Equal parts.
    pub increments: u32,
    /// Walls that move.
    #[serde(default)]
    pub moving: Moving,
}

/// See [`Step::Polyaxial`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Polyaxial {
    /// Strains of x, y, z over the step.
    pub strain: [f64; 3],
    /// Equal parts.
    pub increments: u32,
    /// Walls that move.
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
    /// Equal parts.
    pub increments: u32,
}

/// See [`Step::Repeat`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Repeat {
    /// How often.
    pub times: u32,
    /// What.
    pub steps: Vec<Step>,
}

/// See [`Step::RigLog`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RigLog {
    /// CSV file, relative to the scene file.
    pub file: PathBuf,
    /// Column with the time \[s\].
    pub time: String,
    /// Column with the axial strain (compression positive).
    pub axial_strain: String,
    /// Unit of the axial strain.
    #[serde(default)]
    pub unit: StrainUnit,
    /// What the other two axes do.
    #[serde(default)]
    pub lateral: Lateral,
    /// Axis of the axial strain.
    #[serde(default)]
    pub axis: Axis,
}

/// Unit of a strain column.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrainUnit {
    /// A plain ratio.
    #[default]
    Ratio,
    /// Per cent.
    Percent,
    /// Millionths.
    Microstrain,
}

/// What the lateral walls do while the axial ones follow a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lateral {
    /// They keep the volume: undrained.
    #[default]
    ConstantVolume,
    /// They stay.
    Fixed,
    /// They recede until the lateral stress is that of the start: needs stress-controlled walls.
    Free,
}

/// When a measure is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// At every increment.
    Always,
    /// When somebody subscribed, records, or the summary shows it.
    #[default]
    OnDemand,
    /// Never.
    Never,
}

/// Which moduli.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModuliKind {
    /// Hooke fit of each interval (T 2.15).
    #[default]
    Secant,
    /// None.
    None,
}

/// What is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Outputs {
    /// Every contact.
    pub contact_network: When,
    /// Moduli.
    pub moduli: ModuliKind,
}

/// The ROS 2 node.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Node {
    /// How far discovery reaches.
    pub discovery: Discovery,
    /// DDS domain, at most 232; 0 = that of `ROS_DOMAIN_ID`, or 0 when it is not set.
    pub domain_id: u16,
    /// Commands older than this are refused \[s\]; 0 = never.
    pub stale_after: f64,
    /// A rig inside the program publishes the load path as commands through DDS.
    pub virtual_rig: bool,
}

impl Default for Node {
    fn default() -> Self {
        Self { discovery: Discovery::Localhost, domain_id: 0, stale_after: 0.0, virtual_rig: false }
    }
}

/// How far discovery reaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discovery {
    /// Loopback only.
    #[default]
    Localhost,
    /// Every interface.
    Subnet,
}

/// The recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Record {
    /// Size of an MCAP chunk before compression: bytes, or a number with `KiB`, `MiB`, `GiB`.
    #[serde(with = "byte_size")]
    pub chunk: u64,
    /// Compression of the chunks.
    pub compression: Compression,
}

impl Default for Record {
    fn default() -> Self {
        Self { chunk: 4 << 20, compression: Compression::Zstd }
    }
}

/// Compression of MCAP chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// Zstandard.
    #[default]
    Zstd,
    /// LZ4.
    Lz4,
    /// None.
    None,
}

/// `4 MiB` and its kin.
mod byte_size {
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Raw {
        Bytes(u64),
        Text(String),
    }

    pub(super) fn serialize<S: Serializer>(bytes: &u64, to: S) -> Result<S::Ok, S::Error> {
        for (unit, shift) in [("GiB", 30), ("MiB", 20), ("KiB", 10)] {
            if *bytes > 0 && bytes.is_multiple_of(1 << shift) {
                return to.serialize_str(&format!("{} {unit}", bytes >> shift));
            }
        }
        to.serialize_u64(*bytes)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<u64, D::Error> {
        let text = match Raw::deserialize(from)? {
            Raw::Bytes(bytes) => return Ok(bytes),
            Raw::Text(text) => text,
        };
        let number = text.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let shift = match &text[number.len()..] {
            "" | "B" => 0,
            "KiB" => 10,
            "MiB" => 20,
            "GiB" => 30,
            _ => return Err(D::Error::custom(format!("unit of `{text}`: B, KiB, MiB or GiB"))),
        };
        let count: u64 = number.trim().parse().map_err(|_| {
            D::Error::custom(format!("`{text}` is no size: a whole number and a unit, as in 4 MiB"))
        })?;
        count
            .checked_mul(1 << shift)
            .ok_or_else(|| D::Error::custom(format!("`{text}` is larger than can be addressed")))
    }
}

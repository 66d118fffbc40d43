//! The scene file: everything that a run depends on, with a default for every key but `pack`.
//!
//! [`load()`] reads the YAML, refuses unknown and duplicate keys, checks the whole and names file,
//! line and field of everything that is wrong. Relative files are meant from the scene file's
//! folder. Lengths are in m, moduli and stresses in Pa, compression is positive.

mod cement;
mod check;
mod choice;
mod contact;
mod crystal;
mod dimension;
mod dissociate;
mod error;
mod grading;
mod hydrate;
mod linear;
mod load;
mod load_path;
mod material;
mod measured_wrench;
mod node;
mod outputs;
mod pack;
pub mod prepare;
mod record;
mod rig_log;
mod shear;
mod solver;
mod surround;
mod syntax;
mod targets;
mod tree;
mod unavailable;
mod view;
mod walls;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::wall::Bounds;

pub use cement::{Cement, CementLaw, CementStrength, Exponential, Parallel, Power, Solution};
use check::{Field, Problems};
pub use choice::Choice;
pub use contact::{Contact, Coulomb, Friction, Law, Normal, Rotation, Update};
pub use crystal::Crystal;
pub use dissociate::{BIOT, Dissociate};
pub use error::{Problem, SceneError};
pub use grading::Grading;
pub use hydrate::Hydrate;
pub use linear::{BondForm, Linear, LinearBond};
pub use load::{Loaded, load, parse};
pub use load_path::{
    Axis, Isotropic, LoadPath, MAX_COMMANDS, Moving, Polyaxial, Repeat, Step, Triaxial, Uniaxial,
    Unload, WallsStep,
};
pub use material::Material;
pub use measured_wrench::MeasuredWrench;
pub use node::{
    Discovery, Fault, Joint, JointStates, JointTrajectory, Late, Limits, Node, ServiceMapping,
    WallName, Zero,
};
pub use outputs::{ModuliKind, Outputs, When};
pub use pack::{Generate, PackSource, Radius};
pub use record::{Compression, OnFailure, Record, Split, Topics};
pub use rig_log::{Lateral, RigLog, StrainUnit};
pub use shear::ShearStep;
pub use solver::{MAX_STRAIN_INCREMENT, Method, Solver, TOLERANCE};
pub use surround::{Annulus, Cell, Cylinder, MOST_POINTS, PointSides, Points};
pub use targets::Targets;
pub use view::{ColorBy, VIEW_SCALE, View};
pub use walls::Walls;

/// A whole scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name shown in summaries and recordings.
    #[serde(default = "default_name")]
    pub name: String,
    /// 3 for spheres, 2 for discs.
    #[serde(default = "default_dimension")]
    pub dimension: u8,
    /// Materials by name. `quartz`, `glass` and `hydrate` of T table 2.1 are always here; a
    /// definition in the file takes their place.
    #[serde(default = "material::builtin", deserialize_with = "material::with_builtin")]
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
    /// The pictures for viewers.
    #[serde(default)]
    pub view: View,
}

fn default_name() -> String {
    "unnamed".into()
}

fn default_dimension() -> u8 {
    3
}

impl Scene {
    /// The scene as YAML with every default written out; reading it gives an equal scene.
    ///
    /// # Errors
    /// Only when a path in the scene is not UTF-8, which no scene that was read holds.
    pub fn to_yaml(&self) -> Result<String, SceneError> {
        serde_saphyr::to_string(self).map_err(|error| SceneError::Echo(error.to_string()))
    }

    fn check(&self, problems: &mut Problems) {
        let at = Field::root();
        if self.name.is_empty() || self.name.chars().any(char::is_control) {
            problems.add(
                at.key("name"),
                format!("{:?} is no name; allowed: one line of text", self.name),
            );
        }
        if !matches!(self.dimension, 2 | 3) {
            problems.add(at.key("dimension"), format!("{}; allowed: 2, 3", self.dimension));
        }
        dimension::check(self, problems);
        surround::check(self, problems);
        for (name, material) in &self.materials {
            material.check(&at.key("materials").key(name), problems);
        }
        self.walls.check(&at.key("walls"), problems);
        self.pack.check(&at.key("pack"), &self.materials, problems);
        prepare::check(&self.pack.prepare, &at.key("pack").key("prepare"), &self.contact, problems);
        self.contact.check(&at.key("contact"), problems);
        problems.finite(&at.key("gravity"), &self.gravity);
        if let Some(reference) = &self.reference {
            problems.bounds(&at.key("reference"), reference);
        }
        self.solver.check(&at.key("solver"), problems);
        self.load_path.check(&at.key("load_path"), self.walls.cell.is_box(), problems);
        self.outputs.check(&at.key("outputs"), problems);
        self.node.check(&at.key("node"), problems);
        self.record.check(&at.key("record"), problems);
        self.view.check(&at.key("view"), &self.outputs, problems);
    }
}

//! Where the grains come from.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use super::{Crystal, Grading, Hydrate, Material, prepare};
use crate::wall::Bounds;

/// Most grains that a scene may ask for.
const MAX_GRAINS: u64 = 10_000_000;

/// Where the grains come from; exactly one of `generate`, `crystal` and `file`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PackSource {
    /// Make the pack.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generate: Option<Generate>,
    /// Lay it out as a crystal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub crystal: Option<Crystal>,
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
    /// Which grains are gas hydrate; without it those that a pack that is read says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hydrate: Option<Hydrate>,
    /// Seed of the per-grain spread of a material given to a crystal or a pack that is read.
    #[serde(default)]
    pub seed: u64,
    /// What is done with the pack, made or read and cut, before the run.
    #[serde(default)]
    pub prepare: Vec<prepare::Step>,
}

impl PackSource {
    /// The seed of what is drawn by lot.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.generate.as_ref().map_or(self.seed, |generate| generate.seed)
    }

    pub(super) fn check(
        &self,
        at: &Field,
        materials: &BTreeMap<String, Material>,
        problems: &mut Problems,
    ) {
        let sources = [self.generate.is_some(), self.crystal.is_some(), self.file.is_some()];
        match sources.iter().filter(|&&given| given).count() {
            0 => problems.add(
                at.clone(),
                "neither `generate` nor `crystal` nor `file` is given; allowed: exactly one of them",
            ),
            1 => {}
            _ => problems.add(
                at.clone(),
                "more than one of `generate`, `crystal` and `file` is given; allowed: exactly one \
                 of them",
            ),
        }
        if let Some(generate) = &self.generate {
            generate.check(&at.key("generate"), materials, problems);
        }
        if let Some(crystal) = &self.crystal {
            crystal.check(&at.key("crystal"), materials, problems);
        }
        if self.file.is_none() {
            self.check_unused(at, problems);
        }
        if let Some(name) = &self.material {
            known(&at.key("material"), name, materials, problems);
        }
        if let Some(hydrate) = &self.hydrate {
            hydrate.check(&at.key("hydrate"), materials, problems);
        }
        if let Some(bounds) = &self.bounds {
            problems.bounds(&at.key("box"), bounds);
        }
        if let Some(cut) = &self.cut {
            problems.bounds(&at.key("cut"), cut);
        }
    }

    /// Keys that mean nothing for a pack that is made: who wrote them expected something.
    fn check_unused(&self, at: &Field, problems: &mut Problems) {
        let only = |what: &str| format!("only for a pack that is read by `file`; {what}");
        let source = if self.crystal.is_some() { "crystal" } else { "generate" };
        if self.bounds.is_some() {
            problems.add(at.key("box"), only("the box of a pack that is made follows its grains"));
        }
        if self.material.is_some() {
            problems.add(at.key("material"), only(&format!("here it is `{source}.material`")));
        }
        if self.seed != 0 && self.generate.is_some() {
            problems.add(at.key("seed"), only("here it is `generate.seed`"));
        }
    }
}

pub(super) fn known(
    field: &Field,
    name: &str,
    materials: &BTreeMap<String, Material>,
    problems: &mut Problems,
) {
    if !materials.contains_key(name) {
        let names = materials.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        problems.add(field.clone(), format!("no material is named `{name}`; known: {names}"));
    }
}

/// A pack made from a seed (T 2.7.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generate {
    /// Number of grains, at least 1.
    pub grains: usize,
    /// Radii \[m\].
    pub radius: Radius,
    /// Name of a material.
    pub material: String,
    /// Seed of radii, properties and positions.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Isotropic stress to compact to \[Pa\], above 0.
    pub confining_stress: f64,
    /// Proportions of the box.
    #[serde(default = "default_aspect")]
    pub aspect: [f64; 3],
    /// Rounds in which grains with fewer than 4 contacts are expanded until they have 4 (T 2.7.2).
    #[serde(default)]
    pub expand_floaters: u32,
    /// f_gg^I: friction of discs while they are compacted, 0 to infinite; it sets their density
    /// (B 3.2.1). Spheres are compacted without.
    #[serde(default)]
    pub compaction_friction: f64,
}

fn default_seed() -> u64 {
    1
}

fn default_aspect() -> [f64; 3] {
    [1.0; 3]
}

impl Generate {
    fn check(&self, at: &Field, materials: &BTreeMap<String, Material>, problems: &mut Problems) {
        problems.count(at.key("grains"), self.grains as u64, 1, MAX_GRAINS);
        self.radius.check(&at.key("radius"), problems);
        known(&at.key("material"), &self.material, materials, problems);
        problems.positive(
            at.key("confining_stress"),
            self.confining_stress,
            "confining_stress > 0 Pa",
        );
        for (axis, &share) in self.aspect.iter().enumerate() {
            problems.number(
                at.key("aspect").index(axis),
                share,
                "0.01 <= aspect <= 100",
                |share| (0.01..=100.0).contains(&share),
            );
        }
        problems.count(at.key("expand_floaters"), u64::from(self.expand_floaters), 0, 1000);
        problems.at_least_zero(
            at.key("compaction_friction"),
            self.compaction_friction,
            "compaction_friction >= 0, .inf included",
        );
    }
}

/// Distribution of the radii \[m\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Radius {
    /// Evenly between the two.
    Uniform([f64; 2]),
    /// All the same.
    Constant(f64),
    /// Sand with a sieve curve that is straight in the logarithm of the size (B A.1-A.5).
    GradingA(Grading),
    /// Evenly between the two that the mean and their ratio give (B A.7-A.8).
    GradingB(Grading),
}

impl Radius {
    fn check(&self, at: &Field, problems: &mut Problems) {
        match *self {
            Self::Uniform(limits) => {
                let at = at.key("uniform");
                for (index, &limit) in limits.iter().enumerate() {
                    problems.positive(at.index(index), limit, "radius > 0 m");
                }
                if limits[0] > limits[1] {
                    let text = format!(
                        "{:?} is above {:?}; allowed: the smaller radius first",
                        limits[0], limits[1]
                    );
                    problems.add(at, text);
                }
            }
            Self::Constant(radius) => {
                problems.positive(at.key("constant"), radius, "radius > 0 m");
            }
            Self::GradingA(grading) => grading.check(&at.key("grading_a"), problems),
            Self::GradingB(grading) => grading.check(&at.key("grading_b"), problems),
        }
    }
}

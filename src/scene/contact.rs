//! Contact laws.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::check::{Field, Problems};
use super::{Cement, Linear, Solution};

/// Contact laws.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Contact {
    /// Normal law.
    pub normal: Normal,
    /// Tangential law.
    pub friction: Friction,
    /// Torsional couple of frictional contacts (T 3.6-3.9).
    pub torsion: bool,
    /// Whether discs turn.
    pub rotation: Rotation,
}

/// Whether discs turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rotation {
    /// As their contacts take them.
    #[default]
    Free,
    /// Not at all (B 3.2.3).
    Locked,
}

impl Default for Contact {
    fn default() -> Self {
        Self {
            normal: Normal::Hertz,
            friction: Friction::None,
            torsion: true,
            rotation: Rotation::Free,
        }
    }
}

impl Contact {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        if let Friction::Coulomb(coulomb) = &self.friction {
            let field = at.key("friction").key("coefficient");
            problems.at_least_zero(field, coulomb.coefficient, "coefficient >= 0, .inf included");
        }
        if let Normal::Linear(linear) = &self.normal {
            linear.check(&at.key("normal").key("linear"), problems);
        }
        if let Normal::Cement(cement) = &self.normal {
            cement.check(&at.key("normal").key("cement"), problems);
            let law = match &self.friction {
                Friction::Coulomb(coulomb) => coulomb.law,
                Friction::None => Law::ReturnMap,
            };
            if cement.solution == Solution::TwoStep && law != Law::ReturnMap {
                let text = "contacts without cement slide by radial return where \
                            contact.normal.cement.solution is two_step; allowed: return_map";
                problems.add(at.key("friction").key("law"), text);
            }
        }
    }
}

/// Normal contact law.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Normal {
    /// Hertz (T 2.2).
    Hertz,
    /// Cemented pairs, and Hertz for the others.
    Cement(Cement),
    /// Forces proportional to the overlap, in the plane (B 8).
    Linear(Linear),
}

/// Tangential contact law: the word `none`, or the keys of [`Coulomb`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// Ideally smooth grains and walls (T chapter 2).
    None,
    /// Elastic shear up to a Coulomb limit (T chapter 3).
    Coulomb(Coulomb),
}

impl Friction {
    /// Coefficient of friction μ between grains whose pack does not tell their own.
    #[must_use]
    pub fn coefficient(self) -> f64 {
        match self {
            Self::None => 0.0,
            Self::Coulomb(coulomb) => coulomb.coefficient,
        }
    }
}

/// Elastic shear up to a Coulomb limit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Coulomb {
    /// Coefficient μ between grains whose pack does not tell their own, 0 to infinite.
    pub coefficient: f64,
    /// How force follows displacement.
    pub law: Law,
    /// Which normal force limits the tangential one.
    pub update: Update,
}

impl Default for Coulomb {
    fn default() -> Self {
        Self { coefficient: 0.3, law: Law::ReturnMap, update: Update::Frozen }
    }
}

/// How the tangential force follows the tangential displacement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Law {
    /// Stick or slide by radial return: the derivative of an exact potential.
    ReturnMap,
    /// Stick or slide by the secant stiffness of T 3.5.
    Secant,
    /// Slip that spreads from the contact's edge (Mindlin and Deresiewicz 1953).
    MindlinDeresiewicz,
}

/// Which normal force limits the tangential one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Update {
    /// That at the start of the increment (T 3.3.2).
    Frozen,
    /// That at its end, found by a few sweeps.
    Current,
}

impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::None => to.serialize_str("none"),
            Self::Coulomb(coulomb) => coulomb.serialize(to),
        }
    }
}

impl<'de> Deserialize<'de> for Friction {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(WordOrKeys)
    }
}

struct WordOrKeys;

impl<'de> Visitor<'de> for WordOrKeys {
    type Value = Friction;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("`none`, or a mapping such as `{coefficient: 0.3}`")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Friction, E> {
        match word {
            "none" => Ok(Friction::None),
            other => Err(E::unknown_variant(other, &["none", "{coefficient: ...}"])),
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Friction, A::Error> {
        Coulomb::deserialize(MapAccessDeserializer::new(map)).map(Friction::Coulomb)
    }
}

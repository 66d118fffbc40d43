//! Which joint of a rig moves which wall.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::scene::check::{Field, Problems};
use crate::wall;

/// `sensor_msgs/JointState` that the walls follow.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointStates {
    /// Session of the commands that the messages become.
    #[serde(default = "JointStates::session")]
    pub session: String,
    /// The joints that move a wall, by name.
    pub joints: BTreeMap<String, Joint>,
}

impl JointStates {
    fn session() -> String {
        "joint_states".into()
    }

    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        check_joints(&self.joints, &at.key("joints"), problems);
    }
}

/// `trajectory_msgs/JointTrajectory` whose points the walls go through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointTrajectory {
    /// Sessions of the commands that the points become: this, `/` and the number of the
    /// trajectory.
    #[serde(default = "JointTrajectory::session")]
    pub session: String,
    /// The joints that move a wall, by name.
    pub joints: BTreeMap<String, Joint>,
}

impl JointTrajectory {
    fn session() -> String {
        "joint_trajectory".into()
    }

    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        let at = at.key("joints");
        check_joints(&self.joints, &at, problems);
        for (name, _) in self.joints.iter().filter(|(_, joint)| joint.zero == Zero::First) {
            let text = "`first` is for node.joint_states; allowed here: a number";
            problems.add(at.key(name).key("zero"), text);
        }
    }
}

fn check_joints(joints: &BTreeMap<String, Joint>, at: &Field, problems: &mut Problems) {
    if joints.is_empty() {
        problems.add(at.clone(), "no joint moves a wall; allowed: at least one");
    }
    let mut moved: [Option<&str>; wall::COUNT] = [None; wall::COUNT];
    for (name, joint) in joints {
        let at = at.key(name);
        joint.check(&at, problems);
        if let Some(other) = moved[joint.wall.index()].replace(name) {
            let wall = wall::NAMES[joint.wall.index()];
            let text = format!("`{other}` moves {wall} already; allowed: one joint a wall");
            problems.add(at.key("wall"), text);
        }
    }
}

/// How a joint moves its wall: inward displacement = sign gear (position - zero).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// The wall.
    pub wall: WallName,
    /// 1 when the joint's position grows as the wall goes inwards, -1 when it falls.
    #[serde(default = "Joint::one")]
    pub sign: f64,
    /// Position of the joint where the wall is at its start.
    #[serde(default)]
    pub zero: Zero,
    /// Way of the wall per unit of the joint's position \[m/m or m/rad\].
    #[serde(default = "Joint::one")]
    pub gear: f64,
}

impl Joint {
    fn one() -> f64 {
        1.0
    }

    fn check(&self, at: &Field, problems: &mut Problems) {
        problems.number(at.key("sign"), self.sign, "1 and -1", |sign| sign.abs() == 1.0);
        problems.positive(at.key("gear"), self.gear, "gear > 0 m a unit of the joint");
        if let Zero::At(position) = self.zero {
            problems.number(at.key("zero"), position, "a finite number", |_| true);
        }
    }
}

/// A wall by its name, in the order of [`wall::NAMES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WallName {
    /// The wall at low x.
    XMin,
    /// The wall at high x.
    XMax,
    /// The wall at low y.
    YMin,
    /// The wall at high y.
    YMax,
    /// The wall at low z.
    ZMin,
    /// The wall at high z.
    ZMax,
}

impl WallName {
    /// Its place among the six.
    #[must_use]
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// Where a joint's position is counted from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Zero {
    /// This position.
    At(f64),
    /// The position in the first message that can be read.
    First,
}

impl Default for Zero {
    fn default() -> Self {
        Self::At(0.0)
    }
}

impl Serialize for Zero {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::At(position) => to.serialize_f64(*position),
            Self::First => to.serialize_str("first"),
        }
    }
}

impl<'de> Deserialize<'de> for Zero {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(NumberOrWord)
    }
}

struct NumberOrWord;

impl Visitor<'_> for NumberOrWord {
    type Value = Zero;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a number, or `first`")
    }

    fn visit_f64<E: Error>(self, position: f64) -> Result<Zero, E> {
        Ok(Zero::At(position))
    }

    fn visit_i64<E: Error>(self, position: i64) -> Result<Zero, E> {
        Ok(Zero::At(position as f64))
    }

    fn visit_u64<E: Error>(self, position: u64) -> Result<Zero, E> {
        Ok(Zero::At(position as f64))
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Zero, E> {
        match word {
            "first" => Ok(Zero::First),
            other => Err(E::unknown_variant(other, &["a number", "first"])),
        }
    }
}

//! Shadow mode: the walls follow the measured positions of a rig's joints.

use super::joints::Joints;
use crate::command::request::Intake;
use crate::command::{Ask, Command, Mode, Stamp};
use crate::msg::JointState;
use crate::scene::JointStates;
use crate::wall::{self, WallTarget};

/// Makes a command of each `sensor_msgs/JointState`.
///
/// Every joint of the map must be in every message; others are ignored, and so are velocities and
/// efforts.
#[derive(Clone, Debug)]
pub struct JointStateMap {
    session: String,
    sequence: u64,
    joints: Joints,
}

impl JointStateMap {
    /// For the joints of a scene.
    #[must_use]
    pub fn new(map: &JointStates) -> Self {
        Self { session: map.session.clone(), sequence: 0, joints: Joints::new(&map.joints) }
    }

    /// The command of `message`, which was `age` s old when it arrived.
    pub fn intake(&mut self, message: &JointState, age: Option<f64>) -> Intake {
        self.sequence += 1;
        let JointState { header, name: names, position: positions, .. } = message;
        let read = self.joints.places(names).and_then(|places| {
            let targets = self.joints.targets(names, &places, positions)?;
            self.joints.set_zeros(&places, positions);
            Ok(targets)
        });
        let stamp = header.stamp.into();
        match read {
            Ok(targets) => Intake::Command(self.command(stamp, targets, age)),
            Err(text) => Intake::Malformed(self.command(stamp, self.joints.unknown(), age), text),
        }
    }

    /// What stands for a message of about `stamp` that cannot be read, for which `text` is why.
    pub fn unreadable(&mut self, stamp: Stamp, text: String) -> Intake {
        self.sequence += 1;
        Intake::Malformed(self.command(stamp, self.joints.unknown(), None), text)
    }

    fn command(
        &self,
        stamp: Stamp,
        targets: [WallTarget; wall::COUNT],
        age: Option<f64>,
    ) -> Command {
        Command {
            stamp,
            session: self.session.clone(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask: Ask::Targets(targets),
            age,
        }
    }
}

//! Shadow mode: the walls follow the measured positions of a rig's joints.

use super::joints::Joints;
use crate::command::request::Intake;
use crate::command::{Ask, Command, Mode};
use crate::msg::JointState;
use crate::scene::JointStates;

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
        let command = |targets| Command {
            stamp: header.stamp.into(),
            session: self.session.clone(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask: Ask::Targets(targets),
            age,
        };
        match read {
            Ok(targets) => Intake::Command(command(targets)),
            Err(text) => Intake::Malformed(command(self.joints.unknown()), text),
        }
    }
}

//! Trajectories: the walls go through the points, one increment each.

use super::joints::Joints;
use crate::command::request::Intake;
use crate::command::{Ask, Command, Mode, Stamp};
use crate::msg;
use crate::scene;
use crate::wall::{self, WallTarget};

/// Makes a command of each point of a `trajectory_msgs/JointTrajectory`, stamped with the time of
/// the point.
///
/// A trajectory is checked as a whole before its first point is served. The twin has no clock: it
/// serves points as fast as it can, in order, and a trajectory that comes meanwhile after them.
/// Velocities, accelerations and efforts are ignored, and so are joints that move no wall.
#[derive(Clone, Debug)]
pub struct TrajectoryMap {
    session: String,
    /// How many came.
    count: u64,
    joints: Joints,
}

/// Where a point sends the walls, and when.
struct Point {
    stamp: Stamp,
    targets: [WallTarget; wall::COUNT],
}

impl TrajectoryMap {
    /// For the joints of a scene.
    #[must_use]
    pub fn new(map: &scene::JointTrajectory) -> Self {
        Self { session: map.session.clone(), count: 0, joints: Joints::new(&map.joints) }
    }

    /// The commands of `message`, which was `age` s old when it arrived. They make a session of
    /// their own, in which the sequence counts from 1. What makes no trajectory gives one intake
    /// that says so.
    pub fn intakes(&mut self, message: &msg::JointTrajectory, age: Option<f64>) -> Vec<Intake> {
        self.count += 1;
        let start = Stamp::from(message.header.stamp);
        // Without a stamp it begins at once: nothing says how old it is.
        let age = age.filter(|_| start != Stamp::default());
        let command = |sequence, stamp: Stamp, targets| {
            let age = age.map(|age| age - (stamp.seconds() - start.seconds()));
            Command { age, ..self.command(sequence, stamp, targets) }
        };
        match self.points(message) {
            Ok(points) => (1..)
                .zip(points)
                .map(|(sequence, Point { stamp, targets })| command(sequence, stamp, targets))
                .map(Intake::Command)
                .collect(),
            Err(text) => vec![Intake::Malformed(command(1, start, self.joints.unknown()), text)],
        }
    }

    /// What stands for a message of about `stamp` that cannot be read, for which `text` is why.
    pub fn unreadable(&mut self, stamp: Stamp, text: String) -> Intake {
        self.count += 1;
        Intake::Malformed(self.command(1, stamp, self.joints.unknown()), text)
    }

    fn command(&self, sequence: u64, stamp: Stamp, targets: [WallTarget; wall::COUNT]) -> Command {
        Command {
            stamp,
            session: format!("{}/{}", self.session, self.count),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Targets(targets),
            age: None,
        }
    }

    /// Every point, or what is wrong with one.
    fn points(&self, message: &msg::JointTrajectory) -> Result<Vec<Point>, String> {
        let places = self.joints.places(&message.joint_names)?;
        if message.points.is_empty() {
            return Err("the trajectory has no points: at least one is needed".into());
        }
        let start = Stamp::from(message.header.stamp);
        let mut last = None;
        let mut points = Vec::with_capacity(message.points.len());
        for (number, point) in (1..).zip(&message.points) {
            let of_point = |text: String| format!("point {number} of the trajectory: {text}");
            let time = point.time_from_start.nanoseconds();
            if time < 0 || last.is_some_and(|last| time <= last) {
                let seconds = time as f64 * 1e-9;
                let text = format!(
                    "its time_from_start is {seconds} s: the times are from 0 s on and increase"
                );
                return Err(of_point(text));
            }
            last = Some(time);
            let beyond = || of_point("its time is beyond what a stamp can tell".into());
            let targets = self.joints.targets(&message.joint_names, &places, &point.positions);
            points.push(Point {
                stamp: start.later(time).ok_or_else(beyond)?,
                targets: targets.map_err(of_point)?,
            });
        }
        Ok(points)
    }
}

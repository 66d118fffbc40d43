//! Joint states and joint trajectories of a rig as commands.

use std::path::Path;

use graintwin::command::map::{JointStateMap, TrajectoryMap};
use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::msg::{Duration, Header, JointState, JointTrajectory, JointTrajectoryPoint, Time};
use graintwin::scene::{self, Node};
use graintwin::wall::WallTarget::{self, Displacement, Keep};

/// A scene's `node` with the joints of both kinds of messages.
fn node(states: &str) -> Node {
    let text = format!(
        "pack: {{file: a.csv}}\nnode:\n  joint_states: {{joints: {{{states}}}}}\n  \
         joint_trajectory: {{session: t, joints: {{top: {{wall: z_max}}, side: {{wall: x_min, \
         zero: 1.0, sign: -1}}}}}}\n"
    );
    scene::parse(&text, Path::new("scene.yaml")).unwrap().node
}

fn follows(states: &str) -> JointStateMap {
    JointStateMap::new(&node(states).joint_states.unwrap())
}

fn goes() -> TrajectoryMap {
    TrajectoryMap::new(&node("a: {wall: x_min}").joint_trajectory.unwrap())
}

fn state(joints: &[(&str, f64)]) -> JointState {
    JointState {
        header: header(7, 9),
        name: joints.iter().map(|(name, _)| (*name).into()).collect(),
        position: joints.iter().map(|(_, position)| *position).collect(),
        ..JointState::default()
    }
}

fn header(sec: i32, nanosec: u32) -> Header {
    Header { stamp: Time { sec, nanosec }, frame_id: "rig".into() }
}

#[track_caller]
fn command(intake: Intake) -> Command {
    match intake {
        Intake::Command(command) => command,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn malformed(intake: Intake, joint: &str) -> (Command, String) {
    match intake {
        Intake::Malformed(command, text) => {
            assert!(text.contains(&format!("`{joint}`")), "{text}");
            (command, text)
        }
        other => panic!("{other:?}"),
    }
}

fn targets(command: &Command) -> [WallTarget; 6] {
    match command.ask {
        Ask::Targets(targets) => targets,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_joint_moves_its_wall_by_sign_and_gear_from_its_zero_and_the_others_keep() {
    let mut map =
        follows("top: {wall: z_max, sign: -1, zero: 0.5, gear: 2.0}, side: {wall: x_min}");
    let message = state(&[("side", 3.0), ("not mapped", f64::NAN), ("top", 0.75)]);
    let found = command(map.intake(&message, Some(0.25)));
    assert_eq!(targets(&found), [Displacement(3.0), Keep, Keep, Keep, Keep, Displacement(-0.5)]);
    let Command { stamp, session, sequence, mode, age, .. } = found;
    assert_eq!((stamp, session.as_str()), (Stamp { sec: 7, nanosec: 9 }, "joint_states"));
    assert_eq!((sequence, mode, age), (1, Mode::Absolute, Some(0.25)));
    assert_eq!(command(map.intake(&message, None)).sequence, 2);
}

#[test]
fn the_first_message_that_can_be_read_is_the_zero_of_those_that_ask_for_it() {
    let mut map = follows("top: {wall: z_max, zero: first}, side: {wall: x_min, zero: 1.0}");
    malformed(map.intake(&state(&[("top", 9.0), ("side", f64::NAN)]), None), "side");
    let mut go =
        |top, side| targets(&command(map.intake(&state(&[("top", top), ("side", side)]), None)));
    let [side, .., top] = go(5.0, 5.0);
    assert_eq!((side, top), (Displacement(4.0), Displacement(0.0)));
    let [side, .., top] = go(5.5, 1.0);
    assert_eq!((side, top), (Displacement(0.0), Displacement(0.5)));
}

#[test]
fn a_message_without_a_position_for_every_mapped_joint_is_malformed_and_names_it() {
    let mut map = follows("top: {wall: z_max}, side: {wall: x_min}");
    let (instead, _) = malformed(map.intake(&state(&[("side", 0.0)]), None), "top");
    // Whoever reads it in a recording is told that it was no command.
    let [side, y_min, .., top] = targets(&instead);
    assert!(matches!((side, top), (Displacement(a), Displacement(b)) if a.is_nan() && b.is_nan()));
    assert_eq!(y_min, Keep);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let message = state(&[("side", 0.0), ("top", value)]);
        let (_, text) = malformed(map.intake(&message, None), "top");
        assert!(text.contains("finite") && text.contains("z_max"), "{text}");
    }
    malformed(map.intake(&state(&[("side", 0.0), ("top", 0.0), ("side", 0.0)]), None), "side");
    for positions in [vec![], vec![0.0], vec![0.0; 3]] {
        let count = positions.len();
        let message = JointState { position: positions, ..state(&[("side", 0.0), ("top", 0.0)]) };
        let (_, text) = malformed(map.intake(&message, None), "side");
        assert!(text.contains(&format!("{count} positions for 2 names")), "{text}");
    }
    malformed(map.intake(&JointState::default(), None), "side");
    // Each has a number of its own.
    let good = command(map.intake(&state(&[("side", 0.0), ("top", 0.0)]), None));
    assert_eq!((instead.sequence, good.sequence), (1, 10));
    let mut geared = follows("top: {wall: z_max, gear: 1.0e+300}");
    malformed(geared.intake(&state(&[("top", 1e300)]), None), "top");
}

fn point(sec: i32, nanosec: u32, positions: &[f64]) -> JointTrajectoryPoint {
    JointTrajectoryPoint {
        positions: positions.into(),
        time_from_start: Duration { sec, nanosec },
        ..JointTrajectoryPoint::default()
    }
}

fn trajectory(points: Vec<JointTrajectoryPoint>) -> JointTrajectory {
    let joint_names = ["side", "arm", "top"].map(String::from).to_vec();
    JointTrajectory { header: header(100, 900_000_000), joint_names, points }
}

#[test]
fn every_point_is_a_command_stamped_with_its_time() {
    let mut map = goes();
    let points = vec![
        point(0, 0, &[1.0, f64::NAN, 0.0]),
        point(0, 200_000_000, &[0.5, 0.0, 1e-3]),
        point(2, 0, &[1.0, 0.0, -1e-3]),
    ];
    let intakes = map.intakes(&trajectory(points.clone()), Some(5.0));
    let commands: Vec<Command> = intakes.into_iter().map(command).collect();
    let stamps: Vec<_> = commands.iter().map(|one| (one.stamp.sec, one.stamp.nanosec)).collect();
    assert_eq!(stamps, [(100, 900_000_000), (101, 100_000_000), (102, 900_000_000)]);
    let places: Vec<_> = commands.iter().map(|one| (one.session.as_str(), one.sequence)).collect();
    assert_eq!(places, [("t/1", 1), ("t/1", 2), ("t/1", 3)]);
    let ends: Vec<_> = commands.iter().map(|one| (targets(one)[0], targets(one)[5])).collect();
    assert_eq!(ends[0], (Displacement(-0.0), Displacement(0.0)));
    assert_eq!(ends[1], (Displacement(0.5), Displacement(1e-3)));
    assert_eq!(ends[2], (Displacement(-0.0), Displacement(-1e-3)));
    assert!(commands.iter().all(|one| targets(one)[1..5] == [Keep; 4]));
    // A point that is still to come is younger than the trajectory.
    let ages: Vec<f64> = commands.iter().map(|one| one.age.unwrap()).collect();
    assert!((ages[0] - 5.0).abs() < 1e-9 && (ages[2] - 3.0).abs() < 1e-9, "{ages:?}");
    // The next one is a session of its own; without a stamp nothing tells its age.
    let next = JointTrajectory { header: header(0, 0), ..trajectory(points) };
    let next = command(map.intakes(&next, Some(1e9)).remove(1));
    assert_eq!((next.session.as_str(), next.sequence, next.age), ("t/2", 2, None));
    assert_eq!(next.stamp, Stamp { sec: 0, nanosec: 200_000_000 });
}

#[test]
fn a_trajectory_with_a_wrong_point_gives_no_command_at_all() {
    let good = || point(1, 0, &[0.0, 0.0, 0.0]);
    let refusal = |points: Vec<JointTrajectoryPoint>| {
        let mut intakes = goes().intakes(&trajectory(points), None);
        assert_eq!(intakes.len(), 1);
        match intakes.remove(0) {
            Intake::Malformed(command, text) => {
                assert_eq!((command.session.as_str(), command.sequence), ("t/1", 1));
                text
            }
            other => panic!("{other:?}"),
        }
    };
    let says = |text: String, words: &[&str]| {
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    says(refusal(vec![]), &["no points"]);
    says(refusal(vec![good(), good()]), &["point 2", "time_from_start is 1 s", "increase"]);
    says(refusal(vec![good(), point(0, 5, &[0.0; 3])]), &["point 2", "increase"]);
    says(refusal(vec![point(-1, 0, &[0.0; 3]), good()]), &["point 1", "from 0 s on"]);
    says(refusal(vec![good(), point(2, 0, &[0.0; 2])]), &["point 2", "2 positions", "`side`"]);
    says(refusal(vec![good(), point(2, 0, &[])]), &["point 2", "0 positions"]);
    says(refusal(vec![good(), point(2, 0, &[0.0, 0.0, f64::NAN])]), &["point 2", "`top`"]);
    says(refusal(vec![good(), point(i32::MAX, 0, &[0.0; 3])]), &["point 2", "stamp"]);
    let joint_names = vec!["top".into(), "arm".into(), "other".into()];
    let without = JointTrajectory { joint_names, ..trajectory(vec![good()]) };
    malformed(goes().intakes(&without, None).remove(0), "side");
}

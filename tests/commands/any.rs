//! Whatever comes to the twin, in whatever order: no wall moves that no accepted command moved,
//! and each message has one report.

use std::collections::VecDeque;

use graintwin::command::map::{JointStateMap, TrajectoryMap};
use graintwin::command::merge::mergeable;
use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command, Disposition, Dissociation, Mode, Stamp};
use graintwin::msg::{Duration, Header, JointState, JointTrajectory, JointTrajectoryPoint, Time};
use graintwin::pack::Pack;
use graintwin::report::{Demand, Report};
use graintwin::scene::{self, Fault, Limits, Scene};
use graintwin::twin::{Merged, Settings, Twin};
use graintwin::wall::{self, WallTarget};
use proptest::prelude::*;

use crate::packs::{bead, centered};

/// Half the side of the box around one grain.
const HALF: f64 = 0.999e-4;

/// Something that happens to a running twin.
#[derive(Clone, Debug)]
enum Event {
    Command(Command),
    Joints(JointState),
    Trajectory(JointTrajectory),
    Hold(bool),
    ResetFaults,
    Limits(Limits),
    StaleAfter(f64),
    Reset,
}

fn scene() -> Scene {
    let text = "pack: {file: none.csv, material: glass}\nnode:\n  joint_states: {joints: {a: {wall: \
                z_max, zero: first}, b: {wall: x_min, sign: -1}}}\n  joint_trajectory: {joints: {a: \
                {wall: z_min}}}\n";
    scene::parse(text, "scene.yaml".as_ref()).unwrap()
}

fn twin(scene: &Scene) -> Twin {
    let pack = Pack {
        bounds: centered([2.0 * HALF; 3]),
        grains: vec![bead([0.0; 3], 1e-4)],
        history: None,
    };
    let mut twin = Twin::new(scene, &pack, 1).unwrap();
    assert_eq!(twin.start(Demand::default()).disposition, Disposition::Applied);
    twin
}

/// What is known of the walls without asking the twin.
struct Model {
    /// Inward displacement \[m\].
    at: [f64; wall::COUNT],
    /// Walls under a load.
    loaded: [bool; wall::COUNT],
    limits: Limits,
    held: bool,
}

impl Model {
    fn new() -> Self {
        let none = [false; wall::COUNT];
        Self { at: [0.0; wall::COUNT], loaded: none, limits: Limits::default(), held: false }
    }

    /// Takes an accepted `command` for granted; returns where it sends the walls that stand.
    fn accept(&mut self, command: &Command) -> [f64; wall::COUNT] {
        let on_top = |w: usize, value: f64| match command.mode {
            Mode::Increment => self.at[w] + value,
            _ => value,
        };
        let mut to = self.at;
        match command.ask {
            Ask::Displacement(asked) => {
                for w in (0..wall::COUNT).filter(|&w| !self.loaded[w]) {
                    to[w] = on_top(w, asked[w]);
                }
            }
            Ask::Dissociation(_) | Ask::Shear(_) => panic!("accepted {command:?}"),
            Ask::Targets(targets) => {
                for (w, target) in targets.into_iter().enumerate() {
                    match target {
                        WallTarget::Keep => {}
                        WallTarget::Displacement(value) => {
                            to[w] = on_top(w, value);
                            self.loaded[w] = false;
                        }
                        WallTarget::Force(_) | WallTarget::Stress(_) => self.loaded[w] = true,
                        WallTarget::Unknown(..) => panic!("accepted {target:?}"),
                    }
                }
            }
        }
        to
    }

    /// Holds one report against what may have happened. `moves` says whether the walls moved with
    /// it rather than with a later one.
    fn check(&mut self, command: &Command, report: &Report) {
        assert_eq!((&report.session, report.sequence), (&command.session, command.sequence));
        // A duplicate gets the report of its original.
        let repeated = report.disposition == Disposition::Duplicate;
        assert!(repeated || report.stamp == command.stamp);
        let accepted = matches!(report.disposition, Disposition::Applied | Disposition::Clamped);
        assert!(accepted || report.measures.is_none());
        assert!(!self.held || report.disposition == Disposition::Held, "{report:?}");
        if !accepted {
            assert!(!report.text.is_empty(), "{report:?}");
            return;
        }
        assert!(command.ask.numbers().iter().all(|number| number.is_finite()));
        let (from, loaded) = (self.at, self.loaded);
        let to = self.accept(command);
        let Some(measures) = &report.measures else {
            assert!(report.text.contains("merged into sequence"), "{report:?}");
            self.at = to;
            return;
        };
        assert!(measures.walls.normal_force.iter().all(|force| force.is_finite()));
        let found = measures.walls.displacement;
        if report.disposition == Disposition::Clamped && found == from {
            // No part of the way is within the limits: what carried a load goes on to carry it.
            self.loaded = loaded;
            return;
        }
        for w in (0..wall::COUNT).filter(|&w| !self.loaded[w]) {
            match report.disposition {
                Disposition::Applied => assert_eq!(found[w], to[w], "{report:?}"),
                _ => {
                    let rounding = 1e-12 * (from[w].abs() + to[w].abs());
                    let (low, high) = (from[w].min(to[w]), from[w].max(to[w]));
                    assert!((low - rounding..=high + rounding).contains(&found[w]), "{report:?}");
                }
            }
            let travel = self.limits.travel.max(from[w].abs()) * (1.0 + 1e-9);
            assert!(self.limits.travel == 0.0 || found[w].abs() <= travel, "{report:?}");
        }
        self.at = found;
    }
}

/// Serves everything that waits, as the program does; returns how many reports there were.
fn serve(twin: &mut Twin, model: &mut Model, mut waiting: VecDeque<Intake>, merge: bool) -> usize {
    let mut reports = 0;
    let mut take = |model: &mut Model, command: &Command, report: &Report| {
        reports += 1;
        model.check(command, report);
    };
    while let Some(intake) = waiting.pop_front() {
        let command = match intake {
            Intake::Malformed(command, text) => {
                let report = twin.refuse(&command, text);
                assert_ne!(report.disposition, Disposition::Applied);
                take(model, &command, &report);
                continue;
            }
            Intake::Command(command) => command,
            Intake::Request(_) => unreachable!(),
        };
        waiting.push_front(Intake::Command(command));
        let count = if merge { mergeable(twin.setpoint(), &waiting).max(1) } else { 1 };
        let first: Vec<Command> = (waiting.drain(..count))
            .filter_map(|intake| match intake {
                Intake::Command(command) => Some(command),
                _ => None,
            })
            .collect();
        assert_eq!(first.len(), count);
        let merged = merge.then(|| twin.apply_merged(&first, Demand::default()));
        let mut first = first.into_iter();
        match merged {
            Some(Merged::Together(all)) => {
                assert!((2..=count).contains(&all.len()));
                for report in all {
                    take(model, &first.next().unwrap(), &report);
                }
            }
            Some(Merged::Apart(apart)) => {
                for command in first.by_ref().take(apart) {
                    take(model, &command, &twin.apply(&command, Demand::default()));
                }
            }
            None => {
                let command = first.next().unwrap();
                take(model, &command, &twin.apply(&command, Demand::default()));
            }
        }
        for command in first.rev() {
            waiting.push_front(Intake::Command(command));
        }
        assert_where(twin, model);
    }
    reports
}

/// The walls are where the model has them.
fn assert_where(twin: &Twin, model: &Model) {
    let start = centered([2.0 * HALF; 3]);
    assert_eq!(twin.pack().bounds, start.displaced(&model.at));
}

/// Numbers as a broken rig may send them; some come again and again.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-3i32..4).prop_map(|step| 1e-8 * f64::from(step)),
        3 => -2e-7..2e-7f64,
        1 => -1e-3..1e-3f64,
        1 => any::<f64>(),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-0.0), Just(1e300), Just(-1.0)],
    ]
}

fn target() -> impl Strategy<Value = WallTarget> {
    prop_oneof![
        6 => Just((0u8, 0.0)),
        6 => number().prop_map(|value| (1, value)),
        1 => (1e-6..1e-2f64).prop_map(|force| (2, force)),
        1 => (1e2..1e6f64).prop_map(|stress| (3, stress)),
        1 => (any::<u8>(), number()),
    ]
    .prop_map(|(control, value)| WallTarget::from_numbers(control, value))
}

fn ask() -> impl Strategy<Value = Ask> {
    prop_oneof![
        2 => prop::array::uniform6(number()).prop_map(Ask::Displacement),
        2 => (number(), 0..6usize).prop_map(|(value, w)| {
            let mut displacement = [0.0; 6];
            displacement[w] = value;
            Ask::Displacement(displacement)
        }),
        2 => prop::array::uniform6(target()).prop_map(Ask::Targets),
        // The pack has no hydrate: whatever is asked is refused.
        1 => prop::array::uniform3(number()).prop_map(|[saturation_loss, pore_pressure, biot]| {
            Ask::Dissociation(Dissociation { saturation_loss, pore_pressure, biot })
        }),
    ]
}

fn stamp() -> impl Strategy<Value = Stamp> {
    prop_oneof![
        (0..20i32).prop_map(|sec| Stamp { sec, nanosec: 0 }),
        (any::<i32>(), any::<u32>()).prop_map(|(sec, nanosec)| Stamp { sec, nanosec }),
    ]
}

prop_compose! {
    fn command()(
        stamp in stamp(),
        sequence in prop_oneof![0u64..12, Just(u64::MAX)],
        another in prop::bool::weighted(0.2),
        mode in prop_oneof![6 => Just(0u8), 3 => Just(1u8), 1 => any::<u8>()],
        ask in ask(),
        age in prop::option::of(number()),
    ) -> Command {
        let session = if another { "another" } else { "test" };
        Command { stamp, session: session.into(), sequence, mode: Mode::from(mode), ask, age }
    }
}

prop_compose! {
    /// Commands in a row, then some of them twice, swapped or dropped.
    fn run()(
        start in 0u64..6,
        asks in prop::collection::vec(ask(), 1..8),
        mangled in prop::collection::vec((0..8usize, 0..8usize), 0..4),
        dropped in prop::option::of(0..8usize),
    ) -> Vec<Event> {
        let command = |(sequence, ask)| Command {
            stamp: Stamp { sec: sequence as i32, nanosec: 0 },
            session: "test".into(), sequence, mode: Mode::Absolute, ask, age: None,
        };
        let mut run: Vec<Command> = (start..).zip(asks).map(command).collect();
        for (one, other) in mangled {
            let (one, other) = (one % run.len(), other % run.len());
            if one == other { run.push(run[one].clone()) } else { run.swap(one, other) }
        }
        if let Some(place) = dropped { run.remove(place % run.len()); }
        run.into_iter().map(Event::Command).collect()
    }
}

fn header() -> impl Strategy<Value = Header> {
    stamp().prop_map(|stamp| Header { stamp: Time::from(stamp), frame_id: String::new() })
}

fn names() -> impl Strategy<Value = Vec<String>> {
    let name = prop::sample::select(vec!["a", "b", "c", ""]).prop_map(String::from);
    prop_oneof![
        3 => Just(vec!["a".into(), "b".into()]),
        1 => prop::collection::vec(name, 0..4),
    ]
}

prop_compose! {
    fn joints()(
        header in header(), name in names(), position in prop::collection::vec(number(), 1..4),
    ) -> JointState {
        JointState { header, name, position, ..JointState::default() }
    }
}

prop_compose! {
    fn trajectory()(
        header in header(),
        joint_names in names(),
        times in prop::collection::vec((-1..4i32, 0..3u32), 0..4),
        positions in prop::collection::vec(number(), 2..3),
        sorted in any::<bool>(),
    ) -> JointTrajectory {
        let mut times = times;
        if sorted { times.sort_unstable(); times.dedup(); }
        let point = |(sec, nanosec)| JointTrajectoryPoint {
            positions: positions.clone(),
            time_from_start: Duration { sec, nanosec },
            ..JointTrajectoryPoint::default()
        };
        JointTrajectory { header, joint_names, points: times.into_iter().map(point).collect() }
    }
}

fn limits() -> impl Strategy<Value = Limits> {
    let limit = |most: f64| prop_oneof![2 => Just(0.0), 1 => 0.0..most];
    (limit(1e-7), limit(1e-7), limit(1e-3), limit(1e-2), any::<bool>()).prop_map(
        |(travel, rate, strain, force, clamp)| Limits { travel, rate, strain, force, clamp },
    )
}

fn events() -> impl Strategy<Value = Vec<Event>> {
    let one = |event: Event| vec![event];
    let some = prop_oneof![
        8 => run(),
        8 => command().prop_map(Event::Command).prop_map(one),
        4 => joints().prop_map(Event::Joints).prop_map(one),
        2 => trajectory().prop_map(Event::Trajectory).prop_map(one),
        1 => any::<bool>().prop_map(Event::Hold).prop_map(one),
        1 => Just(one(Event::ResetFaults)),
        2 => limits().prop_map(Event::Limits).prop_map(one),
        1 => prop_oneof![Just(0.0), 0.0..1e-7f64].prop_map(Event::StaleAfter).prop_map(one),
        1 => Just(one(Event::Reset)),
    ];
    prop::collection::vec(some, 1..6).prop_map(|all| all.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_wall_moves_that_no_accepted_command_moved_and_each_message_has_one_report(
        events in events(),
        merge in any::<bool>(),
        faults in any::<bool>(),
    ) {
        let mut scene = scene();
        if faults {
            scene.node.hold_after = vec![Fault::NotConverged, Fault::Limit];
        }
        let mut settings = Settings::of(&scene);
        let mut twin = twin(&scene);
        let mut model = Model::new();
        let mut states = JointStateMap::new(scene.node.joint_states.as_ref().unwrap());
        let mut trajectories = TrajectoryMap::new(scene.node.joint_trajectory.as_ref().unwrap());
        let mut waiting = VecDeque::new();
        let serve_all = |twin: &mut Twin, model: &mut Model, waiting: &mut VecDeque<Intake>| {
            let came = waiting.len();
            let reports = serve(twin, model, std::mem::take(waiting), merge);
            assert_eq!(reports, came);
            assert_where(twin, model);
        };
        for event in events {
            match event {
                Event::Command(command) => waiting.push_back(Intake::Command(command)),
                Event::Joints(message) => waiting.push_back(states.intake(&message, None)),
                Event::Trajectory(message) => {
                    let intakes = trajectories.intakes(&message, None);
                    prop_assert!(!intakes.is_empty());
                    waiting.extend(intakes);
                }
                other => {
                    serve_all(&mut twin, &mut model, &mut waiting);
                    match other {
                        Event::Hold(held) => {
                            model.held = held;
                            prop_assert!(!held || twin.hold(held).is_ok());
                            twin.hold(held).ok();
                        }
                        Event::ResetFaults => drop(twin.reset_faults()),
                        Event::Limits(limits) => {
                            model.limits = limits;
                            settings.limits = limits;
                            twin.set(&settings);
                        }
                        Event::StaleAfter(seconds) => {
                            settings.stale_after = seconds;
                            twin.set(&settings);
                        }
                        _ => {
                            let report = twin.reset(Demand::default());
                            prop_assert_eq!(report.increment, 0);
                            (model.at, model.loaded) = ([0.0; 6], [false; 6]);
                        }
                    }
                    assert_where(&twin, &model);
                }
            }
        }
        serve_all(&mut twin, &mut model, &mut waiting);
    }
}

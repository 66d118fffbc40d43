//! Whatever comes to the program, its recording gives the same answers again.

#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

use std::path::Path;

use proptest::prelude::*;

use super::*;
use graintwin::command::{Ask, Mode};
use graintwin::pack::{self, Grain, Pack};
use graintwin::record::reader::Bag;
use graintwin::record::replay::{Act, Compared, Replay};
use graintwin::record::{Closing, Provenance, Recorder};
use graintwin::relax::lanes;
use graintwin::scene::{self, Limits, Scene};
use graintwin::twin::Settings;
use graintwin::view::picture::Painter;
use graintwin::wall::{Bounds, WallTarget};

/// Something that comes, and settings that somebody changed before it.
type Comes = (Intake, Option<Settings>);

/// Everything has come already.
struct Came {
    waiting: VecDeque<Comes>,
    changes: VecDeque<Option<Settings>>,
}

impl Came {
    fn pop(&mut self) -> Option<Intake> {
        let (intake, settings) = self.waiting.pop_front()?;
        self.changes.push_back(settings);
        Some(intake)
    }
}

impl Source for Came {
    fn next(&mut self) -> Option<Intake> {
        self.pop()
    }

    fn changed(&mut self) -> Option<(Settings, Late)> {
        Some((self.changes.pop_front()??, Late::Merge))
    }

    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize) {
        while waiting.len() < most
            && let Some(intake) = self.pop()
        {
            waiting.push_back(intake);
        }
    }
}

fn scene() -> Scene {
    let text = "pack: {file: none.csv}\n\
                contact: {friction: {coefficient: 0.3}}\n\
                node: {stale_after: 1.0, hold_after: [not_converged], late: merge}\n";
    scene::parse(text, Path::new("scene.yaml")).unwrap()
}

/// Three grains in a row that touch, and the walls.
fn pack() -> Pack {
    let (young, poisson, density, friction) = (70e9, 0.2, 2.5e3, 0.3);
    let grain = |k: i32| Grain {
        position: [1.0e-5 * f64::from(k), 0.0, 1.999e-3 * f64::from(k)],
        radius: 1e-3,
        young,
        poisson,
        density,
        friction,
        hydrate: false,
    };
    let half = [0.9995e-3, 0.9995e-3, 2.998e-3];
    let bounds = Bounds { min: half.map(|half| -half), max: half };
    Pack { bounds, grains: [-1, 0, 1].map(grain).into(), history: None }
}

fn target() -> impl Strategy<Value = WallTarget> {
    prop_oneof![
        3 => Just(WallTarget::Keep),
        3 => (-2e-6..4e-6).prop_map(WallTarget::Displacement),
        1 => (1e3..1e5).prop_map(WallTarget::Stress),
        1 => Just(WallTarget::Displacement(f64::NAN)),
        1 => Just(WallTarget::Unknown(9, 0.0)),
    ]
}

fn any_command() -> impl Strategy<Value = Command> {
    let ask = prop_oneof![
        4 => prop::array::uniform6(-2e-6..4e-6).prop_map(Ask::Displacement),
        1 => prop::array::uniform6(target()).prop_map(Ask::Targets),
        1 => Just(Ask::Displacement([1.0; 6])),
    ];
    let mode = prop_oneof![6 => Just(Mode::Absolute), 2 => Just(Mode::Increment), 1 => Just(Mode::Unknown(7))];
    let age = prop_oneof![2 => Just(None), 2 => Just(Some(0.5)), 1 => (1.1..9.0).prop_map(Some)];
    ("[ab]", 1u64..12, mode, ask, age).prop_map(|(session, sequence, mode, ask, age)| {
        let stamp = Stamp { sec: sequence as i32, nanosec: 0 };
        Command { stamp, session, sequence, mode, ask, age }
    })
}

/// Commands of a session that lead one wall on, as they are merged.
fn ramp() -> impl Strategy<Value = Vec<Intake>> {
    ("[cd]", 1u64..5, 2u64..5, 1e-8..2e-7).prop_map(
        |(session, first, count, step): (String, _, _, f64)| {
            let command = |sequence: u64| Command {
                stamp: Stamp { sec: sequence as i32, nanosec: 0 },
                session: session.clone(),
                sequence,
                mode: Mode::Absolute,
                ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, 0.0, step * sequence as f64]),
                age: None,
            };
            (first..first + count).map(|sequence| Intake::Command(command(sequence))).collect()
        },
    )
}

fn intakes() -> impl Strategy<Value = Vec<Intake>> {
    let ask = |request: Request| vec![Intake::Request(Asked::new(request, |_| {}))];
    // An intake cannot be cloned, which `Just` would do.
    prop_oneof![
        6 => any_command().prop_map(|command| vec![Intake::Command(command)]),
        3 => ramp(),
        1 => any_command().prop_map(|command| vec![Intake::Malformed(command, "no joint".into())]),
        1 => any::<bool>().prop_map(move |held| ask(Request::Hold(held))),
        1 => any::<bool>().prop_map(move |faults| {
            ask(if faults { Request::ResetFaults } else { Request::Reset })
        }),
    ]
}

fn settings() -> impl Strategy<Value = Option<Settings>> {
    let limit = || prop_oneof![2 => Just(0.0), 1 => 1e-7..1e-5];
    let some = (limit(), limit(), any::<bool>(), 1e-10..1e-7).prop_map(
        |(travel, rate, clamp, tolerance)| {
            let limits = Limits { travel, rate, clamp, ..Limits::default() };
            Some(Settings { stale_after: 1.0, limits, tolerance, max_strain_increment: 2e-4 })
        },
    );
    prop_oneof![9 => Just(None), 1 => some]
}

/// Records what the program answers; returns how many answers there were.
fn record(folder: &Path, came: Vec<Comes>) -> u64 {
    let (scene, pack) = (scene(), pack());
    let mut twin = Twin::new(&scene, &pack, 1).unwrap();
    let texts = pack::texts(&pack, "pack.history.json").unwrap();
    let provenance = Provenance {
        scene: scene.to_yaml().unwrap(),
        pack_csv: texts.csv.into_bytes(),
        pack_json: texts.json.into_bytes(),
        pack_history: None,
        threads: 1,
        seed: 0,
        painter: Some(Painter::new(&scene, &pack.bounds, pack.grains.len())),
    };
    let mut recorder = Recorder::create(folder, &scene.record, &provenance).unwrap();
    let mut source = Came { waiting: came.into(), changes: VecDeque::new() };
    let mut count = Count(&mut recorder, 0);
    {
        let mut sinks: Vec<Box<dyn Sink + '_>> = vec![Box::new(&mut count)];
        let how = (scene.outputs, Late::Merge);
        start(&mut twin, how.0, &mut sinks).unwrap();
        serve(&mut twin, how, &mut source, &mut sinks, &AtomicBool::new(false));
    }
    let answers = count.1;
    recorder.close_with(Closing { increment: twin.increment(), digest: twin.digest() });
    recorder.finish().unwrap();
    answers
}

struct Count<'a>(&'a mut Recorder, u64);

impl Sink for &mut Count<'_> {
    fn demand(&self) -> Demand {
        self.0.demand()
    }

    fn served(&mut self, served: &Arc<Served>) {
        self.1 += 1;
        self.0.served(served);
    }

    fn happened(&mut self, happened: &Happened) {
        self.0.happened(happened);
    }
}

/// Replays on `threads`; returns what was compared.
fn verify(folder: &Path, threads: usize) -> Compared {
    let bag = Bag::open(folder).unwrap();
    let replay = Replay::open(&bag, None).unwrap();
    let mut twin = Twin::new(&replay.scene, &replay.pack, threads).unwrap();
    let painter = Painter::new(&replay.scene, &replay.pack.bounds, replay.pack.grains.len());
    let mut compared = Compared::default();
    let mut tape = replay.tape();
    for step in &mut tape {
        let step = step.unwrap();
        let (mut served, said) = step.play(&mut twin, step.demand());
        compared.request(&step, said.as_ref()).unwrap_or_else(|found| panic!("{found}"));
        compared.answers(&step, &mut served, &painter).unwrap_or_else(|found| panic!("{found}"));
    }
    assert!(!tape.is_cut_off());
    compared.closing(tape.closing().unwrap(), &twin.digest()).unwrap();
    compared
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_came_is_answered_again_with_the_same_bits(
        groups in prop::collection::vec((intakes(), settings()), 0..25),
        portable in any::<bool>(),
    ) {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("run");
        let came = groups.into_iter().flat_map(|(intakes, settings)| {
            let first = [settings].into_iter().chain(std::iter::repeat(None));
            intakes.into_iter().zip(first).collect::<Vec<_>>()
        });
        let answers = record(&folder, came.collect());
        // Where the machine has only these, they are compared with themselves.
        let used = lanes::kernels();
        if portable {
            lanes::choose("portable").unwrap();
        }
        let compared = verify(&folder, 2);
        lanes::choose(used).unwrap();
        prop_assert_eq!(compared.answers, answers);
    }
}

#[test]
fn merged_commands_and_those_that_were_too_old_are_told_apart_on_the_tape() {
    let parent = tempfile::tempdir().unwrap();
    let folder = parent.path().join("run");
    let command = |sequence: u64, way: f64, age| {
        let command = Command {
            stamp: Stamp { sec: sequence as i32, nanosec: 0 },
            session: "a".into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement([0.0, 0.0, 0.0, 0.0, 0.0, way]),
            age,
        };
        (Intake::Command(command), None)
    };
    let came = vec![
        command(1, 1e-7, None),
        command(2, 2e-7, None),
        command(3, 3e-7, Some(0.5)),
        command(4, 4e-7, Some(2.5)),
        command(5, 2e-7, None),
    ];
    assert_eq!(record(&folder, came), 6);
    let bag = Bag::open(&folder).unwrap();
    let replay = Replay::open(&bag, None).unwrap();
    let acts: Vec<Act> = replay.tape().map(|step| step.unwrap().act).collect();
    let shape: Vec<String> = acts
        .iter()
        .map(|act| match act {
            Act::Merge(commands) => format!("merge {}", commands.len()),
            Act::Serve(command) => format!("serve {} {:?}", command.sequence, command.age),
            other => format!("{other:?}"),
        })
        .collect();
    assert_eq!(shape, ["Start", "merge 3", "serve 4 Some(2.5)", "serve 5 None"]);
}

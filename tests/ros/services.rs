//! The node's services, diagnostics, frames, time, and the comparison with a real rig, with peers
//! of two middlewares.

use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;

use futures::StreamExt;
use futures::future::{join, join3};
use graintwin::command::Command;
use graintwin::command::request::{Answer, Asked, Intake, Request};
use graintwin::msg::services::{
    Done, SavePack, SavePackRequest, SetBool, SetBoolRequest, Trigger, TriggerRequest,
};
use graintwin::msg::{DiagnosticArray, topics};
use graintwin::node::{Node, Setup, Summary};
use graintwin::report::Demand;
use graintwin::scene::{self, MeasuredWrench, Outputs, ServiceMapping};
use graintwin::sink::{Beside, Recording, RecordingState, Served, Sink};
use graintwin::wall;
use serde_json::{Value, json};

use crate::made_up::MadeUpTwin;
use crate::network::{Loopback, alone};
use crate::partner::Partner;
use crate::script::{alone_with_peer, perform};

/// A node with a made-up twin on a thread of its own, which answers until it is stopped.
struct Running {
    stop: Arc<AtomicBool>,
    thread: thread::JoinHandle<Outcome>,
}

/// What came to it, and what it served.
struct Outcome {
    requests: Vec<Request>,
    commands: Vec<Command>,
    served: Vec<Arc<Served>>,
    summary: Summary,
}

impl Running {
    fn start(options: &scene::Node, recording: Option<Arc<dyn Recording>>) -> Self {
        let stop = Arc::<AtomicBool>::default();
        let mut node = Node::start(options, Setup::default(), &Outputs::default(), &stop).unwrap();
        node.diagnose("probe 7", recording);
        let thread = thread::spawn(move || {
            let mut twin = MadeUpTwin::new(3);
            let mut sink = node.sink();
            let mut served = vec![twin.start(Demand::ALL)];
            sink.served(&served[0]);
            let (mut requests, mut commands) = (Vec::new(), Vec::new());
            for intake in node.commands() {
                match intake {
                    Intake::Command(command) => {
                        served.push(twin.apply(&command, sink.demand()));
                        sink.served(served.last().unwrap());
                        commands.push(command);
                    }
                    Intake::Malformed(command, text) => panic!("{command:?}: {text}"),
                    Intake::Request(asked) => {
                        requests.push(asked.request.clone());
                        let said = nearly_all(&asked.request);
                        asked.answer(said);
                    }
                }
            }
            Outcome { requests, commands, served, summary: node.stop() }
        });
        Self { stop, thread }
    }

    fn end(self) -> Outcome {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.join().unwrap()
    }
}

/// A recording that keeps everything.
#[derive(Default)]
struct Kept(Mutex<Vec<Beside>>);

impl Recording for Kept {
    fn beside(&self, beside: Beside) {
        self.0.lock().unwrap().push(beside);
    }

    fn state(&self) -> RecordingState {
        RecordingState::default()
    }
}

/// Does everything but a reset of faults.
fn nearly_all(request: &Request) -> Answer {
    match request {
        Request::ResetFaults => Err("there is no fault: ü".into()),
        request => Ok(format!("done: {request:?}")),
    }
}

/// What the tests below ask, in order.
fn every_request() -> [Request; 6] {
    [
        Request::Hold(true),
        Request::Hold(false),
        Request::Reset,
        Request::ResetFaults,
        Request::SavePack("packs/ü 1.csv".into()),
        Request::SavePack(String::new().into()),
    ]
}

#[test]
fn a_cyclone_peer_gets_an_answer_of_every_service_in_the_mapping_of_its_middleware() {
    alone_with_peer(
        a_cyclone_peer_gets_an_answer_of_every_service_in_the_mapping_of_its_middleware,
        |python| {
            let options =
                scene::Node { service_mapping: ServiceMapping::Cyclone, ..scene::Node::default() };
            let node = Running::start(&options, None);
            let received = perform(
                python,
                &json!({"listen": {}, "steps": [
                    {"call": "hold", "fields": {"data": true}},
                    {"call": "hold", "fields": {"data": false}},
                    {"call": "reset", "fields": {}},
                    {"call": "reset_faults", "fields": {}},
                    {"call": "save_pack", "fields": {"path": "packs/ü 1.csv"}},
                    {"call": "save_pack", "fields": {"path": ""}},
                ]}),
            );
            let outcome = node.end();
            assert_eq!(outcome.requests, every_request());
            let answers = received["calls"].as_array().unwrap();
            assert_eq!(answers.len(), every_request().len());
            for (answer, request) in answers.iter().zip(every_request()) {
                let expected = nearly_all(&request);
                assert_eq!(answer["success"], expected.is_ok(), "{request:?}");
                assert_eq!(answer["message"], expected.unwrap_or_else(|text| text));
            }
            assert!(!outcome.summary.data_lost(), "{:?}", outcome.summary);
        },
    );
}

#[test]
fn a_node_of_the_other_mapping_gets_an_answer_of_every_service() {
    alone(a_node_of_the_other_mapping_gets_an_answer_of_every_service, Loopback::Multicast, || {
        let options =
            scene::Node { service_mapping: ServiceMapping::Enhanced, ..scene::Node::default() };
        let node = Running::start(&options, None);
        let mut partner = Partner::new();
        let hold = partner.client::<SetBool>("hold");
        let reset = partner.client::<Trigger>("reset");
        let reset_faults = partner.client::<Trigger>("reset_faults");
        let save_pack = partner.client::<SavePack>("save_pack");
        partner.find(&hold);
        partner.find(&reset);
        partner.find(&reset_faults);
        partner.find(&save_pack);
        let nothing = TriggerRequest::default();
        let save = |path: &str| SavePackRequest { path: path.into() };
        let answers = partner.wait(async {
            [
                hold.async_call_service(SetBoolRequest { data: true }).await.unwrap(),
                hold.async_call_service(SetBoolRequest { data: false }).await.unwrap(),
                reset.async_call_service(nothing).await.unwrap(),
                reset_faults.async_call_service(nothing).await.unwrap(),
                save_pack.async_call_service(save("packs/ü 1.csv")).await.unwrap(),
                save_pack.async_call_service(save("")).await.unwrap(),
            ]
        });
        assert_eq!(node.end().requests, every_request());
        let expected = every_request().map(|request| {
            let answer = nearly_all(&request);
            let success = answer.is_ok();
            Done { success, message: answer.unwrap_or_else(|text| text) }
        });
        assert_eq!(answers, expected);
    });
}

/// What the value called `key` of the part called `name` is.
fn value(array: &DiagnosticArray, name: &str, key: &str) -> Option<String> {
    let status = array.status.iter().find(|status| status.name == name)?;
    status.values.iter().find(|value| value.key == key).map(|value| value.value.clone())
}

#[test]
fn requests_wait_for_a_busy_solver_and_are_refused_when_the_node_stops() {
    alone(
        requests_wait_for_a_busy_solver_and_are_refused_when_the_node_stops,
        Loopback::Multicast,
        || {
            let stop = Arc::<AtomicBool>::default();
            let mut node =
                Node::start(&scene::Node::default(), Setup::default(), &Outputs::default(), &stop)
                    .unwrap();
            node.diagnose("probe 7", None);
            let mut partner = Partner::new();
            let (reset, hold) =
                (partner.client::<Trigger>("reset"), partner.client::<SetBool>("hold"));
            let save_pack = partner.client::<SavePack>("save_pack");
            let diagnostics = partner.subscribe::<DiagnosticArray>(&topics::DIAGNOSTICS);
            partner.find(&reset);
            partner.find(&hold);
            partner.find(&save_pack);

            let (done, held, saved) = thread::scope(|scope| {
                let asking = scope.spawn(|| {
                    let save = SavePackRequest { path: "a.csv".into() };
                    partner.wait(join(
                        reset.async_call_service(TriggerRequest::default()),
                        join3(
                            hold.async_call_service(SetBoolRequest { data: true }),
                            save_pack.async_call_service(save),
                            async {
                                let mut arrays = pin!(diagnostics.async_stream());
                                while let Some(Ok((array, _))) = arrays.next().await {
                                    let waiting = value(&array, "graintwin: intake", "waiting");
                                    if waiting.unwrap() == "3" {
                                        // Nobody serves them until now.
                                        stop.store(true, Ordering::Relaxed);
                                        return;
                                    }
                                }
                            },
                        ),
                    ))
                });
                while !stop.load(Ordering::Relaxed) {
                    thread::sleep(Duration::from_millis(5));
                }
                assert!(node.commands().next().is_none());
                node.stop();
                let (done, (held, saved, ())) = asking.join().unwrap();
                (done.unwrap(), held.unwrap(), saved.unwrap())
            });
            for answer in [done, held, saved] {
                assert!(!answer.success);
                assert_eq!(answer.message, "the node stops: nothing was done");
            }
        },
    );
}

#[test]
fn answers_that_come_in_another_order_than_the_requests_find_their_askers() {
    alone(
        answers_that_come_in_another_order_than_the_requests_find_their_askers,
        Loopback::Multicast,
        || {
            let stop = Arc::<AtomicBool>::default();
            let mut node =
                Node::start(&scene::Node::default(), Setup::default(), &Outputs::default(), &stop)
                    .unwrap();
            let mut partner = Partner::new();
            let clients = [0, 1].map(|_| partner.client::<SavePack>("save_pack"));
            clients.iter().for_each(|client| partner.find(client));
            let solver = thread::spawn(move || {
                let mut asked: Vec<Asked> = node
                    .commands()
                    .filter_map(|intake| match intake {
                        Intake::Request(asked) => Some(asked),
                        Intake::Command(_) | Intake::Malformed(..) => None,
                    })
                    .take(2)
                    .collect();
                while let Some(one) = asked.pop() {
                    let Request::SavePack(path) = one.request.clone() else { panic!("{one:?}") };
                    one.answer(Ok(path.display().to_string()));
                }
                node
            });
            let save = |path: &str| SavePackRequest { path: path.into() };
            let (one, two) = partner.wait(join(
                clients[0].async_call_service(save("one")),
                clients[1].async_call_service(save("two")),
            ));
            assert_eq!((one.unwrap().message, two.unwrap().message), ("one".into(), "two".into()));
            solver.join().unwrap().stop();
        },
    );
}

fn stamp(seconds: f64) -> Value {
    let stamp = graintwin::command::Stamp::from_seconds(seconds);
    json!({"sec": stamp.sec, "nanosec": stamp.nanosec})
}

fn command(sequence: usize, seconds: f64) -> Value {
    json!({"publish": "/graintwin/boundary_command", "type": "BoundaryCommand", "fields": {
        "header": {"stamp": stamp(seconds), "frame_id": ""},
        "session": "rig",
        "sequence": sequence,
        "mode": 0,
        "displacement": [0.0, 0.0, 0.0, 0.0, 0.0, 1e-9 * sequence as f64],
    }})
}

#[test]
fn a_peer_that_comes_late_gets_the_frames_of_the_walls_and_the_diagnostics_of_every_part() {
    alone_with_peer(
        a_peer_that_comes_late_gets_the_frames_of_the_walls_and_the_diagnostics_of_every_part,
        |python| {
            let node = Running::start(&scene::Node::default(), None);
            // Long after the frames went out; the peer takes longer still to come.
            thread::sleep(Duration::from_secs(1));
            let mut invalid = command(2, 2.0);
            invalid["fields"]["mode"] = 7.into();
            let received = perform(
                python,
                &json!({
                    "listen": {"/tf_static": "TFMessage", "/diagnostics": "DiagnosticArray"},
                    "steps": [
                        command(1, 1.0),
                        invalid,
                        {"wait": "/tf_static", "count": 1},
                        {"wait": "/diagnostics", "count": 4},
                    ],
                }),
            );
            let outcome = node.end();
            let frames = received["/tf_static"].as_array().unwrap();
            assert_eq!(frames.len(), 1);
            let frames = frames[0]["transforms"].as_array().unwrap();
            let position = outcome.served[0].report.measures.as_ref().unwrap().walls.position;
            for (frame, name) in frames.iter().zip(["pack", "pack_view"]) {
                assert_eq!(frame["header"]["frame_id"], "world");
                assert_eq!(frame["child_frame_id"], name);
            }
            for (wall, name) in wall::NAMES.iter().enumerate() {
                // Behind the two frames of the pack.
                let frame = &frames[2 + wall];
                assert_eq!(frame["header"]["frame_id"], "pack");
                assert_eq!(frame["child_frame_id"], format!("wall_{name}"));
                let axis = ["x", "y", "z"][wall / 2];
                assert_eq!(frame["transform"]["translation"][axis], position[wall]);
                let rotation = json!({"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0});
                assert_eq!(frame["transform"]["rotation"], rotation);
            }

            let last = received["/diagnostics"].as_array().unwrap().last().unwrap();
            let last: DiagnosticArray = serde_json::from_value(last.clone()).unwrap();
            let levels: Vec<_> =
                last.status.iter().map(|status| (status.name.as_str(), status.level)).collect();
            assert_eq!(
                levels,
                [
                    ("graintwin: solver", 0),
                    ("graintwin: intake", 1),
                    ("graintwin: recorder", 0),
                    ("graintwin: link", 0),
                ]
            );
            assert!(last.status.iter().all(|status| status.hardware_id == "probe 7"));
            let told = |name, key| value(&last, name, key).unwrap();
            assert_eq!(told("graintwin: solver", "increment"), "1");
            for (key, expected) in
                [("received", "2"), ("accepted", "1"), ("refused: invalid", "1"), ("waiting", "0")]
            {
                assert_eq!(told("graintwin: intake", key), expected, "{key}");
            }
            assert_eq!(told("graintwin: link", "subscriptions to /tf_static"), "1");
            assert_eq!(told("graintwin: link", "subscriptions to report"), "0");
            assert_eq!(last.status[2].message, "off");
        },
    );
}

#[test]
fn the_age_of_a_command_is_counted_on_the_time_that_a_peer_says_it_is() {
    alone_with_peer(the_age_of_a_command_is_counted_on_the_time_that_a_peer_says_it_is, |python| {
        let options = scene::Node { use_sim_time: true, ..scene::Node::default() };
        let node = Running::start(&options, None);
        let clock = json!({
            "publish": "/clock",
            "type": "Clock",
            "fields": {"clock": stamp(100.0)},
        });
        let reports = |count| json!({"wait": "/graintwin/report", "count": count});
        let diagnosed = json!({"wait": "/diagnostics", "count": 2});
        perform(
            python,
            &json!({
                "listen": {
                    "/graintwin/report": "Report",
                    "/diagnostics": "DiagnosticArray",
                },
                "steps": [
                    // The initial equilibrium has a report of its own.
                    command(1, 98.5), reports(2), clock, diagnosed, command(2, 98.5), reports(3),
                ],
            }),
        );
        let ages: Vec<_> = node.end().commands.iter().map(|command| command.age).collect();
        assert_eq!(ages, [None, Some(1.5)]);
    });
}

/// Load cells at the bottom and the top of the rig: the bottom one lags 2 ms and shows -(50 + k) N,
/// the top one is 1 ms early and shows 100 + k N.
#[test]
fn the_twin_is_compared_with_what_a_peer_measures() {
    const COMMANDS: usize = 12;
    const Z_MIN: usize = 4;
    const Z_MAX: usize = 5;
    alone_with_peer(the_twin_is_compared_with_what_a_peer_measures, |python| {
        let mut measured_wrench = MeasuredWrench { max_delay: 0.01, ..MeasuredWrench::default() };
        measured_wrench.walls[Z_MIN] = true;
        measured_wrench.walls[Z_MAX] = true;
        let options = scene::Node { measured_wrench, ..scene::Node::default() };
        let kept = Arc::<Kept>::default();
        let node = Running::start(&options, Some(Arc::clone(&kept) as Arc<dyn Recording>));
        let cell = |wall: &str, seconds: f64, force: f64| {
            json!({
                "publish": format!("/graintwin/measured_wrench/{wall}"),
                "type": "WrenchStamped",
                "fields": {
                    "header": {"stamp": stamp(seconds), "frame_id": format!("wall_{wall}")},
                    "wrench": {
                        "force": {"x": 7.0, "y": -8.0, "z": force},
                        "torque": {"x": 0.0, "y": 0.0, "z": 0.0},
                    },
                },
            })
        };
        let mut steps = Vec::new();
        for number in 1..=COMMANDS {
            let (time, k) = (0.1 * number as f64, number as f64);
            let mut these = [
                cell("z_min", time + 0.002, -50.0 - k),
                command(number, time),
                cell("z_max", time - 0.001, 100.0 + k),
            ];
            // Now the one, now the other comes first.
            these.rotate_left(number % 3);
            steps.extend(these);
        }
        steps.push(json!({"wait": "/graintwin/discrepancy", "count": COMMANDS + 1}));
        let received = perform(
            python,
            &json!({"listen": {"/graintwin/discrepancy": "Discrepancy"}, "steps": steps}),
        );
        let outcome = node.end();
        let found = received["/graintwin/discrepancy"].as_array().unwrap();
        assert_eq!(found.len(), COMMANDS + 1);
        let number = |message: &Value, field: &str, wall: usize| message[field][wall].as_f64();
        for (increment, (message, served)) in found.iter().zip(&outcome.served).enumerate() {
            let measures = served.report.measures.as_ref().unwrap();
            assert_eq!(message["increment"], increment);
            let twin = measures.walls.normal_force;
            assert_eq!(message["twin_force"], json!(twin));
            let measured = increment > 0;
            assert_eq!(message["valid"], json!([false, false, false, false, measured, measured]));
            let k = increment as f64;
            for (wall, rig, delay) in [(Z_MIN, 50.0 + k, 0.002), (Z_MAX, 100.0 + k, -0.001)] {
                let rig = measured.then_some(rig);
                assert_eq!(number(message, "rig_force", wall), rig, "increment {increment}");
                assert_eq!(number(message, "difference", wall), rig.map(|rig| twin[wall] - rig));
                let lag = number(message, "delay", wall);
                assert_eq!(lag.is_some(), measured);
                assert!(lag.is_none_or(|lag| (lag - delay).abs() < 1e-8), "{lag:?}");
            }
            assert_eq!(number(message, "rig_force", 0), None);
        }
        assert!(!outcome.summary.data_lost(), "{:?}", outcome.summary);

        let kept = kept.0.lock().unwrap();
        let of_wall = |wall| {
            let forces = kept.iter().filter_map(move |beside| match beside {
                Beside::Measured(at, sample) if *at == wall => Some(sample.wrench.force.z),
                _ => None,
            });
            forces.collect::<Vec<_>>()
        };
        let sent = |first: f64, step: f64| {
            (1..=COMMANDS).map(|k| first + step * k as f64).collect::<Vec<_>>()
        };
        assert_eq!(of_wall(Z_MIN), sent(-50.0, -1.0));
        assert_eq!(of_wall(Z_MAX), sent(100.0, 1.0));
        let compared = kept.iter().filter_map(|beside| match beside {
            Beside::Discrepancy(message) => Some(serde_json::to_value(message).unwrap()),
            _ => None,
        });
        assert_eq!(compared.collect::<Vec<_>>(), *found, "recorded and published");
    });
}

//! The node and the virtual rig over DDS, with a twin that makes its numbers up.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{self, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use graintwin::command::request::Intake;
use graintwin::command::{Ask, Command, Mode, Stamp};
use graintwin::msg::{self, topics};
use graintwin::node::rig::Rig;
use graintwin::node::{Identity, Node, Setup, Summary};
use graintwin::report::Demand;
use graintwin::scene::{self, Outputs, When};
use graintwin::sink::{Served, Sink};

use crate::listener::Listener;
use crate::made_up::MadeUpTwin;
use crate::network::{Loopback, alone, name_of};
use crate::peer::{self, alone_with_peer};

/// What comes to the node; nothing but commands does.
fn commands(node: &mut Node) -> impl Iterator<Item = Command> {
    node.commands().map(|intake| match intake {
        Intake::Command(command) => command,
        other => panic!("{other:?}"),
    })
}

/// Serves commands until they end, as the program does; returns everything that was served.
fn serve(mut node: Node, mut twin: MadeUpTwin) -> (Vec<Arc<Served>>, Summary) {
    let mut sink = node.sink();
    let mut all = vec![twin.start(sink.demand())];
    sink.served(&all[0]);
    for command in commands(&mut node) {
        let served = twin.apply(&command, sink.demand());
        sink.served(&served);
        all.push(served);
    }
    (all, node.stop())
}

fn start(outputs: &Outputs, stop: &Arc<AtomicBool>) -> Node {
    Node::start(&scene::Node::default(), Setup::default(), outputs, stop).unwrap()
}

fn flag() -> Arc<AtomicBool> {
    Arc::default()
}

fn path(length: u64) -> Vec<Command> {
    (1..=length)
        .map(|sequence| Command {
            stamp: Stamp::from_seconds(6.0 * sequence as f64),
            session: "path".into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement(std::array::from_fn(|wall| {
                1e-7 * (sequence * 6 + wall as u64) as f64
            })),
            age: None,
        })
        .collect()
}

/// Waits for something that must come; a minute is for a machine that is busy with other things.
fn wait_until(what: &str, mut ready: impl FnMut() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(start.elapsed() < Duration::from_secs(60), "waited in vain until {what}");
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn the_virtual_rig_plays_its_path_over_a_plain_loopback_and_ends_the_run() {
    alone(
        the_virtual_rig_plays_its_path_over_a_plain_loopback_and_ends_the_run,
        Loopback::Plain,
        || {
            let stop = flag();
            let node = start(&Outputs::default(), &stop);
            let path = path(2000);
            let rig = Rig::start(
                &scene::Node::default(),
                &Identity::default(),
                path.clone().into(),
                node.end_of_commands(),
                &stop,
            )
            .unwrap();
            let (served, summary) = serve(node, MadeUpTwin::new(100));
            let played = rig.join().unwrap();
            println!("{played:?} {summary:?}");
            assert_eq!((played.sent, played.answered), (path.len(), path.len()));
            assert_eq!(summary.commands, path.len() as u64);
            assert!(!summary.data_lost());
            let commands: Vec<Command> = served
                .iter()
                .filter_map(|served| served.command.clone())
                .map(|command| Command { age: None, ..command })
                .collect();
            assert_eq!(commands, path);
        },
    );
}

#[test]
fn without_a_subscriber_only_the_first_equilibrium_and_the_latched_moduli_are_asked_for() {
    alone(
        without_a_subscriber_only_the_first_equilibrium_and_the_latched_moduli_are_asked_for,
        Loopback::Plain,
        || {
            let ask_of = |outputs: Outputs| {
                let stop = flag();
                let node = start(&outputs, &stop);
                let mut sink = node.sink();
                let first = sink.demand();
                sink.served(&MadeUpTwin::new(10).start(first));
                let later = sink.demand();
                let summary = node.stop();
                assert!(!summary.data_lost(), "{summary:?}");
                assert_eq!(summary.frames + summary.frames_skipped, 0, "{summary:?}");
                (first, later)
            };
            let ask = |contact_network| ask_of(Outputs { contact_network, ..Outputs::default() });
            let only_moduli = Demand { moduli: true, ..Demand::default() };
            // Nobody draws here.
            let all = Demand {
                grains: false,
                grain_motion: false,
                tangent: false,
                snapshots: false,
                ..Demand::ALL
            };
            assert_eq!(ask(When::OnDemand), (all, only_moduli));
            let and_network = Demand { contact_network: true, ..only_moduli };
            assert_eq!(ask(When::Always), (all, and_network));
            let no_network = Demand { contact_network: false, ..all };
            assert_eq!(ask(When::Never), (no_network, only_moduli));
            let ask = |grain_motion| ask_of(Outputs { grain_motion, ..Outputs::default() });
            let and_motion = Demand { grain_motion: true, ..only_moduli };
            assert_eq!(ask(When::Always), (Demand { grain_motion: true, ..all }, and_motion));
            assert_eq!(ask(When::Never), (all, only_moduli));
        },
    );
}

#[test]
fn contact_networks_that_the_network_cannot_carry_are_skipped_and_counted() {
    alone(
        contact_networks_that_the_network_cannot_carry_are_skipped_and_counted,
        Loopback::Plain,
        || {
            const FRAMES: u64 = 100;
            let stop = flag();
            let node = start(&Outputs::default(), &stop);
            let listener = Listener::<msg::ContactNetwork>::new(&topics::CONTACT_NETWORK);
            let mut sink = node.sink();
            let mut twin = MadeUpTwin::new(30_000);
            sink.served(&twin.start(Demand::default()));
            wait_until("the subscriber is seen", || sink.demand().contact_network);
            let served = twin.apply(&path(1)[0], sink.demand());
            for _ in 0..FRAMES {
                sink.served(&served);
            }
            stop.store(true, Ordering::Relaxed);
            let summary = node.stop();
            drop(listener);
            println!("{summary:?}");
            assert_eq!(summary.frames + summary.frames_skipped, FRAMES);
            assert!(summary.frames > 0 && summary.frames_skipped > 0);
            assert!(!summary.data_lost());
        },
    );
}

#[test]
fn subscribers_see_a_stopped_node_leave_long_before_its_lease_ends() {
    const LEASE: Duration = Duration::from_secs(50);
    alone(subscribers_see_a_stopped_node_leave_long_before_its_lease_ends, Loopback::Plain, || {
        let node = start(&Outputs::default(), &flag());
        let listener = Listener::<msg::Report>::new(&topics::REPORT);
        wait_until("the node is seen", || listener.publishers() == 1);
        node.stop();
        let stopped = Instant::now();
        wait_until("the node is gone", || listener.publishers() == 0);
        println!("gone after {:?}", stopped.elapsed());
        assert!(stopped.elapsed() < LEASE / 2);
    });
}

#[test]
fn sigterm_ends_a_node_in_the_middle_of_its_work() {
    const ROLE: &str = "GRAINTWIN_TEST_ROLE";
    if std::env::var_os(ROLE).is_some() {
        let stop = flag();
        let raise = Arc::clone(&stop);
        ctrlc::set_handler(move || raise.store(true, Ordering::Relaxed)).unwrap();
        let mut node = start(&Outputs::default(), &stop);
        let rig = Rig::start(
            &scene::Node::default(),
            &Identity::default(),
            path(1_000_000).into(),
            node.end_of_commands(),
            &stop,
        )
        .unwrap();
        let mut sink = node.sink();
        let mut twin = MadeUpTwin::new(100);
        sink.served(&twin.start(sink.demand()));
        for (index, command) in commands(&mut node).enumerate() {
            if index == 20 {
                eprintln!("busy");
            }
            thread::sleep(Duration::from_millis(2));
            sink.served(&twin.apply(&command, sink.demand()));
        }
        let stopping = Instant::now();
        assert!(!node.stop().data_lost());
        rig.join().unwrap();
        println!("ended {:?} after the last command", stopping.elapsed());
        return;
    }
    alone(sigterm_ends_a_node_in_the_middle_of_its_work, Loopback::Plain, || {
        let mut program = process::Command::new(std::env::current_exe().unwrap())
            .args([
                "--exact",
                name_of(&sigterm_ends_a_node_in_the_middle_of_its_work),
                "--nocapture",
            ])
            .env(ROLE, "node")
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(program.stderr.take().unwrap()).lines();
        assert!(lines.by_ref().map_while(Result::ok).any(|line| line.contains("busy")));
        let pid = program.id().to_string();
        assert!(process::Command::new("kill").args(["-TERM", &pid]).status().unwrap().success());
        let mut status = None;
        for _ in 0..60 * 100 {
            status = program.try_wait().unwrap();
            if status.is_some() {
                break;
            }
            thread::sleep(Duration::from_millis(10));
        }
        if status.is_none() {
            program.kill().unwrap();
        }
        assert!(status.expect("it ends within a minute").success());
    });
}

/// Plays `commands` from a CycloneDDS peer to a node with a made-up twin, and has every message
/// that the peer received compared with what was served.
fn play_from_cyclone(
    python: &Path,
    commands: &[Command],
    twin: MadeUpTwin,
    in_flight: Option<usize>,
) {
    let folder = tempfile::tempdir().unwrap();
    let stop = flag();
    let node = start(&Outputs::default(), &stop);
    let solver = thread::spawn(move || serve(node, twin));
    let played = peer::start(python, folder.path(), commands, in_flight).wait().unwrap();
    stop.store(true, Ordering::Relaxed);
    let (served, summary) = solver.join().unwrap();
    println!("{summary:?}");
    assert!(played.success());
    assert!(!summary.data_lost() && summary.frames_skipped == 0, "{summary:?}");

    let arrived: Vec<&Command> = served.iter().filter_map(|one| one.command.as_ref()).collect();
    assert_eq!(arrived.len(), commands.len());
    for (arrived, sent) in arrived.iter().zip(commands) {
        assert_same(arrived, sent);
    }
    peer::compare(python, folder.path(), &served, &[]);
}

fn change(command: &mut Command, how: impl FnOnce(&mut [f64; 6])) {
    let mut numbers = command.ask.numbers();
    how(&mut numbers);
    command.ask = Ask::Displacement(numbers);
}

/// Every field bit by bit, and an age that fits the clock.
fn assert_same(arrived: &Command, sent: &Command) {
    let bits = |command: &Command| command.ask.numbers().map(f64::to_bits);
    assert_eq!(bits(arrived), bits(sent), "displacement of {}", sent.sequence);
    let rest = |command: &Command| Command {
        ask: Ask::Displacement([0.0; 6]),
        age: None,
        ..command.clone()
    };
    assert_eq!(rest(arrived), rest(sent));
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap().as_secs_f64();
    let age = arrived.age.unwrap();
    assert!((0.0..600.0).contains(&(now - sent.stamp.seconds() - age)), "{age}");
}

#[test]
fn a_cyclone_peer_gets_every_field_of_every_message_of_84_commands_and_the_start() {
    alone_with_peer(
        a_cyclone_peer_gets_every_field_of_every_message_of_84_commands_and_the_start,
        |python| {
            let mut commands = path(84);
            for command in &mut commands {
                command.session = "séance 1".into();
                change(command, |displacement| displacement[1] *= -1.0 / 3.0);
            }
            commands[10].ask =
                Ask::Displacement([-0.0, f64::MIN_POSITIVE / 3.0, f64::MAX, f64::MIN, 1e-300, 0.1]);
            commands[20].mode = Mode::Increment;
            commands[21].mode = Mode::Unknown(7);
            change(&mut commands[30], |displacement| displacement[3] = f64::NAN);
            change(&mut commands[31], |displacement| displacement[4] = f64::INFINITY);
            commands[40].stamp = Stamp { sec: -1, nanosec: 999_999_999 };
            commands[83].sequence = u64::MAX;
            play_from_cyclone(python, &commands, MadeUpTwin::new(1500), Some(4));
        },
    );
}

#[test]
fn a_burst_of_2000_commands_from_a_cyclone_peer_loses_nothing_either_way() {
    alone_with_peer(
        a_burst_of_2000_commands_from_a_cyclone_peer_loses_nothing_either_way,
        |python| {
            play_from_cyclone(python, &path(2000), MadeUpTwin::new(3), None);
        },
    );
}

#[test]
fn a_peer_that_comes_late_gets_the_last_moduli_and_nothing_else() {
    alone_with_peer(a_peer_that_comes_late_gets_the_last_moduli_and_nothing_else, |python| {
        let node = start(&Outputs::default(), &flag());
        let mut sink = node.sink();
        let mut twin = MadeUpTwin::new(10);
        sink.served(&twin.start(sink.demand()));
        for command in path(20) {
            sink.served(&twin.apply(&command, sink.demand()));
        }

        let folder = tempfile::tempdir().unwrap();
        assert!(peer::start(python, folder.path(), &[], None).wait().unwrap().success());
        node.stop();

        let file = fs::File::open(peer::received(folder.path())).unwrap();
        let received: serde_json::Map<String, serde_json::Value> =
            serde_json::from_reader(file).unwrap();
        for (topic, messages) in received {
            let messages = messages.as_array().unwrap();
            let last = messages.last().map(|message| message["increment"].as_u64());
            let expected = (topic == "moduli").then_some(Some(20));
            assert_eq!(last, expected, "{topic}");
        }
    });
}

#[test]
fn a_killed_subscriber_holds_messages_up_but_not_the_end_and_what_it_cost_is_counted() {
    alone_with_peer(
        a_killed_subscriber_holds_messages_up_but_not_the_end_and_what_it_cost_is_counted,
        |python| {
            let stop = flag();
            let node = start(&Outputs::default(), &stop);
            let mut sink = node.sink();
            let mut twin = MadeUpTwin::new(0);
            sink.served(&twin.start(Demand::default()));

            let folder = tempfile::tempdir().unwrap();
            let mut subscriber = peer::start(python, folder.path(), &[], None);
            wait_until("the subscriber is seen", || sink.demand().state);
            subscriber.kill().unwrap();
            subscriber.wait().unwrap();

            // More than the window of unacknowledged samples.
            let commands = path(10_000);
            let mut events = 0;
            for command in &commands {
                let answer = twin.apply(command, Demand::default());
                events += answer.report.measures.as_ref().map_or(0, |m| m.events.len() as u64);
                sink.served(&answer);
            }
            stop.store(true, Ordering::Relaxed);
            let summary = node.stop();
            println!("{summary:?}");
            assert!(summary.lost > 0 && summary.data_lost(), "{summary:?}");
            // The frames of the walls go out once.
            let queued = 1 + (1 + commands.len() as u64) * 9 + events;
            assert_eq!(summary.published + summary.lost, queued);
        },
    );
}

//! How long a rig waits for the forces of its command: `cargo bench --bench latency [SECONDS]`.
//!
//! The program serves a pack; a rig in another process sends it a command every 10 ms, which
//! strains the pack by 1e-6 more or less than the one before, and takes the time from there to
//! the arrival of the `~/wall_forces` of that command, or, where the twin merges late ones, of the
//! one that it was merged into. Where it may, the benchmark makes a network
//! of its own; elsewhere it goes to a DDS domain that few use, on loopback.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a benchmark reports on stdout and says on stderr what it is at"
)]

use std::error::Error;
use std::fs::{self, File};
use std::net::Ipv4Addr;
use std::path::Path;
use std::pin::pin;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use futures::StreamExt;
use futures::future::{Either, select};
use graintwin::msg::{BoundaryCommand, ContactNetwork, Header, Time, Topic, WallForces, topics};
use ros2_client::dds::rustdds::DomainParticipantBuilder;
use ros2_client::qos::{History, WhenFull};
use ros2_client::{
    Context, Message, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, QosProfile,
    Subscription,
};
use tokio::runtime::{Builder, Runtime};
use tokio::time::{interval, sleep, timeout};

/// Set in the process that measures.
const INSIDE: &str = "GRAINTWIN_BENCH_NETWORK";

/// From one command to the next.
const PERIOD: Duration = Duration::from_millis(10);

/// Strain from one command to the next.
const STRAIN: f64 = 1e-6;

/// Commands from one turn of the rig to the next.
const LEG: u64 = 10;

/// Commands of each measurement, unless the command line says otherwise \[s\].
const SECONDS: u64 = 20;

/// Longest wait for the program to be found, and for its last answer.
const PATIENCE: Duration = Duration::from_secs(60);

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    if std::env::var_os(INSIDE).is_none() {
        return enter();
    }
    // cargo adds arguments of its own.
    let seconds = std::env::args().skip(1).find_map(|text| text.parse().ok()).unwrap_or(SECONDS);
    println!(
        "grains  friction  late   recorder and network       p50       p99     worst  missed   of"
    );
    for grains in [306, 2740] {
        let folder = tempfile::tempdir()?;
        let side = make_pack(folder.path(), grains)?;
        for friction in [false, true] {
            for (late, busy) in [("every", false), ("every", true), ("merge", false)] {
                write_scene(folder.path(), friction, late)?;
                eprintln!("{grains} grains, friction {friction}, {late}, recorder {busy}");
                let program = Program::start(folder.path(), busy)?;
                let mut times = Rig::new(busy)?.measure(side, seconds)?;
                drop(program);
                times.sort();
                let share = |share: f64| {
                    let rank = (share * times.len() as f64).ceil() as usize;
                    times[rank.saturating_sub(1)]
                };
                println!(
                    "{grains:>6}  {:>8}  {late:>5}  {:>20}  {:>8.3?}  {:>8.3?}  {:>8.3?}  {:>6}  {:>3}",
                    if friction { "0.3" } else { "none" },
                    if busy { "on" } else { "off" },
                    share(0.5),
                    share(0.99),
                    share(1.0),
                    times.iter().filter(|time| **time > PERIOD).count(),
                    times.len(),
                );
            }
        }
    }
    Ok(())
}

/// Starts the benchmark again in a network of its own.
fn enter() -> Result<(), Failure> {
    const SET_UP: &str = "ip link set lo up && ip link set lo multicast on \
                          && ip route add 224.0.0.0/4 dev lo && exec \"$0\" \"$@\"";
    let itself = std::env::current_exe()?;
    let can = |flag: &&str| {
        let probe = Command::new("unshare").args([flag, "true"]).stderr(Stdio::null()).status();
        probe.is_ok_and(|status| status.success())
    };
    let mut command = match ["-n", "-rn"].iter().find(|flag| can(flag)) {
        Some(flag) => {
            let mut command = Command::new("unshare");
            command.args([flag, "sh", "-c", SET_UP]).arg(&itself).env_remove("ROS_DOMAIN_ID");
            command
        }
        None => {
            let mut command = Command::new(&itself);
            command.env("ROS_DOMAIN_ID", "97");
            command
        }
    };
    match command.args(std::env::args().skip(1)).env(INSIDE, "1").status()?.success() {
        true => Ok(()),
        false => Err("the measurement failed".into()),
    }
}

/// Makes a pack of `grains` grains with a coefficient of friction, which counts where the scene has
/// friction, in `folder`; returns the length of its box along z \[m\].
fn make_pack(folder: &Path, grains: u32) -> Result<f64, Failure> {
    let scene = format!(
        "pack: {{generate: {{grains: {grains}, radius: {{uniform: [0.07e-3, 0.13e-3]}}, \
         material: glass, confining_stress: 10.0e6}}}}\n\
         contact: {{friction: {{coefficient: 0.3}}}}\n"
    );
    fs::write(folder.join("made.yaml"), scene)?;
    let made = Command::new(env!("CARGO_BIN_EXE_graintwin"))
        .current_dir(folder)
        .args(["generate", "made.yaml", "--out", "pack.csv", "--quiet"])
        .stdout(Stdio::null())
        .status()?;
    if !made.success() {
        return Err(format!("no pack of {grains} grains: {made}").into());
    }
    let beside: serde_json::Value = serde_json::from_slice(&fs::read(folder.join("pack.json"))?)?;
    let at = |end: &str| beside["box"][end][2].as_f64().ok_or("a box of six numbers");
    Ok(at("max")? - at("min")?)
}

fn write_scene(folder: &Path, friction: bool, late: &str) -> Result<(), Failure> {
    let friction = if friction { "{coefficient: 0.3}" } else { "none" };
    let scene = format!(
        "pack: {{file: pack.csv}}\ncontact: {{friction: {friction}}}\nnode: {{late: {late}}}\n"
    );
    Ok(fs::write(folder.join("scene.yaml"), scene)?)
}

/// The program as a node, killed when it is dropped: nothing of it is needed then.
struct Program(Child);

impl Program {
    fn start(folder: &Path, recording: bool) -> Result<Self, Failure> {
        let bag = folder.join("bag");
        if bag.exists() {
            fs::remove_dir_all(&bag)?;
        }
        let child = Command::new(env!("CARGO_BIN_EXE_graintwin"))
            .current_dir(folder)
            // The other core is the middleware's and the rig's.
            .args(["run", "scene.yaml", "--ros", "--quiet", "--threads", "1"])
            .args(if recording { &["--record", "bag"][..] } else { &[] })
            .stdout(Stdio::null())
            .stderr(File::create(folder.join("log"))?)
            .spawn()?;
        Ok(Self(child))
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // An error says that it has ended.
        self.0.kill().ok();
        self.0.wait().ok();
    }
}

/// The rig's end of the wire. Fields drop in this order, as they must.
struct Rig {
    commands: Publisher<BoundaryCommand>,
    forces: Subscription<WallForces>,
    networks: Option<Subscription<ContactNetwork>>,
    node: Node,
    runtime: Runtime,
    _context: Context,
}

impl Rig {
    /// A rig that also listens to the contact network when `networks` says so.
    fn new(networks: bool) -> Result<Self, Failure> {
        let domain = std::env::var("ROS_DOMAIN_ID").map_or(Ok(0), |text| text.parse())?;
        let participant = DomainParticipantBuilder::new(domain)
            .with_only_networks([Ipv4Addr::LOCALHOST])
            .build()?;
        let context = Context::from_domain_participant(participant)?;
        let mut node = context.new_node(NodeName::new("/", "rig")?, NodeOptions::new())?;
        let (topic, qos) = endpoint(&node, &topics::BOUNDARY_COMMAND)?;
        let commands = node.create_publisher(&topic, Some(qos))?;
        let forces = subscribe(&mut node, &topics::WALL_FORCES)?;
        let networks = match networks {
            true => Some(subscribe(&mut node, &topics::CONTACT_NETWORK)?),
            false => None,
        };
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_time().build()?;
        let spinner = node.spinner()?;
        runtime.spawn(async {
            if let Err(error) = spinner.spin().await {
                eprintln!("the rig follows nobody: {error}");
            }
        });
        Ok(Self { commands, forces, networks, node, runtime, _context: context })
    }

    /// Sends commands for `seconds` to a pack that is `side` long \[m\]; returns the time to the
    /// answer of each.
    fn measure(self, side: f64, seconds: u64) -> Result<Vec<Duration>, Failure> {
        let Self { commands, forces, networks, node, runtime, _context } = self;
        let count = seconds * 100;
        let times = runtime.block_on(async {
            let found = async {
                while commands.get_subscription_count(&node) == 0
                    || forces.get_publisher_count(&node) == 0
                {
                    sleep(PERIOD).await;
                }
            };
            timeout(PATIENCE, found).await.map_err(|_| "the program was not found")?;
            // The program has to find the rig, too.
            sleep(Duration::from_millis(500)).await;
            let draining = async {
                if let Some(networks) = &networks {
                    networks.async_stream().for_each(|_| async {}).await;
                }
                std::future::pending::<()>().await;
            };
            let exchange = exchange(&commands, &forces, side, count);
            match select(pin!(exchange), pin!(draining)).await {
                Either::Left((times, _)) => times,
                Either::Right(((), _)) => Err("the contact networks ended".into()),
            }
        });
        drop((commands, forces, networks, node));
        times
    }
}

/// Publishes `count` commands on time and takes their answers.
async fn exchange(
    commands: &Publisher<BoundaryCommand>,
    forces: &Subscription<WallForces>,
    side: f64,
    count: u64,
) -> Result<Vec<Duration>, Failure> {
    let sending = async {
        let mut tick = interval(PERIOD);
        let mut sent = Vec::new();
        for sequence in 1..=count {
            tick.tick().await;
            sent.push(Instant::now());
            if commands.async_publish(command(sequence, side)).await.is_err() {
                return Err(Failure::from(format!("command {sequence} was not published")));
            }
        }
        Ok(sent)
    };
    let receiving = async {
        let mut come = Vec::new();
        let mut answers = pin!(forces.async_stream());
        while (come.len() as u64) < count {
            let limit = Duration::from_secs(count / 100) + PATIENCE;
            let answer =
                timeout(limit, answers.next()).await.map_err(|_| "an answer is missing")?;
            let (answer, _) = answer.ok_or("the answers ended")??;
            // The stamp of the start is before that of any command.
            let answered = u64::from(answer.header.stamp.nanosec);
            while (come.len() as u64) < answered {
                come.push(Instant::now());
            }
        }
        Ok(come)
    };
    let (sent, come) = futures::try_join!(sending, receiving)?;
    Ok(come.iter().zip(&sent).map(|(come, sent)| *come - *sent).collect())
}

/// A command that goes up and down with the others; its stamp is its number.
fn command(sequence: u64, side: f64) -> BoundaryCommand {
    let phase = sequence % (2 * LEG);
    let steps = if phase <= LEG { phase } else { 2 * LEG - phase };
    BoundaryCommand {
        header: Header { stamp: Time { sec: 0, nanosec: sequence as u32 }, ..Header::default() },
        session: "latency".into(),
        sequence,
        mode: 0,
        displacement: [0.0, 0.0, 0.0, 0.0, 0.0, steps as f64 * STRAIN * side],
    }
}

fn subscribe<M: Message + 'static>(
    node: &mut Node,
    topic: &Topic,
) -> Result<Subscription<M>, Failure> {
    let (topic, qos) = endpoint(node, topic)?;
    Ok(node.create_subscription(&topic, Some(qos))?)
}

fn endpoint(
    node: &Node,
    topic: &Topic,
) -> Result<(ros2_client::dds::rustdds::Topic, QosProfile), Failure> {
    let name = Name::parse(&topic.recorded_name())?;
    let kind = MessageTypeName::new(topic.kind.package, topic.kind.name);
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(Duration::from_secs(1)))
        .history(History::KeepLast { depth: 1000 });
    Ok((node.create_topic(&name, kind, &qos)?, qos))
}

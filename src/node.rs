//! The twin as a ROS 2 node over DDS: commands in, answers out.
//!
//! The node is `/graintwin` until [`args`] rename it; its topics, with their types and qualities of
//! service, are those of [`crate::msg::topics`]. It needs no ROS 2 installation. Who does what:
//!
//! ```text
//! topic -> receive task -> bounded queue -> solver's thread -> queue -> outbox task -> topics
//!                                                                          |
//!                                                                    frames task -> contact network
//!                                                                    easel -> pictures
//! ```
//!
//! Requests of the services go the way of the commands, and their responses back from the solver's
//! thread. What the load cells of a real rig measure is paired with the twin's answers by the
//! tasks that receive it.
//!
//! The tasks run on two threads of the node's own. Commands are never dropped on their way to the
//! solver; messages are never dropped on their way out, except contact networks and pictures, of
//! which only as many go out as the network carries. The solver's thread waits for commands and for nothing
//! else.
//!
//! ```no_run
//! # use std::sync::{Arc, atomic::AtomicBool};
//! # use graintwin::{command::request::Intake, report::Demand, scene};
//! # use graintwin::node::{Node, Setup};
//! # use graintwin::sink::{Served, Sink};
//! # fn run(
//! #     scene: &scene::Scene,
//! #     serve: fn(&Intake, Demand) -> Arc<Served>,
//! # ) -> Result<(), graintwin::node::NodeError> {
//! let stop = Arc::new(AtomicBool::new(false)); // raised by SIGINT and SIGTERM
//! let mut node = Node::start(&scene.node, Setup::default(), &scene.outputs, &stop)?;
//! let mut sink = node.sink();
//! for intake in node.commands() {
//!     sink.served(&serve(&intake, sink.demand()));
//! }
//! let summary = node.stop();
//! # Ok(()) }
//! ```

pub mod args;
mod clock;
mod commands;
mod counters;
mod diagnostics;
mod discrepancy;
mod endpoints;
mod frames;
mod health;
mod mapping;
mod names;
mod outbox;
pub mod parameters;
mod participant;
mod pictures;
pub mod rig;
pub mod rosout;
mod services;
mod strangers;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use clock::Clock;
use ros2_client::{Context, NodeName, NodeOptions};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};

use commands::{Age, Intakes};
pub use commands::{Commands, EndOfCommands};
use counters::Counters;
pub use counters::Summary;
use diagnostics::Watched;
use discrepancy::{Comparison, Recorder};
use endpoints::{Endpoints, Sources, Subscriptions};
pub use names::Identity;
pub use outbox::NodeSink;
use outbox::{Item, Outbox};
use parameters::Parameters;
use parameters::services::Services as ParameterServices;
use pictures::Easel;

use rosout::{Records, Rosout};

use crate::command::map::{JointStateMap, TrajectoryMap};
use crate::command::request::Intake;
use crate::msg::{JointState, JointTrajectory};
use crate::scene::{self, Outputs};
use crate::sink::{Beside, Recording};
use crate::view::picture::Painter;

/// Log directives for the middleware, to go before those of the user. At WARN it tells, on a
/// machine where loopback has no multicast, of every message that it then sends another way; the
/// targets that are off do the same at ERROR, as when asked about a publisher that nobody
/// subscribed to yet.
pub const LOG_FILTER: &str = "ros2_client=error,ros2_client::node=off,\
                              rustdds=error,rustdds::dds::pubsub=off,\
                              rustdds::network::udp_listener=off";

/// Threads of the node: one can be busy with a large message while the other takes commands.
const THREADS: usize = 2;

/// How often the stop flag is looked at.
const LOOK: Duration = Duration::from_millis(10);

/// Longest wait at the end for what is still to be published.
const DRAIN: Duration = Duration::from_secs(5);

/// The same when the stop flag is raised: a person or `ros2 launch` waits.
const DRAIN_WHEN_STOPPED: Duration = Duration::from_millis(300);

/// How long a node that has published everything stays, so that subscribers can ask again for
/// samples that they lost: two heartbeats of its publishers.
const LINGER: Duration = Duration::from_millis(200);

/// Longest wait for the background task of the node to end.
const SPINNER_END: Duration = Duration::from_secs(1);

/// Why the node cannot start.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// A domain that does not exist.
    #[error("{origin} is `{found}`: a whole number from 0 to 232 is allowed")]
    DomainOutOfRange {
        /// Key of the scene or name of the variable.
        origin: &'static str,
        /// What it holds.
        found: String,
    },
    /// No participant in the domain.
    #[error("cannot join DDS domain {domain}: {reason}")]
    Domain {
        /// The domain.
        domain: u16,
        /// What the middleware says.
        reason: String,
    },
    /// No threads for the node.
    #[error("cannot start the threads of the node: {0}")]
    Threads(#[from] std::io::Error),
    /// No node.
    #[error("cannot create the ROS 2 node `{name}`: {reason}")]
    Node {
        /// Its name.
        name: String,
        /// What the middleware says.
        reason: String,
    },
    /// No publisher, subscription or service.
    #[error("cannot create {topic}: {reason}")]
    Endpoint {
        /// Full name of the topic or service.
        topic: String,
        /// What the middleware says.
        reason: String,
    },
}

/// What makes this node a particular one.
#[derive(Debug, Default)]
pub struct Setup {
    /// Its name, and those of its topics and services.
    pub identity: Identity,
    /// Its parameters; without them it has no services for any.
    pub parameters: Option<Parameters>,
    /// What goes to `/rosout`; without it nothing does.
    pub log: Option<Records>,
    /// Who draws for `grains` and `markers`; without one nothing is published there.
    pub painter: Option<Painter>,
}

/// The running node. [`Node::stop`] ends it in order; dropping it ends it at once.
pub struct Node {
    commands: Commands,
    end_of_commands: EndOfCommands,
    outbox: mpsc::UnboundedSender<Item>,
    counters: Arc<Counters>,
    comparison: Option<Arc<Comparison>>,
    recorder: Recorder,
    clock: Clock,
    /// Knows how many commands wait, without keeping their queue open.
    queue: mpsc::WeakSender<Intake>,
    outputs: Outputs,
    draws: bool,
    stop: Arc<AtomicBool>,
    tasks: Vec<JoinHandle<()>>,
    spinner: JoinHandle<()>,
    // Last and in this order: endpoints, the runtime whose tasks use them, the context of all.
    endpoints: Arc<Endpoints>,
    runtime: Runtime,
    context: Context,
}

impl Node {
    /// Joins the domain and starts the node's threads. When it returns, every endpoint exists.
    ///
    /// The domain is `options.domain_id`, or `ROS_DOMAIN_ID` of the environment when that is 0.
    /// A raised `stop` ends [`Node::commands`] within milliseconds.
    ///
    /// # Errors
    /// When the domain is out of range or the middleware refuses something.
    pub fn start(
        options: &scene::Node,
        setup: Setup,
        outputs: &Outputs,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, NodeError> {
        let Setup { identity, parameters, log, painter } = setup;
        let (context, undone) = participant::join(options)?;
        let (mut ros_node, spinner) = create(&context, identity.namespace(), identity.name())?;
        let log = match log {
            Some(records) => Some((Rosout::new(&mut ros_node, &identity)?, records)),
            None => None,
        };
        let clock = Clock::new(options.use_sim_time);
        let parameters = match parameters {
            Some(store) => {
                Some((ParameterServices::new(&mut ros_node, &identity, options, &clock)?, store))
            }
            None => None,
        };
        let (endpoints, subscriptions) = Endpoints::new(ros_node, &identity, options)?;
        let endpoints = Arc::new(endpoints);
        let runtime = Builder::new_multi_thread()
            .worker_threads(THREADS)
            .thread_name("ros")
            .enable_time()
            .build()?;
        let counters = Arc::<Counters>::default();

        let spinner = runtime.spawn(spin(spinner));
        let (commands_in, commands_out) = mpsc::channel(commands::WAITING);
        let waiting = commands_in.downgrade();
        let recorder = Recorder::default();
        let intake = Intakes {
            queue: commands_in,
            counters: Arc::clone(&counters),
            clock: clock.clone(),
            recorder: Arc::clone(&recorder),
        };
        let Subscriptions { sources, cells, clock: times, services } = subscriptions;
        let watched = strangers::watched(&identity, options);
        let mut tasks = vec![runtime.spawn(strangers::warn(context.clone(), watched))];
        tasks.extend(times.map(|times| runtime.spawn(clock::follow(times, clock.clone()))));
        tasks.extend(services.start(&runtime, &intake.queue, &counters));
        let receiving = receive(&runtime, sources, options, intake);
        let end_of_commands =
            EndOfCommands(receiving.iter().map(JoinHandle::abort_handle).collect());
        let stopping = runtime.spawn(end_when_stopped(Arc::clone(stop), end_of_commands.clone()));
        let (frames_in, frames_out) = mpsc::unbounded_channel();
        let pacing =
            runtime.spawn(frames::send(frames_out, Arc::clone(&endpoints), Arc::clone(&counters)));
        let easel = Arc::new(Easel::new(Arc::clone(&counters)));
        let draws = painter.is_some();
        tasks.extend(painter.map(|painter| {
            runtime.spawn(pictures::send(Arc::clone(&easel), painter, Arc::clone(&endpoints)))
        }));
        let (outbox_in, outbox_out) = mpsc::unbounded_channel();
        let outbox = Outbox {
            endpoints: Arc::clone(&endpoints),
            frames: frames_in,
            easel,
            counters: Arc::clone(&counters),
        };
        let publishing = runtime.spawn(outbox.run(outbox_out));
        let comparison = options.measured_wrench.cells().map(|mapped| {
            let (outbox, recorder) = (outbox_in.clone(), Arc::clone(&recorder));
            Arc::new(Comparison::new(mapped, outbox, recorder, Arc::clone(&counters)))
        });
        if let Some(comparison) = &comparison {
            for (wall, cell) in cells {
                let comparison = Arc::clone(comparison);
                tasks.push(runtime.spawn(discrepancy::receive(wall, cell, comparison)));
            }
            tasks.push(runtime.spawn(discrepancy::look(Arc::clone(comparison))));
        }
        tasks.extend(receiving.into_iter().chain([stopping, pacing, publishing]));

        if let Some((services, store)) = parameters {
            tasks.extend(services.serve(&runtime, &store, &recorder));
        }
        if let Some((rosout, records)) = log {
            tasks.push(runtime.spawn(rosout.run(records, Arc::clone(&recorder))));
        }
        for sentence in undone {
            tracing::warn!("{sentence}");
        }
        tracing::info!("node {} is in DDS domain {}", identity.full_name(), context.domain_id());
        Ok(Self {
            commands: Commands::new(commands_out, Arc::clone(stop)),
            end_of_commands,
            outbox: outbox_in,
            counters,
            comparison,
            recorder,
            clock,
            queue: waiting,
            outputs: *outputs,
            draws,
            stop: Arc::clone(stop),
            tasks,
            spinner,
            endpoints,
            runtime,
            context,
        })
    }

    /// Where the twin's answers go. One is enough.
    #[must_use]
    pub fn sink(&self) -> NodeSink {
        NodeSink::new(
            self.outbox.clone(),
            &self.endpoints,
            Arc::clone(&self.counters),
            self.comparison.clone(),
            (self.outputs, self.draws),
        )
    }

    /// Tells once a second on `/diagnostics` how everything fares, under the name `hardware_id`.
    /// That goes into the `recording` too, and so does what comes and goes beside the answers.
    pub fn diagnose(&mut self, hardware_id: &str, recording: Option<Arc<dyn Recording>>) {
        if let Some(recording) = recording {
            // Only the first call finds the place empty; a run has one recording.
            self.recorder.set(recording).ok();
        }
        let watched = Watched {
            endpoints: Arc::clone(&self.endpoints),
            counters: Arc::clone(&self.counters),
            commands: self.queue.clone(),
            recorder: Arc::clone(&self.recorder),
            clock: self.clock.clone(),
            hardware_id: hardware_id.into(),
        };
        self.tasks.push(self.runtime.spawn(watched.run()));
    }

    /// The commands of the rig. Waits for each; see [`Commands`] for the end.
    pub fn commands(&mut self) -> &mut Commands {
        &mut self.commands
    }

    /// A handle for whoever knows that the rig is done.
    #[must_use]
    pub fn end_of_commands(&self) -> EndOfCommands {
        self.end_of_commands.clone()
    }

    /// Publishes what is left, within bounds, and leaves the domain: peers see the node go.
    pub fn stop(self) -> Summary {
        let stopped = self.stop.load(Ordering::Relaxed);
        let limit = if stopped { DRAIN_WHEN_STOPPED } else { DRAIN };
        self.end_of_commands.declare();
        // Requests among them are dropped unanswered, and so refused.
        drop(self.commands);
        if let Some(comparison) = &self.comparison {
            comparison.flush();
        }
        self.runtime.block_on(async {
            // Past the limit, the summary counts what is left.
            timeout(limit, drained(&self.outbox, &self.counters)).await.ok();
            if self.endpoints.any_listener() || self.counters.asked.load(Ordering::Relaxed) > 0 {
                sleep(LINGER).await;
            }
            for task in self.tasks {
                task.abort();
                // An error says that it was aborted.
                task.await.ok();
            }
            drop(self.endpoints);
            if timeout(SPINNER_END, self.spinner).await.is_err() {
                tracing::warn!("the node's background task did not end within {SPINNER_END:?}");
            }
        });
        drop(self.context);
        let summary = self.counters.summary();
        if summary.frames_skipped > 0 {
            tracing::warn!(
                "{} contact networks or motions of the grains were not published, {} were: the \
                 network is slower than the twin",
                summary.frames_skipped,
                summary.frames
            );
        }
        if summary.pictures_skipped > 0 {
            tracing::info!(
                "{} pictures were not published, {} were: the network is slower than the twin",
                summary.pictures_skipped,
                summary.pictures
            );
        }
        summary
    }
}

/// Starts a task for each topic that commands come from.
fn receive(
    runtime: &Runtime,
    sources: Sources,
    options: &scene::Node,
    intake: Intakes,
) -> Vec<JoinHandle<()>> {
    let Sources { commands, targets, dissociations, shears, joint_states, joint_trajectory } =
        sources;
    let mut tasks = vec![
        runtime.spawn(intake.clone().receive(commands, commands::of_ours)),
        runtime.spawn(intake.clone().receive(targets, commands::of_ours)),
        runtime.spawn(intake.clone().receive(dissociations, commands::of_ours)),
        runtime.spawn(intake.clone().receive(shears, commands::of_ours)),
    ];
    if let (Some(subscription), Some(map)) = (joint_states, &options.joint_states) {
        let mut map = JointStateMap::new(map);
        let read = move |message: JointState, age: &Age<'_>| {
            [map.intake(&message, age(message.header.stamp.into()))]
        };
        let receiving = intake.clone().receive_and_record(subscription, Beside::JointStates, read);
        tasks.push(runtime.spawn(receiving));
    }
    if let (Some(subscription), Some(map)) = (joint_trajectory, &options.joint_trajectory) {
        let mut map = TrajectoryMap::new(map);
        let read = move |message: JointTrajectory, age: &Age<'_>| {
            map.intakes(&message, age(message.header.stamp.into()))
        };
        let receiving = intake.receive_and_record(subscription, Beside::JointTrajectory, read);
        tasks.push(runtime.spawn(receiving));
    }
    tasks
}

/// A node of `context`, and the background task it needs.
fn create(
    context: &Context,
    namespace: &str,
    name: &str,
) -> Result<(ros2_client::Node, ros2_client::Spinner), NodeError> {
    let failed = |reason: String| NodeError::Node { name: name.into(), reason };
    let node_name = NodeName::new(namespace, name).map_err(|error| failed(error.to_string()))?;
    // The parameter services of the middleware speak to one of the two common RMWs only, and make
    // the tools of the other hang. Its publisher of the log waits for subscribers.
    let options = NodeOptions::new().start_parameter_services(false).enable_rosout(false);
    let mut node =
        context.new_node(node_name, options).map_err(|error| failed(error.to_string()))?;
    let spinner = node.spinner().map_err(|error| failed(error.to_string()))?;
    Ok((node, spinner))
}

async fn spin(spinner: ros2_client::Spinner) {
    if let Err(error) = spinner.spin().await {
        tracing::error!("the node does not follow who comes and goes: {error}");
    }
}

async fn end_when_stopped(stop: Arc<AtomicBool>, commands: EndOfCommands) {
    while !stop.load(Ordering::Relaxed) {
        sleep(LOOK).await;
    }
    commands.declare();
}

/// Returns when everything that was queued is published and every request has its response.
async fn drained(outbox: &mpsc::UnboundedSender<Item>, counters: &Counters) {
    let (done, flushed) = oneshot::channel();
    if outbox.send(Item::Flush(done)).is_ok() {
        // An error says that the outbox is gone: there is nothing to wait for.
        flushed.await.ok();
    }
    let under_way = |queued: &AtomicU64, done: &AtomicU64| {
        queued.load(Ordering::Relaxed) > done.load(Ordering::Relaxed)
    };
    while under_way(&counters.frames_queued, &counters.frames_done)
        || under_way(&counters.pictures_queued, &counters.pictures_done)
        || under_way(&counters.asked, &counters.answered)
    {
        sleep(LOOK).await;
    }
}

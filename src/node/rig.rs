//! A rig inside the program: it plays a load path to the node over DDS, as a rig outside would.
//!
//! It has a participant and a node of its own, `virtual_rig` in the namespace of the twin, and
//! knows of the twin only what comes over the network, so that one program on one machine shows the
//! whole path. Where loads took the walls, which a step of the path begins from, it knows from the
//! path's own [`Whereabouts`](crate::path::Whereabouts).

use std::mem::discriminant;
use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use futures::StreamExt;
use ros2_client::{Context, Node, Spinner, Subscription};
use tokio::runtime::{Builder, Runtime};
use tokio::time::{sleep, timeout};

use super::endpoints::{Out, subscribe};
use super::{EndOfCommands, Identity, NodeError, SPINNER_END, create, participant, spin};
use crate::command::Command;
use crate::msg::convert::CommandMessage;
use crate::msg::{BoundaryCommand, Dissociation, Report, ShearCommand, WallTargets, topics};
use crate::path::{Path, PathError};
use crate::scene;

/// Name of the rig's node.
const NODE: &str = "virtual_rig";

/// Commands that may be without an answer at a time.
const IN_FLIGHT: usize = 16;

/// Longest wait for the twin's node to be found.
const MATCHING: Duration = Duration::from_secs(30);

/// How often the waits look at the stop flag.
const LOOK: Duration = Duration::from_millis(10);

/// Why the rig did not play its path.
#[derive(Debug, thiserror::Error)]
pub enum RigError {
    /// The twin's node was not found.
    #[error("the virtual rig found no node that takes its commands and reports on them within {} s", MATCHING.as_secs())]
    NoTwin,
    /// A command could not be published.
    #[error("the virtual rig could not publish command {sequence}")]
    CommandLost {
        /// Its sequence.
        sequence: u64,
    },
    /// A report could not be read.
    #[error("the virtual rig got a report that it cannot read: {0}")]
    Report(String),
    /// The path could not be gone on with.
    #[error(transparent)]
    Path(PathError),
    /// A bug.
    #[error("the virtual rig's thread panicked")]
    Panicked,
}

/// What the rig did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Played {
    /// Commands published.
    pub sent: usize,
    /// Commands whose report came back.
    pub answered: usize,
    /// Time from a command to its report, waiting and solving included, that half of them stay
    /// below \[s\].
    pub round_trip_median: f64,
    /// The same for 99 of 100.
    pub round_trip_p99: f64,
    /// The longest.
    pub round_trip_worst: f64,
}

/// The running rig.
pub struct Rig {
    thread: thread::JoinHandle<Result<Played, RigError>>,
}

impl Rig {
    /// Joins the domain of `options` and plays `path` from a thread of its own as soon as the node
    /// `twin` is found. When the last command is answered, when the rig fails, or when `stop`
    /// is raised, it declares the `end` of the commands, which ends the run.
    ///
    /// # Errors
    /// When the domain is out of range or the middleware refuses something.
    pub fn start(
        options: &scene::Node,
        twin: &Identity,
        path: Path,
        end: EndOfCommands,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, NodeError> {
        // What of the environment cannot be done, the node has said.
        let (context, _) = participant::join(options)?;
        let link = Link::new(context, twin)?;
        let runtime = Builder::new_current_thread().enable_time().build()?;
        let stop = Arc::clone(stop);
        let thread = thread::Builder::new().name(NODE.to_owned()).spawn(move || {
            let _end = DeclareAtEnd(end);
            link.play(&runtime, path, &stop)
        })?;
        Ok(Self { thread })
    }

    /// Waits until the rig has ended.
    ///
    /// # Errors
    /// When the path could not be played.
    pub fn join(self) -> Result<Played, RigError> {
        self.thread.join().unwrap_or(Err(RigError::Panicked))
    }
}

/// Declares the end of the commands however the thread ends.
struct DeclareAtEnd(EndOfCommands);

impl Drop for DeclareAtEnd {
    fn drop(&mut self) {
        self.0.declare();
    }
}

/// The topics of the commands.
struct Commands {
    boundary: Out<BoundaryCommand>,
    targets: Out<WallTargets>,
    dissociations: Out<Dissociation>,
    shears: Out<ShearCommand>,
}

impl Commands {
    fn are_matched(&self, node: &Node) -> bool {
        self.boundary.is_matched(node)
            && self.targets.is_matched(node)
            && self.dissociations.is_matched(node)
            && self.shears.is_matched(node)
    }

    /// False when the command is lost.
    async fn publish(&self, command: &Command) -> bool {
        match CommandMessage::from(command) {
            CommandMessage::Boundary(message) => self.boundary.publish(message).await,
            CommandMessage::Targets(message) => self.targets.publish(message).await,
            CommandMessage::Dissociation(message) => self.dissociations.publish(message).await,
            CommandMessage::Shear(message) => self.shears.publish(message).await,
        }
    }
}

/// The rig's end of the wire. Fields drop in this order, as they must.
struct Link {
    commands: Commands,
    reports: Subscription<Report>,
    node: Node,
    spinner: Spinner,
    context: Context,
}

impl Link {
    fn new(context: Context, twin: &Identity) -> Result<Self, NodeError> {
        let (mut node, spinner) = create(&context, twin.namespace(), NODE)?;
        let commands = Commands {
            boundary: Out::new(&mut node, twin, &topics::BOUNDARY_COMMAND)?,
            targets: Out::new(&mut node, twin, &topics::WALL_TARGETS)?,
            dissociations: Out::new(&mut node, twin, &topics::DISSOCIATION)?,
            shears: Out::new(&mut node, twin, &topics::SHEAR_COMMAND)?,
        };
        let reports = subscribe(&mut node, twin, &topics::REPORT)?;
        Ok(Self { commands, reports, node, spinner, context })
    }

    fn play(self, runtime: &Runtime, path: Path, stop: &AtomicBool) -> Result<Played, RigError> {
        let Self { commands, reports, node, spinner, context } = self;
        let played = runtime.block_on(async {
            let spinner = tokio::spawn(spin(spinner));
            let played = match find_twin(&commands, &reports, &node, stop).await {
                Ok(()) => exchange(&commands, &reports, path, stop).await,
                Err(error) => Err(error),
            };
            drop((commands, reports, node));
            // Past the limit, the drop of the context ends it.
            timeout(SPINNER_END, spinner).await.ok();
            played
        });
        drop(context);
        played
    }
}

/// Returns when both directions are matched, or when `stop` is raised.
async fn find_twin(
    commands: &Commands,
    reports: &Subscription<Report>,
    node: &Node,
    stop: &AtomicBool,
) -> Result<(), RigError> {
    let start = Instant::now();
    while !(commands.are_matched(node) && reports.get_publisher_count(node) > 0) {
        if stop.load(Ordering::Relaxed) {
            break;
        }
        if start.elapsed() > MATCHING {
            return Err(RigError::NoTwin);
        }
        sleep(LOOK).await;
    }
    Ok(())
}

/// A command on its way.
struct InFlight {
    session: String,
    sequence: u64,
    sent: Instant,
}

/// Publishes `path` and takes the reports until every command has one.
async fn exchange(
    commands: &Commands,
    reports: &Subscription<Report>,
    path: Path,
    stop: &AtomicBool,
) -> Result<Played, RigError> {
    let mut path = path;
    let mut next = None;
    let mut topic = None;
    let mut in_flight: Vec<InFlight> = Vec::with_capacity(IN_FLIGHT);
    let mut round_trips = Vec::new();
    let mut sent = 0;
    let mut reports = pin!(reports.async_stream());
    while !stop.load(Ordering::Relaxed) {
        while in_flight.len() < IN_FLIGHT {
            if next.is_none() && (in_flight.is_empty() || !path.waits()) {
                next = path.next().transpose().map_err(RigError::Path)?;
            }
            // What goes over two topics could overtake.
            let same = |command: &Command| topic == Some(discriminant(&command.ask));
            let Some(command) = next.take_if(|next| in_flight.is_empty() || same(next)) else {
                break;
            };
            topic = Some(discriminant(&command.ask));
            let start = Instant::now();
            if !commands.publish(&command).await {
                return Err(RigError::CommandLost { sequence: command.sequence });
            }
            sent += 1;
            let Command { session, sequence, .. } = command;
            in_flight.push(InFlight { session, sequence, sent: start });
        }
        if in_flight.is_empty() {
            break;
        }
        let report = match timeout(LOOK, reports.next()).await {
            Err(_) => continue,
            Ok(None) => break,
            Ok(Some(Ok((report, _)))) => report,
            Ok(Some(Err(error))) => return Err(RigError::Report(error.to_string())),
        };
        let answered = in_flight.iter().position(|command| {
            command.sequence == report.sequence && command.session == report.session
        });
        if let Some(answered) = answered {
            round_trips.push(in_flight.swap_remove(answered).sent.elapsed().as_secs_f64());
        }
    }
    Ok(summary(sent, round_trips))
}

fn summary(sent: usize, mut round_trips: Vec<f64>) -> Played {
    round_trips.sort_by(f64::total_cmp);
    let answered = round_trips.len();
    let quantile = |share: f64| {
        let rank = (share * answered as f64).ceil() as usize;
        round_trips.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
    };
    Played {
        sent,
        answered,
        round_trip_median: quantile(0.5),
        round_trip_p99: quantile(0.99),
        round_trip_worst: quantile(1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summary_of_a_hundred_round_trips_names_the_50th_the_99th_and_the_100th() {
        let trips = (1..=100).rev().map(f64::from).collect();
        let played = summary(120, trips);
        assert_eq!((played.sent, played.answered), (120, 100));
        assert_eq!(played.round_trip_median, 50.0);
        assert_eq!(played.round_trip_p99, 99.0);
        assert_eq!(played.round_trip_worst, 100.0);
        assert_eq!(summary(1, Vec::new()).round_trip_worst, 0.0);
    }
}

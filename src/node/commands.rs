//! Commands on their way from their topics to the solver.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use futures::StreamExt;
use ros2_client::{Message, Subscription};
use tokio::sync::mpsc;
use tokio::task::AbortHandle;

use super::clock::Clock;
use super::counters::Counters;
use crate::command::Command;
use crate::command::request::Intake;
use crate::msg::Described;

/// Commands that wait for the solver outside of DDS: 9 MB. When they are full, DDS keeps the
/// topic's depth more; a rig that is further ahead than both is told of a gap.
pub(super) const WAITING: usize = 65_536;

/// The commands of the topics and what else is asked, in order, as a blocking iterator for the solver's thread.
///
/// It ends at once when the stop flag is raised, and after the last waiting command when the
/// commands were declared complete with [`EndOfCommands`].
#[derive(Debug)]
pub struct Commands {
    queue: mpsc::Receiver<Intake>,
    stop: Arc<AtomicBool>,
}

impl Commands {
    pub(super) fn new(queue: mpsc::Receiver<Intake>, stop: Arc<AtomicBool>) -> Self {
        Self { queue, stop }
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Iterator for Commands {
    type Item = Intake;

    fn next(&mut self) -> Option<Intake> {
        if self.stopped() {
            return None;
        }
        let intake = self.queue.blocking_recv();
        if self.stopped() { None } else { intake }
    }
}

/// Says that no command will come any more.
#[derive(Clone, Debug)]
pub struct EndOfCommands(pub(super) Vec<AbortHandle>);

impl EndOfCommands {
    /// Ends [`Commands`] after those that wait already.
    pub fn declare(&self) {
        self.0.iter().for_each(AbortHandle::abort);
    }
}

/// Takes every command from a topic and hands it over with its age.
pub(super) async fn receive<M>(
    subscription: Subscription<M>,
    queue: mpsc::Sender<Intake>,
    counters: Arc<Counters>,
    clock: Clock,
) where
    M: Message + Described + 'static,
    Command: From<M>,
{
    let mut stream = pin!(subscription.async_stream());
    while let Some(sample) = stream.next().await {
        match sample {
            Ok((message, info)) => {
                let mut command = Command::from(message);
                let arrival = info.received_timestamp().map(|time| time.to_nanos());
                command.age = clock.age(command.stamp, arrival);
                counters.commands.fetch_add(1, Ordering::Relaxed);
                counters.health.arrived();
                if queue.send(command.into()).await.is_err() {
                    return;
                }
            }
            Err(error) => {
                counters.unreadable.fetch_add(1, Ordering::Relaxed);
                tracing::error!("a command is lost, its bytes are no {}: {error}", M::TYPE.name);
            }
        }
    }
}

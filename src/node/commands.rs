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
use super::discrepancy::{Recorder, record};
use crate::command::request::Intake;
use crate::command::{Command, Stamp};
use crate::msg::Described;
use crate::sink::Beside;

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

    /// The next one if it has come already, unless the stop flag is raised.
    pub fn next_waiting(&mut self) -> Option<Intake> {
        if self.stopped() { None } else { self.queue.try_recv().ok() }
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

/// How old a message is that was stamped so \[s\], if anybody can say.
pub(super) type Age<'a> = dyn Fn(Stamp) -> Option<f64> + 'a;

/// The way from the topics to [`Commands`].
#[derive(Clone)]
pub(super) struct Intakes {
    pub(super) queue: mpsc::Sender<Intake>,
    pub(super) counters: Arc<Counters>,
    pub(super) clock: Clock,
    pub(super) recorder: Recorder,
}

impl Intakes {
    /// Takes every message from a topic and hands over what `read` makes of it.
    pub(super) async fn receive<M, F, I>(self, subscription: Subscription<M>, read: F)
    where
        M: Message + Described + 'static,
        F: FnMut(M, &Age<'_>) -> I,
        I: IntoIterator<Item = Intake>,
        I::IntoIter: Send,
    {
        self.take(subscription, |_| {}, read).await;
    }

    /// The same, and the messages are recorded as they come. Commands need no such record: theirs is
    /// written with their report.
    pub(super) async fn receive_and_record<M, F, I>(
        self,
        subscription: Subscription<M>,
        beside: fn(M) -> Beside,
        read: F,
    ) where
        M: Message + Described + Clone + 'static,
        F: FnMut(M, &Age<'_>) -> I,
        I: IntoIterator<Item = Intake>,
        I::IntoIter: Send,
    {
        let recorder = Arc::clone(&self.recorder);
        let note = move |message: &M| {
            record(&recorder, || beside(message.clone()));
        };
        self.take(subscription, note, read).await;
    }

    async fn take<M, F, I>(self, subscription: Subscription<M>, note: impl Fn(&M), mut read: F)
    where
        M: Message + Described + 'static,
        F: FnMut(M, &Age<'_>) -> I,
        I: IntoIterator<Item = Intake>,
        I::IntoIter: Send,
    {
        let mut stream = pin!(subscription.async_stream());
        while let Some(sample) = stream.next().await {
            match sample {
                Ok((message, info)) => {
                    let arrival = info.received_timestamp().map(|time| time.to_nanos());
                    note(&message);
                    let intakes = read(message, &|stamp| self.clock.age(stamp, arrival));
                    for intake in intakes {
                        self.counters.commands.fetch_add(1, Ordering::Relaxed);
                        self.counters.health.arrived();
                        if self.queue.send(intake).await.is_err() {
                            return;
                        }
                    }
                }
                Err(error) => {
                    self.counters.unreadable.fetch_add(1, Ordering::Relaxed);
                    let name = M::TYPE.name;
                    tracing::error!("a command is lost, its bytes are no {name}: {error}");
                }
            }
        }
    }
}

/// The command in a message of this package, with its age.
pub(super) fn of_ours<M>(message: M, age: &Age<'_>) -> [Intake; 1]
where
    Command: From<M>,
{
    let command = Command::from(message);
    let age = age(command.stamp);
    [Intake::Command(Command { age, ..command })]
}

//! The thread that encodes answers and hands them to the clients' queues.

use std::ptr;
use std::sync::Arc;

use ::foxglove::SinkId;

use super::outlets::{Outlet, Outlets};
use super::queue::{Queue, Waiting, Work};
use crate::msg::answer::{self, Outgoing};
use crate::msg::cdr::CdrError;
use crate::msg::topics::{self, Topic};
use crate::view::picture::Painter;

/// What the thread owns.
pub(super) struct Speaker {
    outlets: Arc<Outlets>,
    painter: Painter,
    /// The last increment 0, which has the frames.
    start: Option<Waiting>,
    /// The last answer with measures.
    last: Option<Waiting>,
    buffer: Vec<u8>,
}

impl Speaker {
    pub(super) fn new(outlets: Arc<Outlets>, painter: Painter) -> Self {
        Self { outlets, painter, start: None, last: None, buffer: Vec::new() }
    }

    /// Until the queue ends.
    pub(super) fn run(mut self, queue: &Queue) {
        while let Some(Work { newcomers, answer }) = queue.take() {
            for (outlet, client) in newcomers {
                self.welcome(outlet, client);
            }
            if let Some((waiting, listeners)) = answer {
                self.send(&waiting, &listeners);
                if waiting.served.report.measures.is_some() {
                    if waiting.served.command.is_none() {
                        self.start = Some(waiting.clone());
                    }
                    self.last = Some(waiting);
                }
            }
        }
    }

    /// Tells a newcomer how the twin is, as far as the topic says that.
    fn welcome(&mut self, outlet: Outlet, client: SinkId) {
        let topic = self.outlets.topic(outlet);
        let known = if ptr::eq(topic, &topics::TF_STATIC) {
            self.start.clone()
        } else if is_state(topic) {
            self.last.clone()
        } else {
            None
        };
        if let Some(known) = known {
            self.send(&known, &[(outlet, client)]);
        }
    }

    /// Sends what the listeners have subscribed to.
    fn send(&mut self, waiting: &Waiting, listeners: &[(Outlet, SinkId)]) {
        let Self { outlets, painter, buffer, .. } = self;
        let of = |topic: &Topic| {
            let outlet = outlets.of_topic(topic);
            listeners.iter().filter(move |(one, _)| Some(*one) == outlet)
        };
        let mut take = |topic: &'static Topic, message: &dyn Outgoing| -> Result<(), CdrError> {
            message.encode(buffer)?;
            for &(outlet, client) in of(topic) {
                outlets.send(outlet, client, buffer, waiting.time);
            }
            Ok(())
        };
        let wants = |topic: &Topic| of(topic).next().is_some();
        if let Err(error) = answer::each(&waiting.served, Some(painter), &wants, &mut take) {
            tracing::error!("not shown to the clients of the Foxglove server: {error}");
        }
    }
}

/// Whether messages on `topic` say how the twin is, rather than what happened.
fn is_state(topic: &Topic) -> bool {
    let happened = [&topics::CRACKS, &topics::EVENTS, &topics::REARRANGEMENTS, &topics::SNAPSHOTS];
    !happened.contains(&topic) && topics::measures().any(|one| ptr::eq(one, topic))
}

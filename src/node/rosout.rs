//! `/rosout`: what the program logs, for whoever watches the node from afar.
//!
//! Warnings and errors of the program itself; those of the middleware would multiply there, since
//! publishing makes more of them.

use std::fmt::{self, Write};
use std::time::Duration;

use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, Publisher, QosProfile};
use tokio::sync::mpsc;
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;

use super::NodeError;
use super::clock::Clock;
use super::discrepancy::{self, Recorder};
use super::names::Identity;
use crate::msg::rcl::Log;
use crate::msg::topics;
use crate::sink::Beside;

/// Messages that are kept: for late subscribers, and on the way to the node.
const DEPTH: usize = topics::ROSOUT.qos.depth as usize;

/// How long a message is of interest.
const LIFESPAN: Duration = Duration::from_secs(10);

/// How long one message waits for a subscriber that leaves no room; then it is lost.
const PATIENCE: Duration = Duration::from_millis(100);

/// What the targets of the program's own messages begin with.
const OWN: &str = env!("CARGO_PKG_NAME");

/// The messages on their way to the node.
#[derive(Debug)]
pub struct Records(mpsc::Receiver<Log>);

/// Takes messages from the log. It never waits: when too many are on their way, one is lost.
#[derive(Debug)]
pub struct RosoutLayer(mpsc::Sender<Log>);

/// A layer for the log, and where its messages come out.
#[must_use]
pub fn layer() -> (RosoutLayer, Records) {
    let (sender, receiver) = mpsc::channel(DEPTH);
    (RosoutLayer(sender), Records(receiver))
}

impl<S: Subscriber> Layer<S> for RosoutLayer {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let about = event.metadata();
        let own = about.target().strip_prefix(OWN);
        if !own.is_some_and(|rest| rest.is_empty() || rest.starts_with("::")) {
            return;
        }
        let level = match *about.level() {
            Level::ERROR => 40,
            Level::WARN => 30,
            _ => return,
        };
        let mut text = Text(String::new());
        event.record(&mut text);
        // Full, or nobody publishes any more: either way there is nobody to tell.
        self.0
            .try_send(Log {
                stamp: Clock::default().now().into(),
                level,
                name: String::new(),
                msg: text.0,
                file: about.file().unwrap_or_default().into(),
                function: about.target().into(),
                line: about.line().unwrap_or_default(),
            })
            .ok();
    }
}

/// The message of an event, and its fields behind it.
struct Text(String);

impl Visit for Text {
    fn record_debug(&mut self, field: &Field, value: &dyn fmt::Debug) {
        // Writing to a string cannot fail.
        if field.name() == "message" {
            write!(self.0, "{value:?}").ok();
        } else {
            write!(self.0, " {}={value:?}", field.name()).ok();
        }
    }
}

/// The publisher of the topic.
pub(super) struct Rosout {
    publisher: Publisher<Log>,
    logger: String,
}

impl Rosout {
    pub(super) fn new(node: &mut Node, identity: &Identity) -> Result<Self, NodeError> {
        let name = identity.resolve(topics::ROSOUT.name);
        let failed = |error: &dyn std::error::Error| NodeError::Endpoint {
            topic: name.clone(),
            reason: error.to_string(),
        };
        let qos = QosProfile::publisher_default()
            .reliability_reliable(WhenFull::Wait(PATIENCE))
            .durability(Durability::TransientLocal)
            .history(History::KeepLast { depth: DEPTH })
            .lifespan(Some(LIFESPAN));
        let parsed = Name::parse(&name).map_err(|error| failed(&error))?;
        let kind = MessageTypeName::new("rcl_interfaces", "Log");
        let topic = node.create_topic(&parsed, kind, &qos).map_err(|error| failed(&error))?;
        let publisher = node.create_publisher(&topic, Some(qos)).map_err(|error| failed(&error))?;
        Ok(Self { publisher, logger: identity.logger() })
    }

    /// Publishes `records`, and records them, until there are no more.
    pub(super) async fn run(self, mut records: Records, recorder: Recorder) {
        while let Some(mut record) = records.0.recv().await {
            record.name.clone_from(&self.logger);
            discrepancy::record(&recorder, || Beside::Log(record.clone()));
            // To log that a message of the log is lost would make one more of them.
            self.publisher.async_publish(record).await.ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use tracing_subscriber::layer::SubscriberExt;

    use super::*;

    #[test]
    fn own_warnings_and_errors_come_out_and_nothing_else_and_a_flood_never_waits() {
        let (layer, mut records) = layer();
        tracing::subscriber::with_default(tracing_subscriber::registry().with(layer), || {
            tracing::info!("all is well");
            tracing::warn!(target: "graintwin_other", "not ours");
            tracing::error!(target: "rustdds::rtps", "not ours");
            tracing::warn!(target: "graintwin", wall = 3, "moved {} m", 0.5);
            tracing::error!("lost");
            for _ in 0..2 * DEPTH {
                tracing::warn!("flood");
            }
        });
        let first = records.0.try_recv().unwrap();
        assert_eq!((first.level, first.msg.as_str()), (30, "moved 0.5 m wall=3"));
        let second = records.0.try_recv().unwrap();
        assert_eq!((second.level, second.msg.as_str()), (40, "lost"));
        assert_eq!(second.file, file!());
        let mut rest = 0;
        while records.0.try_recv().is_ok() {
            rest += 1;
        }
        assert_eq!(rest, DEPTH - 2);
    }
}

//! What time it is for the node: the machine's, or that of `/clock`.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use futures::StreamExt;
use ros2_client::qos::{History, Reliability};
use ros2_client::{MessageTypeName, Name, Node, QosProfile, Subscription};

use super::NodeError;
use super::names::Identity;
use crate::command::Stamp;
use crate::msg::{self, Described};

const TOPIC: &str = "/clock";

/// Stands for a time that nobody has told yet.
const UNKNOWN: i64 = i64::MIN;

/// A clock that every task can have.
#[derive(Clone, Debug, Default)]
pub(super) struct Clock {
    /// Nanoseconds that `/clock` told last, when it is to be believed.
    simulated: Option<Arc<AtomicI64>>,
}

impl Clock {
    /// The machine's clock, or one that waits to be [told](Self::tell).
    pub(super) fn new(simulated: bool) -> Self {
        Self { simulated: simulated.then(|| Arc::new(UNKNOWN.into())) }
    }

    /// Takes what `/clock` says; nothing happens when it is not to be believed.
    pub(super) fn tell(&self, time: Stamp) {
        if let Some(simulated) = &self.simulated {
            simulated.store(time.nanoseconds(), Ordering::Relaxed);
        }
    }

    /// The time; 0 while `/clock` has not told it.
    pub(super) fn now(&self) -> Stamp {
        let nanoseconds = match &self.simulated {
            Some(simulated) => simulated.load(Ordering::Relaxed).max(0),
            None => {
                let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
                i64::try_from(since.as_nanos()).unwrap_or(i64::MAX)
            }
        };
        Stamp {
            sec: (nanoseconds / 1_000_000_000).try_into().unwrap_or(i32::MAX),
            nanosec: (nanoseconds % 1_000_000_000) as u32,
        }
    }

    /// How old `stamp` is \[s\]. `arrival` is when its message came by the machine's clock \[ns\].
    /// `None` when nobody can say.
    pub(super) fn age(&self, stamp: Stamp, arrival: Option<i64>) -> Option<f64> {
        let now = match &self.simulated {
            Some(simulated) => {
                Some(simulated.load(Ordering::Relaxed)).filter(|now| *now != UNKNOWN)
            }
            None => arrival,
        };
        Some(now?.saturating_sub(stamp.nanoseconds()) as f64 * 1e-9)
    }
}

/// A subscription to `/clock`, best effort as its publishers may be.
pub(super) fn subscribe(
    node: &mut Node,
    identity: &Identity,
) -> Result<Subscription<msg::Clock>, NodeError> {
    let name = identity.resolve(TOPIC);
    let failed = |reason: String| NodeError::Endpoint { topic: name.clone(), reason };
    let qos = QosProfile {
        reliability: Reliability::BestEffort,
        history: History::KeepLast { depth: 1 },
        ..QosProfile::subscription_default()
    };
    let name = Name::parse(&name).map_err(|error| failed(error.to_string()))?;
    let kind = msg::Clock::TYPE;
    let kind = MessageTypeName::new(kind.package, kind.name);
    let topic = node.create_topic(&name, kind, &qos).map_err(|error| failed(error.to_string()))?;
    node.create_subscription(&topic, Some(qos)).map_err(|error| failed(error.to_string()))
}

/// Tells `clock` what `/clock` says.
pub(super) async fn follow(subscription: Subscription<msg::Clock>, clock: Clock) {
    let mut times = pin!(subscription.async_stream());
    while let Some(time) = times.next().await {
        match time {
            Ok((time, _)) => clock.tell(time.clock.into()),
            Err(error) => tracing::warn!("a time on {TOPIC} cannot be read: {error}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(sec: i32) -> Stamp {
        Stamp { sec, nanosec: 250_000_000 }
    }

    #[test]
    fn on_the_machines_clock_a_message_is_as_old_as_its_arrival_says() {
        let clock = Clock::new(false);
        clock.tell(stamp(1_000_000));
        assert_eq!(clock.age(stamp(10), Some(12_000_000_000)), Some(1.75));
        assert_eq!(clock.age(stamp(10), None), None);
        assert!(clock.now().sec > 1_000_000_000);
    }

    #[test]
    fn on_a_simulated_clock_only_what_it_told_last_counts() {
        let clock = Clock::new(true);
        let arrival = Some(1_700_000_000_000_000_000);
        assert_eq!((clock.age(stamp(10), arrival), clock.now()), (None, Stamp::default()));
        let copy = clock.clone();
        copy.tell(stamp(13));
        assert_eq!((clock.age(stamp(10), arrival), clock.now()), (Some(3.0), stamp(13)));
        copy.tell(stamp(8));
        assert_eq!(clock.age(stamp(10), arrival), Some(-2.0));
    }
}

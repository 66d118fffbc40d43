//! What time it is for the node: the machine's, or that of `/clock`.

use std::pin::pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI64, Ordering};
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

/// A clock that every task can have. The default one is the machine's for good.
#[derive(Clone, Debug)]
pub(super) struct Clock {
    /// Whether `/clock` is to be believed.
    simulated: Arc<AtomicBool>,
    /// Nanoseconds that `/clock` told last.
    told: Arc<AtomicI64>,
}

impl Default for Clock {
    fn default() -> Self {
        Self::new(Arc::default())
    }
}

impl Clock {
    /// The machine's clock while `simulated` is not set, and one that waits to be
    /// [told](Self::tell) while it is.
    pub(super) fn new(simulated: Arc<AtomicBool>) -> Self {
        Self { simulated, told: Arc::new(UNKNOWN.into()) }
    }

    /// Takes what `/clock` says.
    pub(super) fn tell(&self, time: Stamp) {
        self.told.store(time.nanoseconds(), Ordering::Relaxed);
    }

    /// The time; 0 while `/clock` is to be believed and has not told it.
    pub(super) fn now(&self) -> Stamp {
        let nanoseconds = match self.is_simulated() {
            true => self.told.load(Ordering::Relaxed).max(0),
            false => {
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
        let now = match self.is_simulated() {
            true => Some(self.told.load(Ordering::Relaxed)).filter(|now| *now != UNKNOWN),
            false => arrival,
        };
        Some(now?.saturating_sub(stamp.nanoseconds()) as f64 * 1e-9)
    }

    fn is_simulated(&self) -> bool {
        self.simulated.load(Ordering::Relaxed)
    }
}

/// A subscription to `/clock`, best effort as its publishers may be.
pub(super) fn subscribe(
    node: &mut Node,
    identity: &Identity,
) -> Result<Subscription<msg::Clock>, NodeError> {
    let failed = |reason: String| NodeError::Endpoint { topic: TOPIC.into(), reason };
    let qos = QosProfile {
        reliability: Reliability::BestEffort,
        history: History::KeepLast { depth: 1 },
        ..QosProfile::subscription_default()
    };
    let name = Name::parse(&identity.resolve(TOPIC)).map_err(|error| failed(error.to_string()))?;
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
        let clock = Clock::default();
        clock.tell(stamp(1_000_000));
        assert_eq!(clock.age(stamp(10), Some(12_000_000_000)), Some(1.75));
        assert_eq!(clock.age(stamp(10), None), None);
        assert!(clock.now().sec > 1_000_000_000);
    }

    #[test]
    fn on_a_simulated_clock_only_what_it_told_last_counts() {
        let simulated = Arc::new(AtomicBool::new(true));
        let clock = Clock::new(Arc::clone(&simulated));
        let arrival = Some(1_700_000_000_000_000_000);
        assert_eq!((clock.age(stamp(10), arrival), clock.now()), (None, Stamp::default()));
        let copy = clock.clone();
        copy.tell(stamp(13));
        assert_eq!((clock.age(stamp(10), arrival), clock.now()), (Some(3.0), stamp(13)));
        copy.tell(stamp(8));
        assert_eq!(clock.age(stamp(10), arrival), Some(-2.0));
        simulated.store(false, Ordering::Relaxed);
        assert!(clock.age(stamp(10), arrival).unwrap() > 1.6e9);
    }
}

//! The intake: whether commands come, and what becomes of them.

use std::time::Duration;

use super::recent::Recent;
use super::{Level, Status};
use crate::command::Disposition;
use crate::node::health::Vitals;

/// Silence after which a rig that was there is missed.
pub(super) const SILENCE: Duration = Duration::from_secs(10);

/// Why commands are refused, in words.
const REASONS: [(Disposition, &str); 7] = [
    (Disposition::Stale, "too old"),
    (Disposition::Gap, "after a gap"),
    (Disposition::OutOfOrder, "out of order"),
    (Disposition::Limit, "beyond a limit"),
    (Disposition::Invalid, "invalid"),
    (Disposition::NotConverged, "not converged"),
    (Disposition::Held, "on hold"),
];

/// What has come in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrivals {
    pub received: u64,
    pub unreadable: u64,
    pub waiting: usize,
}

/// What came in before.
#[derive(Debug, Default)]
pub(super) struct Past {
    refused: Recent,
    unreadable: Recent,
}

impl Past {
    pub(super) fn status(&mut self, vitals: &Vitals, arrivals: &Arrivals) -> Status {
        let mut status = Status::new("intake", "commands are served");
        let refusals = REASONS.map(|(reason, words)| (words, vitals.refused[reason as usize]));
        let refused = self.refused.rose(refusals.iter().map(|(_, count)| count).sum());
        let unreadable = self.unreadable.rose(arrivals.unreadable);
        if vitals.on_hold {
            status.say(Level::Warn, "on hold: commands are refused");
        } else if unreadable {
            status.say(Level::Warn, "samples could not be read in the last seconds");
        } else if refused {
            status.say(Level::Warn, "commands were refused in the last seconds");
        } else if let Some(silence) = vitals.silence.filter(|silence| *silence > SILENCE) {
            let text = format!("no command for {} s", silence.as_secs());
            status.say(Level::Stale, text);
        } else if vitals.silence.is_none() {
            status.say(Level::Ok, "no rig yet");
        }
        status.value("received", &arrivals.received);
        status.value("accepted", &vitals.accepted);
        status.value("repeated", &vitals.repeated);
        for (words, count) in refusals {
            status.value(format!("refused: {words}"), &count);
        }
        status.value("unreadable", &arrivals.unreadable);
        status.value("waiting", &arrivals.waiting);
        let age = vitals.silence.map_or("never".into(), |age| format!("{:.3}", age.as_secs_f64()));
        status.value("newest arrived before (s)", &age);
        status.value("on hold", &vitals.on_hold);
        status.value("measurements of no use", &vitals.unused);
        status
    }
}

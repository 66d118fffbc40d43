//! The link: who listens, and what does not get through.

use super::recent::Recent;
use super::{Level, Status};

/// Messages on their way that are too many: subscribers do not keep up.
const MANY: u64 = 1000;

/// What went out.
#[derive(Clone, Debug, Default)]
pub(super) struct Traffic {
    pub listeners: Vec<(&'static str, usize)>,
    pub published: u64,
    pub lost: u64,
    pub waiting: u64,
    pub frames: u64,
    pub skipped: u64,
    pub pictures: u64,
    pub pictures_skipped: u64,
}

/// What went out before.
#[derive(Debug, Default)]
pub(super) struct Past {
    lost: Recent,
    skipped: Recent,
}

impl Past {
    pub(super) fn status(&mut self, traffic: &Traffic) -> Status {
        let peers: usize = traffic.listeners.iter().map(|(_, count)| count).sum();
        let mut status = Status::new("link", format!("{peers} subscriptions"));
        let lost = self.lost.rose(traffic.lost);
        let skipped = self.skipped.rose(traffic.skipped);
        if lost {
            status.say(Level::Error, "messages were lost in the last seconds");
        } else if traffic.waiting > MANY {
            status.say(Level::Warn, "subscribers do not keep up");
        } else if skipped {
            status.say(Level::Warn, "contact networks were left out in the last seconds");
        }
        status.value("published", &traffic.published);
        status.value("lost", &traffic.lost);
        status.value("waiting", &traffic.waiting);
        status.value("contact networks published", &traffic.frames);
        status.value("contact networks left out", &traffic.skipped);
        status.value("pictures published", &traffic.pictures);
        status.value("pictures left out", &traffic.pictures_skipped);
        for (topic, count) in &traffic.listeners {
            status.value(format!("subscriptions to {topic}"), count);
        }
        status
    }
}

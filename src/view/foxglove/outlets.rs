//! The topics that clients see.

use std::ptr;
use std::sync::Arc;

use ::foxglove::{ChannelBuilder, ChannelId, Context, PartialMetadata, RawChannel, Schema, SinkId};

use super::ServeError;
use crate::msg::topics::{self, Topic};

/// A channel for each topic that answers have messages on.
pub(super) struct Outlets {
    /// Channels hold it weakly.
    context: Arc<Context>,
    all: Vec<(&'static Topic, Arc<RawChannel>)>,
}

/// One of the [`Outlets`], by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Outlet(usize);

impl Outlets {
    pub(super) fn new(context: Arc<Context>) -> Result<Self, ServeError> {
        let commands = [&topics::BOUNDARY_COMMAND, &topics::WALL_TARGETS, &topics::REPORT];
        let channel = |topic: &'static Topic| {
            let kind = topic.kind;
            let schema = Schema::new(kind.full_name(), "ros2msg", kind.definition().into_bytes());
            let channel = ChannelBuilder::new(topic.recorded_name())
                .message_encoding("cdr")
                .schema(schema)
                .context(&context)
                .build_raw()
                .map_err(ServeError::Topic)?;
            Ok((topic, channel))
        };
        let all = commands.into_iter().chain(topics::measures()).map(channel);
        let all = all.collect::<Result<_, ServeError>>()?;
        Ok(Self { context, all })
    }

    pub(super) fn context(&self) -> &Arc<Context> {
        &self.context
    }

    /// Whether somebody has subscribed.
    pub(super) fn has_listener(&self, topic: &'static Topic) -> bool {
        self.all.iter().any(|(one, channel)| ptr::eq(*one, topic) && channel.has_sinks())
    }

    /// Those whose messages need contact networks, bonds, grains or their motion.
    pub(super) fn pictures(&self) -> Vec<Outlet> {
        let pictures = [
            &topics::CONTACT_NETWORK,
            &topics::BONDS,
            &topics::GRAIN_MOTION,
            &topics::GRAINS,
            &topics::MARKERS,
        ];
        pictures.into_iter().filter_map(|topic| self.of_topic(topic)).collect()
    }

    pub(super) fn of_channel(&self, id: ChannelId) -> Option<Outlet> {
        self.all.iter().position(|(_, channel)| channel.id() == id).map(Outlet)
    }

    pub(super) fn of_topic(&self, topic: &Topic) -> Option<Outlet> {
        self.all.iter().position(|(one, _)| ptr::eq(*one, topic)).map(Outlet)
    }

    pub(super) fn topic(&self, outlet: Outlet) -> &'static Topic {
        self.all[outlet.0].0
    }

    /// Puts a message into the queue of a client, as of `time` \[ns since 1970\].
    pub(super) fn send(&self, outlet: Outlet, client: SinkId, bytes: &[u8], time: u64) {
        let when = PartialMetadata { log_time: Some(time) };
        self.all[outlet.0].1.log_with_meta_to_sink(bytes, when, Some(client));
    }
}

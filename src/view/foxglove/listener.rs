//! Who comes and goes.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ::foxglove::SinkId;
use ::foxglove::websocket::{ChannelView, Client, ServerListener};

use super::outlets::{Outlet, Outlets};
use super::queue::Queue;

/// Tells the queue who has subscribed to what. Called by the server, which must not be held up.
pub(super) struct Listener {
    outlets: Arc<Outlets>,
    queue: Arc<Queue>,
    clients: Arc<AtomicU64>,
}

impl Listener {
    pub(super) fn new(
        outlets: &Arc<Outlets>,
        queue: &Arc<Queue>,
        clients: &Arc<AtomicU64>,
    ) -> Self {
        let (outlets, queue, clients) = (outlets.clone(), queue.clone(), clients.clone());
        Self { outlets, queue, clients }
    }

    fn who(&self, client: &Client, channel: &ChannelView<'_>) -> Option<(Outlet, SinkId)> {
        Some((self.outlets.of_channel(channel.id())?, client.sink_id()?))
    }
}

impl ServerListener for Listener {
    fn on_subscribe(&self, client: Client, channel: ChannelView<'_>) {
        if let Some(who) = self.who(&client, &channel) {
            self.queue.came(who);
        }
    }

    fn on_unsubscribe(&self, client: Client, channel: ChannelView<'_>) {
        if let Some(who) = self.who(&client, &channel) {
            self.queue.left(who);
        }
    }

    fn on_client_connect(&self) {
        self.clients.fetch_add(1, Ordering::Relaxed);
    }
}

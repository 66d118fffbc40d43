//! The answers of a running twin, live to Foxglove and its kin: a server of the Foxglove WebSocket
//! protocol with a channel for each topic, named, described and encoded as in recordings.
//!
//! **The twin never waits for a viewer.** Its thread hands an answer over and returns; a thread of
//! the server's own encodes what somebody has subscribed to, and hands it to the clients' queues.
//! When it falls behind, contact networks, bonds and pictures of the oldest answers that wait are left
//! out, and counted; commands, reports and wall forces never are. The queue of a client holds 1024
//! messages; of a client that takes them more slowly than they come, the oldest are lost.
//!
//! **Nobody looks, nothing is drawn.** Contact networks, bonds, motions of the grains, grains and markers are
//! measured, drawn and encoded while a client has subscribed to them.
//!
//! **Whoever comes later** gets, of the topics that say how the twin is (not of those that say what
//! happened), the last message at once: frames, wall forces, state, moduli; networks and
//! pictures when they were measured. So all of them begin with the same increment.
//!
//! Clients can look only: they publish nothing, and there is nothing to call. There is no password
//! and no encryption either.

mod error;
mod listener;
mod outlets;
mod queue;
mod speaker;

use std::net::{IpAddr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use ::foxglove::{Context, WebSocketServer, WebSocketServerHandle};
use tokio::runtime::{self, Runtime};
use tokio::time::timeout;

pub use error::ServeError;
use listener::Listener;
use outlets::Outlets;
use queue::Queue;
use speaker::Speaker;

use crate::msg::topics;
use crate::report::Demand;
use crate::sink::{Served, Sink};
use crate::view::picture::Painter;

/// How long clients have at the end for what is on its way to them: the server closes connections
/// without emptying its queues, and does not tell when they are empty.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// How long the connections may take to close; a client that reads nothing would hold them.
const CLOSING: Duration = Duration::from_secs(1);

/// A server that clients can connect to. What they are shown comes through its [sink](Self::sink).
pub struct Server {
    address: SocketAddr,
    outlets: Arc<Outlets>,
    queue: Arc<Queue>,
    clients: Arc<AtomicU64>,
    speaker: Option<JoinHandle<()>>,
    handle: Option<WebSocketServerHandle>,
    // Behind what runs on it, which is dropped first.
    runtime: Runtime,
}

/// What a server did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Clients that connected.
    pub clients: u64,
    /// Answers whose contact network and pictures were left out, though somebody had subscribed,
    /// since newer ones waited already.
    pub skipped: u64,
}

impl Server {
    /// Listens at `address`; port 0 takes any that is free.
    ///
    /// # Errors
    /// When the address cannot be listened at, another program using it for one, or the system has
    /// no room for another thread.
    pub fn start(address: SocketAddr) -> Result<Self, ServeError> {
        let runtime = runtime::Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name("foxglove-net")
            .enable_all()
            .build()
            .map_err(ServeError::Thread)?;
        let context = Context::new();
        let outlets = Arc::new(Outlets::new(context)?);
        let queue = Arc::new(Queue::new(outlets.pictures()));
        let clients = Arc::new(AtomicU64::new(0));
        let listener = Listener::new(&outlets, &queue, &clients);
        let server = WebSocketServer::new()
            .name(topics::NODE)
            .context(outlets.context())
            .listener(Arc::new(listener))
            .bind(host(address.ip()), address.port());
        let handle =
            runtime.block_on(server.start()).map_err(|error| ServeError::bind(address, error))?;
        let address = SocketAddr::new(address.ip(), handle.port());
        let (speaker, handle) = (None, Some(handle));
        Ok(Self { address, outlets, queue, clients, speaker, handle, runtime })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Where the twin puts its answers; pictures are drawn by the `painter`.
    ///
    /// # Errors
    /// When the system has no room for another thread.
    pub fn sink(&mut self, painter: Painter) -> Result<LiveSink, ServeError> {
        let speaker = Speaker::new(Arc::clone(&self.outlets), painter);
        let queue = Arc::clone(&self.queue);
        let thread = thread::Builder::new()
            .name("foxglove".into())
            .spawn(move || speaker.run(&queue))
            .map_err(ServeError::Thread)?;
        self.speaker = Some(thread);
        Ok(LiveSink { outlets: Arc::clone(&self.outlets), queue: Arc::clone(&self.queue) })
    }

    /// Sends what waits, and closes the connections.
    #[must_use]
    pub fn stop(mut self) -> Shown {
        self.finish();
        if let Some(handle) = self.handle.take() {
            if handle.client_count() > 0 {
                thread::sleep(LAST_WORDS);
            }
            let closing = async { timeout(CLOSING, handle.stop().wait()).await };
            if self.runtime.block_on(closing).is_err() {
                tracing::debug!("a client of the Foxglove server did not take its last messages");
            }
        }
        Shown { clients: self.clients.load(Ordering::Relaxed), skipped: self.queue.skipped() }
    }

    /// Ends the thread that encodes, after what waits for it.
    fn finish(&mut self) {
        self.queue.end();
        if self.speaker.take().is_some_and(|thread| thread.join().is_err()) {
            tracing::error!("the Foxglove server's thread panicked: clients saw no more");
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.finish();
    }
}

/// The address as the server takes it in front of a colon and the port.
fn host(address: IpAddr) -> String {
    match address {
        IpAddr::V4(address) => address.to_string(),
        IpAddr::V6(address) => format!("[{address}]"),
    }
}

/// Where the twin puts its answers for a [`Server`] to show.
pub struct LiveSink {
    outlets: Arc<Outlets>,
    queue: Arc<Queue>,
}

impl Sink for LiveSink {
    /// State and moduli are always wanted, since whoever comes later gets the last.
    fn demand(&self) -> Demand {
        let asked = |topic| self.outlets.has_listener(topic);
        // Markers show the grains and the contacts.
        let marked = asked(&topics::MARKERS);
        Demand {
            state: true,
            moduli: true,
            tangent: true,
            contact_network: marked || asked(&topics::CONTACT_NETWORK),
            grains: marked || asked(&topics::GRAINS),
            grain_motion: asked(&topics::GRAIN_MOTION),
            fabric: asked(&topics::FABRIC),
            hydrate: asked(&topics::HYDRATE),
            shear: asked(&topics::SHEAR_STATE),
            plane: asked(&topics::PLANE_STATE),
            rearrangements: asked(&topics::REARRANGEMENTS),
            snapshots: asked(&topics::SNAPSHOTS),
            bonds: marked || asked(&topics::BONDS),
            cracks: asked(&topics::CRACKS),
        }
    }

    fn served(&mut self, served: &Arc<Served>) {
        self.queue.put(Arc::clone(served));
    }
}

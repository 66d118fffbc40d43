//! What can be asked of the twin besides moving its walls.
//!
//! A request goes through the queue of the commands to the solver's thread, in the order of
//! arrival, and its response goes back when the answer comes. Requests that wait when the node
//! stops are answered with a refusal.

use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use futures::StreamExt;
use futures::stream::FuturesUnordered;
use ros2_client::qos::{Durability, History, WhenFull};
use ros2_client::request_id::RmwRequestId;
use ros2_client::{Message, Name, Node, QosProfile, Server, ServiceMapping, ServiceTypeName};
use tokio::runtime::Runtime;
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;

use super::NodeError;
use super::counters::Counters;
use super::names::Identity;
use crate::command::request::{Asked, Intake, Request};
use crate::msg::services::{Done, SavePack, Service, SetBool, Trigger};

/// Responses and requests kept for a peer, as ROS 2 does for services.
const DEPTH: usize = 10;

/// Longest wait for a peer that leaves no room for its response.
const ATTEMPT: Duration = Duration::from_secs(1);

const STOPPING: &str = "the node stops: nothing was done";

/// The services of the node.
pub(super) struct Services {
    reset: Ends<Trigger>,
    reset_faults: Ends<Trigger>,
    hold: Ends<SetBool>,
    save_pack: Ends<SavePack>,
}

type Ends<S> = Server<<S as Service>::Request, Done>;

impl Services {
    pub(super) fn new(
        node: &mut Node,
        identity: &Identity,
        mapping: ServiceMapping,
    ) -> Result<Self, NodeError> {
        Ok(Self {
            reset: server::<Trigger>(node, identity, mapping, "reset")?,
            reset_faults: server::<Trigger>(node, identity, mapping, "reset_faults")?,
            hold: server::<SetBool>(node, identity, mapping, "hold")?,
            save_pack: server::<SavePack>(node, identity, mapping, "save_pack")?,
        })
    }

    /// Serves them all; what is asked goes into `queue`, which they do not keep open.
    pub(super) fn start(
        self,
        runtime: &Runtime,
        queue: &mpsc::Sender<Intake>,
        counters: &Arc<Counters>,
    ) -> [JoinHandle<()>; 4] {
        let door = || Door { queue: queue.downgrade(), counters: Arc::clone(counters) };
        [
            runtime.spawn(serve(self.reset, |_| Request::Reset, door())),
            runtime.spawn(serve(self.reset_faults, |_| Request::ResetFaults, door())),
            runtime.spawn(serve(self.hold, |asked| Request::Hold(asked.data), door())),
            runtime.spawn(serve(
                self.save_pack,
                |asked| Request::SavePack(asked.path.into()),
                door(),
            )),
        ]
    }
}

fn server<S>(
    node: &mut Node,
    identity: &Identity,
    mapping: ServiceMapping,
    name: &str,
) -> Result<Server<S::Request, Done>, NodeError>
where
    S: Service,
    S::Request: Message + Clone + 'static,
{
    let full_name = identity.resolve(&format!("~/{name}"));
    let failed = |reason: String| NodeError::Endpoint { topic: full_name.clone(), reason };
    let parsed = Name::parse(&full_name).map_err(|error| failed(error.to_string()))?;
    let kind = ServiceTypeName::new(S::TYPE.package, S::TYPE.name);
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::Wait(ATTEMPT))
        .durability(Durability::Volatile)
        .history(History::KeepLast { depth: DEPTH });
    node.create_server(mapping, &parsed, &kind, qos.clone(), qos)
        .map_err(|error| failed(error.to_string()))
}

/// The way to the solver's thread.
struct Door {
    queue: mpsc::WeakSender<Intake>,
    counters: Arc<Counters>,
}

impl Door {
    /// Hands `request` over, when there is still somebody to take it; the answer comes later.
    async fn ask(&self, request: Request) -> oneshot::Receiver<Done> {
        let (to, from) = oneshot::channel();
        let counters = Arc::clone(&self.counters);
        let asked = Asked::new(request.clone(), move |answer| {
            if answer.is_ok() {
                counters.health.done(&request);
            }
            let success = answer.is_ok();
            let message = answer.unwrap_or_else(|refusal| refusal);
            // Fails when the node has stopped meanwhile; nobody can be told any more.
            to.send(Done { success, message }).ok();
        });
        if let Some(queue) = self.queue.upgrade() {
            // A queue without a reader drops what it gets, and so does this.
            queue.send(Intake::Request(asked)).await.ok();
        }
        from
    }
}

/// Takes every request of a service and sends its response when the answer is there.
async fn serve<R>(server: Server<R, Done>, request_of: fn(R) -> Request, door: Door)
where
    R: Message + 'static,
{
    let mut requests = server.receive_request_stream();
    let mut responses = FuturesUnordered::new();
    loop {
        futures::select! {
            request = requests.select_next_some() => match request {
                Ok((id, request)) => {
                    door.counters.asked.fetch_add(1, Ordering::Relaxed);
                    let answer = door.ask(request_of(request)).await;
                    responses.push(respond(&server, id, answer, &door.counters));
                }
                Err(error) => {
                    tracing::warn!("a request cannot be read and gets no response: {error}");
                }
            },
            () = responses.select_next_some() => {}
        }
    }
}

async fn respond<R: Message + 'static>(
    server: &Server<R, Done>,
    id: RmwRequestId,
    answer: oneshot::Receiver<Done>,
    counters: &Counters,
) {
    let refusal = |_| Done { success: false, message: STOPPING.into() };
    let done = answer.await.unwrap_or_else(refusal);
    if let Err(error) = server.async_send_response(id, done).await {
        tracing::error!("the response to a request is lost: {error:?}");
    }
    counters.answered.fetch_add(1, Ordering::Relaxed);
}

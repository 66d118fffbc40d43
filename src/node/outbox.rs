//! Answers on their way from the solver to their topics.
//!
//! The solver's thread only converts and hands over; publishing takes microseconds on average but
//! milliseconds at times, and longer while a subscriber leaves no room.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Weak};
use std::time::Duration;

use tokio::sync::{mpsc, oneshot};
use tokio::time::{Instant, timeout};

use super::counters::Counters;
use super::discrepancy::Comparison;
use super::endpoints::Endpoints;
use super::frames::{Frame, Frames};
use super::pictures::{Easel, Picture};
use crate::msg::convert::LIVE_BONDS;
use crate::msg::rearrangement::{self, LIVE_CONTACTS, LIVE_GRAINS, Rearrangement};
use crate::msg::{
    Cracks, Discrepancy, Event, Fabric, Hydrate, JointState, Moduli, PackState, PlaneState, Report,
    ShearState, TFMessage, Tangent, WallForces, WrenchStamped, convert,
};
use crate::report::Demand;
use crate::scene::{ModuliKind, Outputs, When};
use crate::sink::{Served, Sink};
use crate::wall;

/// How long a subscriber must have been matched before the initial equilibrium is sent to it. The
/// match is one-sided: a subscriber that has not found this publisher yet drops the sample, and
/// not every implementation asks for it again.
const SETTLE: Duration = Duration::from_millis(250);

/// How often the wait for a first subscriber looks.
const LOOK: Duration = Duration::from_millis(25);

/// What the solver's thread hands over.
pub(super) enum Item {
    /// The initial equilibrium, held until somebody listens.
    Initial(Vec<Outgoing>),
    /// The answer to a command.
    Answer(Vec<Outgoing>),
    /// Answered when everything before it is published.
    Flush(oneshot::Sender<()>),
}

/// One message for one topic.
pub(super) enum Outgoing {
    WallForces(WallForces),
    Wrench(usize, WrenchStamped),
    WallStates(JointState),
    State(PackState),
    Moduli(Moduli),
    Tangent(Box<Tangent>),
    Frame(Frame),
    Picture(Picture, Arc<Served>),
    Event(Event),
    Fabric(Box<Fabric>),
    Hydrate(Hydrate),
    Shear(ShearState),
    PlaneState(Box<PlaneState>),
    Cracks(Box<Cracks>),
    Rearrangement(Rearrangement),
    Report(Report),
    Discrepancy(Discrepancy),
    /// Kept by the middleware for whoever comes later.
    Frames(TFMessage),
}

/// Where the solver puts the twin's answers for the node to publish.
pub struct NodeSink {
    queue: mpsc::UnboundedSender<Item>,
    /// Weak, so that a sink that outlives the node does not keep it on the network.
    endpoints: Weak<Endpoints>,
    frames: Frames,
    counters: Arc<Counters>,
    comparison: Option<Arc<Comparison>>,
    outputs: Outputs,
    /// Whether somebody draws pictures.
    draws: bool,
    started: bool,
}

impl NodeSink {
    pub(super) fn new(
        queue: mpsc::UnboundedSender<Item>,
        endpoints: &Arc<Endpoints>,
        counters: Arc<Counters>,
        comparison: Option<Arc<Comparison>>,
        (outputs, draws): (Outputs, bool),
    ) -> Self {
        let endpoints = Arc::downgrade(endpoints);
        let frames = Frames::new(Arc::clone(&counters));
        Self { queue, endpoints, frames, counters, comparison, outputs, draws, started: false }
    }

    /// Everything that `served` says, the report last: it closes the increment.
    fn messages(&self, served: &Arc<Served>) -> Vec<Outgoing> {
        let mut messages = Vec::new();
        if let Some(measures) = &served.report.measures {
            messages.push(Outgoing::WallForces(convert::wall_forces(measures)));
            messages.extend(
                (0..wall::COUNT)
                    .map(|wall| Outgoing::Wrench(wall, convert::wall_wrench(measures, wall))),
            );
            messages.push(Outgoing::WallStates(convert::wall_states(measures)));
            messages.extend(convert::pack_state(measures).map(Outgoing::State));
            messages.extend(convert::moduli(measures).map(Outgoing::Moduli));
            messages.extend(convert::fabric(measures).map(|one| Outgoing::Fabric(Box::new(one))));
            messages.extend(convert::hydrate(measures).map(Outgoing::Hydrate));
            messages.extend(convert::shear(measures).map(Outgoing::Shear));
            messages.extend(convert::plane_state(measures).map(Box::new).map(Outgoing::PlaneState));
            messages.extend(convert::tangent(measures).map(Box::new).map(Outgoing::Tangent));
            let cracks = convert::crack_chunks(measures, LIVE_BONDS);
            messages.extend(cracks.map(Box::new).map(Outgoing::Cracks));
            messages.extend(convert::events(measures).map(Outgoing::Event));
            let chunks = rearrangement::chunks(measures, LIVE_GRAINS, LIVE_CONTACTS);
            messages.extend(chunks.map(Outgoing::Rearrangement));
        }
        messages.push(Outgoing::Report(Report::from(&served.report)));
        self.counters.queued.fetch_add(messages.len() as u64, Ordering::Relaxed);
        messages.extend(self.frames.take(served).map(Outgoing::Frame));
        if self.draws && served.report.measures.as_ref().is_some_and(|one| one.grains.is_some()) {
            let pictures = [Picture::Grains, Picture::Markers];
            messages.extend(pictures.map(|one| Outgoing::Picture(one, Arc::clone(served))));
        }
        messages
    }
}

impl Sink for NodeSink {
    /// The initial equilibrium is wanted whole, since its subscribers come later. After it, the
    /// moduli are always wanted, since their topic keeps the last for whoever comes.
    fn demand(&self) -> Demand {
        let endpoints = self.endpoints.upgrade();
        let asked = |listens: fn(&Endpoints) -> bool| {
            !self.started || endpoints.as_deref().is_some_and(listens)
        };
        let when = |ordered, listens: fn(&Endpoints) -> bool| match ordered {
            When::Always => true,
            When::OnDemand => asked(listens),
            When::Never => false,
        };
        let Outputs { contact_network, grain_motion, markers, fabric, rearrangements, .. } =
            self.outputs;
        let Outputs { bonds, cracks, .. } = self.outputs;
        // The markers show the state and the contacts too.
        let marked =
            self.draws && when(markers, |endpoints| endpoints.markers.has_listener(endpoints));
        let clouded =
            self.draws && when(markers, |endpoints| endpoints.grains.has_listener(endpoints));
        Demand {
            grains: marked || clouded,
            grain_motion: when(grain_motion, |endpoints| {
                endpoints.grain_motion.has_listener(endpoints)
            }),
            state: marked || asked(|endpoints| endpoints.state.has_listener(endpoints)),
            moduli: self.outputs.moduli != ModuliKind::None,
            tangent: self.outputs.moduli.takes_tangent(),
            contact_network: when(contact_network, |endpoints| {
                endpoints.contact_network.has_listener(endpoints)
            }) || marked && contact_network != When::Never,
            hydrate: asked(|endpoints| endpoints.hydrate.has_listener(endpoints)),
            shear: asked(|endpoints| endpoints.shear_state.has_listener(endpoints)),
            plane: asked(|endpoints| endpoints.plane_state.has_listener(endpoints)),
            fabric: when(fabric, |endpoints| endpoints.fabric.has_listener(endpoints)),
            rearrangements: when(rearrangements, |endpoints| {
                endpoints.rearrangements.has_listener(endpoints)
            }),
            // Recorded only.
            snapshots: false,
            bonds: when(bonds, |endpoints| endpoints.bonds.has_listener(endpoints))
                || marked && bonds != When::Never,
            cracks: when(cracks, |endpoints| endpoints.cracks.has_listener(endpoints)),
        }
    }

    fn served(&mut self, served: &Arc<Served>) {
        self.counters.health.served(served);
        if let Some(measures) = served.report.measures.as_ref().filter(|_| !self.started) {
            self.counters.queued.fetch_add(1, Ordering::Relaxed);
            let frames = Outgoing::Frames(convert::wall_frames(measures));
            // As below.
            self.queue.send(Item::Answer(vec![frames])).ok();
        }
        self.started = true;
        let messages = self.messages(served);
        let item = match served.command {
            None => Item::Initial(messages),
            Some(_) => Item::Answer(messages),
        };
        // Fails only when the node has stopped; its summary then counts the messages as lost.
        self.queue.send(item).ok();
        if let Some(comparison) = &self.comparison {
            comparison.served(served);
        }
    }
}

/// Publishes what comes out of `queue`, in order.
pub(super) struct Outbox {
    pub endpoints: Arc<Endpoints>,
    pub frames: mpsc::UnboundedSender<Frame>,
    pub easel: Arc<Easel>,
    pub counters: Arc<Counters>,
}

impl Outbox {
    pub(super) async fn run(self, mut queue: mpsc::UnboundedReceiver<Item>) {
        let mut held: Vec<Held> = Vec::new();
        loop {
            let item = if held.is_empty() {
                queue.recv().await
            } else if let Ok(item) = timeout(LOOK, queue.recv()).await {
                item
            } else {
                self.publish_settled(&mut held).await;
                continue;
            };
            let Some(item) = item else { return };
            if let Item::Initial(messages) = item {
                held.extend(messages.into_iter().map(Held::new));
                continue;
            }
            for held in held.drain(..) {
                self.publish(held.message).await;
            }
            match item {
                Item::Answer(messages) => {
                    for message in messages {
                        self.publish(message).await;
                    }
                }
                Item::Flush(done) => {
                    // Fails when the asker did not wait that long.
                    done.send(()).ok();
                }
                Item::Initial(_) => {}
            }
        }
    }

    /// Publishes those of `held` whose subscriber has had time to find the publisher.
    async fn publish_settled(&self, held: &mut Vec<Held>) {
        for mut waiting in std::mem::take(held) {
            if waiting.matched.is_none() && self.has_listener(&waiting.message) {
                waiting.matched = Some(Instant::now());
            }
            if waiting.matched.is_some_and(|since| since.elapsed() >= SETTLE) {
                self.publish(waiting.message).await;
            } else {
                held.push(waiting);
            }
        }
    }

    fn has_listener(&self, message: &Outgoing) -> bool {
        let endpoints = &*self.endpoints;
        match message {
            Outgoing::WallForces(_) => endpoints.wall_forces.has_listener(endpoints),
            Outgoing::Wrench(wall, _) => endpoints.wrenches[*wall].has_listener(endpoints),
            Outgoing::WallStates(_) => endpoints.wall_states.has_listener(endpoints),
            Outgoing::State(_) => endpoints.state.has_listener(endpoints),
            Outgoing::Moduli(_) => endpoints.moduli.has_listener(endpoints),
            Outgoing::Tangent(_) => endpoints.tangent.has_listener(endpoints),
            Outgoing::Frame(frame) => frame.has_listener(endpoints),
            Outgoing::Picture(Picture::Grains, _) => endpoints.grains.has_listener(endpoints),
            Outgoing::Picture(Picture::Markers, _) => endpoints.markers.has_listener(endpoints),
            Outgoing::Event(_) => endpoints.events.has_listener(endpoints),
            Outgoing::Hydrate(_) => endpoints.hydrate.has_listener(endpoints),
            Outgoing::Shear(_) => endpoints.shear_state.has_listener(endpoints),
            Outgoing::PlaneState(_) => endpoints.plane_state.has_listener(endpoints),
            Outgoing::Fabric(_) => endpoints.fabric.has_listener(endpoints),
            Outgoing::Cracks(_) => endpoints.cracks.has_listener(endpoints),
            Outgoing::Rearrangement(_) => endpoints.rearrangements.has_listener(endpoints),
            Outgoing::Report(_) => endpoints.report.has_listener(endpoints),
            Outgoing::Discrepancy(_) => {
                endpoints.discrepancy.as_ref().is_some_and(|out| out.has_listener(endpoints))
            }
            Outgoing::Frames(_) => endpoints.tf_static.has_listener(endpoints),
        }
    }

    async fn publish(&self, message: Outgoing) {
        let endpoints = &*self.endpoints;
        let heard = self.has_listener(&message);
        let published = match message {
            Outgoing::WallForces(message) => endpoints.wall_forces.publish(message).await,
            Outgoing::Wrench(wall, message) => endpoints.wrenches[wall].publish(message).await,
            Outgoing::WallStates(message) => endpoints.wall_states.publish(message).await,
            Outgoing::State(message) => endpoints.state.publish(message).await,
            Outgoing::Moduli(message) => endpoints.moduli.publish(message).await,
            Outgoing::Tangent(message) => endpoints.tangent.publish(*message).await,
            Outgoing::Event(message) => endpoints.events.publish(message).await,
            Outgoing::Hydrate(message) => endpoints.hydrate.publish(message).await,
            Outgoing::Shear(message) => endpoints.shear_state.publish(message).await,
            Outgoing::PlaneState(message) => endpoints.plane_state.publish(*message).await,
            Outgoing::Fabric(message) => endpoints.fabric.publish(*message).await,
            Outgoing::Cracks(message) => endpoints.cracks.publish(*message).await,
            Outgoing::Rearrangement(message) => endpoints.rearrangements.publish(message).await,
            Outgoing::Report(message) => endpoints.report.publish(message).await,
            Outgoing::Discrepancy(message) => match &endpoints.discrepancy {
                Some(out) => out.publish(message).await,
                None => false,
            },
            Outgoing::Frames(message) => endpoints.tf_static.publish(message).await,
            Outgoing::Frame(frame) => {
                if heard {
                    // Fails only when the task that paces the frames is gone, at the end.
                    self.frames.send(frame).ok();
                } else {
                    self.counters.frames_done.fetch_add(1, Ordering::Relaxed);
                }
                return;
            }
            Outgoing::Picture(picture, served) => {
                if heard {
                    self.easel.put(picture, served);
                }
                return;
            }
        };
        let counter = if published { &self.counters.published } else { &self.counters.lost };
        counter.fetch_add(1, Ordering::Relaxed);
        self.counters.done.fetch_add(1, Ordering::Relaxed);
    }
}

/// A message of the initial equilibrium that waits for a subscriber.
struct Held {
    message: Outgoing,
    /// When its topic was first seen to have one.
    matched: Option<Instant>,
}

impl Held {
    fn new(message: Outgoing) -> Self {
        Self { message, matched: None }
    }
}

//! Who takes the answers.

use std::sync::Arc;

use graintwin::record::{Provenance, Recorder};
use graintwin::report::Demand;
use graintwin::scene::Scene;
use graintwin::sink::{Served, Sink};

use crate::linked::Linked;
use crate::variant::Listens;

/// A sink with what it needs to live.
pub(crate) enum Listener {
    Nobody,
    Recorder(Recorder, tempfile::TempDir),
    Node(Box<Linked>),
}

impl Listener {
    pub(crate) fn start(listens: Listens, scene: &Scene) -> Self {
        match listens {
            Listens::Nobody => Self::Nobody,
            Listens::Recorder => {
                let folder = tempfile::tempdir().expect("a folder");
                let provenance = Provenance {
                    scene: String::new(),
                    pack_csv: Vec::new(),
                    pack_json: Vec::new(),
                    pack_history: None,
                    threads: 1,
                    seed: 1,
                    painter: None,
                };
                let bag = folder.path().join("bag");
                let recorder = Recorder::create(&bag, &scene.record, &provenance);
                Self::Recorder(recorder.expect("a new bag"), folder)
            }
            Listens::Node | Listens::Subscriber => {
                Self::Node(Box::new(Linked::start(listens == Listens::Subscriber, scene)))
            }
        }
    }

    /// What it wants of the next increment.
    pub(crate) fn demand(&self) -> Demand {
        match self {
            Self::Nobody => Demand::default(),
            Self::Recorder(recorder, _) => recorder.demand(),
            Self::Node(linked) => linked.sink.demand(),
        }
    }

    pub(crate) fn served(&mut self, served: &Arc<Served>) {
        match self {
            Self::Nobody => {}
            Self::Recorder(recorder, _) => recorder.served(served),
            Self::Node(linked) => linked.sink.served(served),
        }
    }

    /// Waits until a subscriber that is to come is there.
    pub(crate) fn settle(&self) {
        match self {
            Self::Node(linked) => linked.settle(),
            Self::Nobody | Self::Recorder(..) => {}
        }
    }

    /// Publishes and writes what is left.
    pub(crate) fn end(self) {
        match self {
            Self::Nobody => {}
            Self::Recorder(recorder, _folder) => {
                recorder.finish().expect("the bag is written");
            }
            Self::Node(linked) => linked.end(),
        }
    }
}

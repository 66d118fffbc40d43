//! `run --record`: the recorder among the sinks.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use graintwin::command::circumstance::Happened;
use graintwin::pack::{self, Pack};
use graintwin::record::{Closing, HISTORY, Provenance, RecordError, Recorded, Recorder, claim};
use graintwin::report::Demand;
use graintwin::scene::{Loaded, OnFailure};
use graintwin::sink::{Served, Sink};

use super::Failure;

/// Makes sure that `folder` can take a recording, before the run costs any time.
pub(super) fn reserve(folder: &Path) -> Result<(), Failure> {
    claim(folder).map_err(Failure::input)
}

/// A recorder that says on stderr when it fails, and ends the run then if the scene says so.
pub(super) struct Recording {
    recorder: Recorder,
}

impl Recording {
    pub(super) fn start(
        folder: &Path,
        loaded: &Loaded,
        pack: &Pack,
        threads: usize,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let pack = pack::texts(pack, HISTORY)?;
        let provenance = Provenance {
            scene: loaded.scene.to_yaml()?,
            pack_csv: pack.csv.into_bytes(),
            pack_json: pack.json.into_bytes(),
            pack_history: pack.history.map(String::into_bytes),
            threads,
            seed: loaded.scene.pack.seed(),
        };
        let settings = &loaded.scene.record;
        let recorder = Recorder::create(folder, settings, &provenance).map_err(Failure::input)?;
        let (on_failure, stop) = (settings.on_failure, Arc::clone(stop));
        recorder.tell_failure(move |failure| match on_failure {
            OnFailure::Continue => {
                tracing::error!("{failure}; the run goes on without recording");
            }
            OnFailure::Stop => {
                tracing::error!("{failure}; the run ends after this increment");
                stop.store(true, Ordering::SeqCst);
            }
        });
        Ok(Self { recorder })
    }

    /// The recording for the node.
    #[cfg(feature = "ros")]
    pub(super) fn handle(&self) -> Arc<dyn graintwin::sink::Recording> {
        Arc::new(self.recorder.handle())
    }

    /// How the run ended.
    pub(super) fn close_with(&mut self, closing: Closing) {
        self.recorder.close_with(closing);
    }

    pub(super) fn finish(self) -> Result<Recorded, RecordError> {
        self.recorder.finish()
    }
}

impl Sink for &mut Recording {
    fn demand(&self) -> Demand {
        self.recorder.demand()
    }

    fn happened(&mut self, happened: &Happened) {
        self.recorder.happened(happened);
    }

    fn served(&mut self, served: &Arc<Served>) {
        self.recorder.served(served);
    }
}

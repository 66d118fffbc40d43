//! `run --record`: the recorder among the sinks.

use std::path::Path;
use std::sync::Arc;

use graintwin::command::circumstance::Happened;
use graintwin::pack::{self, Pack};
use graintwin::record::{Closing, HISTORY, Provenance, RecordError, Recorded, Recorder, claim};
use graintwin::report::Demand;
use graintwin::scene::Loaded;
use graintwin::sink::{Served, Sink};

use super::Failure;

/// Makes sure that `folder` can take a recording, before the run costs any time.
pub(super) fn reserve(folder: &Path) -> Result<(), Failure> {
    claim(folder).map_err(Failure::input)
}

/// A recorder that says on stderr when it fails.
pub(super) struct Recording {
    recorder: Recorder,
    told: bool,
}

impl Recording {
    pub(super) fn start(
        folder: &Path,
        loaded: &Loaded,
        pack: &Pack,
        threads: usize,
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
        let recorder = Recorder::create(folder, &loaded.scene.record, &provenance);
        Ok(Self { recorder: recorder.map_err(Failure::input)?, told: false })
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
        if !self.told
            && let Some(failure) = self.recorder.failure()
        {
            tracing::error!("{failure}; the run goes on without recording");
            self.told = true;
        }
    }
}

//! `run --record`: the recorder among the sinks.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use graintwin::command::circumstance::Happened;
use graintwin::pack::{self, Pack};
use graintwin::record::{Closing, HISTORY, Provenance, Recorder, claim};
use graintwin::report::Demand;
use graintwin::scene::{Loaded, OnFailure};
use graintwin::sink::{Served, Sink};
use graintwin::twin::Twin;
use graintwin::view::picture::Painter;

use super::Failure;
use super::summary::Summary;

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
        let provenance = provenance(loaded, pack, threads)?;
        let recorder = Recorder::create(folder, &loaded.scene.record, &provenance);
        Ok(Self::of(recorder.map_err(Failure::input)?, loaded, stop))
    }

    /// Goes on behind the whole recording in `folder`.
    pub(super) fn resume(
        folder: &Path,
        loaded: &Loaded,
        pack: &Pack,
        threads: usize,
        stop: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        let provenance = provenance(loaded, pack, threads)?;
        let recorder = Recorder::resume(folder, &loaded.scene.record, &provenance);
        Ok(Self::of(recorder.map_err(Failure::input)?, loaded, stop))
    }

    fn of(recorder: Recorder, loaded: &Loaded, stop: &Arc<AtomicBool>) -> Self {
        let (on_failure, stop) = (loaded.scene.record.on_failure, Arc::clone(stop));
        recorder.tell_failure(move |failure| match on_failure {
            OnFailure::Continue => {
                tracing::error!("{failure}; the run goes on without recording");
            }
            OnFailure::Stop => {
                tracing::error!("{failure}; the run ends after this increment");
                stop.store(true, Ordering::SeqCst);
            }
        });
        Self { recorder }
    }

    /// The recording for the node.
    pub(super) fn handle(&self) -> Arc<dyn graintwin::sink::Recording> {
        Arc::new(self.recorder.handle())
    }

    /// Ends it with what `twin` came to, and tells the summary.
    pub(super) fn end(mut self, twin: &Twin, summary: &mut Summary) {
        let (increment, digest) = (twin.increment(), twin.digest());
        self.recorder.close_with(Closing { increment, digest });
        summary.recorded(self.recorder.finish());
    }
}

/// What makes the recording.
fn provenance(loaded: &Loaded, pack: &Pack, threads: usize) -> Result<Provenance, Failure> {
    let painter = Some(Painter::new(&loaded.scene, &pack.bounds, pack.grains.len()));
    let pack = pack::texts(pack, HISTORY)?;
    Ok(Provenance {
        scene: loaded.scene.to_yaml()?,
        pack_csv: pack.csv.into_bytes(),
        pack_json: pack.json.into_bytes(),
        pack_history: pack.history.map(String::into_bytes),
        threads,
        seed: loaded.scene.pack.seed(),
        painter,
    })
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

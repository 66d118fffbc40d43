//! No recording without the feature `mcap`.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use graintwin::pack::Pack;
use graintwin::report::Demand;
use graintwin::scene::Loaded;
use graintwin::sink::{self, Served, Sink};
use graintwin::twin::Twin;

use crate::cli::Failure;
use crate::cli::summary::Summary;

/// There is none.
pub(in crate::cli) enum Recording {}

/// Nobody asks for one.
pub(in crate::cli) fn reserve(_: &Path) -> Result<(), Failure> {
    Ok(())
}

impl Recording {
    pub(in crate::cli) fn start(
        _: &Path,
        _: &Loaded,
        _: &Pack,
        _: usize,
        _: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        Err(Failure::Input(anyhow::anyhow!("this program was built without the feature `mcap`")))
    }

    pub(in crate::cli) fn handle(&self) -> Arc<dyn sink::Recording> {
        match *self {}
    }

    pub(in crate::cli) fn end(self, _: &Twin, _: &mut Summary) {
        match self {}
    }
}

impl Sink for &mut Recording {
    fn demand(&self) -> Demand {
        match **self {}
    }

    fn served(&mut self, _: &Arc<Served>) {
        match **self {}
    }
}

//! No recording to go on with without the feature `mcap`.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use graintwin::pack::Pack;
use graintwin::scene::Loaded;
use graintwin::sink::Sink;
use graintwin::twin::Twin;

use crate::cli::Failure;
use crate::cli::orders::Intakes;
use crate::cli::recording::Recording;

/// There is none.
pub(in crate::cli) enum Earlier {}

impl Earlier {
    pub(in crate::cli) fn open(_: &Path) -> Result<Self, Failure> {
        Err(Failure::Input(anyhow::anyhow!("this program was built without the feature `mcap`")))
    }

    pub(in crate::cli) fn scene(&self) -> Result<Loaded, Failure> {
        match *self {}
    }

    pub(in crate::cli) fn pack(&self, _: &Loaded) -> Result<Pack, Failure> {
        match *self {}
    }

    pub(in crate::cli) fn catch_up(
        &self,
        _: &Loaded,
        _: &mut Twin,
        _: Option<&mut Intakes<'_>>,
        _: &mut [Box<dyn Sink + '_>],
    ) -> Result<(), Failure> {
        match *self {}
    }

    pub(in crate::cli) fn go_on(
        &self,
        _: &Loaded,
        _: &Pack,
        _: usize,
        _: &Arc<AtomicBool>,
    ) -> Result<Recording, Failure> {
        match *self {}
    }
}

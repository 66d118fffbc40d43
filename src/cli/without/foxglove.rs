//! No live server without the feature `foxglove`.

use graintwin::sink::Sink;
use graintwin::view::picture::Painter;

use crate::cli::Failure;

/// Nobody can ask for one.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Asked {}

impl Asked {
    pub(in crate::cli) fn start(&self) -> Result<Option<Live>, Failure> {
        Ok(None)
    }
}

/// There is none.
pub(in crate::cli) enum Live {}

impl Live {
    pub(in crate::cli) fn sink(&mut self, _: Painter) -> Result<Box<dyn Sink>, Failure> {
        match *self {}
    }

    pub(in crate::cli) fn end(self) {
        match self {}
    }
}

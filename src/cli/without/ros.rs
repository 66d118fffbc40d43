//! No node without the feature `ros`.
#![allow(clippy::needless_pass_by_value, reason = "the real ones keep what they are given")]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use graintwin::scene::Scene;
use graintwin::sink::{Recording, Sink};
use graintwin::view::picture::Painter;

use crate::cli::job::Sender;
use crate::cli::log::ForNode;
use crate::cli::orders::Orders;
use crate::cli::source::Source;
use crate::cli::summary::Summary;
use crate::cli::{Cli, Failure};

/// There is none.
pub(in crate::cli) enum Setup {}

/// There is none.
pub(in crate::cli) enum Link {}

/// Nobody asks for one.
pub(in crate::cli) fn setup(
    _: bool,
    _: &Cli,
    _: &mut Scene,
    (): ForNode,
) -> Result<Option<Setup>, Failure> {
    Ok(None)
}

pub(in crate::cli) fn drawn_by(setup: Setup, _: Painter) -> Setup {
    match setup {}
}

impl Link {
    pub(in crate::cli) fn start(
        _: &Scene,
        setup: Setup,
        _: Orders,
        _: Sender,
        _: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        match setup {}
    }

    pub(in crate::cli) fn showing(
        _: &Scene,
        setup: Setup,
        _: &Arc<AtomicBool>,
    ) -> Result<Self, Failure> {
        match setup {}
    }

    pub(in crate::cli) fn diagnose(&mut self, _: &Scene, _: Option<Arc<dyn Recording>>) {
        match *self {}
    }

    pub(in crate::cli) fn length(&self) -> Option<usize> {
        match *self {}
    }

    pub(in crate::cli) fn sink(&self) -> Box<dyn Sink> {
        match *self {}
    }

    pub(in crate::cli) fn commands(&mut self) -> Box<dyn Source + '_> {
        match *self {}
    }

    pub(in crate::cli) fn end_into(self, _: &mut Summary) {
        match self {}
    }
}

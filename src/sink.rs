//! Where the answers go: the node, the recorder, the summary, each behind the same door.

use std::sync::Arc;

use crate::command::Command;
use crate::report::{Demand, Report};

/// One command with its report; the initial equilibrium has no command.
#[derive(Debug)]
pub struct Served {
    /// What was asked.
    pub command: Option<Command>,
    /// What became of it.
    pub report: Report,
}

/// Somebody who wants the answers. Called on the solver's thread: hand over and return.
pub trait Sink {
    /// What this sink wants of the next increment.
    fn demand(&self) -> Demand;

    /// Takes one answer.
    fn served(&mut self, served: &Arc<Served>);
}

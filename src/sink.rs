//! Where the answers go: the node, the recorder, the summary, each behind the same door.

use std::sync::Arc;

use crate::command::Command;
use crate::command::circumstance::Happened;
use crate::msg::rcl::{Log, ParameterEvent};
use crate::msg::{DiagnosticArray, Discrepancy, JointState, JointTrajectory, WrenchStamped};
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

    /// Takes what else bears on the answers, in its order among them.
    fn happened(&mut self, _happened: &Happened) {}
}

/// What comes and goes beside commands and answers.
#[derive(Clone, Debug, PartialEq)]
pub enum Beside {
    /// What the load cell of a wall of the real rig measured.
    Measured(usize, WrenchStamped),
    /// How an increment compares with that.
    Discrepancy(Discrepancy),
    /// What the joints of the rig said, as it came; the twin is moved by the command made of it.
    JointStates(JointState),
    /// What path the joints of the rig were to take, as it came.
    JointTrajectory(JointTrajectory),
    /// How the program fares.
    Diagnostics(DiagnosticArray),
    /// What the program logs.
    Log(Log),
    /// What parameters were set.
    ParameterEvent(ParameterEvent),
}

/// How a recording fares.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordingState {
    /// Messages in it.
    pub messages: u64,
    /// Size of its files on disk.
    pub bytes: u64,
    /// Answers, and messages beside them, that are not in it.
    pub lost: u64,
    /// Bytes that its file system has left, where the system tells.
    pub free: Option<u64>,
    /// What went wrong.
    pub failure: Option<String>,
}

/// A recording as seen from threads that are not the solver's.
pub trait Recording: Send + Sync {
    /// Takes what came or went; waits while the disk is slower.
    fn beside(&self, beside: Beside);

    /// How it fares.
    fn state(&self) -> RecordingState;
}

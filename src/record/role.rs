//! What the messages of a recording are to the run.

use crate::msg::topics::{self, Topic};

/// What the messages on a topic are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A command: an answer begins.
    Command,
    /// What else bears on the answers.
    Circumstance,
    /// A report: an answer is whole.
    Report,
    /// A measure.
    Measure,
    /// Where the walls are: measured at a start, and repeated in front of each further file.
    Frames,
    /// It came or went beside the twin.
    Beside,
}

impl Role {
    /// Of the messages on the recorded topic `name`.
    pub(super) fn of(name: &str) -> Self {
        let is = |known: &Topic| known.recorded_name() == name;
        if topics::commands().any(is) {
            Self::Command
        } else if is(&topics::CIRCUMSTANCE) {
            Self::Circumstance
        } else if is(&topics::REPORT) {
            Self::Report
        } else if is(&topics::TF_STATIC) {
            Self::Frames
        } else if topics::measures().any(is) {
            Self::Measure
        } else {
            Self::Beside
        }
    }
}

//! What besides commands bears on the twin's answers.

use super::Stamp;
use super::request::{Answer, Request};
use crate::twin::Settings;

/// Something that has to happen again, at its place among the commands, for the answers to be the
/// same again.
#[derive(Clone, Debug, PartialEq)]
pub enum Circumstance {
    /// Somebody asked for something and got this answer.
    Asked(Request, Answer),
    /// These settings hold from here on.
    Settings(Settings),
    /// The command that follows was that old when it came \[s\], and is refused for it.
    Age(f64),
    /// The command that follows stands for a message that makes none, for this reason.
    Malformed(String),
}

/// A circumstance with its place and time.
#[derive(Clone, Debug, PartialEq)]
pub struct Happened {
    /// The increment at which it happened.
    pub increment: u64,
    /// When, by the clock of the machine.
    pub stamp: Stamp,
    /// What.
    pub what: Circumstance,
}

//! What else can be asked of a twin between two commands, and how the answer gets back.

use std::fmt;
use std::path::PathBuf;

use super::Command;

/// Whatever comes to the twin, in the order in which it came.
#[derive(Debug)]
pub enum Intake {
    /// Move the walls.
    Command(Command),
    /// A message that makes no command: what stands for it, and what is wrong with it.
    Malformed(Command, String),
    /// Anything else.
    Request(Asked),
}

impl From<Command> for Intake {
    fn from(command: Command) -> Self {
        Self::Command(command)
    }
}

/// Something other than moving the walls.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Back to the initial equilibrium: increment 0 again, no command remembered.
    Reset,
    /// The pack as it is now into this file.
    SavePack(PathBuf),
    /// Refuse every command as held, or serve them again.
    Hold(bool),
    /// Forget the faults that keep the twin on hold.
    ResetFaults,
}

/// Done, or refused; either with a sentence.
pub type Answer = Result<String, String>;

/// A request with the way back to who asked.
pub struct Asked {
    /// What is asked.
    pub request: Request,
    reply: Box<dyn FnOnce(Answer) + Send>,
}

impl Asked {
    /// `reply` is called once, with the answer, on the solver's thread: it hands over and returns.
    #[must_use]
    pub fn new(request: Request, reply: impl FnOnce(Answer) + Send + 'static) -> Self {
        Self { request, reply: Box::new(reply) }
    }

    /// Answers.
    pub fn answer(self, answer: Answer) {
        (self.reply)(answer);
    }
}

impl fmt::Debug for Asked {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.debug_tuple("Asked").field(&self.request).finish()
    }
}

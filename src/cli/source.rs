//! Where commands and requests come from.

use std::collections::VecDeque;
use std::vec;

use graintwin::command::Command;
use graintwin::command::request::Intake;

/// Somebody who hands over what comes to the twin.
pub(super) trait Source {
    /// The next one. Waits for it; `None` is the end.
    fn next(&mut self) -> Option<Intake>;

    /// Puts behind `waiting` what has come already, until it holds `most`. Waits for nothing.
    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize);
}

/// Commands from a file. They have time: none is behind.
pub(super) struct Given(vec::IntoIter<Command>);

impl Given {
    pub(super) fn new(commands: Vec<Command>) -> Self {
        Self(commands.into_iter())
    }
}

impl Source for Given {
    fn next(&mut self) -> Option<Intake> {
        self.0.next().map(Intake::from)
    }

    fn overtake(&mut self, _: &mut VecDeque<Intake>, _: usize) {}
}

#[cfg(feature = "ros")]
impl Source for &mut graintwin::node::Commands {
    fn next(&mut self) -> Option<Intake> {
        Iterator::next(*self)
    }

    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize) {
        while waiting.len() < most
            && let Some(intake) = self.next_waiting()
        {
            waiting.push_back(intake);
        }
    }
}

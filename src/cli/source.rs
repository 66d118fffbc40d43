//! Where commands and requests come from.

use std::collections::VecDeque;

use graintwin::command::request::Intake;
use graintwin::scene::Late;
use graintwin::twin::Settings;

/// Somebody who hands over what comes to the twin.
pub(super) trait Source {
    /// The next one. Waits for it; `None` is the end.
    fn next(&mut self) -> Option<Intake>;

    /// What somebody has set since the last call, and what is to happen to late commands then.
    fn changed(&mut self) -> Option<(Settings, Late)> {
        None
    }

    /// Puts behind `waiting` what has come already, until it holds `most`. Waits for nothing.
    fn overtake(&mut self, waiting: &mut VecDeque<Intake>, most: usize);
}

/// What is there from the beginning, as in a file. It has time: nothing waits.
pub(super) struct Given<I>(pub(super) I);

impl<I: Iterator<Item = Intake>> Source for Given<I> {
    fn next(&mut self) -> Option<Intake> {
        self.0.next()
    }

    fn overtake(&mut self, _: &mut VecDeque<Intake>, _: usize) {}
}

//! Where commands and requests come from.

use std::collections::VecDeque;

use graintwin::command::request::Intake;

/// Somebody who hands over what comes to the twin.
pub(super) trait Source {
    /// The next one. Waits for it; `None` is the end.
    fn next(&mut self) -> Option<Intake>;

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

//! Messages in the order in which they were recorded, out of a file that is only roughly in it.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::Message;

/// Most messages that are held back to be put in order.
const MOST: usize = 4096;

/// Most bytes of them.
const MOST_BYTES: usize = 16 << 20;

/// Holds back messages until those that were recorded before them have come.
#[derive(Default)]
pub(super) struct Window {
    held: BinaryHeap<Reverse<Held>>,
    bytes: usize,
    /// Messages put in so far.
    count: u64,
    /// When the last message was recorded that was given out.
    last: u64,
}

/// A message that came too late: its number, counted from 1, and by how much \[ns\].
pub(super) struct TooLate {
    pub(super) number: u64,
    pub(super) nanoseconds: u64,
}

struct Held {
    number: u64,
    message: Message,
}

impl Window {
    /// Takes the next message of the file.
    pub(super) fn put(&mut self, message: Message) -> Result<(), TooLate> {
        self.count += 1;
        if message.log_time < self.last {
            let nanoseconds = self.last - message.log_time;
            return Err(TooLate { number: self.count, nanoseconds });
        }
        self.bytes += message.data.len();
        self.held.push(Reverse(Held { number: self.count, message }));
        Ok(())
    }

    /// The next message, when enough others are held or `all` have come.
    pub(super) fn take(&mut self, all: bool) -> Option<Message> {
        if !all && self.held.len() < MOST && self.bytes < MOST_BYTES {
            return None;
        }
        let Reverse(Held { message, .. }) = self.held.pop()?;
        self.bytes -= message.data.len();
        self.last = message.log_time;
        Some(message)
    }
}

impl Held {
    /// Those of one moment stay in the order of the file.
    fn key(&self) -> (u64, u64) {
        (self.message.log_time, self.number)
    }
}

impl PartialEq for Held {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for Held {}

impl PartialOrd for Held {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Held {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.key().cmp(&other.key())
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::Channel;
    use super::*;

    fn message(log_time: u64, data: Vec<u8>) -> Message {
        let (topic, kind, encoding, about) = Default::default();
        let definition = "".into();
        let channel = Channel { topic, kind, encoding, definition, about, schema: None };
        Message { channel: Arc::new(channel), log_time, publish_time: 0, sequence: 0, data }
    }

    fn through(messages: impl IntoIterator<Item = Message>) -> Result<Vec<(u64, Vec<u8>)>, u64> {
        let mut window = Window::default();
        let mut out = Vec::new();
        for message in messages {
            window.put(message).map_err(|late| late.number)?;
            out.extend(window.take(false));
        }
        out.extend(std::iter::from_fn(|| window.take(true)));
        Ok(out.into_iter().map(|message| (message.log_time, message.data)).collect())
    }

    #[test]
    fn messages_of_one_moment_stay_in_the_order_of_the_file() {
        let out = through([(7, 1), (5, 2), (7, 3), (5, 4)].map(|(time, n)| message(time, vec![n])));
        assert_eq!(out.unwrap(), [(5, vec![2]), (5, vec![4]), (7, vec![1]), (7, vec![3])]);
    }

    #[test]
    fn a_message_further_behind_than_the_window_is_refused() {
        let times = |late_at: u64| {
            let behind = (0..late_at).map(|time| message(1000 + time, vec![]));
            through(behind.chain([message(1000, vec![])]))
        };
        assert!(times(MOST as u64 - 1).is_ok());
        assert_eq!(times(MOST as u64 + 1).unwrap_err(), MOST as u64 + 2);
    }

    #[test]
    fn large_messages_are_not_held_by_the_thousand() {
        let mut window = Window::default();
        for time in 0..100 {
            window.put(message(time, vec![0; 1 << 20])).ok().unwrap();
            window.take(false);
            assert!(window.bytes <= MOST_BYTES, "{}", window.bytes);
        }
    }
}

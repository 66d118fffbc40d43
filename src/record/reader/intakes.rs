//! The commands in a bag, and what else was meant as such, as the live node would have them.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;

use serde::de::DeserializeOwned;

use super::items::{Item, Items};
use super::source::{Reader, Scan, Source};
use super::window::{TooLate, Window};
use super::{Bag, Message, ReadError};
use crate::command::request::Intake;
use crate::command::{Ask, Command, Mode, Stamp};
use crate::msg::{
    BoundaryCommand, Described, Dissociation, MessageType, ShearCommand, WallTargets, cdr,
};
use crate::wall;

/// Largest message that is taken apart \[bytes\]: a trajectory of 80 000 points.
const LARGEST: usize = 8 << 20;

/// The commands of a bag; see [`Bag::intakes`].
pub struct Intakes {
    bag: PathBuf,
    items: Items,
    readers: BTreeMap<String, Reader>,
    window: Window,
    /// What the last message became.
    ready: VecDeque<(u64, Intake)>,
    /// What ends the reading, behind what is in the window.
    end: Option<Option<ReadError>>,
    messages: u64,
    damage: Option<ReadError>,
}

impl Intakes {
    pub(super) fn new(bag: &Bag, source: &Source<'_>) -> Result<Self, ReadError> {
        let scan = Scan::of(bag)?;
        // The damage is a better reason than that there is nothing before it.
        let (readers, messages) = match scan.choose(source) {
            Ok(chosen) => chosen,
            Err(error) => return Err(scan.damage.unwrap_or(error)),
        };
        Ok(Self {
            bag: bag.path.clone(),
            items: bag.items(),
            readers,
            window: Window::default(),
            ready: VecDeque::new(),
            end: None,
            messages,
            damage: scan.damage,
        })
    }

    /// Messages that commands are made of. A trajectory is one.
    #[must_use]
    pub fn messages(&self) -> u64 {
        self.messages
    }

    /// The topics that they are on, by name.
    pub fn topics(&self) -> impl Iterator<Item = &str> {
        self.readers.keys().map(String::as_str)
    }

    /// Where the bag stops making sense; the last item says so too.
    #[must_use]
    pub fn damage(&self) -> Option<&ReadError> {
        self.damage.as_ref()
    }

    /// Reads on until the window gives something out.
    fn message(&mut self) -> Option<Message> {
        loop {
            if let Some(message) = self.window.take(self.end.is_some()) {
                return Some(message);
            }
            if self.end.is_some() {
                return None;
            }
            match self.items.next() {
                Some(Ok(Item::Message(message))) => self.put(message),
                Some(Ok(_)) => {}
                Some(Err(error)) => self.end = Some(Some(error)),
                None => self.end = Some(None),
            }
        }
    }

    fn put(&mut self, mut message: Message) {
        if !self.readers.contains_key(&message.channel.topic) {
            return;
        }
        // What is too large shows as much by a byte more than is read.
        message.data.truncate(LARGEST + 1);
        if let Err(TooLate { number, nanoseconds }) = self.window.put(message) {
            let seconds = nanoseconds as f64 * 1e-9;
            self.end =
                Some(Some(ReadError::OutOfOrder { path: self.bag.clone(), number, seconds }));
        }
    }
}

impl Iterator for Intakes {
    type Item = Result<(u64, Intake), ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(intake) = self.ready.pop_front() {
                return Some(Ok(intake));
            }
            let Some(message) = self.message() else {
                return self.end.as_mut()?.take().map(Err);
            };
            let reader = self.readers.get_mut(&message.channel.topic)?;
            let time = message.log_time;
            self.ready.extend(reader.read(&message).into_iter().map(|intake| (time, intake)));
        }
    }
}

impl Reader {
    /// What the message asks. None is lost: one that cannot be read becomes an intake that says so.
    fn read(&mut self, message: &Message) -> Vec<Intake> {
        // What stands for a message without a stamp of its own.
        let stamp = i64::try_from(message.log_time).ok();
        let stamp = stamp.and_then(|time| Stamp::default().later(time)).unwrap_or_default();
        let bytes = &message.data;
        let read = match self {
            Self::Boundary => decode::<BoundaryCommand>(bytes).map(proper),
            Self::Targets => decode::<WallTargets>(bytes).map(proper),
            Self::Dissociation => decode::<Dissociation>(bytes).map(proper),
            Self::Shear => decode::<ShearCommand>(bytes).map(proper),
            Self::States(map) => decode(bytes).map(|states| vec![map.intake(&states, None)]),
            Self::Trajectory(map) => decode(bytes).map(|points| map.intakes(&points, None)),
        };
        read.unwrap_or_else(|text| {
            vec![match self {
                Self::Boundary | Self::Targets | Self::Dissociation | Self::Shear => {
                    Intake::Malformed(nameless(stamp), text)
                }
                Self::States(map) => map.unreadable(stamp, text),
                Self::Trajectory(map) => map.unreadable(stamp, text),
            }]
        })
    }
}

fn proper(command: impl Into<Command>) -> Vec<Intake> {
    vec![Intake::Command(command.into())]
}

/// Stands for a command whose session and number cannot be read.
fn nameless(stamp: Stamp) -> Command {
    Command {
        stamp,
        session: String::new(),
        sequence: 0,
        mode: Mode::Absolute,
        ask: Ask::Displacement([f64::NAN; wall::COUNT]),
        age: None,
    }
}

/// The message in `bytes`, or a sentence about them.
fn decode<T: Described + DeserializeOwned>(bytes: &[u8]) -> Result<T, String> {
    let unreadable = |reason: String| format!("the message cannot be read: {reason}");
    if bytes.len() > LARGEST {
        let kind: &MessageType = T::TYPE;
        let name = kind.full_name();
        return Err(unreadable(format!("{name}: it has more than {LARGEST} bytes")));
    }
    cdr::decode(bytes).map_err(|error| unreadable(error.to_string()))
}

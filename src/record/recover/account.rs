//! What a bag holds that is whole.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::track::Track;
use crate::msg::topics;
use crate::record::bag::{Channel, Contents};
use crate::record::reader::{Bag, Item, ReadError};
use crate::record::target::DESCRIPTION;
use crate::record::{PROGRAM, metadata};

/// What a bag holds, and how much of it is whole.
#[derive(Debug, Default)]
pub struct Account {
    /// Whether this program recorded it: then what counts are whole answers, else whole messages.
    pub own: bool,
    /// Its files in order.
    pub files: Vec<File>,
    /// Whether rosbag2's description of the folder, without which ROS 2 does not open it, names all
    /// of them.
    pub described: bool,
    /// Messages that are whole, or came beside what is.
    pub kept: u64,
    /// Messages that belong to an answer that was cut off.
    pub dropped: u64,
    /// What the whole answers say, in an own bag.
    pub answers: Answers,
    /// Messages up to the end of the last whole answer.
    pub(super) whole: u64,
    /// The last frames of the walls: bytes and `publish_time`.
    pub(super) frames: Option<(Vec<u8>, u64)>,
}

/// A file of a bag.
#[derive(Debug)]
pub struct File {
    /// Where it is.
    pub path: PathBuf,
    /// Messages in it that can be read.
    pub messages: u64,
    /// Where it stops making sense.
    pub damage: Option<ReadError>,
    /// Whether it is behind a damage and was not read: without what is lost before it, what is in it
    /// cannot be replayed.
    pub behind: bool,
    pub(super) contents: Contents,
    /// Messages in the files before it.
    pub(super) before: u64,
}

/// The whole answers of an own bag.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answers {
    /// Reports by disposition; the initial equilibrium and resets are not among them.
    pub dispositions: BTreeMap<u8, u64>,
    /// How often the twin was brought to its initial equilibrium.
    pub starts: u64,
    /// Session, sequence and increment of the last report.
    pub last: Option<(String, u64, u64)>,
    /// Commands whose report was cut off.
    pub unanswered: u64,
}

impl Account {
    /// Reads all of `bag`, but what is behind the damage of an own one.
    ///
    /// # Errors
    /// When the system cannot read it.
    pub fn of(bag: &Bag) -> Result<Self, ReadError> {
        let mut account = Self::default();
        let mut track = Track::default();
        for (path, items) in bag.files() {
            let behind = account.own && account.is_damaged();
            let before = track.messages();
            let mut file = File {
                path: path.to_owned(),
                messages: 0,
                damage: None,
                behind,
                contents: Contents::default(),
                before,
            };
            if !behind {
                for item in items {
                    match item {
                        Ok(item) => account.take(item, &mut file, &mut track),
                        Err(damage @ ReadError::Damaged { .. }) => file.damage = Some(damage),
                        Err(error) => return Err(error),
                    }
                }
            }
            file.messages = track.messages() - before;
            account.files.push(file);
        }
        if account.own {
            (account.whole, account.kept, account.answers) = track.end();
        } else {
            (account.whole, account.kept) = (track.messages(), track.messages());
        }
        account.dropped = track.messages() - account.kept;
        account.described = !bag.path().is_dir() || is_described(bag.path(), &account.files);
        Ok(account)
    }

    /// Whether a file stops making sense somewhere.
    #[must_use]
    pub fn is_damaged(&self) -> bool {
        self.files.iter().any(|file| file.damage.is_some())
    }

    /// Whether every file is whole, and every answer, and the description of the folder.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        !self.is_damaged() && self.dropped == 0 && self.described
    }

    fn take(&mut self, item: Item, file: &mut File, track: &mut Track) {
        match item {
            Item::Channel(channel) => {
                if self.own {
                    track.channel(&channel.topic);
                }
                file.contents.channels.push(Channel::from(&*channel));
            }
            Item::Message(message) => {
                file.contents.reaches(message.log_time);
                let topic = &message.channel.topic;
                // A channel may be there twice, under two numbers.
                let channels = &mut file.contents.channels;
                if let Some(known) = channels.iter_mut().find(|known| known.topic == *topic) {
                    known.messages += 1;
                }
                track.take(&message, self.own);
                if self.own && *topic == topics::TF_STATIC.recorded_name() {
                    self.frames = Some((message.data, message.publish_time));
                }
            }
            Item::Metadata { name, .. } => self.own |= name == PROGRAM && track.messages() == 0,
            Item::Attachment { .. } => {}
        }
    }
}

fn is_described(folder: &Path, files: &[File]) -> bool {
    let Ok(text) = fs::read_to_string(folder.join(DESCRIPTION)) else { return false };
    let names = |file: &File| {
        let name = file.path.file_name().unwrap_or_default().to_string_lossy();
        // Others write names without quotes, where they can.
        text.contains(&*name) || text.contains(&metadata::quoted(&name))
    };
    files.iter().all(names)
}

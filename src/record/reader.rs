//! Recordings as input: what is in a bag, and the commands in it.
//!
//! Reads rosbag2 folders with MCAP files and such files alone, its own and those of others, from
//! the front and record by record: memory is bounded by the largest record and chunk. A file that
//! is cut off is read up to its last whole message; one that is damaged, up to the damage.

mod commands;
mod error;
mod fields;
mod items;
mod records;
mod survey;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::msg::MessageType;
pub(in crate::record) use items::{Item, Items};

pub use commands::Commands;
pub use error::ReadError;
pub use records::Damage;
pub use survey::{AttachmentSummary, Survey, TopicSummary};

/// A topic of a bag.
#[derive(Debug, PartialEq, Eq)]
pub struct Channel {
    /// Name of the topic.
    pub topic: String,
    /// Name of its type, as `graintwin_msgs/msg/Report`.
    pub kind: String,
    /// Encoding of its messages; `cdr` in a bag of ROS 2.
    pub encoding: String,
    /// Text of the type's definition.
    pub definition: String,
}

impl Channel {
    /// Whether its messages are called `kind`.
    #[must_use]
    pub fn has_type(&self, kind: &MessageType) -> bool {
        self.kind.split_once("/msg/") == Some((kind.package, kind.name))
    }

    /// Whether its definition has the fields of `kind`.
    #[must_use]
    pub fn has_fields(&self, kind: &'static MessageType) -> bool {
        commands::same_fields(&self.definition, &kind.definition())
    }
}

/// One message of a bag.
#[derive(Debug)]
pub struct Message {
    /// What it came on.
    pub channel: Arc<Channel>,
    /// When it was recorded \[ns since 1970\].
    pub log_time: u64,
    /// When it was sent \[ns\].
    pub publish_time: u64,
    /// Its bytes.
    pub data: Vec<u8>,
}

/// A bag on disk.
#[derive(Debug)]
pub struct Bag {
    path: PathBuf,
    files: Vec<PathBuf>,
}

impl Bag {
    /// The bag at `path`: a folder with MCAP files, or one such file.
    ///
    /// # Errors
    /// When there is none.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let failed = |error| ReadError::Io { path: path.to_owned(), error };
        let mut files = Vec::new();
        if path.is_dir() {
            for entry in fs::read_dir(path).map_err(failed)? {
                let file = entry.map_err(failed)?.path();
                if file.extension().is_some_and(|extension| extension == "mcap") {
                    files.push(file);
                }
            }
            // Parts are numbered without leading zeros.
            files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
        } else {
            fs::metadata(path).map_err(failed)?;
            files.push(path.to_owned());
        }
        if files.is_empty() {
            return Err(ReadError::NoBag(path.to_owned()));
        }
        Ok(Self { path: path.to_owned(), files })
    }

    /// The folder or file that it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Every message, file by file in the order of the files.
    pub fn messages(&self) -> impl Iterator<Item = Result<Message, ReadError>> + '_ {
        self.items().filter_map(|item| match item {
            Ok(Item::Message(message)) => Some(Ok(message)),
            Ok(_) => None,
            Err(error) => Some(Err(error)),
        })
    }

    /// The bytes of the attachment `name`, if the bag has it.
    ///
    /// # Errors
    /// When the bag is damaged before it.
    pub fn attachment(&self, name: &str) -> Result<Option<Vec<u8>>, ReadError> {
        for item in self.items() {
            match item? {
                Item::Attachment { name: found, data, .. } if found == name => {
                    return Ok(Some(data));
                }
                _ => {}
            }
        }
        Ok(None)
    }

    /// Reads the whole bag and says what is in it, up to the damage if there is any.
    ///
    /// # Errors
    /// When the system cannot read it.
    pub fn survey(&self) -> Result<Survey, ReadError> {
        Survey::of(self)
    }

    /// The commands in the order of the bag, from whatever topics have their types.
    ///
    /// # Errors
    /// The iterator's items are errors where the bag is damaged or a command is none; it ends
    /// after the first, and with one when there was no command at all.
    #[must_use]
    pub fn commands(&self) -> Commands<'_> {
        Commands::new(self)
    }

    /// Every piece in the order of the files.
    pub(in crate::record) fn items(&self) -> Items<'_> {
        Items::new(&self.files)
    }
}

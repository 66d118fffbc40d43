//! Recordings as input: what is in a bag, and the commands in it.
//!
//! Reads rosbag2 folders with MCAP files and such files alone, its own and those of others, from
//! the front and record by record. A file that is cut off is read up to its last whole message;
//! one that is damaged, up to the chunk or record with the damage.
//!
//! **Memory is bounded**, whatever a file says of itself. Nothing is made room for before it has
//! come, so that a record that is not packed never costs more than its file has bytes, nor more
//! than 512 MiB. One chunk and one message are held at a time, the chunk packed or unpacked. A
//! chunk may unpack to 64 MiB, or to a hundred times its packed size if that is more, and to
//! 512 MiB at most. The names and definitions of a file's topics may take 16 MiB of it. In all, a
//! file of a few kilobytes, made to do harm, makes the reader take less than
//! [`SMALL_FILE_MEMORY`].

mod bounded;
mod chunk;
mod commands;
mod error;
mod fields;
mod intakes;
mod items;
mod part;
mod records;
mod source;
mod survey;
mod window;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::msg::MessageType;
pub(in crate::record) use items::{Item, Items};

pub use commands::Commands;
pub use error::ReadError;
pub use intakes::Intakes;
use part::Part;
pub use part::is_bag;
pub use records::Damage;
pub use source::Source;
pub use survey::{AttachmentSummary, Survey, TopicSummary};

/// Most memory for reading a file of a few kilobytes, whatever is in it \[bytes\].
pub const SMALL_FILE_MEMORY: usize = 256 << 20;

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
    pub definition: Arc<str>,
    /// What else is said of it: in a bag of ROS 2, its quality of service under
    /// `offered_qos_profiles`.
    pub about: BTreeMap<String, String>,
    /// The type as it stands in the file.
    pub(in crate::record) schema: Option<Arc<Schema>>,
}

/// A type as it stands in a file.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::record) struct Schema {
    pub(in crate::record) name: String,
    pub(in crate::record) encoding: String,
    text: Arc<str>,
    pub(in crate::record) data: Vec<u8>,
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
        commands::same_fields(&self.definition, kind)
    }
}

/// One message of a bag.
#[derive(Debug)]
pub struct Message {
    /// What it came on.
    pub channel: Arc<Channel>,
    /// Its number among those of its publisher; 0 where nobody counts.
    pub sequence: u32,
    /// When it was recorded \[ns since 1970\].
    pub log_time: u64,
    /// When it was sent \[ns\].
    pub publish_time: u64,
    /// Its bytes.
    pub data: Vec<u8>,
}

/// A bag.
#[derive(Debug)]
pub struct Bag {
    path: PathBuf,
    parts: Vec<Part>,
}

impl Bag {
    /// The bag at `path`: a folder with MCAP files, or one such file.
    ///
    /// # Errors
    /// When there is none, or one that rosbag2 has stored in another way.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        Ok(Self { path: path.to_owned(), parts: part::find(path)? })
    }

    /// The bag of one MCAP file with these `bytes`, which errors call `name`.
    #[must_use]
    pub fn from_bytes(name: &Path, bytes: impl Into<Arc<[u8]>>) -> Self {
        Self { path: name.to_owned(), parts: vec![Part::from_bytes(name, bytes.into())] }
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

    /// What `source` says the commands are, in the order in which it was recorded, with that time
    /// \[ns since 1970\]: what the live node would have made of the same messages, but that none
    /// has an age, and that bytes which are no message are refused as malformed.
    ///
    /// The bag is read once before the first item, to find the topics and what is wrong. Messages
    /// are then taken as they are asked for. Recorders write roughly in order: those that stand
    /// up to 4096 messages, and 16 MiB, behind their place are put back.
    ///
    /// # Errors
    /// When the system cannot read the bag, or it has no such topic, or several. The iterator's
    /// last item is an error where the bag is damaged or further out of order.
    pub fn intakes(&self, source: &Source<'_>) -> Result<Intakes, ReadError> {
        Intakes::new(self, source)
    }

    /// Its files, each with its pieces.
    pub(in crate::record) fn files(&self) -> impl Iterator<Item = (&Path, Items)> {
        self.parts.iter().map(|part| (part.path.as_path(), Items::new(vec![part.clone()])))
    }

    /// Every piece in the order of the files.
    pub(in crate::record) fn items(&self) -> Items {
        Items::new(self.parts.clone())
    }
}

//! Why a bag is of no use.

use std::io;
use std::path::PathBuf;

use super::Damage;
use crate::msg::cdr::CdrError;

/// What `ros2 bag convert` is to make of a bag.
const CONVERT: &str = "`output_bags: [{uri: NEW_BAG, storage_id: mcap, all: true}]`";

/// Why a bag could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The system said no.
    #[error("cannot read {}: {error}", .path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// What the system said.
        error: io::Error,
    },
    /// A folder without a bag.
    #[error("{} holds no .mcap file; a bag is a rosbag2 folder with MCAP storage", .0.display())]
    NoBag(PathBuf),
    /// A pipe, a device or a folder by the name of a bag's file.
    #[error("{} is no file", .0.display())]
    NoFile(PathBuf),
    /// Another storage of rosbag2.
    #[error(
        "{} is a bag in SQLite; MCAP is read: convert it with `ros2 bag convert -i BAG -o mcap.yaml`, \
         where mcap.yaml holds {CONVERT}", .0.display()
    )]
    Sqlite(PathBuf),
    /// A bag that rosbag2 packed in a way of its own.
    #[error(
        "{} is packed {what}, which only rosbag2 reads; MCAP packs by itself: convert it with \
         `ros2 bag convert -i BAG -o mcap.yaml`, where mcap.yaml holds {CONVERT}", .path.display()
    )]
    Packed {
        /// The file or folder.
        path: PathBuf,
        /// How: file by file, or message by message.
        what: &'static str,
    },
    /// The contents make no sense from somewhere on.
    #[error("{} is {damage}; {messages} messages before that can be read", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Where and why.
        damage: Damage,
        /// Messages of the bag before the damage.
        messages: u64,
    },
    /// There is nothing to take commands from.
    #[error(
        "{} holds no graintwin_msgs/msg/BoundaryCommand; its topics: {}",
        .path.display(), .topics.join(", ")
    )]
    NoCommands {
        /// The bag.
        path: PathBuf,
        /// What it holds instead, as `name (type)`.
        topics: Vec<String>,
    },
    /// Commands come from more than one topic, and their order would be anyone's guess.
    #[error("{} holds commands on both {} and {}: one is allowed", .path.display(), .topics[0], .topics[1])]
    TwoCommandTopics {
        /// The bag.
        path: PathBuf,
        /// The names of the topics.
        topics: [String; 2],
    },
    /// The commands were written by another version of the message.
    #[error("{}: topic {topic} has another definition of graintwin_msgs/msg/BoundaryCommand", .path.display())]
    OtherDefinition {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
    },
    /// A message is not the bytes of a command.
    #[error("{}: command {number}: {error}", .path.display())]
    Command {
        /// The bag.
        path: PathBuf,
        /// Which, counted from 1.
        number: u64,
        /// What is wrong with it.
        error: CdrError,
    },
}

//! Why a bag is of no use.

use std::io;
use std::path::PathBuf;

use super::Damage;
use crate::msg::MessageType;
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
        "{} holds no commands, neither graintwin_msgs/msg/BoundaryCommand nor joints that the \
         scene maps; its topics: {}", .path.display(), list(.topics)
    )]
    NoCommands {
        /// The bag.
        path: PathBuf,
        /// What it holds instead, as `name (type)`.
        topics: Vec<String>,
    },
    /// The topic that was named is not there.
    #[error("{} has no topic {topic}; its topics: {}", .path.display(), list(.topics))]
    NoTopic {
        /// The bag.
        path: PathBuf,
        /// What was named.
        topic: String,
        /// What there is, as `name (type)`.
        topics: Vec<String>,
    },
    /// The topic that was named has no commands.
    #[error(
        "{}: topic {topic} is {kind}; allowed: graintwin_msgs/msg/BoundaryCommand, \
         graintwin_msgs/msg/WallTargets, sensor_msgs/msg/JointState and \
         trajectory_msgs/msg/JointTrajectory", .path.display()
    )]
    NoSuchCommands {
        /// The bag.
        path: PathBuf,
        /// What was named.
        topic: String,
        /// Name of its type.
        kind: String,
    },
    /// Which joint moves which wall is not known.
    #[error(
        "{}: topic {topic} is {kind}, and the scene does not say which joint moves which wall: \
         node.{key} is needed", .path.display()
    )]
    Unmapped {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// Name of its type.
        kind: String,
        /// What is missing in the scene's `node`.
        key: &'static str,
    },
    /// More than one topic has joints.
    #[error(
        "{} has joints on {} topics, {}: one is to be named", .path.display(), .topics.len(),
        list(.topics)
    )]
    SeveralTopics {
        /// The bag.
        path: PathBuf,
        /// Their names.
        topics: Vec<String>,
    },
    /// A message is further from its place than can be put right.
    #[error(
        "{}: message {number} of the commands was recorded {seconds} s before one that stands \
         thousands of messages before it; `ros2 bag convert` puts a bag in order", .path.display()
    )]
    OutOfOrder {
        /// The bag.
        path: PathBuf,
        /// Which, counted from 1 over the topics with commands.
        number: u64,
        /// By how much \[s\].
        seconds: f64,
    },
    /// Commands come from more than one topic, and their order would be anyone's guess.
    #[error("{} holds commands on both {} and {}: one is allowed", .path.display(), .topics[0], .topics[1])]
    TwoCommandTopics {
        /// The bag.
        path: PathBuf,
        /// The names of the topics.
        topics: [String; 2],
    },
    /// The commands were written by another version of the message, or not as CDR.
    #[error("{}: topic {topic} has another definition of {}", .path.display(), .kind.full_name())]
    OtherDefinition {
        /// The bag.
        path: PathBuf,
        /// The topic.
        topic: String,
        /// The type.
        kind: &'static MessageType,
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

/// Most names in one sentence.
const NAMES: usize = 20;

fn list(names: &[String]) -> String {
    let shown = names[..names.len().min(NAMES)].join(", ");
    match names.len() {
        0 => "none".into(),
        count if count > NAMES => format!("{shown} and {} more", count - NAMES),
        _ => shown,
    }
}

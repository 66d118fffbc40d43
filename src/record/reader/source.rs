//! Which messages of a bag are the commands.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use super::items::Item;
use super::{Bag, Channel, ReadError};
use crate::command::map::{JointStateMap, TrajectoryMap};
use crate::msg::{
    BoundaryCommand, Described, Dissociation, JointState, JointTrajectory, MessageType,
    ShearCommand, WallTargets,
};
use crate::scene;

/// Where the commands of a bag are.
///
/// Without a name they are the messages of this package, if the bag has any; else those of the
/// only topic with joints that the scene maps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Source<'a> {
    /// The topic.
    pub topic: Option<&'a str>,
    /// How `sensor_msgs/JointState` moves the walls.
    pub joint_states: Option<&'a scene::JointStates>,
    /// How `trajectory_msgs/JointTrajectory` moves the walls.
    pub joint_trajectory: Option<&'a scene::JointTrajectory>,
}

impl<'a> Source<'a> {
    /// With the joints of a scene, on `topic` if it is given.
    #[must_use]
    pub fn new(node: &'a scene::Node, topic: Option<&'a str>) -> Self {
        Self {
            topic,
            joint_states: node.joint_states.as_ref(),
            joint_trajectory: node.joint_trajectory.as_ref(),
        }
    }

    /// How to read messages of the type called `kind`.
    fn reader(&self, kind: &str) -> Kind {
        let is = |known: &MessageType| kind == known.full_name();
        if is(BoundaryCommand::TYPE) {
            Kind::Read(Reader::Boundary)
        } else if is(WallTargets::TYPE) {
            Kind::Read(Reader::Targets)
        } else if is(Dissociation::TYPE) {
            Kind::Read(Reader::Dissociation)
        } else if is(ShearCommand::TYPE) {
            Kind::Read(Reader::Shear)
        } else if is(JointState::TYPE) {
            match self.joint_states {
                Some(map) => Kind::Read(Reader::States(JointStateMap::new(map))),
                None => Kind::Unmapped("joint_states"),
            }
        } else if is(JointTrajectory::TYPE) {
            match self.joint_trajectory {
                Some(map) => Kind::Read(Reader::Trajectory(TrajectoryMap::new(map))),
                None => Kind::Unmapped("joint_trajectory"),
            }
        } else {
            Kind::Other
        }
    }
}

/// What a type of messages is good for.
enum Kind {
    Read(Reader),
    /// It would make commands, if the scene had this in `node`.
    Unmapped(&'static str),
    Other,
}

/// How to make commands of a topic's messages.
pub(super) enum Reader {
    Boundary,
    Targets,
    Dissociation,
    Shear,
    States(JointStateMap),
    Trajectory(TrajectoryMap),
}

impl Reader {
    pub(super) fn kind(&self) -> &'static MessageType {
        match self {
            Self::Boundary => BoundaryCommand::TYPE,
            Self::Targets => WallTargets::TYPE,
            Self::Dissociation => Dissociation::TYPE,
            Self::Shear => ShearCommand::TYPE,
            Self::States(_) => JointState::TYPE,
            Self::Trajectory(_) => JointTrajectory::TYPE,
        }
    }

    /// Whether its messages are commands, and not something that is made into such.
    fn is_proper(&self) -> bool {
        matches!(self, Self::Boundary | Self::Targets | Self::Dissociation | Self::Shear)
    }
}

/// What is in a bag.
pub(super) struct Scan {
    bag: PathBuf,
    topics: BTreeMap<String, Topic>,
    pub(super) damage: Option<ReadError>,
}

struct Topic {
    channel: Arc<Channel>,
    messages: u64,
    /// Whether it is described otherwise elsewhere in the bag.
    varies: bool,
}

impl Scan {
    /// Reads all of `bag`, up to the damage if there is any.
    pub(super) fn of(bag: &Bag) -> Result<Self, ReadError> {
        let mut scan = Self { bag: bag.path.clone(), topics: BTreeMap::new(), damage: None };
        for item in bag.items() {
            match item {
                Ok(Item::Channel(channel)) => scan.describe(&channel),
                Ok(Item::Message(message)) => {
                    if let Some(topic) = scan.topics.get_mut(&message.channel.topic) {
                        topic.messages += 1;
                    }
                }
                Ok(Item::Attachment { .. } | Item::Metadata { .. }) => {}
                Err(damage @ ReadError::Damaged { .. }) => scan.damage = Some(damage),
                Err(error) => return Err(error),
            }
        }
        Ok(scan)
    }

    fn describe(&mut self, channel: &Arc<Channel>) {
        let name = channel.topic.clone();
        let topic = self.topics.entry(name).or_insert_with(|| Topic {
            channel: Arc::clone(channel),
            messages: 0,
            varies: false,
        });
        topic.varies |= topic.channel != *channel;
    }

    /// The topics that `source` means, with their readers, and how many messages are on them.
    pub(super) fn choose(
        &self,
        source: &Source<'_>,
    ) -> Result<(BTreeMap<String, Reader>, u64), ReadError> {
        let chosen = match source.topic {
            Some(name) => vec![self.named(name, source)?],
            None => self.obvious(source)?,
        };
        let mut readers = BTreeMap::new();
        let mut messages = 0;
        for (name, reader) in chosen {
            let topic = &self.topics[name];
            let channel = &topic.channel;
            if topic.varies || channel.encoding != "cdr" || !channel.has_fields(reader.kind()) {
                let (path, topic) = (self.bag.clone(), name.clone());
                return Err(ReadError::OtherDefinition { path, topic, kind: reader.kind() });
            }
            messages += topic.messages;
            readers.insert(name.clone(), reader);
        }
        Ok((readers, messages))
    }

    fn named(&self, name: &str, source: &Source<'_>) -> Result<(&String, Reader), ReadError> {
        let (path, topic) = (self.bag.clone(), name.to_owned());
        let Some((name, found)) = self.topics.get_key_value(name) else {
            return Err(ReadError::NoTopic { path, topic, topics: self.list() });
        };
        let kind = found.channel.kind.clone();
        match source.reader(&kind) {
            Kind::Read(reader) => Ok((name, reader)),
            Kind::Unmapped(key) => Err(ReadError::Unmapped { path, topic, kind, key }),
            Kind::Other => Err(ReadError::NoSuchCommands { path, topic, kind }),
        }
    }

    fn obvious(&self, source: &Source<'_>) -> Result<Vec<(&String, Reader)>, ReadError> {
        let path = || self.bag.clone();
        let mut proper = Vec::new();
        let mut joints = Vec::new();
        let mut unmapped = Vec::new();
        for (name, topic) in self.topics.iter().filter(|(_, topic)| topic.messages > 0) {
            match source.reader(&topic.channel.kind) {
                Kind::Read(reader) if reader.is_proper() => proper.push((name, reader)),
                Kind::Read(reader) => joints.push((name, reader)),
                Kind::Unmapped(key) => unmapped.push((name, topic.channel.kind.clone(), key)),
                Kind::Other => {}
            }
        }
        // One topic of each type.
        for kind in super::commands::KINDS {
            let mut names = proper.iter().filter(|(_, reader)| reader.kind() == kind);
            if let (Some((first, _)), Some((second, _))) = (names.next(), names.next()) {
                let topics = [first, second].map(|name| (*name).clone());
                return Err(ReadError::TwoCommandTopics { path: path(), topics });
            }
        }
        if !proper.is_empty() {
            return Ok(proper);
        }
        match joints.len() {
            1 => Ok(joints),
            0 => Err(match unmapped.into_iter().next() {
                Some((topic, kind, key)) => {
                    ReadError::Unmapped { path: path(), topic: topic.clone(), kind, key }
                }
                None => ReadError::NoCommands { path: path(), topics: self.list() },
            }),
            _ => {
                let topics = joints.iter().map(|(name, _)| (*name).clone()).collect();
                Err(ReadError::SeveralTopics { path: path(), topics })
            }
        }
    }

    fn list(&self) -> Vec<String> {
        let name = |topic: &Topic| format!("{} ({})", topic.channel.topic, topic.channel.kind);
        self.topics.values().map(name).collect()
    }
}

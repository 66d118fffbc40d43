//! The commands in a bag.

use super::items::{Item, Items};
use super::{Bag, Channel, Message, ReadError};
use crate::command::Command;
use crate::msg::{
    BoundaryCommand, Described, Dissociation, MessageType, ShearCommand, WallTargets, cdr,
};

/// Types that are commands.
pub(super) const KINDS: [&MessageType; 4] =
    [BoundaryCommand::TYPE, WallTargets::TYPE, Dissociation::TYPE, ShearCommand::TYPE];

/// The commands of a bag; see [`Bag::commands`].
pub struct Commands<'a> {
    bag: &'a Bag,
    items: Items,
    /// Topic of each of [`KINDS`].
    topics: [Option<String>; KINDS.len()],
    others: Vec<String>,
    commands: u64,
    ended: bool,
}

impl<'a> Commands<'a> {
    pub(super) fn new(bag: &'a Bag) -> Self {
        let items = bag.items();
        Self {
            bag,
            items,
            topics: std::array::from_fn(|_| None),
            others: Vec::new(),
            commands: 0,
            ended: false,
        }
    }

    /// Notes a topic, and refuses commands that would not be understood.
    fn channel(&mut self, channel: &Channel) -> Result<(), ReadError> {
        let Some(kind) = KINDS.iter().position(|kind| channel.kind == kind.full_name()) else {
            self.others.push(format!("{} ({})", channel.topic, channel.kind));
            return Ok(());
        };
        let path = self.bag.path.clone();
        let topic = channel.topic.clone();
        match self.topics[kind].replace(topic.clone()) {
            Some(first) if first != topic => {
                return Err(ReadError::TwoCommandTopics { path, topics: [first, topic] });
            }
            _ => {}
        }
        if channel.encoding == "cdr" && same_fields(&channel.definition, KINDS[kind]) {
            Ok(())
        } else {
            Err(ReadError::OtherDefinition { path, topic, kind: KINDS[kind] })
        }
    }

    fn command(&mut self, message: &Message) -> Option<Result<Command, ReadError>> {
        let topic = Some(&message.channel.topic);
        let kind = self.topics.iter().position(|known| known.as_ref() == topic)?;
        self.commands += 1;
        let command = match kind {
            0 => cdr::decode::<BoundaryCommand>(&message.data).map(Command::from),
            2 => cdr::decode::<Dissociation>(&message.data).map(Command::from),
            3 => cdr::decode::<ShearCommand>(&message.data).map(Command::from),
            _ => cdr::decode::<WallTargets>(&message.data).map(Command::from),
        };
        Some(command.map_err(|error| ReadError::Command {
            path: self.bag.path.clone(),
            number: self.commands,
            error,
        }))
    }
}

impl Iterator for Commands<'_> {
    type Item = Result<Command, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            let command = match self.items.next() {
                Some(Ok(Item::Channel(channel))) => self.channel(&channel).err().map(Err),
                Some(Ok(Item::Message(message))) => self.command(&message),
                Some(Ok(_)) => None,
                Some(Err(error)) => Some(Err(error)),
                None => {
                    self.ended = true;
                    (self.commands == 0).then(|| {
                        let topics = std::mem::take(&mut self.others);
                        Err(ReadError::NoCommands { path: self.bag.path.clone(), topics })
                    })
                }
            };
            if let Some(command) = command {
                self.ended |= command.is_err();
                return Some(command);
            }
        }
        None
    }
}

/// Whether a definition is that of `kind` but for comments, constants, blanks, the name of the
/// package before types of its own, and the texts of the types it is made of.
pub(super) fn same_fields(definition: &str, kind: &'static MessageType) -> bool {
    fields(definition, kind.package).eq(fields(&kind.definition(), kind.package))
}

fn fields<'a>(definition: &'a str, package: &str) -> impl Iterator<Item = Vec<&'a str>> {
    definition
        .lines()
        .take_while(|line| !line.starts_with("===="))
        .map(|line| line.split('#').next().unwrap_or_default())
        // A bound, as in `string<=10 name`, is no constant.
        .filter(|line| !line.trim().is_empty() && !line.replace("<=", "").contains('='))
        .map(move |line| {
            let own = |word: &'a str| word.strip_prefix(package)?.strip_prefix('/');
            line.split_whitespace().map(|word| own(word).unwrap_or(word)).collect()
        })
}

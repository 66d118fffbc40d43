//! What a bag tells of a run.

use std::collections::{BTreeMap, BTreeSet};
use std::mem;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::run::plane::grains::Contacts;
use super::run::{Measure, Run};
use crate::msg::Described;
use crate::msg::cdr;
use crate::record::reader::{Bag, Message, ReadError};

/// The measures in a bag.
#[derive(Debug, Default)]
pub struct History {
    /// Name of the scene, when the bag says it.
    pub scene: Option<String>,
    /// The longest run, and the last of those; a bag without a reset has only one.
    pub run: Run,
    /// Which run it is, from 1.
    pub number: usize,
    /// Runs in the bag.
    pub runs: usize,
    /// Topics that were passed over, and why.
    pub passed_over: BTreeSet<String>,
    /// Messages that are not what their topic says.
    pub unreadable: u64,
    /// Where the bag stops making sense; all the rest is what was read before that.
    pub damage: Option<ReadError>,
    sources: BTreeMap<&'static str, Source>,
    /// The run that is being read.
    current: Run,
}

/// Where the messages of a type come from.
#[derive(Debug)]
struct Source {
    topic: String,
    /// Whether they can be understood.
    fits: bool,
}

/// What is read of a scene; it may be of another version.
#[derive(Deserialize)]
struct Named {
    name: String,
}

impl History {
    /// Reads all of `bag`, up to the damage if there is any.
    ///
    /// # Errors
    /// When the system cannot read it.
    pub fn read(bag: &Bag) -> Result<Self, ReadError> {
        let mut history = Self { scene: scene_name(bag), ..Self::default() };
        for message in bag.messages() {
            match message {
                Ok(message) => history.add(&message),
                Err(damage @ ReadError::Damaged { .. }) => history.damage = Some(damage),
                Err(error) => return Err(error),
            }
        }
        history.end_run();
        if history.run.is_plane() {
            history.run.plane.contacts = Contacts::read(bag);
        }
        Ok(history)
    }

    fn add(&mut self, message: &Message) {
        let measure = (self.decode(message).map(Measure::State))
            .or_else(|| self.decode(message).map(Measure::Walls))
            .or_else(|| self.decode(message).map(Measure::Moduli))
            .or_else(|| self.decode(message).map(Box::new).map(Measure::Tangent))
            .or_else(|| self.decode(message).map(Measure::Network))
            .or_else(|| self.decode(message).map(Box::new).map(Measure::Motion))
            .or_else(|| self.decode(message).map(|one| Measure::Fabric(Box::new(one))))
            .or_else(|| self.decode(message).map(Measure::Hydrate))
            .or_else(|| self.decode(message).map(Measure::Shear))
            .or_else(|| self.decode(message).map(Box::new).map(Measure::Plane))
            .or_else(|| self.decode(message).map(Box::new).map(Measure::Cloud))
            .or_else(|| self.decode(message).map(Box::new).map(Measure::Cracks))
            .or_else(|| self.decode(message).map(Measure::Event))
            .or_else(|| self.decode(message).map(Measure::Rearrangement));
        let Some(measure) = measure else { return };
        if self.current.ends_before(&measure) {
            self.end_run();
        }
        self.current.add(measure);
    }

    fn end_run(&mut self) {
        self.runs += 1;
        let run = mem::take(&mut self.current);
        if run.len() >= self.run.len() {
            (self.run, self.number) = (run, self.runs);
        }
    }

    /// The message as a `T`, if it comes on the topic of that type.
    fn decode<T: Described + DeserializeOwned>(&mut self, message: &Message) -> Option<T> {
        let channel = &message.channel;
        if !channel.has_type(T::TYPE) {
            return None;
        }
        let topic = &channel.topic;
        let fits = || channel.encoding == "cdr" && channel.has_fields(T::TYPE);
        let source = self.sources.entry(T::TYPE.name);
        let source = source.or_insert_with(|| Source { topic: topic.clone(), fits: fits() });
        if source.topic != *topic {
            let first = &source.topic;
            self.passed_over.insert(format!("{topic}: {first} has the same type and came first"));
            return None;
        }
        if !source.fits {
            let kind = T::TYPE.full_name();
            self.passed_over.insert(format!("{topic}: it has another definition of {kind}"));
            return None;
        }
        let decoded = cdr::decode(&message.data);
        self.unreadable += u64::from(decoded.is_err());
        decoded.ok()
    }
}

/// Nothing when the bag is not one of this program's, or is damaged before it.
fn scene_name(bag: &Bag) -> Option<String> {
    let text = bag.attachment("scene.yaml").ok()??;
    let scene: Named = serde_saphyr::from_str(std::str::from_utf8(&text).ok()?).ok()?;
    Some(scene.name)
}

//! Recorded answers against those that were made again.

use std::collections::BTreeSet;

use super::step::{Answer, Step};
use crate::command::circumstance::Circumstance;
use crate::msg::answer;
use crate::msg::fields::first_difference;
use crate::msg::topics::{self, Topic};
use crate::msg::{PackState, cdr};
use crate::record::Closing;
use crate::record::reader::Message;
use crate::record::replay::Act;
use crate::sink::Served;
use crate::view::picture::Painter;

/// The first thing that is not the same.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "increment {increment}, {topic}, {field}: {recorded} in the recording, {replayed} in the replay"
)]
pub struct Difference {
    /// The increment that the replay has reached.
    pub increment: u64,
    /// Topic of the message.
    pub topic: String,
    /// The field, as `normal_force[4]`.
    pub field: String,
    /// What the recording holds.
    pub recorded: String,
    /// What the replay made.
    pub replayed: String,
}

/// What was compared, and found to be the same.
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Compared {
    /// Answers, the initial equilibrium among them.
    pub answers: u64,
    /// Their messages.
    pub messages: u64,
    /// The last increment.
    pub increment: u64,
    /// The digest of the state at the end, when the recording tells it.
    pub state: Option<String>,
    /// Topics of the first answer: those that this recording has.
    #[serde(skip)]
    topics: BTreeSet<String>,
}

impl Compared {
    /// Compares the answers of `step` with those that playing it gave, with the pictures
    /// that the `painter` draws of them; the `solve_seconds` of the latter become those of the
    /// recording.
    ///
    /// # Errors
    /// The first difference.
    pub fn answers(
        &mut self,
        step: &Step,
        served: &mut [Served],
        painter: &Painter,
    ) -> Result<(), Difference> {
        if served.len() != step.answers.len() {
            let [recorded, replayed] =
                [step.answers.len(), served.len()].map(|count| count.to_string());
            return Err(self.difference("answers", "their number", recorded, replayed));
        }
        for (recorded, served) in step.answers.iter().zip(served) {
            self.increment = served.report.increment;
            if self.topics.is_empty() {
                let topics = recorded.messages.iter().map(|one| one.channel.topic.clone());
                // An event is rare, and no first answer has one.
                self.topics = topics.chain([topics::EVENTS.recorded_name()]).collect();
            }
            take_time(recorded, served);
            self.answer(recorded, served, painter)?;
            self.answers += 1;
        }
        Ok(())
    }

    /// Compares what was said to a request with what is said now.
    ///
    /// # Errors
    /// The difference.
    pub fn request(
        &self,
        step: &Step,
        said: Option<&Result<String, String>>,
    ) -> Result<(), Difference> {
        let (Act::Happened(Circumstance::Asked(_, recorded)), Some(said)) = (&step.act, said)
        else {
            return Ok(());
        };
        if recorded == said {
            return Ok(());
        }
        let topic = topics::CIRCUMSTANCE.recorded_name();
        let [recorded, replayed] = [recorded, said].map(|answer| format!("{answer:?}"));
        Err(self.difference(&topic, "text", recorded, replayed))
    }

    /// Compares what the run came to.
    ///
    /// # Errors
    /// The difference.
    pub fn closing(&mut self, recorded: &Closing, digest: &str) -> Result<(), Difference> {
        if recorded.digest != digest {
            return Err(self.difference("the end", "state", &recorded.digest, digest));
        }
        self.state = Some(digest.into());
        Ok(())
    }

    fn answer(
        &mut self,
        recorded: &Answer,
        served: &Served,
        painter: &Painter,
    ) -> Result<(), Difference> {
        let mut left: Vec<Option<&Message>> = recorded.messages.iter().map(Some).collect();
        // Captured apart: `self` counts meanwhile.
        let topics = self.topics.clone();
        let wants = |topic: &Topic| match is_on_demand(topic) {
            true => recorded.has(topic),
            false => !is_command(topic) && topics.contains(&topic.recorded_name()),
        };
        let mut bytes = Vec::new();
        let painter = Some(painter).filter(|painter| painter.records(self.increment));
        answer::each(served, painter, &wants, &mut |topic, message| {
            let name = topic.recorded_name();
            message.encode(&mut bytes).map_err(|error| {
                self.difference(&name, "as a whole", "a message", error.to_string())
            })?;
            let place = left
                .iter_mut()
                .find(|message| message.is_some_and(|message| message.channel.topic == name));
            let Some(recorded) = place.and_then(Option::take) else {
                return Err(self.difference(&name, "as a whole", "nothing", "a message"));
            };
            self.messages += 1;
            if recorded.data == bytes {
                return Ok(());
            }
            let found = first_difference(&recorded.channel.definition, &recorded.data, &bytes);
            let Some([recorded, replayed]) = found else {
                return Err(self.difference(&name, "padding", "some bytes", "others"));
            };
            Err(self.difference(&name, &recorded.path, recorded.value, replayed.value))
        })?;
        // A file of a split recording begins with the frames again.
        let frames = topics::TF_STATIC.recorded_name();
        let left = left.into_iter().flatten().find(|message| message.channel.topic != frames);
        match left {
            None => Ok(()),
            Some(left) => {
                Err(self.difference(&left.channel.topic, "as a whole", "a message", "nothing"))
            }
        }
    }

    fn difference(
        &self,
        topic: &str,
        field: &str,
        recorded: impl Into<String>,
        replayed: impl Into<String>,
    ) -> Difference {
        Difference {
            increment: self.increment,
            topic: topic.into(),
            field: field.into(),
            recorded: recorded.into(),
            replayed: replayed.into(),
        }
    }
}

fn is_command(topic: &Topic) -> bool {
    topics::commands().any(|command| command == topic)
}

/// Whether a recording may have messages on `topic` for some answers only.
fn is_on_demand(topic: &Topic) -> bool {
    [
        &topics::STATE,
        &topics::MODULI,
        &topics::TANGENT,
        &topics::CONTACT_NETWORK,
        &topics::GRAIN_MOTION,
        &topics::FABRIC,
        &topics::HYDRATE,
        &topics::SHEAR_STATE,
        &topics::PLANE_STATE,
        &topics::REARRANGEMENTS,
        &topics::SNAPSHOTS,
    ]
    .contains(&topic)
}

/// Gives the answer the time that the recorded one took: it is no part of what is compared.
fn take_time(recorded: &Answer, served: &mut Served) {
    let Some(state) = served.report.measures.as_mut().and_then(|of| of.state.as_mut()) else {
        return;
    };
    let topic = topics::STATE.recorded_name();
    let recorded = recorded.messages.iter().find(|message| message.channel.topic == topic);
    // What is no state differs, and that is told.
    if let Some(Ok(recorded)) = recorded.map(|message| cdr::decode::<PackState>(&message.data)) {
        state.solve_seconds = recorded.solve_seconds;
    }
}

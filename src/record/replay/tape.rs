//! A run as its recording tells it, step by step.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;

use super::ReplayError;
use super::step::{Act, Answer, Step};
use crate::command::circumstance::{Circumstance, Happened};
use crate::command::request::Request;
use crate::command::{Command, Disposition};
use crate::msg::topics;
use crate::msg::{self, BoundaryCommand, Described, Dissociation, ShearCommand, WallTargets, cdr};
use crate::record::reader::{Bag, Item, Items, Message};
use crate::record::role::Role;
use crate::record::{Closing, END};

/// The steps of a run in order; see [`Replay::tape`](super::Replay::tape).
///
/// An answer without its report was cut off, and is left out with all that follows. The iterator
/// ends after its first error; where the bag is damaged that is the last item.
pub struct Tape {
    path: PathBuf,
    items: Items,
    /// Messages so far.
    number: u64,
    /// What has been read of the step at hand.
    half: Half,
    /// Commands that were served as one increment so far, and that increment.
    merged: Option<Applied>,
    ready: VecDeque<Step>,
    error: Option<ReplayError>,
    closing: Option<Closing>,
    ended: bool,
}

/// The beginning of a step.
#[derive(Default)]
struct Half {
    time: Option<u64>,
    command: Option<Command>,
    age: Option<f64>,
    malformed: Option<String>,
    reset: bool,
    messages: Vec<Message>,
}

impl Half {
    /// Frames that another file repeats belong to no answer.
    fn forget_frames(&mut self) {
        let frames = topics::TF_STATIC.recorded_name();
        self.messages.retain(|message| message.channel.topic != frames);
    }
}

/// Commands that led to one increment.
struct Applied {
    increment: u64,
    time: u64,
    commands: Vec<Command>,
    answers: Vec<Answer>,
}

impl Tape {
    pub(super) fn new(bag: &Bag) -> Self {
        Self {
            path: bag.path().into(),
            items: bag.items(),
            number: 0,
            half: Half::default(),
            merged: None,
            ready: VecDeque::new(),
            error: None,
            closing: None,
            ended: false,
        }
    }

    /// What the run came to, once the tape has ended; a run that was killed left none.
    #[must_use]
    pub fn closing(&self) -> Option<&Closing> {
        self.closing.as_ref()
    }

    /// Whether the tape ended in the middle of an answer.
    #[must_use]
    pub fn is_cut_off(&self) -> bool {
        self.half.time.is_some()
    }

    fn take(&mut self, message: Message) -> Result<(), ReplayError> {
        self.number += 1;
        let role = Role::of(&message.channel.topic);
        if !matches!(role, Role::Beside | Role::Frames) {
            self.half.time.get_or_insert(message.log_time);
        }
        let wrong = |path: &PathBuf, number, reason: String| ReplayError::Tape {
            bag: path.clone(),
            number,
            topic: message.channel.topic.clone(),
            reason,
        };
        match role {
            Role::Beside => {}
            Role::Frames => {
                self.half.forget_frames();
                self.half.messages.push(message);
            }
            Role::Measure => self.half.messages.push(message),
            Role::Command => {
                let command =
                    command(&message).map_err(|reason| wrong(&self.path, self.number, reason))?;
                self.half.command = Some(command);
                self.half.forget_frames();
            }
            Role::Circumstance => {
                let happened = cdr::decode::<msg::Circumstance>(&message.data)
                    .map_err(|error| error.to_string())
                    .and_then(Happened::try_from)
                    .map_err(|reason| wrong(&self.path, self.number, reason))?;
                self.happened(happened.what);
            }
            Role::Report => {
                let report = cdr::decode::<msg::Report>(&message.data)
                    .map_err(|error| wrong(&self.path, self.number, error.to_string()))?;
                self.half.messages.push(message);
                self.answered(&report);
            }
        }
        Ok(())
    }

    fn happened(&mut self, what: Circumstance) {
        match what {
            Circumstance::Age(age) => self.half.age = Some(age),
            Circumstance::Malformed(text) => self.half.malformed = Some(text),
            Circumstance::Asked(Request::Reset, _) => self.half.reset = true,
            what => {
                self.flush();
                let time = self.half.time.take().unwrap_or(0);
                let act = Act::Happened(what);
                self.ready.push_back(Step { time, act, answers: Vec::new() });
            }
        }
    }

    /// The report of the step at hand has come: its answer is whole.
    fn answered(&mut self, report: &msg::Report) {
        // A recording may have gone on after a run's end.
        self.closing = None;
        let Half { time, command, age, malformed, reset, messages } =
            std::mem::take(&mut self.half);
        let (time, answer) = (time.unwrap_or(0), Answer { messages });
        let applied = report.disposition == Disposition::Applied as u8;
        let act = match (command, malformed) {
            (Some(command), None) if applied => {
                return self.applied(report.increment, time, command, answer);
            }
            (Some(command), None) => Act::Serve(Command { age, ..command }),
            (Some(command), Some(text)) => Act::Refuse(command, text),
            (None, _) if reset => Act::Reset,
            (None, _) => Act::Start,
        };
        self.flush();
        self.ready.push_back(Step { time, act, answers: vec![answer] });
    }

    /// A command was applied. Those that were merged say that they led to the same increment.
    fn applied(&mut self, increment: u64, time: u64, command: Command, answer: Answer) {
        if self.merged.as_ref().is_some_and(|merged| merged.increment != increment) {
            self.flush();
        }
        let new = || Applied { increment, time, commands: Vec::new(), answers: Vec::new() };
        let merged = self.merged.get_or_insert_with(new);
        merged.commands.push(command);
        merged.answers.push(answer);
    }

    /// Nothing more is merged with what was.
    fn flush(&mut self) {
        let Some(Applied { time, mut commands, answers, .. }) = self.merged.take() else { return };
        let act = match commands.len() {
            1 => Act::Serve(commands.remove(0)),
            _ => Act::Merge(commands),
        };
        self.ready.push_back(Step { time, act, answers });
    }
}

impl Iterator for Tape {
    type Item = Result<Step, ReplayError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(step) = self.ready.pop_front() {
                return Some(Ok(step));
            }
            if let Some(error) = self.error.take() {
                return Some(Err(error));
            }
            let ended = match self.items.next() {
                Some(Ok(Item::Message(message))) => self.take(message),
                Some(Ok(Item::Metadata { name, values })) if name == END => {
                    self.closing = closing(&values);
                    Ok(())
                }
                Some(Ok(_)) => Ok(()),
                Some(Err(error)) => Err(error.into()),
                None if self.ended => return None,
                None => {
                    self.ended = true;
                    self.flush();
                    Ok(())
                }
            };
            if let Err(error) = ended {
                // The bag's own items end with their error; after one of ours, so do the steps.
                self.ended = true;
                self.flush();
                self.error = Some(error);
                self.items.end();
            }
        }
    }
}

fn command(message: &Message) -> Result<Command, String> {
    let is = |kind| message.channel.has_type(kind);
    let command = if is(BoundaryCommand::TYPE) {
        cdr::decode::<BoundaryCommand>(&message.data).map(Command::from)
    } else if is(Dissociation::TYPE) {
        cdr::decode::<Dissociation>(&message.data).map(Command::from)
    } else if is(ShearCommand::TYPE) {
        cdr::decode::<ShearCommand>(&message.data).map(Command::from)
    } else {
        cdr::decode::<WallTargets>(&message.data).map(Command::from)
    };
    command.map_err(|error| error.to_string())
}

fn closing(values: &BTreeMap<String, String>) -> Option<Closing> {
    let increment = values.get("increment")?.parse().ok()?;
    Some(Closing { increment, digest: values.get("state")?.clone() })
}

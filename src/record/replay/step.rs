//! A step of a run, and how it is made again.

use std::collections::VecDeque;

use crate::command::Command;
use crate::command::circumstance::Circumstance;
use crate::command::request::{self, Request};
use crate::msg::topics::{self, Topic};
use crate::record::reader::Message;
use crate::report::Demand;
use crate::sink::Served;
use crate::twin::{Merged, Twin};

/// What was done to the twin.
#[derive(Clone, Debug, PartialEq)]
pub enum Act {
    /// It was brought to the initial equilibrium.
    Start,
    /// It went back there.
    Reset,
    /// It served a command.
    Serve(Command),
    /// It served several commands as one increment.
    Merge(Vec<Command>),
    /// A message came that makes no command, for this reason; the command stands for it.
    Refuse(Command, String),
    /// Something else that bears on the answers.
    Happened(Circumstance),
}

/// An answer of the twin as it was recorded.
#[derive(Debug)]
pub struct Answer {
    /// Its messages in the order of the bag, the report last; without the command.
    pub messages: Vec<Message>,
}

impl Answer {
    /// Whether it has a message on `topic`.
    #[must_use]
    pub fn has(&self, topic: &Topic) -> bool {
        let name = topic.recorded_name();
        self.messages.iter().any(|message| message.channel.topic == name)
    }
}

/// A step of a run: what was done, and what the twin answered.
#[derive(Debug)]
pub struct Step {
    /// When the first message of it was recorded \[ns since 1970\].
    pub time: u64,
    /// What was done.
    pub act: Act,
    /// An answer for each command, one for a start or reset, none for anything else.
    pub answers: Vec<Answer>,
}

impl Step {
    /// What the twin must measure to give the recorded answers again.
    #[must_use]
    pub fn demand(&self) -> Demand {
        let has = |topic: &Topic| self.answers.iter().any(|answer| answer.has(topic));
        // Markers show the state, the contacts and the cement.
        let marked = has(&topics::MARKERS);
        Demand {
            state: has(&topics::STATE) || marked,
            moduli: has(&topics::MODULI),
            tangent: has(&topics::TANGENT),
            contact_network: has(&topics::CONTACT_NETWORK) || marked,
            grains: has(&topics::GRAINS) || marked,
            grain_motion: has(&topics::GRAIN_MOTION),
            fabric: has(&topics::FABRIC),
            hydrate: has(&topics::HYDRATE),
            shear: has(&topics::SHEAR_STATE),
            plane: has(&topics::PLANE_STATE),
            rearrangements: has(&topics::REARRANGEMENTS),
            snapshots: has(&topics::SNAPSHOTS),
            bonds: has(&topics::BONDS) || marked,
            cracks: has(&topics::CRACKS),
        }
    }

    /// What of it has to be recorded as circumstances, before the answers, when a request was
    /// answered with `said` now.
    #[must_use]
    pub fn circumstances(&self, said: Option<request::Answer>) -> Vec<Circumstance> {
        match &self.act {
            Act::Happened(Circumstance::Asked(request, recorded)) => {
                let said = said.unwrap_or_else(|| recorded.clone());
                vec![Circumstance::Asked(request.clone(), said)]
            }
            Act::Happened(what) => vec![what.clone()],
            Act::Refuse(_, text) => vec![Circumstance::Malformed(text.clone())],
            Act::Serve(Command { age: Some(age), .. }) => vec![Circumstance::Age(*age)],
            Act::Reset => vec![Circumstance::Asked(Request::Reset, Ok(String::new()))],
            Act::Start | Act::Serve(_) | Act::Merge(_) => Vec::new(),
        }
    }

    /// Does the same to `twin`; returns what it answers, in the order of [`Step::answers`], and
    /// what it says to a request. Stores no pack.
    pub fn play(&self, twin: &mut Twin, demand: Demand) -> (Vec<Served>, Option<request::Answer>) {
        let first = |report| vec![Served { command: None, report }];
        let answer =
            |command: &Command, report| vec![Served { command: Some(command.clone()), report }];
        let served = match &self.act {
            Act::Start => first(twin.start(demand)),
            Act::Reset => first(twin.reset(demand)),
            Act::Serve(command) => answer(command, twin.apply(command, demand)),
            Act::Merge(commands) => merge(commands, twin, demand),
            Act::Refuse(command, text) => answer(command, twin.refuse(command, text.clone())),
            Act::Happened(what) => return (Vec::new(), happen(what, twin)),
        };
        (served, None)
    }
}

fn merge(commands: &[Command], twin: &mut Twin, demand: Demand) -> Vec<Served> {
    let mut served = Vec::with_capacity(commands.len());
    let mut waiting: VecDeque<Command> = commands.iter().cloned().collect();
    let alone = |command: Command, twin: &mut Twin| {
        let report = twin.apply(&command, demand);
        Served { command: Some(command), report }
    };
    while !waiting.is_empty() {
        match twin.apply_merged(waiting.make_contiguous(), demand) {
            Merged::Together(reports) => {
                let together = waiting.drain(..reports.len()).zip(reports);
                served.extend(
                    together.map(|(command, report)| Served { command: Some(command), report }),
                );
            }
            Merged::Apart(count) => {
                served.extend(waiting.drain(..count).map(|command| alone(command, twin)));
            }
        }
    }
    served
}

fn happen(what: &Circumstance, twin: &mut Twin) -> Option<request::Answer> {
    match what {
        Circumstance::Asked(Request::Hold(held), _) => Some(twin.hold(*held)),
        Circumstance::Asked(Request::ResetFaults, _) => Some(Ok(twin.reset_faults())),
        Circumstance::Settings(settings) => {
            twin.set(settings);
            None
        }
        // A reset is an act of its own, and so is what comes with a command; a stored pack changes
        // nothing in the twin.
        Circumstance::Asked(Request::Reset | Request::SavePack(_), _)
        | Circumstance::Age(_)
        | Circumstance::Malformed(_) => None,
    }
}

//! Following the answers of a recording, to know which are whole.

use super::Answers;
use crate::command::Disposition;
use crate::command::circumstance::{Circumstance, Happened};
use crate::command::request::Request;
use crate::msg::topics::{self, Topic};
use crate::msg::{self, cdr};
use crate::record::reader::Message;
use crate::record::role::Role;

/// Where in the answers a recording is.
///
/// Of commands that were merged only the last has measures: until it has come, the reports of the
/// others do not make them whole.
#[derive(Debug, Default)]
pub(super) struct Track {
    messages: u64,
    /// Messages up to the end of the last whole answer.
    whole: u64,
    /// Messages behind it that stand for themselves.
    beside: u64,
    answers: Answers,
    /// The same with the answers that are not known to be whole.
    open: Answers,
    command: bool,
    measured: bool,
    /// Whether the recording has a topic of which every increment has a message.
    has_measures: bool,
}

impl Track {
    pub(super) fn messages(&self) -> u64 {
        self.messages
    }

    /// Notes a topic of the recording.
    pub(super) fn channel(&mut self, topic: &str) {
        self.has_measures |= always_measured(topic);
    }

    /// Takes a message; of another program's bag all are whole.
    pub(super) fn take(&mut self, message: &Message, own: bool) {
        self.messages += 1;
        if !own {
            return;
        }
        if stands_for_itself(message) {
            self.beside += 1;
            return;
        }
        match Role::of(&message.channel.topic) {
            Role::Command => {
                self.command = true;
                self.open.unanswered += 1;
            }
            Role::Measure => self.measured |= always_measured(&message.channel.topic),
            Role::Report => self.answered(message),
            Role::Circumstance | Role::Frames | Role::Beside => {}
        }
    }

    fn answered(&mut self, message: &Message) {
        let command = std::mem::take(&mut self.command);
        let measured = std::mem::take(&mut self.measured);
        let Ok(report) = cdr::decode::<msg::Report>(&message.data) else { return };
        self.open.unanswered = self.open.unanswered.saturating_sub(u64::from(command));
        if command {
            *self.open.dispositions.entry(report.disposition).or_default() += 1;
        } else {
            self.open.starts += 1;
        }
        let applied = report.disposition == Disposition::Applied as u8;
        self.open.last = Some((report.session, report.sequence, report.increment));
        if !(command && applied && self.has_measures && !measured) {
            self.whole = self.messages;
            self.beside = 0;
            self.answers.clone_from(&self.open);
        }
    }

    /// Messages up to the end of the last whole answer, messages to be kept, and the answers.
    pub(super) fn end(&mut self) -> (u64, u64, Answers) {
        let answered = |answers: &Answers| answers.dispositions.values().sum::<u64>();
        // Those that were merged with one that is missing have their reports.
        let merged = answered(&self.open) - answered(&self.answers);
        self.answers.unanswered = self.open.unanswered + merged;
        (self.whole, self.whole + self.beside, std::mem::take(&mut self.answers))
    }
}

/// Whether a message behind the last whole answer means something without what is missing.
pub(super) fn stands_for_itself(message: &Message) -> bool {
    match Role::of(&message.channel.topic) {
        Role::Beside => true,
        Role::Circumstance => {
            let happened = cdr::decode::<msg::Circumstance>(&message.data)
                .map_err(|error| error.to_string())
                .and_then(Happened::try_from);
            match happened.map(|happened| happened.what) {
                Ok(Circumstance::Age(_) | Circumstance::Malformed(_)) | Err(_) => false,
                Ok(Circumstance::Asked(Request::Reset, _)) => false,
                Ok(Circumstance::Asked(..) | Circumstance::Settings(_)) => true,
            }
        }
        Role::Command | Role::Measure | Role::Frames | Role::Report => false,
    }
}

/// Whether every increment has a message on the recorded topic `name`.
fn always_measured(name: &str) -> bool {
    let is = |known: &Topic| known.recorded_name() == name;
    is(&topics::WALL_FORCES)
        || topics::WALL_WRENCH.iter().any(is)
        || is(&topics::WALL_STATES)
        || is(&topics::STATE)
}

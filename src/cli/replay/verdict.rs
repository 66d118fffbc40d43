//! What `replay --verify` says.

use serde::Serialize;

use graintwin::record::replay::{Compared, Difference};
use graintwin::relax::lanes;

use super::Program;
use crate::cli::{Failure, Outcome};

/// Whether a replay gave the recorded answers.
#[derive(Serialize)]
pub(super) struct Verdict {
    /// Whether everything that was compared is equal.
    equal: bool,
    /// Whether that was the whole recording.
    whole: bool,
    compared: Compared,
    /// The first difference.
    #[serde(skip_serializing_if = "Option::is_none")]
    difference: Option<Different>,
    /// Version that recorded.
    recorded_by: String,
    /// Kernels that recorded.
    recorded_kernels: String,
    /// Kernels that replayed.
    kernels: &'static str,
    /// Threads that replayed.
    threads: usize,
}

#[derive(Serialize)]
struct Different {
    increment: u64,
    topic: String,
    field: String,
    recorded: String,
    replayed: String,
    #[serde(skip)]
    sentence: String,
}

impl Verdict {
    pub(super) fn new(
        compared: Compared,
        difference: Option<Difference>,
        whole: bool,
        program: &Program,
        threads: usize,
    ) -> Self {
        let difference = difference.map(|difference| {
            let sentence = difference.to_string();
            let Difference { increment, topic, field, recorded, replayed } = difference;
            Different { increment, topic, field, recorded, replayed, sentence }
        });
        Self {
            equal: difference.is_none(),
            whole,
            compared,
            difference,
            recorded_by: program.version.clone(),
            recorded_kernels: program.kernels.clone(),
            kernels: lanes::kernels(),
            threads,
        }
    }

    pub(super) fn json(&self) -> Result<String, Failure> {
        let mut text = serde_json::to_string_pretty(self).map_err(Failure::other)?;
        text.push('\n');
        Ok(text)
    }

    pub(super) fn text(&self) -> String {
        let Compared { answers, messages, increment, state, .. } = &self.compared;
        let mut text = match &self.difference {
            Some(different) => format!("different       {}\n", different.sentence),
            None => "equal           to the bit, solve_seconds excepted\n".into(),
        };
        let mut line = |name: &str, what: &str| text.push_str(&format!("{name:<16}{what}\n"));
        line(
            "compared",
            &format!("{answers} answers, {messages} messages, up to increment {increment}"),
        );
        if !self.whole {
            line("", "not the whole recording: see the messages above");
        }
        let state = state.as_deref().unwrap_or("not told by the recording, or not reached");
        line("state", state);
        let (threads, kernels) = (self.threads, self.kernels);
        line(
            "recorded by",
            &format!("version {}, kernels {}", self.recorded_by, self.recorded_kernels),
        );
        line("replayed on", &format!("{threads} threads, kernels {kernels}"));
        text
    }

    /// Done only when everything is equal and was there.
    pub(super) fn outcome(&self) -> Result<Outcome, Failure> {
        match (&self.difference, self.whole) {
            (Some(different), _) => Err(Failure::Other(anyhow::anyhow!("{}", different.sentence))),
            (None, false) => Ok(Outcome::Incomplete),
            (None, true) => Ok(Outcome::Done),
        }
    }
}

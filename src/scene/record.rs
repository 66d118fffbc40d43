//! The recorder.

mod byte_size;
mod topics;

use serde::{Deserialize, Serialize};

use super::check::{Field, Problems};
use crate::msg::Topic;

pub use topics::Topics;

/// The recorder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Record {
    /// Size of an MCAP chunk before compression: bytes, or a number with `KiB`, `MiB`, `GiB`;
    /// 1 MiB to 1 GiB. It must be larger than the largest message.
    #[serde(with = "byte_size")]
    pub chunk: u64,
    /// Compression of the chunks.
    pub compression: Compression,
    /// Level of zstd, 1 (fast) to 22 (small); without it 1: the low bits of measures do not
    /// compress, and a run must not wait for its recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub level: Option<u32>,
    /// When a new file is begun.
    pub split: Split,
    /// Which topics are recorded. Commands, circumstances and reports always are: a replay needs
    /// them.
    pub topics: Topics,
    /// Names or patterns of topics that are not, though `topics` names them.
    pub exclude: Vec<String>,
    /// What happens to the run when writing fails.
    pub on_failure: OnFailure,
}

impl Default for Record {
    fn default() -> Self {
        Self {
            chunk: 4 << 20,
            compression: Compression::Zstd,
            level: None,
            split: Split::default(),
            topics: Topics::All,
            exclude: Vec::new(),
            on_failure: OnFailure::Continue,
        }
    }
}

impl Record {
    pub(super) fn check(&self, at: &Field, problems: &mut Problems) {
        size(at.key("chunk"), self.chunk, 1 << 30, "1 GiB", problems);
        match (self.level, self.compression) {
            (None, _) => {}
            (Some(level), Compression::Zstd) => {
                problems.count(at.key("level"), level.into(), 1, 22);
            }
            (Some(_), Compression::Lz4 | Compression::None) => {
                problems.add(at.key("level"), "only `compression: zstd` has levels");
            }
        }
        self.split.check(&at.key("split"), problems);
        self.topics.check(&at.key("topics"), problems);
        topics::check_excluded(&self.exclude, &at.key("exclude"), problems);
    }

    /// Whether what goes over `topic` is recorded.
    #[must_use]
    pub fn takes(&self, topic: &Topic) -> bool {
        topics::is_always_recorded(topic)
            || (self.topics.name(topic) && !topics::any_names(&self.exclude, topic))
    }
}

fn size(at: Field, bytes: u64, most: u64, most_in_words: &str, problems: &mut Problems) {
    if !(1 << 20..=most).contains(&bytes) {
        problems.add(at, format!("{bytes} bytes is outside 1 MiB to {most_in_words}"));
    }
}

/// When a recording goes on in a new file; without limits it is one file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Split {
    /// Size that a file may reach, 1 MiB to 1024 GiB. It goes beyond by less than one answer and
    /// the index at the file's end.
    #[serde(skip_serializing_if = "Option::is_none", with = "byte_size::optional")]
    pub size: Option<u64>,
    /// Time between the first message of a file and its last \[s\], at least 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duration: Option<f64>,
}

impl Split {
    fn check(&self, at: &Field, problems: &mut Problems) {
        if let Some(bytes) = self.size {
            size(at.key("size"), bytes, 1 << 40, "1024 GiB", problems);
        }
        if let Some(duration) = self.duration {
            problems.number(at.key("duration"), duration, "duration >= 1 s", |s| s >= 1.0);
        }
    }
}

/// Compression of MCAP chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Compression {
    /// Zstandard.
    #[default]
    Zstd,
    /// LZ4.
    Lz4,
    /// None.
    None,
}

/// What happens to the run when writing the recording fails.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnFailure {
    /// It goes on without recording.
    #[default]
    Continue,
    /// It ends after the increment at hand.
    Stop,
}

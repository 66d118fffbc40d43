//! The recorder: whether everything gets onto the disk.

use super::{Level, Status};
use crate::sink::RecordingState;

/// Room on the disk below which to warn.
const LITTLE: u64 = 1 << 30;

pub(super) fn status(state: Option<RecordingState>) -> Status {
    let Some(state) = state else { return Status::new("recorder", "off") };
    let mut status = Status::new("recorder", "recording");
    if let Some(failure) = &state.failure {
        status.say(Level::Error, failure);
    } else if state.lost > 0 {
        status.say(Level::Error, "not everything is recorded");
    } else if let Some(free) = state.free.filter(|free| *free < LITTLE) {
        status.say(Level::Warn, format!("the disk has {} MiB left", free >> 20));
    }
    status.value("messages", &state.messages);
    status.value("bytes", &state.bytes);
    status.value("lost", &state.lost);
    let free = state.free.map_or("unknown".into(), |free| free.to_string());
    status.value("free on the disk (bytes)", &free);
    status
}

//! The wall clock, as messages carry it.

use std::time::SystemTime;

use crate::msg::Time;

/// The time since 1970 in UTC; zero before.
pub(super) fn now() -> Time {
    let since = SystemTime::UNIX_EPOCH.elapsed().unwrap_or_default();
    Time { sec: i32::try_from(since.as_secs()).unwrap_or(i32::MAX), nanosec: since.subsec_nanos() }
}

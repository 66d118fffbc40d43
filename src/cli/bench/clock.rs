//! What this process has used so far.

use std::time::Duration;

use anyhow::anyhow;
use nix::sys::resource::{UsageWho, getrusage};
use nix::time::ClockId;

use crate::cli::Failure;

/// Whether the system counts CPU time at all.
pub(super) fn check() -> Result<(), Failure> {
    let now = ClockId::CLOCK_PROCESS_CPUTIME_ID.now();
    now.map(|_| ()).map_err(|error| Failure::Other(anyhow!("no CPU clock: {error}")))
}

/// CPU time of all threads; it can be read where it could be once.
pub(super) fn process() -> Duration {
    ClockId::CLOCK_PROCESS_CPUTIME_ID.now().map_or(Duration::ZERO, Duration::from)
}

/// Largest memory so far \[bytes\].
pub(super) fn peak_resident_bytes() -> Option<u64> {
    let unit = if cfg!(target_vendor = "apple") { 1 } else { 1024 };
    let most = getrusage(UsageWho::RUSAGE_SELF).ok()?.max_rss();
    Some(u64::try_from(most).ok()? * unit)
}

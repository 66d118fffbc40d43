//! SIGINT and SIGTERM: the first ends the run after the increment at hand, a later one at once.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use anyhow::anyhow;

use super::Failure;

/// Launchers pass on the signal that the terminal has sent as well: that is still the first.
const ECHO: Duration = Duration::from_secs(1);

/// A flag that the first signal sets.
pub(super) fn on_signal() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let (shared, first) = (Arc::clone(&flag), OnceLock::new());
    ctrlc::set_handler(move || {
        if !shared.swap(true, Ordering::SeqCst) {
            tracing::warn!("stopping after this increment; once more stops at once");
        }
        if first.get_or_init(Instant::now).elapsed() > ECHO {
            std::process::exit(1);
        }
    })
    .map_err(|error| Failure::Other(anyhow!("cannot listen to signals: {error}")))?;
    Ok(flag)
}

//! SIGINT and SIGTERM: the first ends the run after the increment at hand, the second at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

use super::Failure;

/// A flag that the first signal sets.
pub(super) fn on_signal() -> Result<Arc<AtomicBool>, Failure> {
    let flag = Arc::new(AtomicBool::new(false));
    let shared = Arc::clone(&flag);
    ctrlc::set_handler(move || {
        if shared.swap(true, Ordering::SeqCst) {
            std::process::exit(1);
        }
        tracing::warn!("stopping after this increment; once more stops at once");
    })
    .context("cannot listen to signals")
    .map_err(Failure::Other)?;
    Ok(flag)
}

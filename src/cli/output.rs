//! Writing to stdout and stderr.

use std::io::{self, ErrorKind, Write};

use anyhow::Context;

use super::Failure;

/// Prints a result. A reader that has gone away (`| head`) is no failure.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("stdout").map_err(Failure::Other)
        }
        _ => Ok(()),
    }
}

/// Says on stderr why a verb did not end, one complaint a line.
pub(crate) fn complain(failure: &Failure) {
    let (Failure::Input(error) | Failure::Other(error)) = failure;
    let mut stderr = io::stderr().lock();
    for line in format!("{error:#}").lines() {
        // Nothing is left to tell it to when stderr fails.
        let _ = writeln!(stderr, "error: {line}");
    }
}

/// `value` with `digits` significant digits.
pub(super) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..digits.max(6)).contains(&magnitude) {
        let decimals = usize::try_from(digits - 1 - magnitude).unwrap_or(0);
        format!("{value:.decimals$}")
    } else {
        let decimals = usize::try_from(digits - 1).unwrap_or(0);
        format!("{value:.decimals$e}")
    }
}

//! The work-precision table for people.

use std::fmt::Write as _;

use graintwin::bench::{Ended, Row};

use super::Measured;
use crate::cli::output::significant;

const HEADER: &str = "\
method               tolerance     ms, median       mean  gradients  products  bytes/grain  \
forces: median, worst  positions: median, worst  moduli: median, worst\n";

pub(super) fn write(measured: &Measured) -> String {
    let Measured { scene, file, grains, increments, threads, reference, .. } = measured;
    let mut text = format!(
        "scene       {scene}, {}\npack        {grains} grains\n\
         walked      {increments} increments on {threads} thread(s)\n\
         reference   {} at {:.0e}, residual {:.1e}\n",
        file.display(),
        reference.method.name(),
        reference.tolerance,
        reference.residual,
    );
    if let Some(bytes) = measured.peak_resident_bytes {
        let megabytes = significant(bytes as f64 * 1e-6, 3);
        text.push_str(&format!("memory      {megabytes} MB at most, all in all\n"));
    }
    text.push_str("\nAn increment, and its errors against the reference\n");
    text.push_str(HEADER);
    measured.rows.iter().for_each(|row| line(&mut text, row));
    if !measured.whole {
        text.push_str("interrupted: the rows that follow were not measured\n");
    }
    text
}

/// How a row ended.
pub(super) fn note(row: &Row) -> &str {
    match row.ended {
        Ended::Complete => "complete",
        _ => &row.text,
    }
}

// Writing to a string cannot fail.
fn line(to: &mut String, row: &Row) {
    let _ = write!(to, "{:<20}  {:>8.0e}", row.method.name(), row.tolerance);
    if row.increments > 0 {
        let milli = |seconds: f64| significant(seconds * 1e3, 3);
        let _ = write!(
            to,
            "  {:>13} {:>10}  {:>9} {:>9}  {:>11}",
            milli(row.cpu_seconds_median),
            milli(row.cpu_seconds_mean),
            row.gradients,
            row.products,
            significant(row.bytes_per_grain, 3),
        );
        let errors = [row.force_error, row.position_error, row.modulus_error];
        for (error, width) in errors.iter().zip([21, 24, 21]) {
            let both = format!("{}, {}", shown(error.median), shown(error.worst));
            let _ = write!(to, "  {both:>width$}");
        }
    }
    if row.ended != Ended::Complete {
        let _ = write!(to, "  {}", note(row));
    }
    to.push('\n');
}

/// An error; a dash where none is known.
fn shown(error: f64) -> String {
    if error.is_nan() { "-".into() } else { format!("{error:.1e}") }
}

//! The diagram as a CSV.

use std::fmt::Write as _;

use super::Row;

const HEADER: &str = "method,tolerance,ended,increments,rounds,cpu_seconds_median,\
    cpu_seconds_mean,gradients,products,iterations,residual,bytes_per_grain,force_error_median,\
    force_error_worst,position_error_median,position_error_worst,modulus_error_median,\
    modulus_error_worst\n";

/// `rows` with a header: one line a row, what is not known left empty, units as in [`Row`].
#[must_use]
pub fn to_csv(rows: &[Row]) -> String {
    let mut text = String::from(HEADER);
    for row in rows {
        let ended = format!("{:?}", row.ended).to_lowercase();
        // Writing to a string cannot fail.
        let _ = write!(text, "{},{:e},{ended},", row.method.name(), row.tolerance);
        let _ = write!(text, "{},{}", row.increments, row.rounds);
        for number in [
            row.cpu_seconds_median,
            row.cpu_seconds_mean,
            row.gradients,
            row.products,
            row.iterations,
            row.residual,
            row.bytes_per_grain,
            row.force_error.median,
            row.force_error.worst,
            row.position_error.median,
            row.position_error.worst,
            row.modulus_error.median,
            row.modulus_error.worst,
        ] {
            let _ = match number.is_nan() {
                true => write!(text, ","),
                false => write!(text, ",{number:e}"),
            };
        }
        text.push('\n');
    }
    text
}

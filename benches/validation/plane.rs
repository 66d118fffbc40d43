//! Sand, sandstone and a crystal of discs (B chapters 3 to 5): tables 3, 4, 6 and 9 to 13, and what
//! figures 13 to 20, 34 and 52 say in numbers.

mod bend;
mod crystal;
mod cylinder;
mod rig;
mod sand;
mod sandstone;
mod unconfined;

pub(crate) use bend::run as bend;
pub(crate) use crystal::run as crystal;
pub(crate) use cylinder::run as cylinder;
pub(crate) use sand::run as sand;
pub(crate) use sandstone::run as sandstone;
pub(crate) use unconfined::run as unconfined;

/// Axial strain of an increment (B tables 1 and 8).
const INCREMENT: f64 = 4.0e-5;

/// Mean diameter of the grains \[m\].
const DIAMETER: f64 = 2.0e-4;

/// Poisson's ratio of the grains.
const POISSON: f64 = 0.16;

/// Mean of `values`, and in brackets the lowest and the highest, with `digits` behind the point; a dash
/// where a test did not come so far.
fn spread(values: impl IntoIterator<Item = f64>, digits: usize) -> String {
    let values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() || values.iter().any(|value| value.is_nan()) {
        return "-".into();
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{mean:.digits$} [{low:.digits$}, {high:.digits$}]")
}

/// A number that a test may not show.
fn found(value: Option<f64>) -> f64 {
    value.unwrap_or(f64::NAN)
}

//! One row of the diagram.

use serde::Serialize;

use super::Spread;
use crate::scene::Method;

/// How a row ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ended {
    /// Every increment was served.
    Complete,
    /// The time was up: the row holds the increments up to there.
    Limit,
    /// An increment was not served: the row holds those before it.
    Failed,
    /// Not walked: a looser tolerance took too long.
    Skipped,
}

/// What one method and tolerance took over the increments, and how far from the reference it came.
/// Numbers that are not known are NaN, null in JSON.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Method.
    pub method: Method,
    /// Tolerance of the residual.
    pub tolerance: f64,
    /// How it ended.
    pub ended: Ended,
    /// Increments served.
    pub increments: usize,
    /// Walks; of each increment the shortest time counts.
    pub rounds: u32,
    /// CPU time of an increment \[s\], its measures included: median over the increments.
    pub cpu_seconds_median: f64,
    /// Mean over the increments \[s\].
    pub cpu_seconds_mean: f64,
    /// Evaluations of energy and gradient in an increment, median.
    pub gradients: f64,
    /// Products of the Hessian with a vector in an increment, median.
    pub products: f64,
    /// Steps of the method in an increment, median.
    pub iterations: f64,
    /// Largest residual at the end of an increment, over the mean contact force.
    pub residual: f64,
    /// Memory of state and scratch at the end, over the number of grains.
    pub bytes_per_grain: f64,
    /// Largest error of a wall's normal force over the largest normal force.
    pub force_error: Spread,
    /// Root mean square distance of the load-carrying grains over the mean radius.
    pub position_error: Spread,
    /// Largest relative error of the secant bulk and shear moduli.
    pub modulus_error: Spread,
    /// Where and why it ended early; empty when it did not.
    pub text: String,
}

impl Row {
    /// A row that is not walked because `looser` took too long.
    pub(super) fn skipped(method: Method, tolerance: f64, looser: f64) -> Self {
        let unknown = Spread { median: f64::NAN, worst: f64::NAN };
        Self {
            method,
            tolerance,
            ended: Ended::Skipped,
            increments: 0,
            rounds: 0,
            cpu_seconds_median: f64::NAN,
            cpu_seconds_mean: f64::NAN,
            gradients: f64::NAN,
            products: f64::NAN,
            iterations: f64::NAN,
            residual: f64::NAN,
            bytes_per_grain: f64::NAN,
            force_error: unknown,
            position_error: unknown,
            modulus_error: unknown,
            text: format!("not tried: {looser:.0e} ran into the time limit"),
        }
    }
}

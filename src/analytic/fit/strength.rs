//! φ' and c' from states of failure (A.94).

use super::line::{Line, line, through_origin};
use crate::analytic::strength::MohrCoulomb;

/// A strength fitted to tests.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fitted {
    /// φ' and c'.
    pub strength: MohrCoulomb,
    /// Root of the mean square of what is left of σ1 \[Pa\].
    pub residual: f64,
}

/// φ' and c' that lie closest in σ1 to failures at `[σ3, σ1]` \[Pa\], by least squares; nothing from
/// fewer than two σ3, or when σ1 falls with σ3.
#[must_use]
pub fn cohesive(failures: &[[f64; 2]]) -> Option<Fitted> {
    line(failures).and_then(fitted)
}

/// φ' of sand, without cohesion, that lies closest in σ1 to failures at `[σ3, σ1]` \[Pa\].
#[must_use]
pub fn sand(failures: &[[f64; 2]]) -> Option<Fitted> {
    through_origin(failures).and_then(fitted)
}

/// σ1 = k σ3 + q is k = (1 + sin φ')/(1 - sin φ') and q = 2 c' √k.
fn fitted(line: Line) -> Option<Fitted> {
    let Line { slope, intercept, residual } = line;
    let friction = ((slope - 1.0) / (slope + 1.0)).asin();
    let strength = MohrCoulomb { friction, cohesion: intercept / (2.0 * slope.sqrt()) };
    (slope > 0.0).then_some(Fitted { strength, residual })
}

/// φ' \[rad\] that one state of sand mobilises (A.20); nothing unless it is compressed.
#[must_use]
pub fn mobilised(major: f64, minor: f64) -> Option<f64> {
    (minor > 0.0 && major >= minor).then(|| ((major - minor) / (major + minor)).asin())
}

//! The solver: whether commands find their equilibria.

use super::{Level, Status};
use crate::command::Disposition;
use crate::node::health::Vitals;

/// Commands in a row without an equilibrium that are an error.
const MANY: u64 = 3;

pub(super) fn status(vitals: &Vitals) -> Status {
    let mut status = Status::new("solver", "in equilibrium");
    let failing = vitals.failing;
    if failing > 0 {
        let level = if failing < MANY { Level::Warn } else { Level::Error };
        let last = if failing == 1 { "the last command" } else { "the last commands" };
        status.say(level, format!("no equilibrium for {last}: the twin is back at the one before"));
    }
    status.value("increment", &vitals.increment);
    status.value("iterations of the last increment", &vitals.iterations);
    status.value("relative residual", &format!("{:.3e}", vitals.residual));
    status.value("time of the last increment (s)", &format!("{:.6}", vitals.solve_seconds));
    status.value("not converged", &vitals.refused[Disposition::NotConverged as usize]);
    status.value("not converged in a row", &failing);
    status
}

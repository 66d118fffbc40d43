//! What the equilibria cost, and how good they are.

use crate::msg::PackState;
use crate::view::chart::{Chart, Series};
use crate::view::run::Run;
use crate::view::scale::Axis;

/// Iterations of each increment.
pub(super) fn iterations(run: &Run) -> Chart {
    let point = |state: &PackState| [state.increment as f64, f64::from(state.iterations)];
    let total: u64 = run.states.iter().map(|state| u64::from(state.iterations)).sum();
    Chart {
        title: "Solver effort".into(),
        x: Axis::count("increment"),
        y: Axis::count("iterations"),
        series: vec![Series::new(0, "iterations", run.states.iter().map(point))],
        notes: vec![format!("{total} iterations in all, sub-steps included.")],
    }
}

/// Residual of each equilibrium.
pub(super) fn residual(run: &Run) -> Chart {
    let point = |state: &PackState| [state.increment as f64, state.residual];
    let loose = run.states.iter().filter(|state| !state.converged).count();
    let zero = run.states.iter().filter(|state| state.residual == 0.0).count();
    let mut notes = Vec::new();
    if loose > 0 {
        notes.push(format!("Not converged: {loose} of {}.", run.states.len()));
    }
    if zero > 0 {
        notes.push(format!("Exactly zero, and not on this axis: {zero}."));
    }
    Chart {
        title: "Residual of the equilibria".into(),
        x: Axis::count("increment"),
        y: Axis::log("relative residual"),
        series: vec![Series::new(1, "residual", run.states.iter().map(point))],
        notes,
    }
}

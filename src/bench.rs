//! The work-precision diagram of a scene: what accuracy costs, by method and tolerance.
//!
//! The first increments of a load path are walked once as accurately as the pack allows
//! ([`Reference`]), and then again from the same pack with every method and tolerance
//! ([`measure`]). A [`Row`] holds what that took and how far it ended from the reference. The clock
//! is the caller's.

mod csv;
mod error;
mod reference;
mod row;
mod walk;

use std::ops::ControlFlow;
use std::time::Duration;

use crate::command::Command;
use crate::pack::Pack;
use crate::scene::{Method, Scene};
use crate::twin::{Twin, TwinError};

pub use csv::to_csv;
pub use error::Spread;
pub use reference::{NoReference, Reference};
pub use row::{Ended, Row};
use walk::walk;

/// Tolerances of the diagram, from loose to tight.
pub const TOLERANCES: [f64; 9] = [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10];

/// What is walked.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Laws, walls and settings; its method and tolerance do not count.
    pub scene: &'a Scene,
    /// The pack at the start.
    pub pack: &'a Pack,
    /// The load path, one increment a command; not empty.
    pub commands: &'a [Command],
    /// Threads of the solver, 0 for one a core.
    pub threads: usize,
}

impl Job<'_> {
    fn twin(&self, method: Method, tolerance: f64) -> Result<Twin, TwinError> {
        let mut scene = self.scene.clone();
        scene.solver.method = method;
        scene.solver.tolerance = tolerance;
        Twin::new(&scene, self.pack, self.threads)
    }
}

/// How long is measured, and by what.
pub struct Timing<'a> {
    /// Walks of each row; of each increment the shortest time counts. At least 1.
    pub rounds: u32,
    /// Time after which a row ends with the increment at hand.
    pub limit: Duration,
    /// CPU time since some moment.
    pub clock: &'a dyn Fn() -> Duration,
}

/// Walks the job with every method for its dimension and every tolerance that is looser than the reference's.
///
/// Where a method ran into the time limit, its tighter tolerances are not tried. `watch` sees each
/// row and may break off; the rows so far are returned then.
///
/// # Errors
/// When a twin cannot be made.
pub fn measure(
    job: &Job<'_>,
    reference: &Reference,
    timing: &Timing<'_>,
    watch: &mut dyn FnMut(&Row) -> ControlFlow<()>,
) -> Result<Vec<Row>, TwinError> {
    let mut rows = Vec::new();
    for method in Method::ALL.into_iter().filter(|one| one.relaxes(job.scene.dimension)) {
        let mut slow = None;
        for tolerance in TOLERANCES.into_iter().filter(|&one| one > reference.tolerance) {
            let row = match slow {
                Some(looser) => Row::skipped(method, tolerance, looser),
                None => row(job, method, tolerance, reference, timing)?,
            };
            if row.ended == Ended::Limit {
                slow = Some(tolerance);
            }
            let next = watch(&row);
            rows.push(row);
            if next.is_break() {
                return Ok(rows);
            }
        }
    }
    Ok(rows)
}

/// Walks the job with one method and tolerance.
fn row(
    job: &Job<'_>,
    method: Method,
    tolerance: f64,
    reference: &Reference,
    timing: &Timing<'_>,
) -> Result<Row, TwinError> {
    let end = (timing.clock)() + timing.limit;
    let mut best = walk(job, method, tolerance, reference, timing.clock, end)?;
    let mut rounds = 1;
    while best.ended == Ended::Complete && rounds < timing.rounds && (timing.clock)() < end {
        let again = walk(job, method, tolerance, reference, timing.clock, end)?;
        if again.ended != Ended::Complete {
            break;
        }
        for (least, time) in best.seconds.iter_mut().zip(again.seconds) {
            *least = least.min(time);
        }
        rounds += 1;
    }
    Ok(best.row(method, tolerance, rounds))
}

//! One walk along the load path, timed.

use std::time::Duration;

use super::Job;
use super::error::{Error, Spread, median};
use super::reference::{Moment, Reference, refused};
use super::row::{Ended, Row};
use crate::command::Disposition;
use crate::relax::Effort;
use crate::report::Demand;
use crate::scene::Method;
use crate::twin::{Twin, TwinError};

/// What a run without subscribers is asked for.
const DEMAND: Demand =
    Demand { state: true, moduli: true, tangent: false, contact_network: false, grains: false };

/// What a walk came to; the lists have one entry an increment.
#[derive(Debug)]
pub(super) struct Walk {
    pub(super) ended: Ended,
    /// CPU time of each increment \[s\].
    pub(super) seconds: Vec<f64>,
    text: String,
    gradients: Vec<f64>,
    products: Vec<f64>,
    iterations: Vec<f64>,
    errors: Vec<Error>,
    residual: f64,
    bytes_per_grain: f64,
}

/// Walks `job`; after `end` on `clock` no further increment begins.
pub(super) fn walk(
    job: &Job<'_>,
    method: Method,
    tolerance: f64,
    reference: &Reference,
    clock: &dyn Fn() -> Duration,
    end: Duration,
) -> Result<Walk, TwinError> {
    let mut twin = job.twin(method, tolerance)?;
    let mut walk = Walk {
        ended: Ended::Complete,
        seconds: Vec::new(),
        text: String::new(),
        gradients: Vec::new(),
        products: Vec::new(),
        iterations: Vec::new(),
        errors: Vec::new(),
        residual: 0.0,
        bytes_per_grain: f64::NAN,
    };
    let first = twin.start(Demand::default());
    if first.disposition != Disposition::Applied {
        (walk.ended, walk.text) = (Ended::Failed, first.text);
        return Ok(walk);
    }
    let mut before = twin.effort();
    for (increment, (command, at)) in (1..).zip(job.commands.iter().zip(&reference.moments)) {
        if clock() >= end {
            let done = increment - 1;
            walk.ended = Ended::Limit;
            walk.text = format!("time limit after {done} of {} increments", job.commands.len());
            break;
        }
        let start = clock();
        let report = twin.apply(command, DEMAND);
        let seconds = clock().saturating_sub(start).as_secs_f64();
        let Some(moment) = Moment::of(&twin, &report) else {
            (walk.ended, walk.text) = (Ended::Failed, refused(increment, &report));
            break;
        };
        walk.seconds.push(seconds);
        walk.take_effort(&twin, &mut before);
        walk.errors.push(Error::of(&moment, at, reference.mean_radius));
        if let Some(state) = report.measures.and_then(|measures| measures.state) {
            walk.residual = walk.residual.max(state.residual);
            walk.iterations.push(f64::from(state.iterations));
        }
    }
    walk.bytes_per_grain = twin.bytes() as f64 / job.pack.grains.len() as f64;
    Ok(walk)
}

impl Walk {
    fn take_effort(&mut self, twin: &Twin, before: &mut Effort) {
        let now = twin.effort();
        self.gradients.push((now.gradients - before.gradients) as f64);
        self.products.push((now.products - before.products) as f64);
        *before = now;
    }

    /// The row of the diagram.
    pub(super) fn row(self, method: Method, tolerance: f64, rounds: u32) -> Row {
        let increments = self.seconds.len();
        let mean = self.seconds.iter().sum::<f64>() / increments as f64;
        let spread = |of: fn(&Error) -> f64| Spread::of(self.errors.iter().map(of));
        Row {
            method,
            tolerance,
            ended: self.ended,
            increments,
            rounds,
            force_error: spread(|error| error.force),
            position_error: spread(|error| error.position),
            modulus_error: spread(|error| error.modulus),
            cpu_seconds_median: median(self.seconds),
            cpu_seconds_mean: mean,
            gradients: median(self.gradients),
            products: median(self.products),
            iterations: median(self.iterations),
            residual: self.residual,
            bytes_per_grain: self.bytes_per_grain,
            text: self.text,
        }
    }
}

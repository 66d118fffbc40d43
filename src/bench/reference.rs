//! The converged reference of a diagram.

use serde::Serialize;

use super::Job;
use crate::command::Disposition;
use crate::report::{Demand, Report};
use crate::scene::Method;
use crate::twin::{Twin, TwinError};

/// Tolerances of the reference; the first one counts that every increment reaches.
const TOLERANCES: [f64; 4] = [1e-11, 1e-10, 1e-9, 1e-8];

/// Why there is no reference.
#[derive(Debug, thiserror::Error)]
pub enum NoReference {
    /// The twin could not be made.
    #[error(transparent)]
    Twin(#[from] TwinError),
    /// The load path could not be walked.
    #[error("no reference: at tolerance {tolerance:.0e} {text}")]
    Failed {
        /// The loosest tolerance tried.
        tolerance: f64,
        /// Where it ended and why.
        text: String,
    },
}

/// The load path, walked as accurately as the pack allows.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    /// Method.
    pub method: Method,
    /// Tolerance that every increment reached.
    pub tolerance: f64,
    /// Largest residual of an increment.
    pub residual: f64,
    /// Arithmetic mean of the radii \[m\].
    #[serde(skip)]
    pub(super) mean_radius: f64,
    /// One entry an increment.
    #[serde(skip)]
    pub(super) moments: Vec<Moment>,
}

/// What errors are taken of at one equilibrium.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    /// Normal forces on the walls \[N\].
    pub(super) force: [f64; crate::wall::COUNT],
    /// Centres \[m\], in the order of the pack file.
    pub(super) position: Vec<[f64; 3]>,
    /// Whether a grain has a contact, shape (n); empty where nobody asked.
    pub(super) carries: Vec<bool>,
    /// Secant bulk and shear modulus of the increment \[Pa\]; NaN where not known.
    pub(super) moduli: [f64; 2],
}

impl Moment {
    /// The state of `twin` after `report`, which must hold measures.
    pub(super) fn of(twin: &Twin, report: &Report) -> Option<Self> {
        let measures = report.measures.as_ref()?;
        let position: Vec<_> = twin.pack().grains.iter().map(|grain| grain.position).collect();
        let mut carries = Vec::new();
        if let Some(network) = &measures.network {
            carries.resize(position.len(), false);
            for &body in network.first.iter().chain(&network.second) {
                // The second body may be a wall.
                if let Some(grain) = carries.get_mut(body as usize) {
                    *grain = true;
                }
            }
        }
        let moduli = measures.moduli.as_ref().map_or([f64::NAN; 2], |m| [m.bulk, m.shear]);
        Some(Self { force: measures.walls.normal_force, position, carries, moduli })
    }
}

impl Reference {
    /// Walks `job` with Newton's method at the tightest tolerance that works.
    ///
    /// # Errors
    /// When the twin cannot be made, or no tolerance takes every increment.
    pub fn of(job: &Job<'_>) -> Result<Self, NoReference> {
        let mut failed = (0.0, String::new());
        for tolerance in TOLERANCES {
            match Self::at(job, tolerance)? {
                Ok(reference) => return Ok(reference),
                Err(text) => failed = (tolerance, text),
            }
        }
        let (tolerance, text) = failed;
        Err(NoReference::Failed { tolerance, text })
    }

    fn at(job: &Job<'_>, tolerance: f64) -> Result<Result<Self, String>, TwinError> {
        let method = Method::Newton;
        let mut twin = job.twin(method, tolerance)?;
        let first = twin.start(Demand::default());
        if first.disposition != Disposition::Applied {
            return Ok(Err(first.text));
        }
        let (mut moments, mut residual) = (Vec::new(), 0.0_f64);
        for (increment, command) in (1..).zip(job.commands) {
            let report = twin.apply(command, Demand::ALL);
            let Some(moment) = Moment::of(&twin, &report) else {
                return Ok(Err(refused(increment, &report)));
            };
            let state = report.measures.as_ref().and_then(|measures| measures.state.as_ref());
            residual = residual.max(state.map_or(0.0, |state| state.residual));
            moments.push(moment);
        }
        let radii = job.pack.grains.iter().map(|grain| grain.radius).sum::<f64>();
        let mean_radius = radii / job.pack.grains.len() as f64;
        Ok(Ok(Self { method, tolerance, residual, mean_radius, moments }))
    }
}

/// Why an increment was not served.
pub(super) fn refused(increment: usize, report: &Report) -> String {
    format!("increment {increment} was not served: {:?}: {}", report.disposition, report.text)
}

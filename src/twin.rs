//! The one door: [`Twin::apply`] takes a command and returns a report.

use crate::command::Command;
use crate::pack::Pack;
use crate::report::{Demand, Report};
use crate::scene::Scene;

/// Why a twin could not be made.
#[derive(Debug, thiserror::Error)]
pub enum TwinError {
    /// The pack cannot be simulated.
    #[error("{0}")]
    Pack(String),
}

/// The digital twin of one specimen.
#[derive(Debug)]
pub struct Twin {
    pack: Pack,
}

impl Twin {
    /// A twin of `pack` under the laws, walls and solver of `scene`, working on `threads` threads.
    ///
    /// # Errors
    /// When the pack cannot be simulated.
    pub fn new(scene: &Scene, pack: Pack, threads: usize) -> Result<Self, TwinError> {
        let _ = (scene, threads);
        Ok(Self { pack })
    }

    /// Relaxes the pack as it was given: increment 0.
    pub fn start(&mut self, demand: Demand) -> Report {
        let _ = demand;
        unreachable!("not yet: {}", self.pack.grains.len())
    }

    /// Serves one command.
    pub fn apply(&mut self, command: &Command, demand: Demand) -> Report {
        let _ = (command, demand);
        unreachable!("not yet")
    }
}

//! The parameters that hold for the running twin.

use super::Parameters;
use crate::scene::{Choice, Late, Limits, Scene};
use crate::twin::Settings;

/// The values of all parameters that can change while the twin runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Live {
    /// Age beyond which a command is refused \[s\]; 0 = never.
    pub stale_after: f64,
    /// Limits of what a command may do.
    pub limits: Limits,
    /// Whether absolute commands may be merged into one path when the rig is faster than the twin.
    pub merge: bool,
    /// Whether time is that of `/clock`.
    pub use_sim_time: bool,
    /// Largest unbalanced force of a grain over the mean contact force.
    pub tolerance: f64,
    /// Largest strain between two equilibria.
    pub max_strain_increment: f64,
    /// Size of the pictures over that of the specimen; 0 = chosen by the program.
    pub view_scale: f64,
}

impl Live {
    pub(super) fn of(scene: &Scene) -> Self {
        Self {
            stale_after: scene.node.stale_after,
            limits: scene.node.limits,
            merge: scene.node.late == Late::Merge,
            use_sim_time: scene.node.use_sim_time,
            tolerance: scene.solver.tolerance,
            max_strain_increment: scene.solver.max_strain_increment,
            view_scale: match scene.view.scale {
                Choice::Auto => 0.0,
                Choice::Given(scale) => scale,
            },
        }
    }

    /// What happens to commands that come faster than the twin serves them.
    #[must_use]
    pub fn late(&self) -> Late {
        if self.merge { Late::Merge } else { Late::Every }
    }

    /// Those that the twin itself takes.
    #[must_use]
    pub fn settings(&self) -> Settings {
        Settings {
            stale_after: self.stale_after,
            limits: self.limits,
            tolerance: self.tolerance,
            max_strain_increment: self.max_strain_increment,
        }
    }

    /// Writes the values into the scene, so that a twin made from it, and a recording that echoes
    /// it, have them.
    pub fn write_to(&self, scene: &mut Scene) {
        scene.node.stale_after = self.stale_after;
        scene.node.limits = self.limits;
        scene.node.late = self.late();
        scene.node.use_sim_time = self.use_sim_time;
        scene.solver.tolerance = self.tolerance;
        scene.solver.max_strain_increment = self.max_strain_increment;
        scene.view.scale = match self.view_scale {
            0.0 => Choice::Auto,
            scale => Choice::Given(scale),
        };
    }
}

/// Tells the solver's thread what was changed.
#[derive(Clone, Debug)]
pub struct Changes(pub(super) Parameters);

impl Changes {
    /// All values when one was set since the last call. Several sets in between are one change:
    /// each leaves a whole that is allowed.
    pub fn take(&self) -> Option<Live> {
        self.0.state().pending.take()
    }
}

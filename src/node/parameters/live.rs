//! The parameters that hold for the running twin.

use super::Parameters;
use crate::scene::Scene;

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
}

/// Limits of what a command may do; 0 = none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Displacement of a wall since the start \[m\].
    pub travel: f64,
    /// Speed of a wall by the stamps of the commands \[m/s\].
    pub rate: f64,
    /// Strain of the specimen since the start along any axis.
    pub strain: f64,
    /// Normal force on a wall \[N\].
    pub force: f64,
    /// Whether a command beyond a limit is served up to the limit rather than refused.
    pub clamp: bool,
}

impl Live {
    pub(super) fn of(scene: &Scene) -> Self {
        Self {
            stale_after: scene.node.stale_after,
            limits: Limits::default(),
            merge: false,
            use_sim_time: scene.node.use_sim_time,
            tolerance: scene.solver.tolerance,
            max_strain_increment: scene.solver.max_strain_increment,
        }
    }

    /// Writes the values that the scene has a key for into it, so that a twin made from it, and a
    /// recording that echoes it, have them.
    pub fn write_to(&self, scene: &mut Scene) {
        scene.node.stale_after = self.stale_after;
        scene.node.use_sim_time = self.use_sim_time;
        scene.solver.tolerance = self.tolerance;
        scene.solver.max_strain_increment = self.max_strain_increment;
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

//! Where the grains were before the present increment.

use crate::relax::jump::Pose;
use crate::state::State;

/// Two poses, since an increment that comes to nothing leaves the present one what it is.
#[derive(Debug, Default)]
pub(super) struct Past {
    before: Pose,
    /// Where the increment under way began.
    departed: Pose,
}

impl Past {
    /// Forgets everything: the present increment begins at `state`.
    pub(super) fn restart(&mut self, state: &State) {
        self.before.copy(state);
    }

    /// An increment begins at `state`.
    pub(super) fn leave(&mut self, state: &State) {
        self.departed.copy(state);
    }

    /// It came to an equilibrium, and is the present one.
    pub(super) fn arrive(&mut self) {
        std::mem::swap(&mut self.before, &mut self.departed);
    }

    /// Where the present increment began.
    pub(super) fn before(&self) -> &Pose {
        &self.before
    }

    /// Memory that its lists hold \[bytes\].
    pub(super) fn heap_bytes(&self) -> usize {
        self.before.heap_bytes() + self.departed.heap_bytes()
    }
}

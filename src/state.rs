//! What a snapshot holds.

use crate::Vec3;
use crate::model::Model;
use crate::wall::{self, Bounds};

/// The configuration of a specimen at an equilibrium, and the ledger that led there.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Centres of the grains \[m\], shape (n), in the solver's order.
    pub position: Vec<Vec3>,
    /// Whether a grain takes part in the balance of forces, shape (n); the others float.
    pub carries: Vec<bool>,
    /// Inward displacement of the walls since the start \[m\].
    pub displacement: [f64; wall::COUNT],
    /// Work of the walls since the start \[J\].
    pub wall_work: f64,
    /// Stored energy at the initial equilibrium \[J\].
    pub initial_energy: f64,
}

impl State {
    /// The state that `model` was loaded with.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        Self {
            position: model.grains.iter().map(|g| Vec3::from(g.position)).collect(),
            carries: vec![true; model.len()],
            displacement: [0.0; wall::COUNT],
            wall_work: 0.0,
            initial_energy: 0.0,
        }
    }

    /// The box now.
    #[must_use]
    pub fn bounds(&self, model: &Model) -> Bounds {
        model.start.displaced(&self.displacement)
    }

    /// Copies `other` into this state without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        self.position.copy_from_slice(&other.position);
        self.carries.copy_from_slice(&other.carries);
        self.displacement = other.displacement;
        self.wall_work = other.wall_work;
        self.initial_energy = other.initial_energy;
    }
}

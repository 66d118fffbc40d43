//! The specimen: grains with their properties, and the box they are in.

mod beside;
mod build;
mod coincident;
mod crystal;
mod csv;
pub mod discs;
mod error;
pub mod generate;
pub mod grading;
mod history;
pub mod hydrate;
pub mod prepare;
pub mod properties;
mod rescale;
mod save;

use crate::wall::Bounds;

pub use beside::box_file;
pub use build::{build, from_texts, unprepared};
pub use crystal::crystal;
pub use csv::{Columns, Constants, PackFile, PackRow, read};
pub use error::PackError;
pub use history::{
    BondMemory, ContactMemory, History, Kept, Layer, MOST_BODIES, body_of, history_file,
    wall_index, wall_of,
};
pub use rescale::rescale;
pub use save::{Texts, save, texts};

/// One grain's constants and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grain {
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Radius R \[m\].
    pub radius: f64,
    /// Young's modulus E \[Pa\].
    pub young: f64,
    /// Poisson's ratio ν.
    pub poisson: f64,
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Coefficient of friction μ, 0 to infinite.
    pub friction: f64,
    /// Whether it is gas hydrate, which can dissociate ([`hydrate`]).
    pub hydrate: bool,
}

/// Grains in a box.
#[derive(Clone, Debug, PartialEq)]
pub struct Pack {
    /// The walls' positions.
    pub bounds: Bounds,
    /// The grains, in the order of the pack file.
    pub grains: Vec<Grain>,
    /// What frictional contacts remember; `None` when no friction ever acted.
    pub history: Option<History>,
}

impl Pack {
    /// The grains that lie wholly inside `bounds`, which becomes the box (HZ-15), without history.
    /// None may be left. Discs, of the dimension 2, keep their depth.
    #[must_use]
    pub fn cut(&self, bounds: &Bounds, dimension: u8) -> Self {
        let inside = |grain: &&Grain| {
            (0..usize::from(dimension)).all(|axis| {
                grain.position[axis] - grain.radius >= bounds.min[axis]
                    && grain.position[axis] + grain.radius <= bounds.max[axis]
            })
        };
        let grains = self.grains.iter().filter(inside).copied().collect();
        let mut bounds = *bounds;
        if dimension == 2 {
            (bounds.min[2], bounds.max[2]) = (self.bounds.min[2], self.bounds.max[2]);
        }
        Self { bounds, grains, history: None }
    }

    /// The grains that lie wholly between the circles of the radius `inner` \[m\], 0 for none, and that in
    /// the square `bounds`, which becomes the box, as [`cut`](Self::cut).
    #[must_use]
    pub fn cut_round(&self, bounds: &Bounds, inner: f64, dimension: u8) -> Self {
        let mut cut = self.cut(bounds, dimension);
        let [x, y, _] = cut.bounds.center();
        let outer = 0.5 * cut.bounds.sides()[0];
        cut.grains.retain(|grain| {
            let distance = (grain.position[0] - x).hypot(grain.position[1] - y);
            let inside = inner == 0.0 || distance - grain.radius >= inner;
            inside && distance + grain.radius <= outer
        });
        cut
    }
}

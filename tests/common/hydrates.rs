//! Packs with hydrate, and commands by which it dissociates.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::command::{Ask, Command, Disposition, Dissociation};
use graintwin::pack::Pack;
use graintwin::pack::hydrate::{Filling, fill_at};
use graintwin::report::{Demand, Hydrate, Measures, Report};
use graintwin::scene::{Material, Solver, Walls};
use graintwin::wall;

use crate::packs::{Rig, absolute, made};

/// Methane hydrate of T table 2.1.
pub(crate) const HYDRATE: Material =
    Material { young: 6.6e9, poisson: 0.32, density: 900.0, spread: 0.0 };

/// Glass of which the smallest grains are of `material`, at an isotropic stress \[Pa\].
pub(crate) fn filled(grains: usize, stress: f64, saturation: f64, material: &Material) -> Pack {
    let filling = Filling { saturation, material, seed: 1 };
    let glass = made(grains, stress, 1);
    fill_at(&glass, &filling, stress, &Walls::default(), Solver::default()).unwrap()
}

/// A dissociation with its numbers in the order of the message.
pub(crate) fn dissociation(loss: f64, pressure: f64, biot: f64) -> Ask {
    let (saturation_loss, pore_pressure) = (loss, pressure);
    Ask::Dissociation(Dissociation { saturation_loss, pore_pressure, biot })
}

impl Rig {
    /// Asks for it.
    pub(crate) fn ask(&mut self, ask: Ask) -> Report {
        self.sequence += 1;
        let command = Command { ask, ..absolute(self.sequence, [0.0; wall::COUNT]) };
        self.twin.apply(&command, Demand::ALL)
    }

    /// Dissociates; it must be applied.
    pub(crate) fn dissociate(&mut self, loss: f64, pressure: f64, biot: f64) -> Measures {
        let report = self.ask(dissociation(loss, pressure, biot));
        assert_eq!(report.disposition, Disposition::Applied, "{}", report.text);
        report.measures.unwrap()
    }
}

/// What [`Demand::ALL`] brings of a pack with hydrate.
pub(crate) fn hydrate(measures: &Measures) -> Hydrate {
    measures.hydrate.unwrap()
}

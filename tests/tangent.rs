//! The tangent stiffness against differences of equilibria, and what must hold of it.
#![allow(clippy::unwrap_used, reason = "a test that fails may panic")]

#[path = "common/packs.rs"]
mod packs;

use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::advance::move_walls;
use graintwin::relax::tangent::{Stiffness, Tangent, tangent};
use graintwin::relax::{Outcome, Status, Workspace, relax};
use graintwin::scene::Scene;
use graintwin::state::State;
use graintwin::wall;
use nalgebra::{Matrix3, Matrix6, Vector6};
use packs::{by_strain, made, scene_to};

/// An increment from one equilibrium, which can be taken again to other walls.
struct Increment {
    model: Model,
    from: State,
    to: [f64; wall::COUNT],
}

impl Increment {
    /// From the pack as it is to `strain`.
    fn new(scene: &Scene, pack: &Pack, strain: [f64; 3]) -> Self {
        let model = Model::new(pack, scene);
        let mut from = State::new(&model);
        if let Some(history) = &pack.history {
            from.recall(&model, history);
        }
        Self { model, from, to: by_strain(&pack.bounds, strain) }
    }

    /// The equilibrium with the walls `more` further in \[m\].
    fn relaxed(&self, more: [f64; wall::COUNT]) -> (State, Workspace, Outcome) {
        let mut state = self.from.clone();
        let mut work = Workspace::new(&self.model);
        work.begin(&self.model, &state);
        let to = std::array::from_fn(|w| self.to[w] + more[w]);
        move_walls(&self.model, &mut state, &to, 1.0);
        let outcome = relax(&self.model, &mut state, &mut work);
        assert_eq!((outcome.status, outcome.descents), (Status::Converged, 0));
        (state, work, outcome)
    }

    fn forces(&self, more: [f64; wall::COUNT]) -> Vector6<f64> {
        let (state, work, _) = self.relaxed(more);
        walls::normal_forces(&self.model, &state, &work.neighbours).into()
    }

    /// Stiffness of the walls by central differences of both `step` \[m\] and half of it.
    fn differences(&self, step: f64) -> Matrix6<f64> {
        let column = |w: usize, step: f64| {
            let by = |sign: f64| std::array::from_fn(|v| if v == w { sign * step } else { 0.0 });
            (self.forces(by(1.0)) - self.forces(by(-1.0))) / (2.0 * step)
        };
        let columns: Vec<_> = (0..wall::COUNT)
            .map(|w| (column(w, 0.5 * step) * 4.0 - column(w, step)) / 3.0)
            .collect();
        Matrix6::from_columns(&columns)
    }

    fn tangent(&self) -> Tangent {
        let (state, work, outcome) = self.relaxed([0.0; wall::COUNT]);
        tangent(&self.model, &state, &work, &outcome)
    }
}

fn off6(a: &Matrix6<f64>, b: &Matrix6<f64>) -> f64 {
    (a - b).amax() / b.amax()
}

#[test]
fn frictionless_stiffness_is_that_of_re_equilibrated_walls() {
    for (grains, stress, seed) in [(120, 1e7, 5), (306, 1e7, 1), (120, 1e6, 3)] {
        let increment = Increment::new(&scene_to(1e-12), &made(grains, stress, seed), [0.0; 3]);
        let tangent = increment.tangent();
        let stiffness = tangent.stands.unwrap();
        let want = increment.differences(3e-7 * 1e-3);
        eprintln!("{} {} {}", off6(&stiffness.walls, &want), stiffness.error, tangent.products);
        eprintln!("{:.4e} {:.4e}", stiffness.relaxed, stiffness.affine);
    }
}

//! An increment from one equilibrium, which can be taken again to other walls.
#![allow(dead_code, reason = "each test takes what it needs of it")]

use graintwin::measure::walls;
use graintwin::model::Model;
use graintwin::pack::Pack;
use graintwin::relax::advance::move_walls;
use graintwin::relax::tangent::{Tangent, tangent};
use graintwin::relax::{Outcome, Status, Workspace, relax};
use graintwin::scene::{Law, Scene};
use graintwin::state::State;
use graintwin::wall::{self, Bounds};
use nalgebra::{Matrix6, Vector6};

use crate::packs::by_strain;

pub(crate) struct Increment {
    model: Model,
    from: State,
    to: [f64; wall::COUNT],
}

impl Increment {
    /// From the pack as it is to `strain`.
    pub(crate) fn new(scene: &Scene, pack: &Pack, strain: [f64; 3]) -> Self {
        let model = Model::new(pack, scene);
        let mut from = State::new(&model);
        if let Some(history) = &pack.history {
            from.recall(&model, history);
        }
        Self { model, from, to: by_strain(&pack.bounds, strain) }
    }

    /// From where this ends, to there.
    pub(crate) fn settled(&self) -> Self {
        let (mut from, mut work, _) = self.reached([0.0; wall::COUNT]);
        work.commit(&self.model, &mut from);
        Self { to: from.displacement, model: self.model.clone(), from }
    }

    /// As [`settled`](Self::settled), with contacts that never slide.
    pub(crate) fn sticking(&self) -> Self {
        let mut settled = self.settled();
        let friction = settled.model.friction.as_mut().unwrap();
        friction.law = Law::ReturnMap;
        friction.coefficient.fill(f64::INFINITY);
        friction.wall_coefficient = f64::INFINITY;
        settled
    }

    /// The box at the end.
    pub(crate) fn bounds(&self) -> Bounds {
        self.model.start.displaced(&self.to)
    }

    /// The equilibrium with the walls `more` further in \[m\], on the branch of this one.
    fn relaxed(&self, more: [f64; wall::COUNT]) -> (State, Workspace, Outcome) {
        let reached = self.reached(more);
        assert_eq!(reached.2.descents, 0);
        reached
    }

    fn reached(&self, more: [f64; wall::COUNT]) -> (State, Workspace, Outcome) {
        let mut state = self.from.clone();
        let mut work = Workspace::new(&self.model);
        // The pack may carry what it remembers.
        work.start(&self.model, &state);
        let to = std::array::from_fn(|w| self.to[w] + more[w]);
        move_walls(&self.model, &mut state, &to, 1.0);
        let outcome = relax(&self.model, &mut state, &mut work);
        assert_eq!(outcome.status, Status::Converged, "{outcome:?}");
        (state, work, outcome)
    }

    /// Normal forces on the walls there \[N\].
    pub(crate) fn forces(&self, more: [f64; wall::COUNT]) -> Vector6<f64> {
        let (mut state, mut work, _) = self.relaxed(more);
        work.commit(&self.model, &mut state);
        walls::normal_forces(&self.model, &state, &work.neighbours).into()
    }

    /// Stiffness of the walls \[N/m\] by central differences of both `step` \[m\] and half of it.
    pub(crate) fn differences(&self, step: f64) -> Matrix6<f64> {
        let column = |w: usize, step: f64| {
            let by = |sign: f64| std::array::from_fn(|v| if v == w { sign * step } else { 0.0 });
            (self.forces(by(1.0)) - self.forces(by(-1.0))) / (2.0 * step)
        };
        let columns: Vec<_> = (0..wall::COUNT)
            .map(|w| (column(w, 0.5 * step) * 4.0 - column(w, step)) / 3.0)
            .collect();
        Matrix6::from_columns(&columns)
    }

    /// The tangent stiffness at the end.
    pub(crate) fn tangent(&self) -> Tangent {
        let (mut state, mut work, outcome) = self.relaxed([0.0; wall::COUNT]);
        match outcome.iterations {
            0 => work.keep(&mut state),
            _ => work.commit(&self.model, &mut state),
        };
        tangent(&self.model, &state, &work, &outcome)
    }
}

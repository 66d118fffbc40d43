//! Moving the walls under limits that only the equilibrium tells: forces, and how far walls under
//! a load go.

use super::Twin;
use crate::command::gate::{Order, Stand};
use crate::measure::walls;
use crate::plane;
use crate::plane::boundary::SIDES;
use crate::relax::Workspace;
use crate::relax::advance::{Advance, advance};
use crate::wall::Setpoint;

/// Halvings in search of the last equilibrium within the limits: it is found to 1/64 of the way.
const HALVINGS: u32 = 6;

/// What an order came to.
pub(super) struct Gone {
    /// How the last equilibrium was reached, or not.
    pub(super) reached: Advance,
    /// What the walls do there.
    pub(super) setpoint: Setpoint,
    /// Why they went not at all or, with `clamped`, not all the way.
    pub(super) beyond: Option<String>,
    /// Whether they went a part of the way.
    pub(super) clamped: bool,
}

impl Gone {
    /// Whether the walls went all the way.
    pub(super) fn is_whole(&self) -> bool {
        self.reached.outcome.status.is_equilibrium() && self.beyond.is_none()
    }
}

impl Twin {
    /// Takes the walls where `order` says, or with `clamp` as far as the limits allow. When they
    /// do not go, the state is what it was.
    pub(super) fn go(&mut self, order: &Order, clamp: bool) -> Gone {
        let (setpoint, tilt, clamped) = (order.setpoint, order.tilt, false);
        self.past.iter_mut().for_each(|past| past.leave(&self.state));
        if !self.gate.watches(&setpoint) {
            let reached = self.advance(&setpoint, tilt);
            return Gone { reached, setpoint, beyond: None, clamped };
        }
        let start = self.state.clone();
        let before = self.stand();
        let reached = self.advance(&setpoint, tilt);
        let beyond = match reached.outcome.status.is_equilibrium() {
            true => self.beyond_limits(&setpoint, &before),
            false => None,
        };
        if beyond.is_none() {
            return Gone { reached, setpoint, beyond, clamped };
        }
        self.state.copy_from(&start);
        if !clamp {
            return Gone { reached, setpoint, beyond, clamped };
        }
        let (mut within, mut too_far) = (0.0, 1.0);
        let mut furthest = None;
        for _ in 0..HALVINGS {
            let share = 0.5 * (within + too_far);
            let part = self.gate.part(&setpoint, &before, share);
            let reached = self.advance(&part, self.gate.tilted_by(tilt, share));
            let allowed = reached.outcome.status.is_equilibrium()
                && self.beyond_limits(&part, &before).is_none();
            match allowed {
                true => {
                    within = share;
                    furthest = Some((self.state.clone(), part, reached));
                }
                false => too_far = share,
            }
            self.state.copy_from(&start);
        }
        let (setpoint, reached) = match furthest {
            Some((state, part, reached)) => {
                self.state = state;
                (part, reached)
            }
            None => {
                let now = *self.gate.now();
                (now, self.advance(&now, self.gate.tilt()))
            }
        };
        Gone { reached, setpoint, beyond, clamped: true }
    }

    /// Why the walls may not stay where `setpoint` took them from `before`.
    pub(super) fn beyond_limits(&mut self, setpoint: &Setpoint, before: &Stand) -> Option<String> {
        let now = self.stand();
        self.gate.beyond_limits(setpoint, before, &now)
    }

    /// Moves the walls as `setpoint` has them; a box of discs then leans by `tilt`.
    pub(super) fn advance(&mut self, setpoint: &Setpoint, tilt: f64) -> Advance {
        let here = self.outcome;
        let Self { model, state, work, pool, .. } = self;
        pool.install(|| match &model.plane {
            None => advance(model, state, work, setpoint, here),
            Some(_) => {
                let Workspace { plane, neighbours, .. } = work;
                plane::advance::advance(model, state, plane, neighbours, setpoint, tilt, here)
            }
        })
    }

    /// The walls now.
    pub(super) fn stand(&mut self) -> Stand {
        let Self { model, state, work, .. } = self;
        work.neighbours.refresh(model, &state.position, &state.bounds(model));
        let mut force = match &model.plane {
            None => walls::normal_forces(model, state, &work.neighbours),
            Some(_) => plane::contacts::normal_forces(model, state, &work.neighbours),
        };
        let cell = model.cell.as_ref();
        for w in (0..SIDES).filter(|&w| cell.is_some_and(|cell| cell.is_membrane(w))) {
            force[w] = state.pressure[w] * model.wall_area(w, &state.displacement);
        }
        Stand { displacement: state.displacement, force }
    }
}

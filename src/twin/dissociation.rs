//! Serving a command by which hydrate dissociates (T 5.2.2).

use super::limited::Gone;
use super::{LOADS_NEED_NEWTON, Twin, loads_need_newton};
use crate::command::gate::Order;
use crate::command::{Command, Disposition, Dissociation};
use crate::relax::dissociate::dissociate;
use crate::relax::tangent;
use crate::report::{Demand, Report};
use crate::state::Dissociated;
use crate::wall::{self, Control, Setpoint};

impl Twin {
    /// Takes grains and walls to where `to` has them; `text` is for the report. When they do not
    /// get there, state and radii are what they were.
    pub(super) fn dissociate(
        &mut self,
        command: &Command,
        to: &Dissociation,
        text: String,
        demand: Demand,
    ) -> Report {
        let now = self.state.dissociated;
        let relief = to.biot * (to.pore_pressure - now.pressure);
        let effective = self.effective_stress();
        // Cement carries tension too.
        if relief > effective && self.model.cement.is_none() {
            let text = format!(
                "pore_pressure would take {relief:e} Pa away from the grains, which carry \
                 {effective:e} Pa: no more than that is allowed"
            );
            return self.refused(command, Disposition::Limit, text);
        }
        let expanded = match self.expanded(relief) {
            Ok(setpoint) => setpoint,
            Err(text) => return self.refused(command, Disposition::NotConverged, text),
        };
        // Half of a dissociation is another one: it is not cut down to a limit.
        let order = match self.gate.limit(command, (expanded, 0.0), text) {
            Ok(order) if !order.clamped => order,
            Ok(Order { text, .. }) | Err(text) => {
                return self.refused(command, Disposition::Limit, text);
            }
        };
        if loads_need_newton(&self.model, &order.setpoint) {
            let disposition = Disposition::Invalid;
            return Report { disposition, text: LOADS_NEED_NEWTON.into(), ..self.blank(command) };
        }
        let end = Dissociated {
            lost: to.saturation_loss,
            pressure: to.pore_pressure,
            borne: now.borne + relief,
            work: 0.0,
        };
        let gone = self.go_to(&end, &order.setpoint);
        if gone.is_whole() {
            self.gate.dissociated(to);
        }
        self.conclude(command, order, gone, demand)
    }

    /// Where the walls go for the pore pressure to take `relief` \[Pa\] of effective stress away:
    /// the sample expands evenly by the volumetric strain relief/K (5.1), K its drained bulk
    /// modulus now, both walls of a pair moving.
    fn expanded(&mut self, relief: f64) -> Result<Setpoint, String> {
        let mut setpoint = *self.gate.now();
        if relief == 0.0 {
            return Ok(setpoint);
        }
        let bulk = self.bulk_modulus().ok_or(NO_MODULUS)?;
        let sides = self.state.bounds(&self.model).sides();
        for (w, control) in setpoint.iter_mut().enumerate() {
            if let Control::Displacement(displacement) = control {
                *displacement -= 0.5 * relief / (3.0 * bulk) * sides[wall::axis(w)];
            }
        }
        Ok(setpoint)
    }

    /// Mean normal stress on the walls \[Pa\].
    fn effective_stress(&mut self) -> f64 {
        let (force, bounds) = (self.stand().force, self.state.bounds(&self.model));
        (0..wall::COUNT).map(|w| force[w] / bounds.area(w)).sum::<f64>() / 6.0
    }

    /// Tangent bulk modulus of the present state \[Pa\], where it is known and above 0.
    fn bulk_modulus(&mut self) -> Option<f64> {
        let Self { model, state, work, pool, outcome, .. } = self;
        work.neighbours.refresh(model, &state.position, &state.bounds(model));
        let found = pool.install(|| tangent::tangent(model, state, work, outcome));
        self.spent.products += found.products;
        found.stands.map(|stands| stands.relaxed.sum() / 9.0).filter(|&bulk| bulk > 0.0)
    }

    /// Takes grains and walls there, unless that is beyond a limit that only the equilibrium tells.
    fn go_to(&mut self, end: &Dissociated, setpoint: &Setpoint) -> Gone {
        self.past.iter_mut().for_each(|past| past.leave(&self.state));
        let (start, before) = (self.state.clone(), self.stand());
        let here = self.outcome;
        let Self { model, state, work, pool, .. } = self;
        let reached = pool.install(|| dissociate(model, state, work, end, setpoint, here));
        let found = reached.outcome.status.is_equilibrium();
        let beyond = match found && self.gate.watches(setpoint) {
            true => self.beyond_limits(setpoint, &before),
            false => None,
        };
        if beyond.is_some() {
            self.state.copy_from(&start);
            self.fit();
        }
        Gone { reached, setpoint: *setpoint, beyond, clamped: false }
    }

    /// Radii and weights follow the state.
    pub(super) fn fit(&mut self) {
        if self.model.dissociate(&self.state.dissociated) {
            self.work.neighbours.forget();
        }
    }

    /// The report of a command that comes to nothing, which takes its place in the sequence.
    fn refused(&mut self, command: &Command, disposition: Disposition, text: String) -> Report {
        let report = Report { disposition, text, ..self.blank(command) };
        self.gate.served(command, None, self.state.displacement, &report);
        report
    }
}

const NO_MODULUS: &str = "the pore pressure expands the sample by its drained bulk modulus, which is \
                          not known here: the state is no minimum, or carries nothing";

//! What can be asked of a twin besides moving its walls.

use std::path::Path;

use super::Twin;
use crate::command::request::Answer;
use crate::command::{Command, Disposition};
use crate::pack;
use crate::relax::{Outcome, Workspace};
use crate::report::{Demand, Report};
use crate::scene::{Limits, Scene};
use crate::state::State;
use crate::wall::Setpoint;

/// What of a scene can change between two commands; units and ranges are the scene's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Settings {
    /// Age beyond which a command is refused \[s\]; 0 = never.
    pub stale_after: f64,
    /// Limits of what a command may do.
    pub limits: Limits,
    /// Largest unbalanced force of a grain over the mean contact force.
    pub tolerance: f64,
    /// Largest strain between two equilibria.
    pub max_strain_increment: f64,
}

impl Settings {
    /// Those of a scene.
    #[must_use]
    pub fn of(scene: &Scene) -> Self {
        Self {
            stale_after: scene.node.stale_after,
            limits: scene.node.limits,
            tolerance: scene.solver.tolerance,
            max_strain_increment: scene.solver.max_strain_increment,
        }
    }
}

impl Twin {
    /// Back to the initial equilibrium: the pack as it was given is relaxed again, so that state
    /// and answers are those of [`Twin::start`] bit for bit, and every command is forgotten.
    /// Limits, hold and faults stay as they are.
    pub fn reset(&mut self, demand: Demand) -> Report {
        self.spent = self.effort();
        self.state = State::new(&self.model);
        if let Some(history) = &self.given_history {
            self.state.recall(&self.model, history);
        }
        self.model.dissociate(&self.state.dissociated);
        self.work = Workspace::new(&self.model);
        self.gate.forget_commands();
        self.increment = 0;
        self.outcome = Outcome::NONE;
        self.stress_strain = ([0.0; 3], [0.0; 3]);
        self.event_energy = 0.0;
        self.start(demand)
    }

    /// Begins or ends a hold, during which every command is refused as held.
    ///
    /// # Errors
    /// When the hold has ended but a fault keeps the twin on hold.
    pub fn hold(&mut self, held: bool) -> Answer {
        self.gate.hold(held);
        match (held, self.gate.holds()) {
            (true, _) => Ok("on hold: every command is refused as HELD".into()),
            (false, None) => Ok("commands are served".into()),
            (false, Some(text)) => Err(text),
        }
    }

    /// Forgets the fault that keeps the twin on hold; a hold that somebody asked for stays.
    pub fn reset_faults(&mut self) -> String {
        let text = match self.gate.reset_faults() {
            Some(fault) => format!("forgotten: {fault}"),
            None => "there is no fault".into(),
        };
        match self.gate.holds() {
            Some(holds) => format!("{text}; still {holds}"),
            None => text,
        }
    }

    /// From now on these settings hold.
    pub fn set(&mut self, settings: &Settings) {
        self.gate.set_limits(settings.limits);
        self.gate.set_stale_after(settings.stale_after);
        self.model.solver.tolerance = settings.tolerance;
        self.model.solver.max_strain_increment = settings.max_strain_increment;
    }

    /// What the walls do now.
    #[must_use]
    pub fn setpoint(&self) -> &Setpoint {
        self.gate.now()
    }

    /// Stores the pack as it is now in `file`, which ends with `.csv`, and beside it its box and
    /// history ([`pack::save`]).
    ///
    /// # Errors
    /// When one of these files exists, since whoever asks may not see what would be lost, or when
    /// they cannot be written.
    pub fn save_pack(&self, file: &Path) -> Answer {
        for taken in [file.to_owned(), pack::box_file(file), pack::history_file(file)] {
            let exists = taken.try_exists();
            if exists.map_err(|error| format!("cannot look for {}: {error}", taken.display()))? {
                return Err(format!("{} exists: name a new file", taken.display()));
            }
        }
        pack::save(&self.pack(), file).map_err(|error| error.to_string())?;
        Ok(format!("increment {} in {}", self.increment, file.display()))
    }

    /// The report of a message that came instead of `command` and makes none: INVALID for the
    /// reason in `text`, or HELD. It takes no place in the sequence.
    #[must_use]
    pub fn refuse(&self, command: &Command, text: String) -> Report {
        let (disposition, text) = match self.gate.holds() {
            Some(holds) => (Disposition::Held, holds),
            None => (Disposition::Invalid, text),
        };
        Report { disposition, text, ..self.blank(command) }
    }
}

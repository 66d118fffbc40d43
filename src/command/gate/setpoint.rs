//! What a command makes the walls do, limits aside.

use super::Gate;
use crate::command::{Ask, Command, Mode, Shear};
use crate::plane::Cell;
use crate::wall::{self, Control, Load, Setpoint, WallTarget};

/// What is wrong with the form of a command.
pub(super) fn malformed(command: &Command) -> Option<String> {
    if let Mode::Unknown(mode) = command.mode {
        return Some(format!("mode {mode}: 0 (absolute) and 1 (increment) are allowed"));
    }
    if let Ask::Dissociation(asked) = &command.ask {
        let (name, value) = asked.named().into_iter().find(|(_, value)| !value.is_finite())?;
        return Some(format!("{name} is {value}: a finite number is needed"));
    }
    if let Ask::Shear(Shear { tilt, .. }) = command.ask
        && !tilt.is_finite()
    {
        return Some(format!("tilt is {tilt}: a finite number is needed"));
    }
    let values = command.ask.numbers();
    let wall = values.iter().position(|value| !value.is_finite())?;
    let (name, value) = (wall::NAMES[wall], values[wall]);
    Some(match command.ask {
        Ask::Displacement(_) => {
            format!("displacement of {name} is {value}: a finite number of metres is needed")
        }
        _ => format!("value of {name} is {value}: a finite number is needed"),
    })
}

/// Whether the sides of `cell` are such that they can do what they are asked.
fn fits(cell: &Cell, ask: &Ask, targets: &[WallTarget; wall::COUNT]) -> Result<(), String> {
    for (w, target) in targets.iter().enumerate() {
        let name = wall::NAMES[w];
        let nothing = matches!(target, WallTarget::Keep | WallTarget::Displacement(0.0));
        let presses = matches!(ask, Ask::Displacement(_))
            || matches!(target, WallTarget::Keep | WallTarget::Stress(_));
        if cell.is_membrane(w) && !presses {
            return Err(format!("{name} is a membrane; allowed: a stress, or keep"));
        }
        if !cell.has(w) && !nothing {
            return Err(format!(
                "{name} is asked for something: there is no such wall here; allowed: 0 m, or keep"
            ));
        }
    }
    Ok(())
}

impl Gate {
    /// The tilt that `ask` leads to, or what is wrong with it.
    pub(super) fn tilted(&self, ask: &Ask, mode: Mode) -> Result<f64, String> {
        let Ask::Shear(Shear { tilt, .. }) = *ask else { return Ok(self.tilt) };
        if !self.leans {
            return Err("tilt: only a box of discs leans; allowed: other commands".into());
        }
        let tilt = if mode == Mode::Increment { self.tilt + tilt } else { tilt };
        match tilt.abs() < 1.0 {
            true => Ok(tilt),
            false => Err(format!("the box would be tilted by {tilt}: allowed: -1 < tilt < 1")),
        }
    }

    /// What the walls do when they are asked so, or what is wrong with it.
    pub(super) fn setpoint(&self, ask: &Ask, mode: Mode) -> Result<Setpoint, String> {
        let targets = ask.targets();
        let mut setpoint = self.now;
        if let Some(cell) = &self.cell {
            fits(cell, ask, &targets)?;
        }
        for (w, target) in targets.into_iter().enumerate() {
            let keeps = matches!(ask, Ask::Displacement(_)) && self.now[w].load().is_some()
                || self.cell.as_ref().is_some_and(|cell| !cell.has(w));
            if !keeps {
                setpoint[w] = self.control(w, target, mode)?;
            }
        }
        for axis in 0..3 {
            let [low, high] = [2 * axis, 2 * axis + 1];
            if let (Some(one), Some(other)) = (setpoint[low].load(), setpoint[high].load())
                && one != other
                && self.cell.as_ref().is_none_or(|cell| cell.is_paired(axis))
            {
                return Err(format!(
                    "{} and {} shall carry {one} and {other}: the two walls of a pair carry \
                     the same load, or one of them stands",
                    wall::NAMES[low],
                    wall::NAMES[high]
                ));
            }
        }
        Ok(setpoint)
    }

    /// What `target` makes wall `w` do.
    fn control(&self, w: usize, target: WallTarget, mode: Mode) -> Result<Control, String> {
        let name = wall::NAMES[w];
        let on_top = mode == Mode::Increment;
        let load = |load: Load, value: f64, unit: &str| {
            if value > 0.0 && value.is_finite() {
                return Ok(Control::Load(load));
            }
            Err(format!("{name} shall carry {value:e} {unit}: a load is above 0 and finite"))
        };
        let under_none =
            || format!("{name} carries no such load that an increment could go on top of");
        match target {
            WallTarget::Keep => Ok(self.now[w]),
            WallTarget::Displacement(value) => {
                let before = match self.now[w] {
                    Control::Displacement(before) => before,
                    Control::Load(_) => self.displacement[w],
                };
                Ok(Control::Displacement(if on_top { before + value } else { value }))
            }
            WallTarget::Force(value) => {
                let before = match self.now[w] {
                    _ if !on_top => 0.0,
                    Control::Load(Load::Force(before)) => before,
                    _ => return Err(under_none()),
                };
                load(Load::Force(before + value), before + value, "N")
            }
            WallTarget::Stress(value) => {
                let before = match self.now[w] {
                    _ if !on_top => 0.0,
                    Control::Load(Load::Stress(before)) => before,
                    _ => return Err(under_none()),
                };
                load(Load::Stress(before + value), before + value, "Pa")
            }
            WallTarget::Unknown(number, _) => Err(format!(
                "control {number} of {name}: 0 (keep), 1 (displacement), 2 (force) and 3 (stress) \
                 are allowed"
            )),
        }
    }
}

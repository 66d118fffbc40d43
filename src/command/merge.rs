//! Which of the commands that wait may become one increment.
//!
//! A rig that is faster than the twin leaves commands waiting. Absolute ones of one session that
//! follow upon each other and lead every wall on in one direction can be served as one increment
//! to the last of them: the walls then go there straight.

use super::request::Intake;
use super::{Ask, Command, Mode};
use crate::wall::{self, Control, Setpoint, WallTarget};

/// How many of the first of `waiting` may become one increment from `now`, what the walls do.
/// Fewer than two means that the first is to be served alone.
pub fn mergeable<'a>(now: &Setpoint, waiting: impl IntoIterator<Item = &'a Intake>) -> usize {
    let mut path = Path::new(now);
    let mut last: Option<&Command> = None;
    let joins = |intake: &&'a Intake| {
        let Intake::Command(command) = intake else { return false };
        let follows = last.is_none_or(|last| {
            last.session == command.session
                && last.sequence.checked_add(1) == Some(command.sequence)
        });
        last = Some(command);
        follows && command.mode == Mode::Absolute && path.goes_on(&command.ask)
    };
    waiting.into_iter().take_while(joins).count()
}

/// Where walls that stand were sent so far.
struct Path<'a> {
    now: &'a Setpoint,
    /// Displacement of each wall \[m\]; of no meaning under a load.
    at: [f64; wall::COUNT],
    /// Whether a wall that moved went inwards.
    inwards: [Option<bool>; wall::COUNT],
}

impl<'a> Path<'a> {
    fn new(now: &'a Setpoint) -> Self {
        let at = now.map(|control| match control {
            Control::Displacement(displacement) => displacement,
            Control::Load(_) => 0.0,
        });
        Self { now, at, inwards: [None; wall::COUNT] }
    }

    /// Goes where `ask` says when no wall turns round and no load is concerned.
    fn goes_on(&mut self, ask: &Ask) -> bool {
        (0..wall::COUNT).all(|w| self.wall_goes_on(w, ask))
    }

    fn wall_goes_on(&mut self, w: usize, ask: &Ask) -> bool {
        let stands = self.now[w].load().is_none();
        let to = match ask {
            Ask::Displacement(displacement) if stands => displacement[w],
            Ask::Displacement(_) => return true,
            Ask::Dissociation(_) | Ask::Shear(_) => return false,
            Ask::Targets(targets) => match targets[w] {
                WallTarget::Keep => return true,
                WallTarget::Displacement(displacement) if stands => displacement,
                _ => return false,
            },
        };
        let inwards = to > self.at[w];
        if !to.is_finite() || (to != self.at[w] && self.inwards[w].is_some_and(|so| so != inwards))
        {
            return false;
        }
        if to != self.at[w] {
            self.inwards[w] = Some(inwards);
        }
        self.at[w] = to;
        true
    }
}

//! Load paths: from the steps of a scene, or a command CSV, to boundary commands.
//!
//! Every command is absolute: the inward displacement of each wall since the start of the run.
//! The session is [`SESSION`], sequences count from 1. A strain step takes 1 s per increment; a
//! file brings its own stamps, which count from the end of the step before it. Whether the walls
//! can go where a command sends them is for the twin to say.

mod csv;
mod error;
mod rig_log;
mod strain;

use std::path::Path;

use crate::command::{Ask, Command, Mode, Stamp};
use crate::scene::{LoadPath, MAX_COMMANDS, Step};
use crate::wall::{self, Bounds};

pub use error::PathError;

/// Session of the commands of a load path.
pub const SESSION: &str = "load_path";

/// Duration of an increment of a strain step.
const INCREMENT_NANOSECONDS: i64 = 1_000_000_000;

/// The commands of a scene's load path.
///
/// `bounds` is the box at the start of the run and `folder` the one that relative files are meant
/// from.
///
/// # Errors
/// When a file cannot be read or is wrong, or the commands are more than [`MAX_COMMANDS`].
pub fn commands(
    path: &LoadPath,
    folder: &Path,
    bounds: &Bounds,
) -> Result<Vec<Command>, PathError> {
    let mut course = Course::new(*bounds);
    follow(&path.0, folder, &mut course)?;
    Ok(course.commands)
}

/// The commands of a command CSV alone.
///
/// # Errors
/// As [`commands`].
pub fn read_csv(file: &Path) -> Result<Vec<Command>, PathError> {
    // Absolute displacements need no box.
    let mut course = Course::new(Bounds { min: [0.0; 3], max: [0.0; 3] });
    csv::follow(file, &mut course)?;
    Ok(course.commands)
}

fn follow(steps: &[Step], folder: &Path, course: &mut Course) -> Result<(), PathError> {
    for step in steps {
        match step {
            Step::Isotropic(step) => strain::isotropic(step, course)?,
            Step::Uniaxial(step) => strain::uniaxial(step, course)?,
            Step::Triaxial(step) => strain::triaxial(step, course)?,
            Step::Polyaxial(step) => strain::polyaxial(step, course)?,
            Step::Unload(step) => strain::unload(step, course)?,
            Step::Repeat(step) => {
                for _ in 0..step.times {
                    follow(&step.steps, folder, course)?;
                }
            }
            Step::Commands(file) => csv::follow(&folder.join(file), course)?,
            Step::RigLog(step) => rig_log::follow(step, &folder.join(&step.file), course)?,
        }
    }
    Ok(())
}

/// The commands so far and where they have led.
#[derive(Debug)]
struct Course {
    /// The box at the start of the run.
    start: Bounds,
    /// Where the last command sends the walls \[m\].
    displacement: [f64; wall::COUNT],
    /// Stamp of the last command \[ns\].
    clock: i64,
    commands: Vec<Command>,
}

impl Course {
    fn new(start: Bounds) -> Self {
        Self { start, displacement: [0.0; wall::COUNT], clock: 0, commands: Vec::new() }
    }

    /// The box after the last command.
    fn bounds(&self) -> Bounds {
        self.start.displaced(&self.displacement)
    }

    /// Adds a command for `nanoseconds` since the start of the run.
    fn push(
        &mut self,
        nanoseconds: i64,
        displacement: [f64; wall::COUNT],
    ) -> Result<(), PathError> {
        let sequence = self.commands.len() as u64 + 1;
        if sequence > MAX_COMMANDS {
            return Err(PathError::TooMany);
        }
        self.displacement = displacement;
        self.clock = nanoseconds;
        self.commands.push(Command {
            stamp: stamp(nanoseconds).ok_or(PathError::TooLong)?,
            session: SESSION.into(),
            sequence,
            mode: Mode::Absolute,
            ask: Ask::Displacement(displacement),
            age: None,
        });
        Ok(())
    }
}

fn stamp(nanoseconds: i64) -> Option<Stamp> {
    let sec = i32::try_from(nanoseconds.div_euclid(1_000_000_000)).ok()?;
    // The remainder of a division by 1e9 fits.
    Some(Stamp { sec, nanosec: nanoseconds.rem_euclid(1_000_000_000) as u32 })
}

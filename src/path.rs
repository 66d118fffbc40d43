//! Load paths: from the steps of a scene, or a command CSV, to commands.
//!
//! Every command is absolute: the inward displacement of each wall since the start of the run, or
//! the load that it carries. The session is [`SESSION`], sequences count from 1. A step takes 1 s
//! per increment; a file brings its own stamps, which count from the end of the step before it.
//! Whether the walls can go where a command sends them is for the twin to say.
//!
//! Where loads and pore pressures take the walls, and what walls that stood carry, only the twin
//! knows: a [`Path`] makes the commands of a step when the step begins, from where the twin is by
//! then.

mod csv;
mod dissociate;
mod error;
mod rig_log;
mod shear;
mod strain;
mod targets;

use std::collections::VecDeque;
use std::path::{Path as FilePath, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use crate::command::{Ask, Command, Dissociation, Mode, Shear, Stamp};
use crate::plane::Cell;
use crate::plane::cell::Side;
use crate::report::{Demand, WallForces};
use crate::scene::{LoadPath, MAX_COMMANDS, Scene, Step};
use crate::sink::{Served, Sink};
use crate::wall::{self, Bounds, WallTarget};

pub use error::PathError;

/// Session of the commands of a load path.
pub const SESSION: &str = "load_path";

/// Duration of an increment of a step.
const INCREMENT_NANOSECONDS: i64 = 1_000_000_000;

/// The commands of a scene's load path, as far as they do not depend on the twin: where a load takes
/// a wall is not known, and every stress counts as 0.
///
/// `bounds` is the box at the start of the run and `folder` the one that relative files are meant
/// from.
///
/// # Errors
/// When a file cannot be read or is wrong, or the commands are more than [`MAX_COMMANDS`].
pub fn commands(
    path: &LoadPath,
    folder: &FilePath,
    bounds: &Bounds,
) -> Result<Vec<Command>, PathError> {
    walked(path, folder, Course::new(*bounds))
}

/// As [`commands`], for spheres or discs as `scene` has them: discs have no z walls to move.
///
/// # Errors
/// As [`commands`].
pub fn commands_of(
    scene: &Scene,
    folder: &FilePath,
    bounds: &Bounds,
) -> Result<Vec<Command>, PathError> {
    walked(&scene.load_path, folder, Course::of(scene, *bounds))
}

fn walked(
    path: &LoadPath,
    folder: &FilePath,
    mut course: Course,
) -> Result<Vec<Command>, PathError> {
    for step in flat(&path.0) {
        follow(step, folder, &mut course)?;
    }
    Ok(course.commands.into())
}

/// The commands of a command CSV alone.
///
/// # Errors
/// As [`commands`].
pub fn read_csv(file: &FilePath) -> Result<Vec<Command>, PathError> {
    // Absolute displacements need no box.
    let mut course = Course::new(Bounds { min: [0.0; 3], max: [0.0; 3] });
    csv::follow(file, &mut course)?;
    Ok(course.commands.into())
}

/// Where the twin is, kept up to date by a [`Sink`].
#[derive(Clone, Debug, Default)]
pub struct Whereabouts(Arc<Mutex<Option<WallForces>>>);

impl Sink for Whereabouts {
    fn demand(&self) -> Demand {
        Demand::default()
    }

    fn served(&mut self, served: &Arc<Served>) {
        if let Some(measures) = &served.report.measures {
            // Nobody can have left it half written.
            *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(measures.walls);
        }
    }
}

/// The commands of a load path, step by step.
#[derive(Debug)]
pub struct Path {
    steps: VecDeque<Step>,
    folder: PathBuf,
    course: Course,
    length: usize,
    /// Whether something on the way takes walls where only the twin knows.
    yields: bool,
    here: Whereabouts,
}

impl Path {
    /// The path of a scene; parameters and errors as those of [`commands`].
    ///
    /// # Errors
    /// As [`commands`].
    pub fn new(scene: &Scene, folder: &FilePath, bounds: &Bounds) -> Result<Self, PathError> {
        let all = commands_of(scene, folder, bounds)?;
        Ok(Self {
            steps: flat(&scene.load_path.0).cloned().collect(),
            folder: folder.to_owned(),
            course: Course::of(scene, *bounds),
            length: all.len(),
            yields: all.iter().any(|command| !matches!(command.ask, Ask::Displacement(_))),
            here: Whereabouts::default(),
        })
    }

    /// Commands of the whole path.
    #[must_use]
    pub fn length(&self) -> usize {
        self.length
    }

    /// What must hear every answer of the twin.
    #[must_use]
    pub fn whereabouts(&self) -> Whereabouts {
        self.here.clone()
    }

    /// Whether where the twin is matters.
    #[must_use]
    pub fn depends_on_the_twin(&self) -> bool {
        self.yields
    }

    /// Whether the next command can only be made once the last one has been served.
    #[must_use]
    pub fn waits(&self) -> bool {
        self.yields && self.course.commands.is_empty() && !self.steps.is_empty()
    }
}

impl From<Vec<Command>> for Path {
    /// Commands that are all known.
    fn from(commands: Vec<Command>) -> Self {
        let mut course = Course::new(Bounds { min: [0.0; 3], max: [0.0; 3] });
        let length = commands.len();
        course.commands = commands.into();
        let (steps, folder, here) = Default::default();
        Self { steps, folder, course, length, yields: false, here }
    }
}

impl Iterator for Path {
    type Item = Result<Command, PathError>;

    /// An error where a file is no longer what it was when the path was made; the path then ends.
    fn next(&mut self) -> Option<Self::Item> {
        while self.course.commands.is_empty() {
            let step = self.steps.pop_front()?;
            if let Some(here) = &*self.here.0.lock().unwrap_or_else(PoisonError::into_inner) {
                self.course.update(here);
            }
            if let Err(error) = follow(&step, &self.folder, &mut self.course) {
                self.steps.clear();
                self.course.commands.clear();
                return Some(Err(error));
            }
        }
        self.course.commands.pop_front().map(Ok)
    }
}

/// Steps with those of repetitions in their place.
fn flat(steps: &[Step]) -> Box<dyn Iterator<Item = &Step> + '_> {
    Box::new(steps.iter().flat_map(|step| match step {
        Step::Repeat(repeat) => {
            let times = (0..repeat.times).flat_map(|_| flat(&repeat.steps));
            Box::new(times) as Box<dyn Iterator<Item = &Step>>
        }
        step => Box::new(std::iter::once(step)),
    }))
}

fn follow(step: &Step, folder: &FilePath, course: &mut Course) -> Result<(), PathError> {
    match step {
        Step::Isotropic(step) => strain::isotropic(step, course),
        Step::Uniaxial(step) => strain::uniaxial(step, course),
        Step::Triaxial(step) => strain::triaxial(step, course),
        Step::Polyaxial(step) => strain::polyaxial(step, course),
        Step::Unload(step) => strain::unload(step, course),
        Step::Walls(step) => targets::follow(step, course),
        Step::Dissociate(step) => dissociate::follow(step, course),
        Step::Shear(step) => shear::follow(step, course),
        Step::Repeat(_) => Ok(()), // Its steps stand in its place.
        Step::Commands(file) => csv::follow(&folder.join(file), course),
        Step::RigLog(step) => rig_log::follow(step, &folder.join(&step.file), course),
    }
}

/// The commands so far and where they have led.
#[derive(Debug)]
struct Course {
    /// The box at the start of the run.
    start: Bounds,
    /// Axes that have walls: x and y, and z but for discs.
    axes: usize,
    /// What surrounds the pack; `None` for six plane walls.
    cell: Option<Cell>,
    /// What the last command has the walls do.
    targets: [WallTarget; wall::COUNT],
    /// Where the walls are by then, as far as it is known \[m\].
    displacement: [f64; wall::COUNT],
    /// Saturation that is lost and pore pressure \[Pa\] by then.
    dissociated: (f64, f64),
    /// Shear of the box by then.
    tilt: f64,
    /// Whether the pore pressure has moved the walls since it was known where they are.
    adrift: bool,
    /// Normal force on each wall when the step began \[N\]; 0 where nobody knows.
    force: [f64; wall::COUNT],
    /// Stamp of the last command \[ns\].
    clock: i64,
    /// Number of the last command.
    sequence: u64,
    commands: VecDeque<Command>,
}

impl Course {
    fn new(start: Bounds) -> Self {
        Self {
            start,
            axes: 3,
            cell: None,
            targets: [WallTarget::Displacement(0.0); wall::COUNT],
            displacement: [0.0; wall::COUNT],
            dissociated: (0.0, 0.0),
            tilt: 0.0,
            adrift: false,
            force: [0.0; wall::COUNT],
            clock: 0,
            sequence: 0,
            commands: VecDeque::new(),
        }
    }

    /// Of the grains of `scene`.
    fn of(scene: &Scene, start: Bounds) -> Self {
        let cell = Cell::of(scene, &start);
        let mut course =
            Self { axes: usize::from(scene.dimension).min(3), cell, ..Self::new(start) };
        let Some(cell) = &course.cell else { return course };
        for (w, side) in cell.sides.iter().enumerate() {
            // A membrane cannot but carry its pressure.
            if let Side::Membrane(pressure) = side {
                course.targets[w] = WallTarget::Stress(*pressure);
            }
        }
        course
    }

    /// Learns from the twin where loads and pore pressures took the walls, and what they carry.
    fn update(&mut self, here: &WallForces) {
        for w in 0..wall::COUNT {
            match &mut self.targets[w] {
                WallTarget::Displacement(target) if self.adrift => {
                    *target = here.displacement[w];
                    self.displacement[w] = here.displacement[w];
                }
                WallTarget::Displacement(_) => {}
                _ => self.displacement[w] = here.displacement[w],
            }
        }
        self.adrift = false;
        self.force = here.normal_force;
    }

    /// The box after the last command.
    fn bounds(&self) -> Bounds {
        self.start.displaced(&self.displacement)
    }

    /// Normal stress on wall `w` when the step began \[Pa\].
    fn stress(&self, w: usize) -> f64 {
        let area = match &self.cell {
            None => self.bounds().area(w),
            Some(cell) => cell.area(w, &self.displacement),
        };
        if area > 0.0 { self.force[w] / area } else { 0.0 }
    }

    /// Whether a wall carries a load.
    fn is_loaded(&self) -> bool {
        self.targets.iter().any(|target| !matches!(target, WallTarget::Displacement(_)))
    }

    /// Adds a command for `nanoseconds` since the start of the run; walls that it keeps do what they
    /// did.
    fn push(
        &mut self,
        nanoseconds: i64,
        targets: [WallTarget; wall::COUNT],
    ) -> Result<(), PathError> {
        let was_loaded = self.is_loaded();
        self.take(targets);
        let ask = match was_loaded || self.is_loaded() {
            true => Ask::Targets(self.targets),
            false => Ask::Displacement(self.displacement),
        };
        self.command(nanoseconds, ask)
    }

    /// Adds a command for `nanoseconds` since the start of the run by which the box leans.
    fn shear(
        &mut self,
        nanoseconds: i64,
        tilt: f64,
        targets: [WallTarget; wall::COUNT],
    ) -> Result<(), PathError> {
        self.take(targets);
        self.tilt = tilt;
        // Walls that are not named do what they did: the path does not know of the scene's own loads.
        self.command(nanoseconds, Ask::Shear(Shear { tilt, targets }))
    }

    fn take(&mut self, targets: [WallTarget; wall::COUNT]) {
        for (w, target) in targets.into_iter().enumerate().take(2 * self.axes) {
            // A membrane that is to stay goes on to press.
            let stays = target == WallTarget::Displacement(self.displacement[w]);
            if stays && self.cell.as_ref().is_some_and(|cell| cell.is_membrane(w)) {
                continue;
            }
            if target != WallTarget::Keep {
                self.targets[w] = target;
            }
            if let WallTarget::Displacement(displacement) = target {
                self.displacement[w] = displacement;
            }
        }
    }

    /// Adds a command for `nanoseconds` since the start of the run by which hydrate dissociates.
    fn dissociate(&mut self, nanoseconds: i64, asked: Dissociation) -> Result<(), PathError> {
        self.dissociated = (asked.saturation_loss, asked.pore_pressure);
        self.adrift = true;
        self.command(nanoseconds, Ask::Dissociation(asked))
    }

    fn command(&mut self, nanoseconds: i64, ask: Ask) -> Result<(), PathError> {
        self.sequence += 1;
        if self.sequence > MAX_COMMANDS {
            return Err(PathError::TooMany);
        }
        self.clock = nanoseconds;
        self.commands.push_back(Command {
            stamp: stamp(nanoseconds).ok_or(PathError::TooLong)?,
            session: SESSION.into(),
            sequence: self.sequence,
            mode: Mode::Absolute,
            ask,
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

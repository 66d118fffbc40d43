//! The commands of a run that no rig outside sends.

use std::cell::RefCell;

use graintwin::command::Command;
use graintwin::command::request::Intake;
use graintwin::path::{Path as LoadPath, PathError, Whereabouts};
use graintwin::scene::Loaded;
use graintwin::wall::Bounds;

use super::Failure;
use super::source::{Given, Source};

/// Where the commands come from.
pub(super) enum Feed {
    /// The load path of the scene.
    Scene,
    /// A list.
    Known(Vec<Command>),
    /// A recording, which may be too large for memory.
    #[cfg_attr(not(feature = "mcap"), expect(dead_code, reason = "nothing reads recordings"))]
    Recorded(Recorded),
}

/// Commands of a recording.
pub(super) struct Recorded {
    /// Them, and what else was meant as such.
    pub(super) intakes: Intakes<'static>,
    /// Messages that they are in.
    pub(super) messages: usize,
}

/// Commands as they come, and what ends them before their end.
pub(super) type Intakes<'a> = Box<dyn Iterator<Item = Result<Intake, Failure>> + 'a>;

/// Why the commands ended before their end.
pub(super) type Broken = RefCell<Option<Failure>>;

/// Commands that are made one by one.
pub(super) struct Orders {
    path: LoadPath,
    recorded: Option<Recorded>,
}

impl Orders {
    /// Those of `feed`, for a pack within `bounds` at the start.
    pub(super) fn new(feed: Feed, loaded: &Loaded, bounds: &Bounds) -> Result<Self, PathError> {
        let none = || LoadPath::from(Vec::new());
        Ok(match feed {
            Feed::Scene => {
                let path = LoadPath::new(&loaded.scene, loaded.folder(), bounds)?;
                Self { path, recorded: None }
            }
            Feed::Known(commands) => Self { path: LoadPath::from(commands), recorded: None },
            Feed::Recorded(recorded) => Self { path: none(), recorded: Some(recorded) },
        })
    }

    /// How many there are.
    pub(super) fn length(&self) -> usize {
        self.recorded.as_ref().map_or(self.path.length(), |recorded| recorded.messages)
    }

    /// What must hear every answer of the twin.
    pub(super) fn whereabouts(&self) -> Whereabouts {
        self.path.whereabouts()
    }

    /// The next ones.
    pub(super) fn iter(&mut self) -> Intakes<'_> {
        match &mut self.recorded {
            Some(recorded) => Box::new(&mut recorded.intakes),
            None => {
                let path = self.path.by_ref();
                Box::new(path.map(|command| Ok(command.map(Intake::from)?)))
            }
        }
    }

    /// What is left of them as a path for a rig to play. A recorded one that could not be read
    /// asks for NaN.
    #[cfg(feature = "ros")]
    pub(super) fn into_path(self) -> Result<LoadPath, Failure> {
        let Some(recorded) = self.recorded else { return Ok(self.path) };
        let command = |intake| match intake {
            Intake::Command(command) | Intake::Malformed(command, _) => Some(command),
            Intake::Request(_) => None,
        };
        let commands = recorded.intakes.filter_map(|item| item.map(command).transpose());
        Ok(LoadPath::from(commands.collect::<Result<Vec<_>, _>>()?))
    }

    /// What is left of them for the twin to serve at once; `broken` keeps what ends them early.
    pub(super) fn into_source(self, broken: &Broken) -> Box<dyn Source + '_> {
        let intakes = match self.recorded {
            Some(recorded) => recorded.intakes,
            None => Box::new(self.path.map(|command| Ok(command.map(Intake::from)?))),
        };
        Box::new(Given(intakes.map_while(|intake| match intake {
            Ok(intake) => Some(intake),
            Err(failure) => {
                broken.replace(Some(failure));
                None
            }
        })))
    }
}

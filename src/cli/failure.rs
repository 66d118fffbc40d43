//! How a verb ends.

use graintwin::pack::PackError;
use graintwin::path::PathError;
use graintwin::scene::SceneError;
use graintwin::twin::TwinError;

/// What a verb that ended came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// Everything was done.
    Done,
    /// It finished, but a command was refused or data was lost.
    Incomplete,
}

/// Why a verb did not end.
#[derive(Debug)]
pub(crate) enum Failure {
    /// An argument or an input file is wrong.
    Input(anyhow::Error),
    /// Anything else.
    Other(anyhow::Error),
}

impl Failure {
    pub(super) fn input(error: impl Into<anyhow::Error>) -> Self {
        Self::Input(error.into())
    }

    pub(super) fn other(error: impl Into<anyhow::Error>) -> Self {
        Self::Other(error.into())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Read { .. } | SceneError::Invalid(_) => Self::input(error),
            SceneError::Echo(_) => Self::other(error),
        }
    }
}

impl From<PackError> for Failure {
    fn from(error: PackError) -> Self {
        match error {
            PackError::Generate(_) | PackError::Prepare(_) | PackError::Write { .. } => {
                Self::other(error)
            }
            _ => Self::input(error),
        }
    }
}

impl From<PathError> for Failure {
    fn from(error: PathError) -> Self {
        Self::input(error)
    }
}

impl From<TwinError> for Failure {
    fn from(error: TwinError) -> Self {
        match error {
            TwinError::Empty | TwinError::History(_) | TwinError::Cell(_) => Self::input(error),
            TwinError::Threads { .. } => Self::other(error),
        }
    }
}

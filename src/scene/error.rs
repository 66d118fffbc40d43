//! What can be wrong with a scene.

use std::fmt;
use std::io;
use std::path::PathBuf;

/// One thing that is wrong in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The scene file.
    pub file: PathBuf,
    /// Line and column, both from 1; `None` when the field is not in the file.
    pub position: Option<(u64, u64)>,
    /// The field, such as `materials.glass.poisson`; empty for the scene as a whole.
    pub field: String,
    /// What is wrong with it and what is allowed.
    pub text: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{}:", self.file.display())?;
        if let Some((line, column)) = self.position {
            write!(to, "{line}:{column}:")?;
        }
        if !self.field.is_empty() {
            write!(to, " {}:", self.field)?;
        }
        write!(to, " {}", self.text)
    }
}

/// Why a scene could not be loaded.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{}: the scene cannot be read: {source}", file.display())]
    Read {
        /// The scene file.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The scene is wrong: every problem that was found, one a line.
    #[error("{}", lines(.0))]
    Invalid(Vec<Problem>),
    /// The scene cannot be written as YAML.
    #[error("the scene cannot be written as YAML: {0}")]
    Echo(String),
}

fn lines(problems: &[Problem]) -> String {
    problems.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

//! Where a recording goes.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::RecordError;

/// A folder, and the names of the files in it that rosbag2 would give: `NAME/NAME_0.mcap`.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub(super) folder: PathBuf,
    name: String,
}

impl Target {
    pub(super) fn new(folder: &Path) -> Self {
        let name = folder.canonicalize().ok().and_then(|folder| {
            folder.file_name().and_then(|name| name.to_str()).map(str::to_owned)
        });
        Self { folder: folder.to_owned(), name: name.unwrap_or_else(|| "recording".into()) }
    }

    /// The files that follow upon the one called `last`, and the number of the next. The folder may
    /// have got another name since.
    pub(super) fn after(folder: &Path, last: &str) -> Option<(Self, u64)> {
        let (name, number) = last.strip_suffix(".mcap")?.rsplit_once('_')?;
        let next = number.parse::<u64>().ok()?.checked_add(1)?;
        Some((Self { folder: folder.to_owned(), name: name.to_owned() }, next))
    }

    /// Name of file `number`.
    pub(super) fn file_name(&self, number: u64) -> String {
        format!("{}_{number}.mcap", self.name)
    }

    /// File `number`.
    pub(super) fn file(&self, number: u64) -> PathBuf {
        self.folder.join(self.file_name(number))
    }

    /// The description of the whole.
    pub(super) fn description(&self) -> PathBuf {
        self.folder.join(DESCRIPTION)
    }
}

/// Name of the description of a bag.
pub(super) const DESCRIPTION: &str = "metadata.yaml";

/// Makes `folder` unless it is there and empty: what [`Recorder::create`](super::Recorder::create)
/// does first.
///
/// # Errors
/// When `folder` is a file, holds something, or cannot be made.
pub fn claim(folder: &Path) -> Result<(), RecordError> {
    let failed = |error: io::Error| RecordError::Create {
        path: folder.to_owned(),
        reason: error.to_string(),
    };
    if folder.exists() && !folder.is_dir() {
        return Err(RecordError::NotAFolder(folder.to_owned()));
    }
    fs::create_dir_all(folder).map_err(failed)?;
    if fs::read_dir(folder).map_err(failed)?.next().is_some() {
        return Err(RecordError::NotEmpty(folder.to_owned()));
    }
    Ok(())
}

//! Storing a pack: grains, box and history.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::Path;

use super::{Pack, PackError, beside, box_file, csv, history, history_file};

/// What the files of a pack hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Texts {
    /// The CSV, with the constants of every grain.
    pub csv: String,
    /// The JSON beside it: the box, and the name of the file with the history.
    pub json: String,
    /// That file, when there is a history.
    pub history: Option<String>,
}

/// The files of `pack` as texts; the one with its history will be called `history_name`.
/// Reading them gives the same bits.
///
/// # Errors
/// When the history does not fit the grains.
pub fn texts(pack: &Pack, history_name: &str) -> Result<Texts, PackError> {
    let json = |history| history::to_json(history, pack.grains.len());
    let history = pack.history.as_ref().map(json).transpose();
    let history = history.map_err(|text| PackError::History { file: history_name.into(), text })?;
    let name = history.as_ref().map(|_| history_name);
    Ok(Texts { csv: csv::to_csv(pack), json: beside::to_json(&pack.bounds, name), history })
}

/// Writes `pack` as a CSV, and beside it as JSON the box and, when there is one, the history.
/// The files of a pack that stood there are replaced or removed. Reading gives the same bits.
///
/// # Errors
/// When the name does not end with `.csv` or is not UTF-8, the history does not fit the grains, or
/// a file cannot be written.
pub fn save(pack: &Pack, file: &Path) -> Result<(), PackError> {
    let beside = history_file(file);
    let name = beside.file_name().and_then(|name| name.to_str());
    let (Some("csv"), Some(name)) = (file.extension().and_then(|end| end.to_str()), name) else {
        return Err(PackError::Name { file: file.into() });
    };
    let texts = texts(pack, name)?;
    match texts.history {
        Some(history) => written(fs::write(&beside, history), &beside)?,
        None => match fs::remove_file(&beside) {
            Err(error) if error.kind() == ErrorKind::NotFound => {}
            removed => written(removed, &beside)?,
        },
    }
    written(fs::write(file, texts.csv), file)?;
    let beside = box_file(file);
    written(fs::write(&beside, texts.json), &beside)
}

fn written(result: io::Result<()>, file: &Path) -> Result<(), PackError> {
    result.map_err(|source| PackError::Write { file: file.into(), source })
}

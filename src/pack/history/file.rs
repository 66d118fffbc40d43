//! The JSON that holds a pack's history, beside its CSV.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::{History, MOST_BODIES};
use crate::pack::PackError;

/// Most bytes of the file for each grain: 100 contacts need 25 kB, 100 layers another 12 kB.
const BYTES_A_GRAIN: u64 = 128 << 10;

/// The file with the history of a pack: `PACK.history.json` beside `PACK.csv`.
#[must_use]
pub fn history_file(csv: &Path) -> PathBuf {
    csv.with_extension("history.json")
}

/// The history of a pack of `grains` grains as JSON, one entry a line. Reading it gives the same
/// bits.
///
/// # Errors
/// When the history is not one of such a pack; [`read`] would refuse it.
pub(in crate::pack) fn to_json(history: &History, grains: usize) -> Result<String, String> {
    history.check_among(grains, MOST_BODIES)?;
    let rotations = lines(&history.rotation)?;
    let contacts = lines(&history.contacts)?;
    let bonds = match history.bonds.is_empty() {
        true => String::new(),
        false => format!(",\n\"bonds\": [\n{}\n]", lines(&history.bonds)?),
    };
    Ok(format!("{{\"rotations\": [\n{rotations}\n],\n\"contacts\": [\n{contacts}\n]{bonds}}}\n"))
}

fn lines<T: Serialize>(entries: &[T]) -> Result<String, String> {
    let lines: Result<Vec<_>, _> = entries.iter().map(serde_json::to_string).collect();
    lines.map(|lines| lines.join(",\n")).map_err(|error| error.to_string())
}

/// Reads the history of a pack of `grains` grains.
///
/// # Errors
/// When the file cannot be read, is much larger than such a pack needs, or holds no history of it.
pub(in crate::pack) fn read(file: &Path, grains: usize) -> Result<History, PackError> {
    let wrong = |text: String| PackError::History { file: file.into(), text };
    let most = BYTES_A_GRAIN.saturating_mul(grains as u64);
    let bytes = at_most(file, most.saturating_add(1))
        .map_err(|source| PackError::ReadHistory { file: file.into(), source })?;
    if bytes.len() as u64 > most {
        return Err(wrong(format!("larger than {most} bytes, which {grains} grains never need")));
    }
    parse(&bytes, file, grains)
}

/// As [`read`] for a file in memory; `file` is what errors name.
pub(in crate::pack) fn parse(
    bytes: &[u8],
    file: &Path,
    grains: usize,
) -> Result<History, PackError> {
    let wrong = |text: String| PackError::History { file: file.into(), text };
    let mut json = serde_json::Deserializer::from_slice(bytes);
    let history: History = serde_path_to_error::deserialize(&mut json).map_err(|error| {
        let path = error.path().to_string();
        match path.as_str() {
            "." => wrong(error.inner().to_string()),
            field => wrong(format!("{field}: {}", error.inner())),
        }
    })?;
    json.end().map_err(|error| wrong(error.to_string()))?;
    // The scene knows how many there are.
    history.check_among(grains, MOST_BODIES).map_err(wrong)?;
    Ok(history)
}

fn at_most(file: &Path, bytes: u64) -> io::Result<Vec<u8>> {
    let mut read = Vec::new();
    File::open(file)?.take(bytes).read_to_end(&mut read)?;
    Ok(read)
}

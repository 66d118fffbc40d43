//! The JSON beside a pack's CSV: the box, and the file with the history when there is one.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use super::{History, PackError, PackFile, history};
use crate::wall::Bounds;

/// Keys of a JSON without a box that its message names.
const MAX_KEYS: usize = 4;

/// The file with the box of a pack: `PACK.json` beside `PACK.csv`.
#[must_use]
pub fn box_file(csv: &Path) -> PathBuf {
    csv.with_extension("json")
}

/// The JSON that tells a pack's box, to stand beside its CSV, and the name of the file with its
/// history, which stands there too.
pub(super) fn to_json(bounds: &Bounds, history: Option<&str>) -> String {
    #[derive(Serialize)]
    struct Beside<'a> {
        #[serde(rename = "box")]
        bounds: &'a Bounds,
        #[serde(skip_serializing_if = "Option::is_none")]
        history: Option<&'a str>,
    }
    let json = serde_json::to_string_pretty(&Beside { bounds, history });
    json.expect("six numbers and a text under fixed names are JSON") + "\n"
}

/// The box in the JSON `text`; `file` is what errors name.
pub(super) fn bounds_in(text: &str, file: &Path) -> Result<Bounds, PackError> {
    let wrong = |text: String| PackError::Box { file: file.into(), text };
    let json: Value = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
    let Some(found) = json.get("box") else {
        let keys: Vec<_> = json.as_object().into_iter().flatten().map(|(key, _)| key).collect();
        let shown = &keys[..keys.len().min(MAX_KEYS)];
        let dots = if keys.len() > MAX_KEYS { " and more" } else { "" };
        return Err(wrong(format!("it has no key `box`, only {shown:?}{dots}")));
    };
    let bounds: Bounds =
        serde_json::from_value(found.clone()).map_err(|error| wrong(format!("box: {error}")))?;
    match (0..3).find(|&axis| bounds.min[axis] >= bounds.max[axis]) {
        None => Ok(bounds),
        Some(axis) => Err(wrong(format!(
            "box: max[{axis}] = {:?} is not above min[{axis}] = {:?}",
            bounds.max[axis], bounds.min[axis]
        ))),
    }
}

impl PackFile {
    /// The box in the JSON beside the CSV.
    ///
    /// # Errors
    /// When there is no such file, it cannot be read, or it holds no box.
    pub fn read_box(&self) -> Result<Bounds, PackError> {
        let file = box_file(&self.file);
        let text = fs::read_to_string(&file)
            .map_err(|source| PackError::ReadBox { file: file.clone(), source })?;
        bounds_in(&text, &file)
    }

    /// The history in the file that the JSON beside the CSV names; `None` when there is no such
    /// JSON or it names none.
    ///
    /// # Errors
    /// When one of the two files cannot be read or is wrong.
    pub fn read_history(&self) -> Result<Option<History>, PackError> {
        let beside = box_file(&self.file);
        let text = match fs::read_to_string(&beside) {
            Ok(text) => text,
            Err(source) if source.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(PackError::ReadHistory { file: beside, source }),
        };
        let json: Value = serde_json::from_str(&text).map_err(|error| PackError::History {
            file: beside.clone(),
            text: error.to_string(),
        })?;
        let name = match json.get("history") {
            None => return Ok(None),
            Some(Value::String(name)) => name,
            Some(other) => {
                let text = format!("history: {other}; allowed: the name of a file");
                return Err(PackError::History { file: beside, text });
            }
        };
        history::read(&beside.with_file_name(name), self.rows.len()).map(Some)
    }
}

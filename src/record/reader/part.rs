//! Where the files of a bag are, and what stands in their place.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::ReadError;

/// Bytes asked of a file at once.
const BUFFER: usize = 64 << 10;

/// Most of rosbag2's description of a folder that is looked at \[bytes\].
const DESCRIPTION: u64 = 1 << 20;

/// One file of a bag.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) path: PathBuf,
    /// What is in it, when it is not on disk.
    bytes: Option<Arc<[u8]>>,
}

impl Part {
    /// Bytes that are called `path`.
    pub(super) fn from_bytes(path: &Path, bytes: Arc<[u8]>) -> Self {
        Self { path: path.to_owned(), bytes: Some(bytes) }
    }

    /// Its bytes from the front.
    pub(super) fn read(&self) -> io::Result<Box<dyn Read + Send>> {
        Ok(match &self.bytes {
            Some(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
            None => Box::new(BufReader::with_capacity(BUFFER, File::open(&self.path)?)),
        })
    }
}

/// Whether `path` is called like a bag, of whatever storage: a folder, or a file of one.
#[must_use]
pub fn is_bag(path: &Path) -> bool {
    path.is_dir() || is_mcap(path) || foreign(path).is_some()
}

/// The parts of the bag at `path`, a folder or a file.
pub(super) fn find(path: &Path) -> Result<Vec<Part>, ReadError> {
    let failed = |error| ReadError::Io { path: path.to_owned(), error };
    if !fs::metadata(path).map_err(failed)?.is_dir() {
        return Ok(vec![part(path)?]);
    }
    let mut files = Vec::new();
    let mut others = None;
    for entry in fs::read_dir(path).map_err(failed)? {
        let file = entry.map_err(failed)?.path();
        if is_mcap(&file) {
            files.push(file);
        } else if foreign(&file).is_some() {
            others = Some(file);
        }
    }
    if let Some(file) = others {
        part(&file)?;
    }
    if files.is_empty() {
        return Err(ReadError::NoBag(path.to_owned()));
    }
    if packs_messages(&path.join("metadata.yaml")) {
        return Err(ReadError::Packed { path: path.to_owned(), what: "message by message" });
    }
    // Parts are numbered without leading zeros.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    files.iter().map(|file| part(file)).collect()
}

/// The file at `path`, if it is one that can be read.
fn part(path: &Path) -> Result<Part, ReadError> {
    match foreign(path) {
        Some(Foreign::Sqlite) => return Err(ReadError::Sqlite(path.to_owned())),
        Some(Foreign::Packed) => {
            return Err(ReadError::Packed { path: path.to_owned(), what: "file by file" });
        }
        None => {}
    }
    // Opening a pipe would wait for a writer.
    let found = fs::metadata(path);
    match found.map_err(|error| ReadError::Io { path: path.to_owned(), error })?.is_file() {
        true => Ok(Part { path: path.to_owned(), bytes: None }),
        false => Err(ReadError::NoFile(path.to_owned())),
    }
}

fn is_mcap(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "mcap")
}

/// Storage of rosbag2 that is not read here.
enum Foreign {
    Sqlite,
    Packed,
}

fn foreign(path: &Path) -> Option<Foreign> {
    let inner = || path.file_stem().map(Path::new).and_then(Path::extension);
    let is_storage = |extension: &OsStr| extension == "mcap" || extension == "db3";
    match path.extension()?.to_str()? {
        "db3" => Some(Foreign::Sqlite),
        "zstd" | "lz4" if inner().is_some_and(is_storage) => Some(Foreign::Packed),
        _ => None,
    }
}

/// Whether rosbag2's description says that every message is packed by itself, which the file does
/// not say.
fn packs_messages(description: &Path) -> bool {
    let mut text = String::new();
    let Ok(file) = File::open(description) else { return false };
    if file.take(DESCRIPTION).read_to_string(&mut text).is_err() {
        return false;
    }
    text.lines()
        .filter_map(|line| line.trim().strip_prefix("compression_mode:"))
        .any(|mode| mode.trim().trim_matches(['"', '\'']).eq_ignore_ascii_case("message"))
}

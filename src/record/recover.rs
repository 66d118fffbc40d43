//! Recordings that were cut off or damaged, made whole again.
//!
//! Of an own recording what is kept ends with the last whole answer: a command, its measures and
//! its report. What came beside the answers is kept to the end. Of other bags every message that can
//! be read is kept. Definitions, topics with their quality of service, attachments, metadata records,
//! times and sequence numbers stay as they are; a file that had to be written again says so in the
//! metadata record [`RECOVERED`](super::RECOVERED).

mod account;
mod rewrite;
mod track;

use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::bag::{Channel, Contents, Past};
use super::reader::{self, Bag, Items, ReadError};
use super::target::{DESCRIPTION, Target};
use super::worker::Beginning;
use super::{RecordError, claim, metadata};

pub use account::{Account, Answers, File};
use rewrite::{RewriteError, rewrite};

/// How files are called while they are written, so that nobody takes them for part of the bag.
const UNFINISHED: &str = "unfinished";

/// Why a bag could not be recovered.
#[derive(Debug, thiserror::Error)]
pub enum RecoverError {
    /// It cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The target cannot be used.
    #[error(transparent)]
    Target(#[from] RecordError),
    /// The target cannot be written.
    #[error("cannot write {}: {reason}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// It is no recording of this program.
    #[error("{} is no recording of graintwin", .0.display())]
    Foreign(PathBuf),
    /// More than its end is missing.
    #[error(
        "{damage}, and files follow upon it: only `graintwin recover` into another folder makes of \
         that a recording"
    )]
    Middle {
        /// What is wrong.
        damage: Box<ReadError>,
    },
}

/// What was recovered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recovered {
    /// Where it is.
    pub folder: PathBuf,
    /// Its files.
    pub files: usize,
    /// How many of them had to be written again.
    pub rewritten: usize,
    /// Messages in them.
    pub kept: u64,
    /// Messages that could be read and are not in them: parts of an answer that was cut off.
    pub dropped: u64,
    /// Files that were left out: those behind the damage of an own recording, and those without a
    /// whole answer.
    pub left_out: usize,
}

/// Makes of the bag at `bag` a whole one in `folder`, which must be new or empty.
///
/// # Errors
/// When the bag cannot be read, or `folder` not be written.
pub fn recover(bag: &Path, folder: &Path) -> Result<Recovered, RecoverError> {
    let bag = Bag::open(bag)?;
    let account = Account::of(&bag)?;
    claim(folder)?;
    let mut files = Vec::new();
    let mut rewritten = 0;
    for ((path, items), file) in bag.files().zip(&account.files) {
        if file.behind {
            continue;
        }
        let name = file_name(path);
        let target = folder.join(&name);
        let contents = if is_whole(&account, file) {
            copy(path, &target)?;
            file.contents.clone()
        } else {
            let contents = write_again(&account, file, items, &target)?;
            if contents.messages() == 0 && !files.is_empty() {
                fs::remove_file(&target).map_err(|error| unwritten(&target, &error))?;
                continue;
            }
            rewritten += 1;
            contents
        };
        files.push(metadata::File { name, contents });
    }
    let description = folder.join(DESCRIPTION);
    let told = bag.path().join(DESCRIPTION);
    if account.is_whole() && told.is_file() {
        copy(&told, &description)?;
    } else {
        fs::write(&description, metadata::file(&files))
            .map_err(|error| unwritten(&description, &error))?;
    }
    Ok(recovered(folder, &account, &files, rewritten))
}

/// Makes the recording in `folder` whole where it is, so that it can go on
/// ([`Recorder::resume`](super::Recorder::resume)). A crash meanwhile loses nothing, and to do it
/// again changes nothing.
///
/// # Errors
/// When `folder` holds no recording of this program, more than its end is missing, or the system
/// says no; what was whole is as it was then.
pub fn in_place(folder: &Path) -> Result<Recovered, RecoverError> {
    let bag = Bag::open(folder)?;
    let account = Account::of(&bag)?;
    if !account.own || !folder.is_dir() {
        return Err(RecoverError::Foreign(folder.to_owned()));
    }
    let last = account.files.len() - 1;
    if let Some(behind) = account.files.iter().position(|file| file.damage.is_some())
        && behind < last
    {
        let Account { mut files, .. } = account;
        return Err(match files.swap_remove(behind).damage {
            Some(damage) => RecoverError::Middle { damage: Box::new(damage) },
            None => RecoverError::Foreign(folder.to_owned()),
        });
    }
    let mut files = Vec::new();
    let mut rewritten = 0;
    let all: Vec<_> = bag.files().zip(&account.files).collect();
    // From the end, so that what is left at any time is a recording that ends earlier.
    for ((path, items), file) in all.into_iter().rev() {
        let name = file_name(path);
        let first = file.before == 0 && account.files.first().is_some_and(|one| one.path == path);
        let contents = if is_whole(&account, file) && (first || file.messages > 0) {
            file.contents.clone()
        } else {
            let unfinished = path.with_extension(UNFINISHED);
            let contents = write_again(&account, file, items, &unfinished)?;
            if contents.messages() == 0 && !first {
                for path in [path, &unfinished] {
                    fs::remove_file(path).map_err(|error| unwritten(path, &error))?;
                }
                continue;
            }
            replace(&unfinished, path)?;
            rewritten += 1;
            contents
        };
        files.push(metadata::File { name, contents });
    }
    files.reverse();
    describe(folder, &metadata::file(&files))?;
    Ok(recovered(folder, &account, &files, rewritten))
}

/// What a recording that goes on begins with.
#[derive(Debug)]
pub(super) struct Resumed {
    pub(super) target: Target,
    pub(super) beginning: Beginning,
    pub(super) past: Past,
}

/// The recording in `folder`, to go on with.
pub(super) fn resumed(folder: &Path) -> Result<Resumed, RecordError> {
    let refuse = |reason: String| RecordError::Resume { path: folder.to_owned(), reason };
    let account = Bag::open(folder)
        .and_then(|bag| Account::of(&bag))
        .map_err(|error| refuse(error.to_string()))?;
    if !account.own {
        return Err(refuse("it is no recording of graintwin".into()));
    }
    if !account.is_whole() {
        return Err(refuse("it is not whole".into()));
    }
    let mut finished = Vec::new();
    let mut finished_bytes = 0;
    let mut last = None;
    for file in account.files {
        finished_bytes += fs::metadata(&file.path).map_or(0, |found| found.len());
        last = last.max(file.contents.times.map(|(_, last)| last));
        let name = file_name(&file.path);
        finished.push(metadata::File { name, contents: file.contents });
    }
    let name = finished.last().map(|file| file.name.clone()).unwrap_or_default();
    let (target, number) = Target::after(folder, &name)
        .ok_or_else(|| refuse(format!("`{name}` has no number, as NAME_0.mcap has")))?;
    let past = Past { last, frames: account.frames };
    Ok(Resumed { target, beginning: Beginning { finished, finished_bytes, number }, past })
}

impl From<&reader::Channel> for Channel {
    fn from(channel: &reader::Channel) -> Self {
        let reader::Channel { topic, kind, encoding, about, .. } = channel;
        Self {
            topic: topic.clone(),
            kind: kind.clone(),
            encoding: encoding.clone(),
            about: about.clone(),
            messages: 0,
        }
    }
}

fn is_whole(account: &Account, file: &File) -> bool {
    file.damage.is_none() && (account.dropped == 0 || file.before + file.messages <= account.whole)
}

fn recovered(
    folder: &Path,
    account: &Account,
    files: &[metadata::File],
    rewritten: usize,
) -> Recovered {
    Recovered {
        folder: folder.to_owned(),
        files: files.len(),
        rewritten,
        kept: account.kept,
        dropped: account.dropped,
        left_out: account.files.len() - files.len(),
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

fn unwritten(path: &Path, error: &io::Error) -> RecoverError {
    RecoverError::Write { path: path.to_owned(), reason: error.to_string() }
}

fn copy(from: &Path, to: &Path) -> Result<(), RecoverError> {
    fs::copy(from, to).map(|_| ()).map_err(|error| unwritten(to, &error))
}

/// Writes what is whole of `file` to `target`, which is on disk then; or nothing.
fn write_again(
    account: &Account,
    file: &File,
    items: Items,
    target: &Path,
) -> Result<Contents, RecoverError> {
    write_to_disk(account, file, items, target).inspect_err(|_| {
        // A part of it is of no use, and takes room.
        fs::remove_file(target).ok();
    })
}

fn write_to_disk(
    account: &Account,
    file: &File,
    items: Items,
    target: &Path,
) -> Result<Contents, RecoverError> {
    let failed = |error: io::Error| unwritten(target, &error);
    let to = BufWriter::new(fs::File::create(target).map_err(failed)?);
    let written = rewrite(account, file, items, &file_name(&file.path), to);
    let (to, contents) = written.map_err(|error| match error {
        RewriteError::Read(error) => error.into(),
        RewriteError::Write(error) => {
            RecoverError::Write { path: target.to_owned(), reason: error.to_string() }
        }
    })?;
    let to = to.into_inner().map_err(|error| failed(error.into_error()))?;
    to.sync_all().map_err(failed)?;
    Ok(contents)
}

/// Puts `unfinished` in the place of `path`: there is one or the other at any time.
fn replace(unfinished: &Path, path: &Path) -> Result<(), RecoverError> {
    fs::rename(unfinished, path).map_err(|error| unwritten(path, &error))?;
    let folder = path.parent().unwrap_or(Path::new("."));
    // That the name is on disk too; a system that cannot say so has nothing better.
    fs::File::open(folder).and_then(|folder| folder.sync_all()).ok();
    Ok(())
}

/// Writes the description of the folder, unless it says the same.
fn describe(folder: &Path, text: &str) -> Result<(), RecoverError> {
    let path = folder.join(DESCRIPTION);
    if fs::read_to_string(&path).is_ok_and(|told| told == text) {
        return Ok(());
    }
    let unfinished = path.with_extension(UNFINISHED);
    let failed = |error: io::Error| unwritten(&unfinished, &error);
    let mut file = fs::File::create(&unfinished).map_err(failed)?;
    file.write_all(text.as_bytes()).and_then(|()| file.sync_all()).map_err(failed)?;
    replace(&unfinished, &path)
}

//! What can be wrong with a pack.

use std::io;
use std::path::PathBuf;

use super::generate::GenerateError;
use super::prepare::PrepareError;
use crate::table::TableError;

/// Why there is no pack.
#[derive(Debug, thiserror::Error)]
pub enum PackError {
    /// The CSV is wrong.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The JSON with the box cannot be read.
    #[error(
        "{}: cannot be read: {source}; the box of a pack stands there or in the scene, \
         `pack: {{file: ..., box: {{min: [x, y, z], max: [x, y, z]}}}}`",
        file.display()
    )]
    ReadBox {
        /// The JSON.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// The JSON holds no box.
    #[error(
        "{}: {text}; allowed: `{{\"box\": {{\"min\": [x, y, z], \"max\": [x, y, z]}}}}`, or the box \
         in the scene, `pack: {{file: ..., box: {{min: [x, y, z], max: [x, y, z]}}}}`",
        file.display()
    )]
    Box {
        /// The JSON.
        file: PathBuf,
        /// What is wrong with it.
        text: String,
    },
    /// A file that tells the history cannot be read.
    #[error("{}: the history of the pack cannot be read: {source}", file.display())]
    ReadHistory {
        /// The JSON with the history, or that which names it.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// A history is wrong.
    #[error("{}: {text}", file.display())]
    History {
        /// The JSON with the history, or that which names it.
        file: PathBuf,
        /// Which entry is wrong and what is allowed.
        text: String,
    },
    /// The pack could not be made.
    #[error(transparent)]
    Generate(#[from] GenerateError),
    /// The pack could not be prepared.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// The scene names no source of grains.
    #[error(
        "pack: neither `generate` nor `crystal` nor `file` is given; allowed: exactly one of them"
    )]
    NoSource,
    /// The scene names a material that it does not have.
    #[error("{field}: no material is named `{name}`; allowed: one of `materials`")]
    UnknownMaterial {
        /// Where.
        field: &'static str,
        /// The name.
        name: String,
    },
    /// Both the scene and the file say which grains are hydrate.
    #[error(
        "pack.hydrate: {} says itself which grains are hydrate, in its column `hydrate`; allowed: \
         one of the two",
        file.display()
    )]
    TwiceHydrate {
        /// The CSV.
        file: PathBuf,
    },
    /// The cut leaves nothing.
    #[error(
        "pack.cut: none of the {grains} grains lies wholly inside; allowed: a box that holds one"
    )]
    EmptyCut {
        /// Grains before the cut.
        grains: usize,
    },
    /// Nothing tells what the grains are made of.
    #[error(
        "{}: it has neither a column `material` nor `young,poisson,density,friction`; allowed \
         besides: `pack.material` in the scene, one for all grains",
        file.display()
    )]
    NoMaterial {
        /// The CSV.
        file: PathBuf,
    },
    /// The name is not that of a CSV.
    #[error("{}: a pack is stored as CSV with its box beside it; allowed: a name with .csv", file.display())]
    Name {
        /// The file.
        file: PathBuf,
    },
    /// The pack cannot be stored.
    #[error("{}: the pack cannot be written: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

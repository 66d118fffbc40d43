//! Making a run again from its recording alone.
//!
//! A recording holds the scene with all defaults, the pack as it was at the start, every command,
//! and what else bears on the answers, in order. [`Replay`] takes them out; its [`Tape`] is the
//! run step by step. Each [`Step`] can be played to a twin and its answers compared, message by
//! message and byte by byte, with what was recorded. Excepted is `solve_seconds`, a wall clock;
//! what came and went beside the twin (load cells, the log, diagnostics) is not made again.
//!
//! The bits depend neither on the number of threads nor on the kernels
//! ([`lanes`](crate::relax::lanes)); they do depend on the version of the program.

mod compare;
mod step;
mod tape;

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::reader::{Bag, Item, ReadError};
use super::{HISTORY, PROGRAM};
use crate::pack::{self, Pack, PackError, Texts};
use crate::scene::{self, Scene, SceneError};

pub use compare::{Compared, Difference};
pub use step::{Act, Answer, Step};
pub use tape::Tape;

/// Why a recording cannot be replayed.
#[derive(Debug, thiserror::Error)]
pub enum ReplayError {
    /// The bag cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// It is not a recording of this program.
    #[error(
        "{} has no attachment `{what}`: it is no recording of graintwin; commands are taken from \
         others with a scene (--scene)",
        .bag.display()
    )]
    Foreign {
        /// The bag.
        bag: PathBuf,
        /// What it lacks.
        what: &'static str,
    },
    /// The scene in it is none.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The pack in it is none.
    #[error(transparent)]
    Pack(#[from] PackError),
    /// Its messages do not tell what happened.
    #[error("{}: message {number} of the run, on {topic}: {reason}", .bag.display())]
    Tape {
        /// The bag.
        bag: PathBuf,
        /// Which, counted from 1 over all topics.
        number: u64,
        /// The topic.
        topic: String,
        /// What is wrong.
        reason: String,
    },
}

/// A recording that can be made again.
#[derive(Debug)]
pub struct Replay<'a> {
    /// The scene of the run.
    pub scene: Scene,
    /// The pack at its start.
    pub pack: Pack,
    /// What recorded it: `version`, `kernels`, `threads` and so on.
    pub program: BTreeMap<String, String>,
    bag: &'a Bag,
}

impl<'a> Replay<'a> {
    /// Takes scene and pack out of `bag`; `scene` stands in for the one in it.
    ///
    /// # Errors
    /// When the bag cannot be read so far, lacks one of them, or one of them is wrong.
    pub fn open(bag: &'a Bag, scene: Option<Scene>) -> Result<Self, ReplayError> {
        let mut files: BTreeMap<String, Vec<u8>> = BTreeMap::new();
        let mut program = BTreeMap::new();
        for item in bag.items() {
            match item? {
                Item::Attachment { name, data, .. } => {
                    files.entry(name).or_insert(data);
                }
                Item::Metadata { name, values } if name == PROGRAM => program = values,
                // They stand in front of the first.
                Item::Message(_) => break,
                Item::Metadata { .. } | Item::Channel(_) => {}
            }
        }
        let path = bag.path();
        let mut text = |what: &'static str| {
            let bytes = files.remove(what);
            let bytes = bytes.ok_or_else(|| ReplayError::Foreign { bag: path.into(), what })?;
            Ok::<_, ReplayError>(String::from_utf8_lossy(&bytes).into_owned())
        };
        let yaml = text("scene.yaml")?;
        let texts = Texts { csv: text("pack.csv")?, json: text("pack.json")?, history: None };
        let history = files.remove(HISTORY);
        let history = history.map(|json| String::from_utf8_lossy(&json).into_owned());
        let scene = match scene {
            Some(scene) => scene,
            None => scene::parse(&yaml, &path.join("scene.yaml"))?,
        };
        let texts = Texts { history, ..texts };
        let pack = pack::from_texts(&scene, &texts, &path.join("pack.csv"))?;
        Ok(Self { scene, pack, program, bag })
    }

    /// The run step by step.
    #[must_use]
    pub fn tape(&self) -> Tape {
        Tape::new(self.bag)
    }
}

//! The parameters of the node: what each means, which values it takes, and what it is now.
//!
//! The store is pure; the node's services speak DDS for it. A set is all or nothing. Values that hold for
//! the running twin reach it through [`Changes`], which the solver's thread looks at between two
//! commands.

mod descriptor;
mod live;
pub mod overrides;
pub(super) mod services;
mod value;
mod yaml;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

pub use descriptor::{Descriptor, Field, Fixed, Range, all};
pub use live::{Changes, Live};
use overrides::Override;
pub use value::{Kind, Value};

use crate::scene::Scene;

/// Between the parts of a name.
const SEPARATOR: char = '.';

/// Why a parameter was not set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// There is none of that name.
    #[error("there is no parameter `{name}`: there are {}", names())]
    Unknown {
        /// The name.
        name: String,
    },
    /// It tells, it does not take.
    #[error("{name} is read-only: it tells what the scene or the command line says")]
    ReadOnly {
        /// Its name.
        name: &'static str,
    },
    /// It counts at the start.
    #[error("{name} is read-only while the node runs: start it with -p {name}:=VALUE")]
    Late {
        /// Its name.
        name: &'static str,
    },
    /// A value of another type.
    #[error("{name} is of type {needed}, not {found}{}", hint(*.needed, *.found))]
    Kind {
        /// Its name.
        name: &'static str,
        /// Its type.
        needed: Kind,
        /// The value's type.
        found: Kind,
    },
    /// A value outside of the range.
    #[error("{name} cannot be {found:?}: {range} is allowed")]
    Outside {
        /// Its name.
        name: &'static str,
        /// The value.
        found: f64,
        /// What is allowed.
        range: Range,
    },
    /// Taking it away.
    #[error("{name} cannot be removed")]
    Removal {
        /// Its name.
        name: &'static str,
    },
}

fn names() -> String {
    let names: Vec<&str> = all().iter().map(|descriptor| descriptor.name).collect();
    names.join(", ")
}

fn hint(needed: Kind, found: Kind) -> &'static str {
    match (needed, found) {
        (Kind::DOUBLE, Kind::INTEGER) => ": write it with a point, as 1.0",
        _ => "",
    }
}

/// A value that was not taken, and where it stands.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{origin}: {refusal}")]
pub struct BadOverride {
    /// File and line, or the argument.
    pub origin: String,
    /// What is wrong with it.
    pub refusal: Refusal,
}

/// The store. Clones are the same store.
#[derive(Clone, Debug)]
pub struct Parameters(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    fixed: Fixed,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    live: Live,
    /// What the solver's thread has not seen yet.
    pending: Option<Live>,
}

impl Parameters {
    /// The parameters of a twin of `scene` that works on `threads` threads.
    #[must_use]
    pub fn new(scene: &Scene, threads: usize) -> Self {
        let state = State { live: Live::of(scene), pending: None };
        Self(Arc::new(Shared { fixed: Fixed::of(scene, threads), state: Mutex::new(state) }))
    }

    /// Takes the values that the node is started with, in order. Returns sentences about those
    /// for parameters that do not exist, which do no harm: files are shared among nodes.
    ///
    /// # Errors
    /// When a parameter does not take the value.
    pub fn start_with(&self, overrides: &[Override]) -> Result<Vec<String>, BadOverride> {
        let mut unknown = Vec::new();
        for Override { name, value, origin } in overrides {
            match self.take(&[(name.clone(), value.clone())]) {
                Ok(()) => {}
                Err(refusal @ Refusal::Unknown { .. }) => {
                    unknown.push(format!("{origin}: {refusal}"));
                }
                Err(refusal) => return Err(BadOverride { origin: origin.clone(), refusal }),
            }
        }
        // The twin is made with them.
        self.state().pending = None;
        Ok(unknown)
    }

    /// Sets all of `wanted`, the last where a name comes twice, or none.
    ///
    /// # Errors
    /// With the first that cannot be set.
    pub fn set(&self, wanted: &[(String, Value)]) -> Result<(), Refusal> {
        for (name, _) in wanted {
            let descriptor = find(name)?;
            if descriptor.at_start() {
                return Err(Refusal::Late { name: descriptor.name });
            }
        }
        self.take(wanted)
    }

    fn take(&self, wanted: &[(String, Value)]) -> Result<(), Refusal> {
        let mut state = self.state();
        let mut live = state.live;
        for (name, value) in wanted {
            find(name)?.set(&mut live, value)?;
        }
        if !wanted.is_empty() {
            state.live = live;
            state.pending = Some(live);
        }
        Ok(())
    }

    /// The value of a parameter; `None` when there is none of that name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Value> {
        let live = self.live();
        find(name).ok().map(|descriptor| descriptor.get(&live, &self.0.fixed))
    }

    /// The values that hold for the running twin.
    #[must_use]
    pub fn live(&self) -> Live {
        self.state().live
    }

    /// Where the solver's thread finds out what was changed. One is enough.
    #[must_use]
    pub fn changes(&self) -> Changes {
        Changes(self.clone())
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // What is behind the lock is whole at any time.
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The parameter of that name.
fn find(name: &str) -> Result<&'static Descriptor, Refusal> {
    let found = all().iter().find(|descriptor| descriptor.name == name);
    found.ok_or_else(|| Refusal::Unknown { name: name.into() })
}

/// Names as `list_parameters` asks for them: those that are one of `prefixes` or below one, or all
/// without any; with a `depth` other than 0 only those with fewer separators behind the prefix.
/// Beside them, everything that a name is below of.
#[must_use]
pub fn list(prefixes: &[String], depth: u64) -> (Vec<&'static str>, Vec<&'static str>) {
    let shallow = |rest: &str| depth == 0 || (rest.matches(SEPARATOR).count() as u64) < depth;
    let listed = |name: &str| {
        let below = |prefix: &String| {
            name.strip_prefix(prefix.as_str()).is_some_and(|rest| {
                (rest.is_empty() || rest.starts_with(SEPARATOR)) && shallow(rest)
            })
        };
        if prefixes.is_empty() { shallow(name) } else { prefixes.iter().any(below) }
    };
    let names: Vec<_> = all().iter().map(|one| one.name).filter(|name| listed(name)).collect();
    let mut above: Vec<_> =
        names.iter().filter_map(|name| Some(name.rsplit_once(SEPARATOR)?.0)).collect();
    above.sort_unstable();
    above.dedup();
    (names, above)
}

#[cfg(test)]
mod tests;

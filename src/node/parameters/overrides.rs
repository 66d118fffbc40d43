//! Values that a node is started with: `-p NAME:=VALUE` and files for `--params-file`.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_saphyr::Spanned;

use super::yaml::{self, Fault, Yaml};
use super::{SEPARATOR, Value};
use crate::node::names::{self, Identity};

/// Key under which a file holds parameters.
const PARAMETERS: &str = "ros__parameters";

/// Largest file.
const MAX_BYTES: u64 = 1 << 20;

/// Where values come from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// One, from the command line.
    One {
        /// The nodes it is for.
        nodes: Nodes,
        /// The parameter.
        name: String,
        /// Its value.
        value: Value,
    },
    /// A file.
    File(PathBuf),
}

/// Which nodes something is for: parts of a full name, where `*` is any one part and `**` any
/// number of them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Nodes(Vec<String>);

/// A value for a parameter of this node.
#[derive(Clone, Debug, PartialEq)]
pub struct Override {
    /// The parameter.
    pub name: String,
    /// Its value.
    pub value: Value,
    /// Where it stands, for messages.
    pub origin: String,
}

/// Why a file gives no values.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// It cannot be read.
    #[error("{}: {source}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// It is no file of parameters.
    #[error("{}{}: {text}", file.display(), line.map(|line| format!(":{line}")).unwrap_or_default())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// The line, from 1.
        line: Option<u64>,
        /// What is wrong and what is allowed.
        text: String,
    },
}

impl Nodes {
    /// Every node.
    fn every() -> Self {
        Self::new("**")
    }

    fn new(path: &str) -> Self {
        Self(path.split('/').filter(|part| !part.is_empty()).map(Into::into).collect())
    }

    /// Whether a node of this full name is one of them.
    #[must_use]
    pub fn hold(&self, full_name: &str) -> bool {
        let parts: Vec<&str> = full_name.split('/').filter(|part| !part.is_empty()).collect();
        // Whether the pattern so far fits the first so many parts of the name.
        let mut fits = vec![false; parts.len() + 1];
        fits[0] = true;
        for pattern in &self.0 {
            if pattern == "**" {
                let first = fits.iter().position(|fit| *fit).unwrap_or(fits.len());
                fits[first..].fill(true);
                continue;
            }
            for end in (1..fits.len()).rev() {
                fits[end] = fits[end - 1] && (pattern == "*" || pattern == parts[end - 1]);
            }
            fits[0] = false;
        }
        fits[parts.len()]
    }
}

/// `[NODE:]NAME:=VALUE`, the value in YAML.
pub(in crate::node) fn parse_rule(rule: &str) -> Result<Source, String> {
    let (left, value) = rule.split_once(":=").ok_or("a rule reads NAME:=VALUE, with := between")?;
    let (nodes, name) = match left.split_once(':') {
        Some((node, name)) => {
            names::check_node(node)?;
            (Nodes::new(node), name)
        }
        None => (Nodes::every(), left),
    };
    check_name(name)?;
    let value = match yaml::read(value) {
        Ok(yaml) => yaml.value.value()?,
        Err(Fault { text, .. }) => return Err(format!("`{value}` is no YAML value: {text}")),
    };
    Ok(Source::One { nodes, name: name.into(), value })
}

fn check_name(name: &str) -> Result<(), String> {
    let part = |part: &str| {
        !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || "_-/".contains(c))
    };
    if name.split(SEPARATOR).all(part) {
        return Ok(());
    }
    Err(format!("`{name}` is no name of a parameter: a and a.b are allowed"))
}

/// The values of `sources` for the node `identity`, in order; reads the files.
///
/// # Errors
/// When a file cannot be read or is none of parameters.
pub fn read(sources: &[Source], identity: &Identity) -> Result<Vec<Override>, FileError> {
    let node = identity.full_name();
    let mut all = Vec::new();
    for source in sources {
        match source {
            Source::One { nodes, name, value } if nodes.hold(&node) => all.push(Override {
                name: name.clone(),
                value: value.clone(),
                origin: format!("-p {name}"),
            }),
            Source::One { .. } => {}
            Source::File(file) => all.extend(parse_file(&text_of(file)?, file, &node)?),
        }
    }
    Ok(all)
}

fn text_of(file: &Path) -> Result<String, FileError> {
    let mut text = String::new();
    File::open(file)
        .and_then(|open| open.take(MAX_BYTES + 1).read_to_string(&mut text))
        .map_err(|source| FileError::Read { file: file.into(), source })?;
    if text.len() as u64 > MAX_BYTES {
        let text = "larger than 1 MiB".into();
        return Err(FileError::Invalid { file: file.into(), line: None, text });
    }
    Ok(text)
}

/// The values in `text` for the node of this full name; `file` is what errors name.
///
/// # Errors
/// When the text is no file of parameters.
pub fn parse_file(text: &str, file: &Path, node: &str) -> Result<Vec<Override>, FileError> {
    let mut all = Vec::new();
    yaml::read(text)
        .and_then(|root| sections(&root, "", file, node, &mut all))
        .map_err(|Fault { line, text }| FileError::Invalid { file: file.into(), line, text })?;
    Ok(all)
}

/// Walks through namespaces and nodes.
fn sections(
    here: &Spanned<Yaml>,
    path: &str,
    file: &Path,
    node: &str,
    all: &mut Vec<Override>,
) -> Result<(), Fault> {
    let entries = match &here.value {
        Yaml::Map(entries) => entries,
        Yaml::Null => return Ok(()),
        _ => {
            return Err(Fault {
                line: Some(yaml::line(here)),
                text: format!(
                    "a single value or a list stands here; allowed: `NODE: {{{PARAMETERS}: ...}}`, \
                     with /** for every node"
                ),
            });
        }
    };
    for (key, value) in entries {
        if key.value != PARAMETERS {
            sections(value, &format!("{path}/{}", key.value), file, node, all)?;
        } else if path.is_empty() {
            return Err(Fault {
                line: Some(yaml::line(key)),
                text: format!(
                    "{PARAMETERS} stands outside of a node; allowed: `/**: {PARAMETERS}`"
                ),
            });
        } else if Nodes::new(path).hold(node) {
            values(value, "", file, all)?;
        }
    }
    Ok(())
}

/// Walks through the parameters of a node.
fn values(
    here: &Spanned<Yaml>,
    name: &str,
    file: &Path,
    all: &mut Vec<Override>,
) -> Result<(), Fault> {
    let fault = |text| Fault { line: Some(yaml::line(here)), text };
    match &here.value {
        Yaml::Map(entries) => {
            for (key, value) in entries {
                let separator = if name.is_empty() { "" } else { "." };
                values(value, &format!("{name}{separator}{}", key.value), file, all)?;
            }
        }
        Yaml::Null if name.is_empty() => {}
        _ if name.is_empty() => {
            return Err(fault(format!("{PARAMETERS} holds keys with values")));
        }
        value => all.push(Override {
            name: name.into(),
            value: value.value().map_err(|text| fault(format!("{name}: {text}")))?,
            origin: format!("{}:{}", file.display(), yaml::line(here)),
        }),
    }
    Ok(())
}

#[cfg(test)]
mod tests;

//! `--ros-args ... [--]`: what `ros2 launch` and `ros2 run` put on a node's command line.
//!
//! Groups may stand anywhere and more than once; everything outside of them is the program's own.
//! A rule that is none is an error, as for every ROS 2 node. A flag that is not known is not: newer
//! launchers may bring new ones. Nothing here opens a file or reads the environment.

mod remap;

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

pub use remap::{Remap, RemapKind};

use super::parameters::overrides::{self, Source};

/// Begins a group of arguments for the node.
const BEGIN: &str = "--ros-args";

/// Ends a group.
const END: &str = "--";

/// Why arguments for the node are none.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub enum ArgsError {
    /// Nothing follows a flag.
    #[error("{flag} is the last argument of --ros-args: {needs} must follow it")]
    Missing {
        /// The flag.
        flag: String,
        /// What it needs.
        needs: &'static str,
    },
    /// What follows a flag is not what it needs.
    #[error("{flag} {found}: {reason}")]
    Invalid {
        /// The flag.
        flag: String,
        /// What follows it.
        found: String,
        /// What is wrong with it and what is allowed.
        reason: String,
    },
}

/// The arguments for the node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RosArgs {
    /// Remap rules in order; the first that matches a name counts.
    pub remaps: Vec<Remap>,
    /// Values for parameters in order; the last for a parameter counts.
    pub parameters: Vec<Source>,
    /// What is logged where.
    pub log: Log,
    /// What was ignored, in sentences for the log.
    pub ignored: Vec<String>,
}

/// What is logged where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Log {
    /// Least severity of what is logged; `None` leaves the program's own.
    pub level: Option<Severity>,
    /// The same for single loggers, in order; the last for a logger counts.
    pub loggers: Vec<(String, Severity)>,
    /// Whether the log goes to stderr.
    pub console: bool,
    /// Whether the log goes to `/rosout`.
    pub rosout: bool,
}

impl Default for Log {
    fn default() -> Self {
        Self { level: None, loggers: Vec::new(), console: true, rosout: true }
    }
}

/// How grave a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// For whoever looks for a fault.
    Debug,
    /// The normal course.
    Info,
    /// It goes on, but somebody should know.
    Warn,
    /// Something was not done.
    Error,
    /// The program ends.
    Fatal,
}

impl Severity {
    fn named(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().as_str() {
            "debug" => Some(Self::Debug),
            "info" => Some(Self::Info),
            "warn" => Some(Self::Warn),
            "error" => Some(Self::Error),
            "fatal" => Some(Self::Fatal),
            _ => None,
        }
    }
}

/// Takes the groups for the node out of a command line. Returns the rest, and the arguments for
/// the node when there was a group, if only an empty one.
///
/// # Errors
/// When a flag lacks what must follow it, or that is not what the flag needs.
pub fn split(
    arguments: impl IntoIterator<Item = OsString>,
) -> Result<(Vec<OsString>, Option<RosArgs>), ArgsError> {
    let mut rest = Vec::new();
    let mut taken: Option<RosArgs> = None;
    let mut arguments = arguments.into_iter();
    while let Some(argument) = arguments.next() {
        if argument == BEGIN {
            group(&mut arguments, taken.get_or_insert_default())?;
        } else {
            rest.push(argument);
        }
    }
    Ok((rest, taken))
}

/// Reads up to the end of a group.
fn group(
    arguments: &mut impl Iterator<Item = OsString>,
    into: &mut RosArgs,
) -> Result<(), ArgsError> {
    while let Some(argument) = arguments.next() {
        let Some(flag) = argument.to_str() else {
            into.ignored.push(unknown(&argument));
            continue;
        };
        let mut next = |needs| Next::of(flag, needs, arguments.next());
        match flag {
            END => return Ok(()),
            BEGIN => {}
            "-r" | "--remap" => {
                into.remaps.push(next("FROM:=TO")?.parse(remap::parse)?);
            }
            "-p" | "--param" => {
                into.parameters.push(next("NAME:=VALUE")?.parse(overrides::parse_rule)?);
            }
            "--params-file" => {
                into.parameters.push(Source::File(PathBuf::from(next("a file")?.value)));
            }
            "--log-level" => match next("LEVEL or LOGGER:=LEVEL")?.parse(log_level)? {
                (None, level) => into.log.level = Some(level),
                (Some(logger), level) => into.log.loggers.push((logger, level)),
            },
            "-e" | "--enclave" => {
                let enclave = next("an enclave")?.value;
                if enclave != "/" {
                    into.ignored.push(format!(
                        "{flag} {}: this node has no security, no key of an enclave is used",
                        enclave.display()
                    ));
                }
            }
            "--log-config-file" | "--log-file-name" => {
                let file = next("a file")?.value;
                into.ignored.push(format!(
                    "{flag} {}: this node writes no log file, it logs to stderr and /rosout",
                    file.display()
                ));
            }
            "--enable-rosout-logs" => into.log.rosout = true,
            "--disable-rosout-logs" => into.log.rosout = false,
            "--enable-stdout-logs" => into.log.console = true,
            "--disable-stdout-logs" => into.log.console = false,
            // There is no log file to write or not to write.
            "--enable-external-lib-logs" | "--disable-external-lib-logs" => {}
            _ => into.ignored.push(unknown(&argument)),
        }
    }
    Ok(())
}

fn unknown(argument: &OsStr) -> String {
    format!("{} after --ros-args is not known here and is ignored", argument.display())
}

/// What follows a flag.
struct Next<'a> {
    flag: &'a str,
    value: OsString,
}

impl<'a> Next<'a> {
    fn of(flag: &'a str, needs: &'static str, value: Option<OsString>) -> Result<Self, ArgsError> {
        let value = value.ok_or_else(|| ArgsError::Missing { flag: flag.into(), needs })?;
        Ok(Self { flag, value })
    }

    fn parse<T>(self, parse: impl FnOnce(&str) -> Result<T, String>) -> Result<T, ArgsError> {
        let found = self.value.display().to_string();
        let parsed = match self.value.to_str() {
            Some(text) => parse(text),
            None => Err("not UTF-8".into()),
        };
        parsed.map_err(|reason| ArgsError::Invalid { flag: self.flag.into(), found, reason })
    }
}

/// `LEVEL` or `LOGGER:=LEVEL`.
fn log_level(text: &str) -> Result<(Option<String>, Severity), String> {
    let (logger, level) = match text.split_once(":=") {
        Some((logger, level)) => (Some(logger), level),
        None => (None, text),
    };
    if logger.is_some_and(|logger| !is_logger(logger)) {
        return Err("the logger's name must be letters, digits, _ and dots".into());
    }
    let level = Severity::named(level)
        .ok_or_else(|| format!("`{level}` is no level: debug, info, warn, error and fatal are"))?;
    Ok((logger.map(Into::into), level))
}

fn is_logger(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "_.".contains(c))
}

#[cfg(test)]
mod tests;

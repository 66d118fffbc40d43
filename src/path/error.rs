//! What can be wrong with a load path once its scene is right.

use crate::scene::MAX_COMMANDS;
use crate::table::TableError;

/// Why a load path has no commands.
#[derive(Debug, thiserror::Error)]
pub enum PathError {
    /// A file of the path is wrong.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The path has too many commands.
    #[error("the load path has more than {MAX_COMMANDS} commands, files included; allowed: fewer")]
    TooMany,
    /// A stamp does not fit a ROS time.
    #[error("the load path lasts longer than 2147483647 s; allowed: less, file stamps included")]
    TooLong,
}
